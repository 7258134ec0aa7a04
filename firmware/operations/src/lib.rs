//! Every arithmetic operation by name, so that a core and the host can go through the same list: one takes prices, the
//! other judges errors, and both give a transcript that must be the same.
//!
//! An [`Operation`] is a mathematical [`Function`] with the formats of its input and output and the domain it is judged
//! on. A [`Variant`] is one way to do it: a row of the price list. A [`Group`] of rows, of which a core's memory holds one
//! at a time, shows them to a [`Visitor`] in an order that is the same everywhere.
//!
//! To add a row is one line in `ours.rs` or `rivals.rs`; to add an operation is a marker in `op.rs` besides, and if its
//! function is new, that function's truth on the host.
#![no_std]
#![forbid(unsafe_code)]

mod hard;
pub mod number;
pub mod op;
mod ours;
pub mod price;
mod rivals;
mod row;
pub mod transcript;

pub use number::{Input, Number};
pub use op::{Format, Function};

use fixedmath::random::Lcg64;

/// What is to be computed: a function, its formats, its domain.
pub trait Operation: 'static {
    /// The name in tables and files.
    const NAME: &'static str;
    /// The function, of which the host knows the truth.
    const FUNCTION: Function;
    /// The output's format, which says what an ulp is and where the output ends.
    const FORMAT: Format;
    /// The inputs that errors and prices are for, in words.
    const DOMAIN: &'static str;
    /// An input.
    type Input: Input;
    /// An output.
    type Output: Number;

    /// Whether an input lies in [`Operation::DOMAIN`].
    fn accepts(_input: Self::Input) -> bool {
        true
    }

    /// An input next to where the result is rounded the other way or leaves its format, if such are known.
    fn hard(random: &mut Lcg64) -> Self::Input {
        Input::draw(random)
    }
}

/// Who wrote a variant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Maker {
    /// `fixedmath`'s own.
    Ours,
    /// The published system's, as `fixedmath` has it.
    Published,
    /// A crate that a user might pick instead.
    Rival(&'static str),
}

/// One way to do an operation: a row of the price list.
pub trait Variant: 'static {
    /// What it does.
    type Operation: Operation;
    /// Its own form of the operation's input.
    type Given: Number;
    /// Its own form of the operation's output.
    type Found: Number;
    /// The path of its function.
    const NAME: &'static str;
    /// Who wrote it.
    const MAKER: Maker;
    /// The function it approaches: the operation's, unless variants differ in more than arithmetic.
    const FUNCTION: Function = <Self::Operation as Operation>::FUNCTION;
    /// The inputs its errors are for, in words.
    const DOMAIN: &'static str = <Self::Operation as Operation>::DOMAIN;
    /// Whether a result that the format does not hold gives the format's end. If not, such inputs are not in its domain.
    const SATURATES: bool = Self::TOTAL;
    /// Whether every input of the operation has a defined result, also outside the domain.
    const TOTAL: bool = !matches!(Self::MAKER, Maker::Rival(_));

    /// The input in this variant's own form.
    fn given(input: OperationInput<Self>) -> Self::Given;

    /// Whether this variant can take an input of the operation's domain.
    fn accepts(_input: OperationInput<Self>) -> bool {
        true
    }

    /// Does it.
    fn apply(given: Self::Given) -> Self::Found;
}

/// The input of a variant's operation.
pub type OperationInput<V> = <<V as Variant>::Operation as Operation>::Input;

/// Rows that fit a core's memory together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// Ours and the published: products, quotients, exponentials, random numbers.
    Arithmetic,
    /// Ours and the published: dot products.
    DotProducts,
    /// Ours and the published: square roots and their reciprocals.
    Roots,
    /// Ours and the published: functions of angles.
    Angles,
    /// Ours and the published: lengths, and vectors of unit length.
    Directions,
    /// Ours and the published: points drawn from distributions.
    Warps,
    /// Rivals: crates that work on 16:16.
    FixedPoint,
    /// Rivals: single precision in software, by the compiler's routines and the mathematical library over them.
    SoftFloat,
    /// Rivals: functions of angles in single precision, by the mathematical library.
    FloatAngles,
    /// Rivals: approximations in single precision.
    RoughFloat,
}

impl Group {
    /// All of them.
    pub const ALL: [Self; 10] = [
        Self::Arithmetic,
        Self::DotProducts,
        Self::Roots,
        Self::Angles,
        Self::Directions,
        Self::Warps,
        Self::FixedPoint,
        Self::SoftFloat,
        Self::FloatAngles,
        Self::RoughFloat,
    ];

    /// The name in the images' names.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Arithmetic => "arithmetic",
            Self::DotProducts => "dot_products",
            Self::Roots => "roots",
            Self::Angles => "angles",
            Self::Directions => "directions",
            Self::Warps => "warps",
            Self::FixedPoint => "fixed_point",
            Self::SoftFloat => "soft_float",
            Self::FloatAngles => "float_angles",
            Self::RoughFloat => "rough_float",
        }
    }

    /// Whether these are rivals, who may use floating point and may panic.
    pub const fn is_rivals(self) -> bool {
        matches!(
            self,
            Self::FixedPoint | Self::SoftFloat | Self::FloatAngles | Self::RoughFloat
        )
    }

    /// Shows every row of the group. In line, so that an image holds only the group it names.
    #[inline(always)]
    pub fn show(self, visitor: &mut impl Visitor) {
        match self {
            Self::Arithmetic => ours::arithmetic(visitor),
            Self::DotProducts => ours::dot_products(visitor),
            Self::Roots => ours::roots(visitor),
            Self::Angles => ours::angles(visitor),
            Self::Directions => ours::directions(visitor),
            Self::Warps => ours::warps(visitor),
            Self::FixedPoint => rivals::fixed_point(visitor),
            Self::SoftFloat => rivals::soft_float(visitor),
            Self::FloatAngles => rivals::float_angles(visitor),
            Self::RoughFloat => rivals::rough_float(visitor),
        }
    }

    /// Cases in the transcripts of the group's rows: rivals are slow, and not ours to prove.
    pub const fn transcript_cases(self) -> u32 {
        if self.is_rivals() { 10_000 } else { 1_000_000 }
    }
}

/// Goes through rows.
pub trait Visitor {
    /// Called once a row.
    fn visit<V: Variant>(&mut self);
}

/// Whether an input is in the domain of both the operation and the variant.
pub fn accepts<V: Variant>(input: OperationInput<V>) -> bool {
    V::Operation::accepts(input) && V::accepts(input)
}

/// An input in the domain of a variant.
#[inline(never)]
fn draw<V: Variant>(random: &mut Lcg64) -> OperationInput<V> {
    loop {
        let input = Input::draw(random);
        if accepts::<V>(input) {
            return input;
        }
    }
}
