//! Looking for light: points of caps, directions in cones, and what of a connection counts, against double precision.

mod guides;

use fixedmath::random::Lcg64;
use fixedmath::{I2F30, I16F16, U0F32};
use floating::Floating;
use proptest::prelude::*;
use tracer::arithmetic::{Formats, Mixed};
use tracer::geometry::sphere::SphereNumbers;
use tracer::geometry::{MaterialId, PrimitiveId};
use tracer::light::{CapLight, Emitter, LEAST_SHARE, LightNumbers, MOST_DOUBLINGS, Magnitude};

type Double = Floating<f64>;

fn fractions(seed: u64, count: usize) -> impl Iterator<Item = U0F32> {
    let mut random = Lcg64::new(seed);
    (0..count).map(move |_| U0F32::from_bits(random.next_fraction()))
}

fn magnitude(value: f64) -> Magnitude {
    let exponent = value.log2().floor() as i32 - 52;
    Magnitude::new((value * 2f64.powi(-exponent)) as u64, exponent)
}

fn value(magnitude: Magnitude) -> f64 {
    let (mantissa, exponent) = magnitude.parts();
    f64::from(mantissa) * 2f64.powi(exponent)
}

/// A cap around the third axis of a sphere of this radius around the origin.
fn cap(radius: f64, height: f64) -> CapLight {
    let (length, along) = (I16F16::from_num, I16F16::ZERO);
    let across = length(radius * (2.0 * height).sqrt());
    CapLight {
        centre: [I16F16::ZERO; 3],
        pole: [along, along, length(radius)],
        across: [[across, along, along], [along, across, along]],
        down: [along, along, length(radius * height)],
        height: U0F32::saturating_from_num(height),
        reach: magnitude(2.0 * height * radius),
        emitter: Emitter {
            threshold: U0F32::MAX,
            primitive: PrimitiveId::new(0),
            material: MaterialId::new(0),
            flags: 0,
        },
        reserved: 0,
    }
}

/// Points lie on the sphere, in the cap, and as many of them in each part as its area says.
#[test]
fn points_of_a_cap_are_uniform_by_area() {
    for (radius, height) in [
        (1.0, 1.0),
        (600.0, 0.00045),
        (100.0, 0.5),
        (5000.0, 1e-6),
        (0.02, 0.9),
    ] {
        let cap = cap(radius, height);
        let (mut count, mut lower) = (0.0, 0.0);
        for fraction in fractions(7, 200_000) {
            let found = Mixed::on_cap(&cap, fraction);
            let exact = Double::on_cap(&cap, fraction);
            assert_eq!(found.is_some(), exact.is_some());
            let (Some(found), Some(exact)) = (found, exact) else {
                continue;
            };
            // Half an ulp of 2^-16 where a coordinate is rounded, and 2^-28 of the radius.
            let bound = 0.5 / 65536.0 + radius * 2f64.powi(-28) + 1e-9;
            for (found, exact) in found.map(I16F16::to_num::<f64>).into_iter().zip(exact) {
                assert!(
                    (found - exact).abs() <= bound,
                    "{radius} {height}: {found} {exact}"
                );
            }
            let away = exact.iter().map(|c| c * c).sum::<f64>().sqrt();
            // The record's vectors are rounded, too.
            assert!((away - radius).abs() < 3.0 / 65536.0, "{radius} {height}: {away}");
            let fallen = (radius - exact[2]) / radius;
            assert!(fallen >= -2e-3 * height && fallen < height * 1.01 + 2.0 / 65536.0 / radius);
            count += 1.0;
            lower += f64::from(u8::from(fallen < height / 2.0));
        }
        assert!((count / 200_000.0 - std::f64::consts::FRAC_PI_4).abs() < 5.0 * 0.5 / 200_000f64.sqrt());
        // By Archimedes, half of the area is below half of the height; of a cap of a few ulp nobody knows where that is.
        if radius * height > 1e-3 {
            let deviation = 0.5 / f64::sqrt(count);
            assert!((lower / count - 0.5).abs() < 5.0 * deviation, "{radius} {height}");
        }
    }
}

/// Directions in a cone are of unit length and uniform by solid angle, and never is the cone too small.
#[test]
fn directions_in_a_cone_are_uniform() {
    for (radius, distance) in [
        (1.0, 1.001),
        (1.0, 2.0),
        (5.0, 300.0),
        (0.01, 20_000.0),
        (1.0 / 256.0, 9.0),
    ] {
        let (radius, distance) = (I16F16::from_num(radius), I16F16::from_num(distance));
        let square = Mixed::product(distance, distance);
        let cone = Mixed::cone(radius, square).expect("from outside");
        let [r, d] = [radius, distance].map(I16F16::to_num::<f64>);
        let exact = Double::cone(r, d * d).expect("from outside");
        let height = cone.to_num::<f64>().powi(2) / 2.0;
        // A bit of 2^-30 of the spread, and the quotient's 2^-30.
        let bound = 2.0 * 2f64.powi(-30) * (2.0 * exact).sqrt() + exact * 2f64.powi(-28);
        assert!(
            (0.0..=bound).contains(&(height - exact)),
            "{r} {d}: {height} {exact}"
        );
        let (mut count, mut sum) = (0.0, 0.0);
        for fraction in fractions(3, 100_000) {
            let Some(v) = Mixed::in_cone(cone, fraction) else {
                continue;
            };
            let v = v.map(I2F30::to_num::<f64>);
            let length = v.iter().map(|c| c * c).sum::<f64>().sqrt();
            assert!((length - 1.0).abs() < 8.0 * 2f64.powi(-30), "{length}");
            count += 1.0;
            sum += (v[0] * v[0] + v[1] * v[1]) / (2.0 * height);
        }
        // The mean of sin^2 over 2 height is 1/2 less a sixth of the height; its deviation is below 0.3.
        let mean = 0.5 - height / 6.0;
        assert!(
            (sum / count - mean).abs() < 5.0 * 0.3 / f64::sqrt(count),
            "{r} {d}: {}",
            sum / count
        );
    }
    assert_eq!(
        Mixed::cone(I16F16::ONE, Mixed::product(I16F16::ONE, I16F16::ONE)),
        None
    );
}

