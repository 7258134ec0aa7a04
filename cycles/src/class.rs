//! Classes of instructions.

/// What kind of work an instruction does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Class {
    /// Arithmetic, logic, moves, shifts by a constant.
    Alu,
    /// A shift by what a register holds.
    RegisterShift,
    /// Products of 32 bits and of halfwords.
    Multiply,
    /// Products of 64 bits.
    LongMultiply,
    /// Quotients.
    Divide,
    /// Loads.
    Load,
    /// Stores.
    Store,
    /// Branches, calls and returns.
    Branch,
    /// All else: status registers, coprocessors, hints.
    Other,
}

impl Class {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::Alu,
        Self::RegisterShift,
        Self::Multiply,
        Self::LongMultiply,
        Self::Divide,
        Self::Load,
        Self::Store,
        Self::Branch,
        Self::Other,
    ];

    /// Its name in tables and files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Alu => "alu",
            Self::RegisterShift => "register shift",
            Self::Multiply => "multiply",
            Self::LongMultiply => "long multiply",
            Self::Divide => "divide",
            Self::Load => "load",
            Self::Store => "store",
            Self::Branch => "branch",
            Self::Other => "other",
        }
    }
}
