//! What the roots are made of: arguments that fill their word, a line from a table, and steps that double or triple its
//! digits.

/// `v` > 0 shifted left by the even number of places that brings it to 2^62 or more, and half that number.
#[inline]
pub(crate) const fn normalised(v: u64) -> (u64, u32) {
    let (upper, lower) = ((v >> 32) as u32, v as u32);
    if upper == 0 {
        // A shift by less than a word is four instructions, by any number of places nine.
        let places = lower.leading_zeros() & !1;
        return ((lower << places) as u64 * (1 << 32), places / 2 + 16);
    }
    let places = upper.leading_zeros() & !1;
    let upper = upper << places | (lower >> 1) >> (31 - places);
    ((upper as u64) << 32 | (lower << places) as u64, places / 2)
}

/// The root of `v` >= 2^62, rounded down.
#[inline]
pub(crate) const fn floor_of_normal(v: u64) -> u32 {
    let x = (v >> 32) as u32;
    let y = reciprocal_seed(x);
    let rough = upper(x, y) << 2;
    // A root off by e leaves a remainder of 2 root e, and y is 1 / root: |e| < 2^-19 here, so 50 of its bits matter.
    let remainder = v.wrapping_sub(rough as u64 * rough as u64) as i64;
    let mend = ((remainder >> 14) as i32 as i64 * y as i64) >> 49;
    let root = (rough as i32).wrapping_add(mend as i32) as u32;
    // What was cut off above leaves the root at most one off.
    let remainder = v.wrapping_sub(root as u64 * root as u64) as i64;
    if remainder < 0 {
        root - 1
    } else if remainder > 2 * root as i64 {
        root + 1
    } else {
        root
    }
}

/// `x` > 0 shifted left by the even number of places that brings it to 2^30 or more, and half that number.
#[inline]
pub(crate) const fn normal_word(x: u32) -> (u32, u32) {
    let shift = x.leading_zeros() / 2;
    (x << (2 * shift), shift)
}

/// What [`grown`] takes from e so that reciprocal roots are too large as often as too small, and still below 2, and to stay below a
/// root: made to fit an `MVN`.
const BELOW: i32 = 0x0961;
const FAR_BELOW: i32 = 0x3fc1;

/// `v` times the root of `1 / (1 - e)`, for `v` below 2^31 and `square` = 1 - e in 4:28, |e| < 2^-9: the step of third
/// order, `1 + e/2 + 3/8 e^2`, within 2^-28.
///
/// It turns a reciprocal root y of x, and likewise a root x y, into better ones when x y^2 is 1 - e. `short` in
/// 2^-40 is taken from e.
#[inline]
const fn grown(v: u32, square: u32, short: i32) -> u32 {
    // 2^28 - square in 2^-40, where the 1 has left the word.
    let e = (-short).wrapping_sub((square << 12) as i32);
    let squared = upper_signed(e, e);
    let growth = e + ((squared - (squared >> 2)) >> 8);
    v.wrapping_add_signed(upper_signed(v as i32, growth) >> 9)
}

/// The upper word of a product: one `SMULL`.
const fn upper_signed(a: i32, b: i32) -> i32 {
    ((a as i64 * b as i64) >> 32) as i32
}

/// The upper word of a product: one `UMULL`.
const fn upper(a: u32, b: u32) -> u32 {
    ((a as u64 * b as u64) >> 32) as u32
}

/// `1 / sqrt(x / 2^32)` in 2:30 for `x` >= 2^30, within 2^-10 of itself.
#[inline]
const fn line(x: u32) -> u32 {
    let [start, loss] = LINES[(x >> 27) as usize];
    start - upper(loss, x << 5)
}

/// `1 / sqrt(x / 2^32)` in 2:30 for `x` >= 2^30, from below, within 2^-19: a line, and one Newton step
/// `y (3 - x y^2) / 2`, which never overshoots.
#[inline]
const fn reciprocal_seed(x: u32) -> u32 {
    let y = line(x);
    // x y^2 is 1 - e in 4:28; what the two products cut off must not count as e, or y could reach 2 and the sign bit.
    let e = (1 << 28) - 2 - upper(upper(x, y), y) as i32;
    (y as i32 + ((y as i32 as i64 * (e << 3) as i64) >> 32) as i32) as u32
}