proptest! {
    #[test]
    fn magnitudes_are_numbers(a in any::<u64>(), b in any::<u64>(), s in 0u32..64, t in 0u32..64, e in -90i32..90) {
        let (a, b) = ((a >> s).max(1), (b >> t).max(1));
        let (x, y) = (Magnitude::new(a, 0), Magnitude::new(b, e));
        let (u, v) = (value(x), value(y));
        let near = |found: Magnitude, exact: f64| (value(found) / exact - 1.0).abs() < 2f64.powi(-29);
        prop_assert!(near(x, a as f64) && x.parts().0 >> 31 == 1);
        prop_assert!(near(x.times(y), u * v));
        prop_assert!(near(x.plus(y), u + v) && near(y.plus(x), u + v));
        prop_assert!(near(x.over(y), u / v));
        prop_assert!(u < 2f64.powi(x.log2()) && u >= 2f64.powi(x.log2() - 1));
        prop_assert_eq!(x.to_fixed(0), u as u64);
        prop_assert_eq!(x.scaled(e).parts(), (x.parts().0, x.parts().1 + e));
    }

    /// Near the light and far from it, for the least emitter and for the greatest.
    #[test]
    fn balances_are_exact(cosine in 1i32..=1 << 30, turned in 1i32..=20_000 << 16, reach in -60.0f64..60.0, square in 1i64..1 << 60, s in 0u32..60) {
        let (cosine, turned) = (I2F30::from_bits(cosine), I16F16::from_bits(turned));
        let reach = magnitude(reach.exp2());
        let bits = (square >> s).max(1);
        let found = Mixed::balance_of_cap(cosine, turned, reach, fixedmath::I32F32::from_bits(bits));
        let exact = Double::balance_of_cap(cosine.to_num(), turned.to_num(), reach, bits as f64 / 2f64.powi(32));
        prop_assert!((value(found) / exact - 1.0).abs() < 2f64.powi(-28), "{} {exact}", value(found));
        prop_assert!(value(found) <= 1.0);
        let share = Mixed::share(found).to_num::<f64>();
        prop_assert!((share - exact.min(1.0)).abs() < 2f64.powi(-28));
        let spread = I2F30::from_bits((turned.to_bits() & 0x3fff_ffff) | 1);
        let height = spread.to_num::<f64>().powi(2) / 2.0;
        let found = Mixed::balance_of_cone(cosine, spread, reach);
        let exact = Double::balance_of_cone(cosine.to_num(), height, reach);
        prop_assert!((value(found) / exact - 1.0).abs() < 2f64.powi(-28), "{} {exact}", value(found));
    }

    /// What chance keeps of a small share is worth that share, to the last fraction.
    #[test]
    fn thinning_is_fair(mantissa in 1u64 << 40..1 << 41, exponent in -90i32..-41) {
        let balance = Magnitude::new(mantissa, exponent);
        let kept = |fraction: u32| Mixed::thinned(balance, || U0F32::from_bits(fraction));
        // The fractions that keep it are the least ones: their number by bisection.
        let (mut low, mut high) = (0u64, 1u64 << 32);
        while low < high {
            let middle = u64::midpoint(low, high);
            if kept(middle as u32).is_some() { low = middle + 1 } else { high = middle }
        }
        let worth = kept(0).expect("the least fraction keeps any").to_num::<f64>() * low as f64 / 2f64.powi(32);
        if balance.log2() > LEAST_SHARE - MOST_DOUBLINGS {
            prop_assert!((worth / value(balance) - 1.0).abs() < 2f64.powi(-18), "{worth} {}", value(balance));
            prop_assert!(kept(0).unwrap().to_num::<f64>() >= 2f64.powi(LEAST_SHARE) * 0.999);
        }
        // In double precision the same fractions keep it.
        let double = |fraction: u32| Double::thinned(value(balance), || U0F32::from_bits(fraction));
        prop_assert!(low == 1 << 32 || double(low as u32).is_none());
        prop_assert!(double((low - 1) as u32).is_some());
    }
}

/// Nothing has no direction.
#[test]
fn a_way_of_no_length_has_no_direction() {
    assert_eq!(Mixed::direction([I16F16::ZERO; 3]), None);
    assert!(Double::direction([0.0; 3]).is_none());
    let one = Mixed::direction([I16F16::ZERO, I16F16::DELTA, I16F16::ZERO]);
    assert_eq!(one, Some([Mixed::ZERO, Mixed::ONE, Mixed::ZERO]));
}
