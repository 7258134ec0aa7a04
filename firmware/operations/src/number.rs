//! What goes into operations and comes out of them, as words for a core and as real values for the host.

use fixedmath::random::Lcg64;
use fixedmath::{I2F30, I16F16, I32F32, I48F16, unit};

/// A value of one or more 32-bit words.
pub trait Number: Copy + Send + 'static {
    /// The value with each of its words, in order, replaced by what `word` makes of it.
    fn through(&self, word: &mut impl FnMut(u32) -> u32) -> Self;

    /// Gives the real numbers it stands for, in order, each as the sum of two doubles, which hold 64 bits exactly.
    fn reals(&self, see: &mut impl FnMut(f64, f64));
}

/// A value that can be drawn.
pub trait Input: Number {
    /// Draws one: every magnitude is as likely as any other, and every eighth word lies next to a power of two.
    fn draw(random: &mut Lcg64) -> Self;

    /// The value of these bits, where 32 bits are all there are.
    fn of_bits(bits: u32) -> Option<Self> {
        let _ = bits;
        None
    }
}

/// A word whose highest bits are copies of its sign, in a random number of places.
#[inline(never)]
fn word(random: &mut Lcg64) -> i32 {
    let (bits, choice) = (random.next_fraction() as i32, random.next_fraction());
    let places = choice >> 27;
    if choice & 7 != 0 {
        return bits >> places;
    }
    // A power of two, its neighbours, or their negatives.
    let edge = (1i32 << places).wrapping_add((bits >> 29) % 2);
    if bits & 1 == 0 { edge } else { edge.wrapping_neg() }
}

/// An angle: the turn's 2^32nd parts. Its real value is in radians.
#[derive(Clone, Copy, Debug)]
pub struct Turn(pub u32);

/// A uniform number: 32 bits that stand for the middle of one of 2^32 equal parts of [0, 1].
#[derive(Clone, Copy, Debug)]
pub struct Fraction(pub u32);

/// A vector whose length is 1 but for rounding, here as much as a few steps of a path may bring about: 2^-15.
#[derive(Clone, Copy, Debug)]
pub struct Direction(pub [I2F30; 3]);

impl Number for Direction {
    #[inline(always)]
    fn through(&self, word: &mut impl FnMut(u32) -> u32) -> Self {
        Self(self.0.through(word))
    }

    fn reals(&self, see: &mut impl FnMut(f64, f64)) {
        self.0.reals(see);
    }
}

/// An exponent, drawn from where the exponential is neither nothing nor too much for 16:16, or hardly: (-16, 16).
#[derive(Clone, Copy, Debug)]
pub struct Exponent(pub I16F16);

impl Number for Exponent {
    #[inline(always)]
    fn through(&self, word: &mut impl FnMut(u32) -> u32) -> Self {
        Self(self.0.through(word))
    }

    fn reals(&self, see: &mut impl FnMut(f64, f64)) {
        self.0.reals(see);
    }
}

impl Input for Exponent {
    fn draw(random: &mut Lcg64) -> Self {
        Self(I16F16::from_bits(word(random) >> 11))
    }

    fn of_bits(bits: u32) -> Option<Self> {
        I16F16::of_bits(bits).map(Self)
    }
}

impl Input for Direction {
    #[inline(never)]
    fn draw(random: &mut Lcg64) -> Self {
        let Some(unit) = unit::checked_normalised(Input::draw(random)) else {
            return Self([I2F30::ZERO, I2F30::ZERO, I2F30::ONE]);
        };
        // Each component is moved by less than 2^-16, so the vector by less than 2^-15.
        Self(unit.map(|component| I2F30::from_bits(component.to_bits() + (word(random) >> 17))))
    }
}

macro_rules! one_word {
    ($type:ty, $bits:ident => $of:expr, $self:ident => $to:expr, $real:expr) => {
        impl Number for $type {
            #[inline(always)]
            fn through(&self, word: &mut impl FnMut(u32) -> u32) -> Self {
                let $self = *self;
                let $bits = word($to);
                $of
            }

            fn reals(&self, see: &mut impl FnMut(f64, f64)) {
                let $self = *self;
                see($real, 0.0);
            }
        }

        impl Input for $type {
            #[inline(never)]
            fn draw(random: &mut Lcg64) -> Self {
                let $bits = word(random) as u32;
                $of
            }

            fn of_bits($bits: u32) -> Option<Self> {
                Some($of)
            }
        }
    };
}

const TWO_TO_32: f64 = 4_294_967_296.0;