/// `1 / sqrt(x / 2^32)` in 2:30 for `x` >= 2^30, within 5 ulp, either way (tried for every x): below 2 even for x = 2^30.
#[inline]
pub(crate) const fn reciprocal(x: u32) -> u32 {
    grown_reciprocal(x, BELOW)
}

/// As [`reciprocal`], within 2 ulp, and not always from below.
#[inline]
pub(crate) const fn near_reciprocal(x: u32) -> u32 {
    grown_reciprocal(x, 0)
}

#[inline]
const fn grown_reciprocal(x: u32, short: i32) -> u32 {
    let y = line(x);
    grown(y, upper(upper(x, y), y), short)
}

/// The root of `x` 2^-32 in 2:30 for `x` >= 2^30, from below, within 16 ulp.
#[inline]
pub(crate) const fn root_from_below(x: u32) -> u32 {
    let y = line(x);
    let root = upper(x, y);
    grown(root, upper(root, y), FAR_BELOW)
}

/// The root of `x` 2^-32 in 2:30 for `x` >= 2^30, within 4 ulp.
#[inline]
pub(crate) const fn rough(x: u32) -> u32 {
    let y = line(x);
    let root = upper(x, y);
    grown(root, upper(root, y), 0)
}

/// The root of `v` from 2^43 to 2^60, within 1.2 units: a finer line, and one step by the remainder.
#[inline]
pub(crate) const fn near(v: u64) -> u32 {
    // What the upper word leaves out is less than 2^-11 of it, and where it is that much the root has 22 bits.
    let places = ((v >> 32) as u32).leading_zeros() & 30;
    let x = ((v >> 32) as u32) << places;
    let y = fine_line(x);
    // x y is a root in 2:30; the remainder tells by how much it is off, in 45 bits.
    let rough = (upper(x, y) << 2) >> (places / 2);
    let remainder = v.wrapping_sub(rough as u64 * rough as u64) as i64;
    let mend = upper_signed((remainder >> 14) as i32, y as i32) >> (17 - places / 2);
    rough.wrapping_add_signed(mend)
}

/// The root of `x` 2^-32 in 2:30 for `x` >= 2^30, within 2 ulp: a finer line, and one Newton step.
#[inline]
pub(crate) const fn fine(x: u32) -> u32 {
    let y = fine_line(x);
    let root = upper(x, y);
    // root y is 1 - e in 4:28, and the better root is root (1 + e/2): e in 2^-40, where the 1 has left the word.
    let e = -((upper(root, y) << 12) as i32);
    root.wrapping_add_signed(upper_signed(root as i32, e) >> 9)
}

/// As [`line`], within 2^-16.
#[inline]
const fn fine_line(x: u32) -> u32 {
    let [start, loss] = FINE_LINES[(x >> 24) as usize];
    start - upper(loss, x << 8)
}

/// Lines for `1 / sqrt(x)` in 2:30 between multiples of 1/32 of [1/4, 1): the value at the segment's start, and what it
/// loses along the segment. The first eight, below 1/4, are never read and spare the index its subtraction.
static LINES: [[u32; 2]; 32] = lines(1 << 63, 2);

/// The same between multiples of 1/256.
static FINE_LINES: [[u32; 2]; 256] = lines(1 << 62, 8);

/// Between multiples of 1/`N` from 1/4 on, where `one` `scale`^2 is `N` 2^60.
const fn lines<const N: usize>(one: u64, scale: u32) -> [[u32; 2]; N] {
    let mut lines = [[0; 2]; N];
    let mut segment = N / 4;
    while segment < N {
        // 2^30 / sqrt(i / N) is the root of N 2^60 / i.
        let i = segment as u64;
        let start = slow_floor(one / i) * scale;
        let end = slow_floor(one / (i + 1)) * scale;
        let middle = slow_floor(one / (2 * i + 1) * 2) * scale;
        // The chord lies above the curve: half its worst distance balances the error.
        let sag = start / 2 + end / 2 - middle;
        lines[segment] = [start - sag / 2, start - end];
        segment += 1;
    }
    lines
}

/// A root for the table, at compile time only.
const fn slow_floor(v: u64) -> u32 {
    let (mut root, mut bit) = (0u64, 1u64 << 31);
    while bit != 0 {
        if (root | bit) * (root | bit) <= v {
            root |= bit;
        }
        bit >>= 1;
    }
    root as u32
}
