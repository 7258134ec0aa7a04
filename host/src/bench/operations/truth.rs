//! What operations should give: real functions, in double precision or better.
//!
//! Where a result may have more than 53 bits that matter (products, quotients, roots) it is kept as the sum of two
//! doubles, whose second is found without an error by a fused multiply and add.

use std::f64::consts::TAU;

use operations::{Format, Function};

/// A real number as the sum of a double and a much smaller one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Real {
    /// The number rounded to a double.
    pub high: f64,
    /// What that lacks.
    pub low: f64,
}

/// The most results an operation has.
pub const RESULTS: usize = 3;

/// From the inputs' real values to the results'; what an operation does not have is 0.
pub type Oracle = fn(&[Real]) -> [Real; RESULTS];

impl Real {
    fn sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let part = high - a;
        Self {
            high,
            low: (a - (high - part)) + (b - part),
        }
    }

    fn product(a: f64, b: f64) -> Self {
        let high = a * b;
        Self {
            high,
            low: a.mul_add(b, -high),
        }
    }

    fn plus(self, other: Self) -> Self {
        let sum = Self::sum(self.high, other.high);
        Self::sum(sum.high, sum.low + self.low + other.low)
    }

    fn quotient(a: f64, b: Self) -> Self {
        let high = a / b.high;
        let remainder = (-high).mul_add(b.high, a) - high * b.low;
        Self {
            high,
            low: remainder / b.high,
        }
    }

    fn root(self) -> Self {
        let high = self.high.sqrt();
        if high == 0.0 {
            return Self::default();
        }
        let remainder = (-high).mul_add(high, self.high) + self.low;
        Self {
            high,
            low: remainder / (2.0 * high),
        }
    }

    /// Cut to the ends of a format.
    pub fn clamped(self, format: Format) -> Self {
        let end = 2f64.powi(format.integer_bits);
        if !self.fits(format) && self.high > 0.0 {
            // The last number before 2^n may need more bits than a double has.
            return Self::sum(end, -2f64.powi(-format.fraction_bits));
        }
        let start = if format.signed { -end } else { 0.0 };
        if self.lies_below(start) {
            start.into()
        } else {
            self
        }
    }

    /// Whether it lies between the ends of a format.
    pub fn fits(self, format: Format) -> bool {
        let end = 2f64.powi(format.integer_bits);
        let start = if format.signed { -end } else { 0.0 };
        let room = (end - self.high) - self.low;
        !self.lies_below(start) && room >= 2f64.powi(-format.fraction_bits)
    }

    /// Whether it lies below `start`, if only by its lower part.
    fn lies_below(self, start: f64) -> bool {
        (self.high - start) + self.low < 0.0
    }

    /// How far `found` is from it.
    pub fn distance(self, found: Self) -> f64 {
        ((found.high - self.high) + (found.low - self.low)).abs()
    }
}

impl From<f64> for Real {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

/// The truth about a function; a random number has none.
pub fn oracle(function: Function) -> Option<Oracle> {
    Some(match function {
        Function::Product => |x| one(Real::product(x[0].high, x[1].high)),
        Function::Dot => |x| one(dot(x)),
        Function::ProductSum => |x| one(Real::product(x[1].high, x[2].high).plus(x[0])),
        Function::Identity => |x| one(x[0]),
        Function::Quotient => |x| one(Real::quotient(x[0].high, x[1])),
        Function::Reciprocal => |x| one(Real::quotient(1.0, x[0])),
        Function::SquareRoot => |x| one(x[0].root()),
        Function::ReciprocalSquareRoot => |x| one(Real::quotient(1.0, x[0].root())),
        Function::Sine => |x| one(x[0].high.sin().into()),
        Function::Cosine => |x| one(x[0].high.cos().into()),
        Function::CosineAndSine => |x| {
            let (sine, cosine) = x[0].high.sin_cos();
            [cosine, sine, 0.0].map(Real::from)
        },
        Function::Angle => |x| one(x[1].high.atan2(x[0].high).into()),
        Function::Exponential => |x| one(x[0].high.exp().into()),
        Function::Length => |x| one(dot(&[x[0], x[1], x[2], x[0], x[1], x[2]]).root()),
        Function::UnitVector => |x| unit(highs(x)).map(Real::from),
        Function::Tent => |x| one(tent(x[0].high).into()),
        Function::Sphere => |x| sphere(x[0].high, x[1].high).map(Real::from),
        Function::OffsetSphere => |x| {
            let (normal, point) = (highs(x), sphere(x[3].high, x[4].high));
            unit(add(normal, point)).map(Real::from)
        },
        Function::LiftedDisc => |x| lifted_disc(highs(x), x[3].high, x[4].high).map(Real::from),
        Function::RandomNumber => return None,
    })
}

/// The error of a result, in the operation's units; angles may differ by whole turns.
pub fn error(function: Function, truth: Real, found: Real) -> f64 {
    let distance = truth.distance(found);
    match function {
        Function::Angle => (distance - TAU * (distance / TAU).round()).abs(),
        _ => distance,
    }
}

fn one(result: Real) -> [Real; RESULTS] {
    [result, Real::default(), Real::default()]
}

fn highs(x: &[Real]) -> [f64; 3] {
    [x[0].high, x[1].high, x[2].high]
}

/// The first three by the next three.
fn dot(x: &[Real]) -> Real {
    let product = |i: usize| Real::product(x[i].high, x[i + 3].high);
    product(0).plus(product(1)).plus(product(2))
}

fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn scaled(v: [f64; 3], by: f64) -> [f64; 3] {
    v.map(|component| component * by)
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    let minor = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = v
        .iter()
        .map(|component| component * component)
        .sum::<f64>()
        .sqrt();
    v.map(|component| component / length)
}

fn tent(uniform: f64) -> f64 {
    if uniform < 0.5 {
        (2.0 * uniform).sqrt() - 1.0
    } else {
        1.0 - (2.0 * uniform - 1.0).sqrt()
    }
}

fn sphere(uniform: f64, angle: f64) -> [f64; 3] {
    let height = 2.0 * uniform - 1.0;
    let radius = (4.0 * uniform * (1.0 - uniform)).sqrt();
    [angle.cos() * radius, angle.sin() * radius, height]
}

/// smallpt's sampling of a hemisphere.
fn lifted_disc(normal: [f64; 3], square: f64, angle: f64) -> [f64; 3] {
    let axis = if normal[0].abs() > 0.1 {
        [0.0, 1.0, 0.0]
    } else {
        [1.0, 0.0, 0.0]
    };
    let u = unit(cross(axis, normal));
    let v = cross(normal, u);
    let radius = square.sqrt();
    let disc = add(scaled(u, angle.cos() * radius), scaled(v, angle.sin() * radius));
    unit(add(disc, scaled(normal, (1.0 - square).sqrt())))
}

#[cfg(test)]
mod tests {
    use super::*;

