//! Linear congruential generators with jump-ahead.
//!
//! One step maps the state `x` to `a x + c` modulo a power of two. `n` steps are again such a map, and its two
//! constants come from squaring (F. Brown, "Random number generation with arbitrary strides", 1994), so a stream can be
//! entered at any place in time logarithmic in the distance.
//!
//! Bit `k` of a state has period 2^(k+1) only. [`Lcg32::low_bits`] is the published use and has period 65,536;
//! [`Lcg64::next_fraction`] gives the upper half of a state, whose lowest bit has period 2^33 and whose highest 2^64.

/// The published 32-bit generator.
///
/// Constants of Numerical Recipes' "quick and dirty" generator; period 2^32.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lcg32 {
    state: u32,
}

impl Lcg32 {
    const MULTIPLIER: u32 = 1_664_525;
    const INCREMENT: u32 = 1_013_904_223;

    /// A generator whose present state is `seed`.
    pub const fn new(seed: u32) -> Self {
        Self { state: seed }
    }

    /// The next state's low 16 bits, as published: period 65,536.
    ///
    /// Cost: 1 instruction.
    pub const fn low_bits(&mut self) -> u16 {
        self.state = self
            .state
            .wrapping_mul(Self::MULTIPLIER)
            .wrapping_add(Self::INCREMENT);
        self.state as u16
    }

    /// Goes `steps` steps on, as that many calls would.
    pub const fn jump(&mut self, mut steps: u32) {
        let (mut a, mut c) = (Self::MULTIPLIER, Self::INCREMENT);
        while steps != 0 {
            if steps & 1 == 1 {
                self.state = self.state.wrapping_mul(a).wrapping_add(c);
            }
            c = a.wrapping_add(1).wrapping_mul(c);
            a = a.wrapping_mul(a);
            steps >>= 1;
        }
    }
}

/// A 64-bit generator used by its upper half: period 2^64.
///
/// Multiplier from D. Knuth's MMIX (The Art of Computer Programming, vol. 2, 3.3.4, table 1, line 26).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lcg64 {
    state: u64,
}

impl Lcg64 {
    const MULTIPLIER: u64 = 6_364_136_223_846_793_005;
    const INCREMENT: u64 = 1_442_695_040_888_963_407;

    /// A generator whose present state is `seed`.
    pub const fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// The next number as the 32 bits of a fraction in [0, 1).
    ///
    /// Cost: 5 instructions.
    #[inline]
    pub const fn next_fraction(&mut self) -> u32 {
        self.state = self
            .state
            .wrapping_mul(Self::MULTIPLIER)
            .wrapping_add(Self::INCREMENT);
        (self.state >> 32) as u32
    }

    /// Goes `steps` steps on, as that many calls would.
    ///
    /// ```
    /// use fixedmath::random::Lcg64;
    /// let (mut walked, mut jumped) = (Lcg64::new(7), Lcg64::new(7));
    /// for _ in 0..1000 {
    ///     walked.next_fraction();
    /// }
    /// jumped.jump(1000);
    /// assert_eq!(walked, jumped);
    /// ```
    pub const fn jump(&mut self, mut steps: u64) {
        let (mut a, mut c) = (Self::MULTIPLIER, Self::INCREMENT);
        while steps != 0 {
            if steps & 1 == 1 {
                self.state = self.state.wrapping_mul(a).wrapping_add(c);
            }
            c = a.wrapping_add(1).wrapping_mul(c);
            a = a.wrapping_mul(a);
            steps >>= 1;
        }
    }
}