one_word!(I16F16, bits => I16F16::from_bits(bits as i32), x => x.to_bits() as u32, f64::from(x.to_bits()) / 65_536.0);
one_word!(I2F30, bits => I2F30::from_bits(bits as i32), x => x.to_bits() as u32, f64::from(x.to_bits()) / (TWO_TO_32 / 4.0));
one_word!(Turn, bits => Turn(bits), x => x.0, f64::from(x.0) * (core::f64::consts::TAU / TWO_TO_32));
one_word!(Fraction, bits => Fraction(bits), x => x.0, (f64::from(x.0) + 0.5) / TWO_TO_32);

/// A whole number.
impl Number for u32 {
    #[inline(always)]
    fn through(&self, word: &mut impl FnMut(u32) -> u32) -> Self {
        word(*self)
    }

    fn reals(&self, see: &mut impl FnMut(f64, f64)) {
        see(f64::from(*self), 0.0);
    }
}

impl Number for f32 {
    #[inline(always)]
    fn through(&self, word: &mut impl FnMut(u32) -> u32) -> Self {
        Self::from_bits(word(self.to_bits()))
    }

    fn reals(&self, see: &mut impl FnMut(f64, f64)) {
        see(f64::from(*self), 0.0);
    }
}

macro_rules! two_words {
    ($type:ty, $bits:ident => $of:expr, $self:ident => $to:expr, $ulp:expr) => {
        impl Number for $type {
            #[inline(always)]
            fn through(&self, word: &mut impl FnMut(u32) -> u32) -> Self {
                let $self = *self;
                let bits: u64 = $to;
                let low = word(bits as u32);
                let $bits = u64::from(word((bits >> 32) as u32)) << 32 | u64::from(low);
                $of
            }

            fn reals(&self, see: &mut impl FnMut(f64, f64)) {
                let $self = *self;
                let bits: u64 = $to;
                // The upper word of a signed number carries the sign.
                let upper = if <$type>::MIN == <$type>::default() {
                    f64::from((bits >> 32) as u32)
                } else {
                    f64::from((bits >> 32) as i32)
                };
                let (high, low) = (upper * TWO_TO_32, f64::from(bits as u32));
                let sum = high + low;
                see(sum * $ulp, (low - (sum - high)) * $ulp);
            }
        }

        impl Input for $type {
            #[inline(never)]
            fn draw(random: &mut Lcg64) -> Self {
                // A word's places over two words: the lower one is noise, or next to a power of two itself.
                let (upper, lower) = (i64::from(word(random)), word(random));
                let places = random.next_fraction() >> 26;
                let $bits = ((upper << 32 | i64::from(lower as u32)) >> places) as u64;
                $of
            }
        }
    };
}

two_words!(I32F32, bits => I32F32::from_bits(bits as i64), x => x.to_bits() as u64, 1.0 / TWO_TO_32);
two_words!(I48F16, bits => I48F16::from_bits(bits as i64), x => x.to_bits() as u64, 1.0 / 65_536.0);
two_words!(u64, bits => bits, x => x, 1.0);

/// Nothing: what a loop without an operation finds.
impl Number for () {
    #[inline(always)]
    fn through(&self, _word: &mut impl FnMut(u32) -> u32) -> Self {}

    fn reals(&self, _see: &mut impl FnMut(f64, f64)) {}
}

macro_rules! several {
    ($($name:ident),+) => {
        impl<$($name: Number),+> Number for ($($name,)+) {
            #[inline(always)]
            #[allow(non_snake_case, reason = "variables named after the types they have")]
            fn through(&self, word: &mut impl FnMut(u32) -> u32) -> Self {
                let ($($name,)+) = self;
                ($($name.through(word),)+)
            }

            #[allow(non_snake_case, reason = "as above")]
            fn reals(&self, see: &mut impl FnMut(f64, f64)) {
                let ($($name,)+) = self;
                $($name.reals(see);)+
            }
        }

        impl<$($name: Input),+> Input for ($($name,)+) {
            #[inline(never)]
            fn draw(random: &mut Lcg64) -> Self {
                ($($name::draw(random),)+)
            }
        }
    };
}

several!(A, B);
several!(A, B, C);

impl<T: Number> Number for [T; 3] {
    #[inline(always)]
    fn through(&self, word: &mut impl FnMut(u32) -> u32) -> Self {
        let [a, b, c] = self;
        [a.through(word), b.through(word), c.through(word)]
    }

    fn reals(&self, see: &mut impl FnMut(f64, f64)) {
        for component in self {
            component.reals(see);
        }
    }
}

impl<T: Input> Input for [T; 3] {
    #[inline(never)]
    fn draw(random: &mut Lcg64) -> Self {
        [T::draw(random), T::draw(random), T::draw(random)]
    }
}
