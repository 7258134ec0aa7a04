//! Which rows an image holds.

use crate::variant::Visitor;
use crate::{ours, rivals};

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
