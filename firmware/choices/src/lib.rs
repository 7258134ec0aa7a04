//! Profile `precise` with one choice of the published system's, and all else as it is: what each choice costs, and what it does to a picture.
//!
//! Like soft float ([`floating`](../floating/index.html)) it is measured in images of its own: no render's image depends on this crate. A
//! choice is a type ([`Switch`]), so an image holds the code of its own and no other.
#![no_std]
#![forbid(unsafe_code)]

mod numbers;
mod pairs;

use core::fmt::Debug;
use core::marker::PhantomData;

use fixedmath::I16F16;
use tracer::material::{HemisphereSampling, MalleyDisc, RejectedDisc};
use tracer::profile::{Precise, Profile, Quadratic};
use tracer::random::{FullState, Random};

pub use numbers::Varied;
pub use pairs::LowBitPairs;

/// A choice that is the published system's where all others are ours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// Square roots bit by bit, in 16:16.
    Root,
    /// Quotients bit by bit, in 16:16, also where the scene's compiler knows reciprocals.
    Division,
    /// Directions in 16:16 instead of 2:30.
    Directions,
    /// The low 16 bits of a 32-bit generator, two draws for each number.
    Generator,
    /// The textbook's formula for spheres, both roots, without what is proved of rooms.
    Intersection,
    /// A diffuse bounce by Malley's disc: a sine, a cosine, two roots and an orthonormal basis.
    Hemisphere,
    /// The same, with a sine of two parabolas.
    Sine,
}

impl Choice {
    /// All of them, in the order of their numbers.
    pub const ALL: [Self; 7] = [
        Self::Root,
        Self::Division,
        Self::Directions,
        Self::Generator,
        Self::Intersection,
        Self::Hemisphere,
        Self::Sine,
    ];

    /// The name by which host and image agree on it.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Root => "root",
            Self::Division => "division",
            Self::Directions => "directions",
            Self::Generator => "generator",
            Self::Intersection => "intersection",
            Self::Hemisphere => "hemisphere",
            Self::Sine => "sine",
        }
    }

    /// The number of the choice of this name, the first's where none is named.
    ///
    /// # Panics
    /// If there is no such choice: while an image is compiled, that ends its build.
    pub const fn number(word: Option<&str>) -> usize {
        let Some(word) = word else {
            return 0;
        };
        let mut number = 0;
        while number < Self::ALL.len() {
            if is_same(word.as_bytes(), Self::ALL[number].word().as_bytes()) {
                return number;
            }
            number += 1;
        }
        panic!("TRACER_CHOICE names no choice: see `choices::Choice::word`");
    }
}

const fn is_same(one: &[u8], other: &[u8]) -> bool {
    let mut place = 0;
    while place < one.len() && place < other.len() && one[place] == other[place] {
        place += 1;
    }
    place == one.len() && place == other.len()
}

/// What differs from `precise`.
pub trait Switch: Copy + Debug + 'static {
    /// Whether roots are found bit by bit, in 16:16.
    const ROOTS: bool = false;
    /// Whether quotients are, and what the scene's compiler knows of reciprocals is not used.
    const QUOTIENTS: bool = false;
    /// Whether components of directions are cut to 16 fraction bits.
    const COARSE: bool = false;
    /// Whether sines are parabolas.
    const PARABOLAS: bool = false;
    /// How a quadratic surface is intersected.
    const QUADRATIC: Quadratic = Quadratic::Power;
    /// Random numbers.
    type Random: Random + Clone;
    /// How a diffuse surface picks a direction.
    type Hemisphere: HemisphereSampling;
}

/// The choice of this number in [`Choice::ALL`].
#[derive(Clone, Copy, Debug)]
pub enum Only<const NUMBER: usize> {}

impl Switch for Only<0> {
    const ROOTS: bool = true;
    type Random = FullState;
    type Hemisphere = RejectedDisc;
}

impl Switch for Only<1> {
    const QUOTIENTS: bool = true;
    type Random = FullState;
    type Hemisphere = RejectedDisc;
}

impl Switch for Only<2> {
    const COARSE: bool = true;
    type Random = FullState;
    type Hemisphere = RejectedDisc;
}

impl Switch for Only<3> {
    type Random = LowBitPairs;
    type Hemisphere = RejectedDisc;
}

impl Switch for Only<4> {
    const QUADRATIC: Quadratic = Quadratic::Textbook;
    type Random = FullState;
    type Hemisphere = RejectedDisc;
}

impl Switch for Only<5> {
    type Random = FullState;
    type Hemisphere = MalleyDisc;
}

impl Switch for Only<6> {
    const PARABOLAS: bool = true;
    type Random = FullState;
    type Hemisphere = MalleyDisc;
}

/// `precise` but for one choice.
#[derive(Clone, Copy, Debug)]
pub struct Single<S>(PhantomData<S>);

/// Host and image agree on `precise`: which choice is another, the host knows, for it had the image built.
impl<S: Switch> Profile for Single<S> {
    const NAME: &'static str = Precise::NAME;
    const STRATIFIED_NAME: &'static str = Precise::STRATIFIED_NAME;
    const EPSILON: I16F16 = Precise::EPSILON;
    const QUADRATIC: Quadratic = S::QUADRATIC;
    type Numbers = Varied<S>;
    type Random = S::Random;
    type Hemisphere = S::Hemisphere;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_are_known_by_their_names() {
        for (number, choice) in Choice::ALL.into_iter().enumerate() {
            assert_eq!(Choice::number(Some(choice.word())), number);
            assert_eq!(choice as usize, number);
        }
        assert_eq!(Choice::number(None), 0);
    }

    #[test]
    #[should_panic(expected = "names no choice")]
    fn a_name_that_is_none_is_refused() {
        Choice::number(Some("roots"));
    }
}