    const LENGTH: Format = Format {
        integer_bits: 15,
        fraction_bits: 16,
        signed: true,
    };

    fn first(function: Function, x: &[f64]) -> Real {
        let x: Vec<Real> = x.iter().copied().map(Real::from).collect();
        oracle(function).expect("a truth")(&x)[0]
    }

    #[test]
    fn results_have_more_bits_than_a_double() {
        // (2^31 - 1)^2 = 2^62 - 2^32 + 1, of which a double keeps all but the 1.
        let largest = 2f64.powi(31) - 1.0;
        let square = first(Function::Product, &[largest, largest]);
        assert_eq!((square.high, square.low), (2f64.powi(62) - 2f64.powi(32), 1.0));
        // 3 times a third is 1 less 2^-107 or so, and the root of 2 squared is 2.
        let third = first(Function::Quotient, &[1.0, 3.0]);
        assert_eq!(third.high.mul_add(3.0, -1.0) + 3.0 * third.low, 0.0);
        let root = first(Function::SquareRoot, &[2.0]);
        let square = root.high.mul_add(root.high, -2.0) + 2.0 * root.high * root.low;
        assert!(square.abs() < 1e-31, "{square}");
    }

    #[test]
    fn a_format_ends_where_it_ends_to_the_last_bit() {
        let wide = Format {
            integer_bits: 31,
            fraction_bits: 32,
            signed: true,
        };
        let ulp = 2f64.powi(-32);
        let least = Real::from(-(2f64.powi(31)));
        assert!(least.fits(wide));
        // Both are -2^31 to the last bit of their upper parts.
        let below = Real { low: -ulp, ..least };
        let above = Real { low: ulp, ..least };
        assert!(!below.fits(wide) && above.fits(wide));
        assert_eq!((below.clamped(wide), above.clamped(wide)), (least, above));
        let beyond = Real::from(2f64.powi(31));
        let largest = Real { low: -ulp, ..beyond };
        assert!(!beyond.fits(wide) && largest.fits(wide));
        assert_eq!(beyond.clamped(wide), largest);
    }

    #[test]
    fn a_dot_product_loses_nothing_to_cancellation() {
        let x = [65_535.0, 1.0 / 65_536.0, 3.0, 65_535.0, 1.0 / 65_536.0, 3.0].map(|x| x * 0.25);
        let mut minus = x;
        minus[0] = -x[0];
        let sum = oracle(Function::Dot).expect("a truth");
        let reals = |x: [f64; 6]| x.map(Real::from);
        let [plus, minus] = [sum(&reals(x))[0], sum(&reals(minus))[0]];
        let rest = plus.plus(minus);
        assert_eq!(rest.high, (9.0 + 2f64.powi(-32)) / 8.0);
    }

    #[test]
    fn what_a_format_does_not_hold_is_cut() {
        let (end, ulp) = (32_768.0, 2f64.powi(-16));
        for (value, cut) in [
            (end, end - ulp),
            (end - ulp / 2.0, end - ulp),
            (-end - 1.0, -end),
            (1.5, 1.5),
        ] {
            assert_eq!(Real::from(value).clamped(LENGTH), cut.into(), "{value}");
        }
        assert!(Real::from(end - ulp).fits(LENGTH) && Real::from(-end).fits(LENGTH));
        assert!(!Real::from(end - ulp / 2.0).fits(LENGTH));
    }

    #[test]
    fn angles_are_compared_around_the_turn() {
        let off = error(Function::Angle, (-0.25).into(), (TAU - 0.125).into());
        assert!((off - 0.125).abs() < 1e-15, "{off}");
    }
}
