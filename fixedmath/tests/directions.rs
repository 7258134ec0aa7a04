//! Angles and unit vectors against double precision.
use fixedmath::{I2F30, angle, random::Lcg64, unit};
use std::f64::consts::TAU;

fn turns() -> impl Iterator<Item = u32> {
    let corners = (0..64u32).flat_map(|k| (0..7u32).map(move |d| (k << 26).wrapping_add(d).wrapping_sub(3)));
    corners.chain((0..1u32 << 24).map(|k| k << 8 | (k & 0xff)))
}

fn worst(mut error: impl FnMut(u32, f64) -> f64) -> f64 {
    turns()
        .map(|turn| error(turn, f64::from(turn) / 4_294_967_296.0 * TAU))
        .fold(0.0, f64::max)
}

#[test]
fn polynomial_sine_and_cosine_stay_within_five_ulp() {
    let ulp = 2f64.powi(-30);
    let found = worst(|turn, angle| {
        let (cosine, sine) = angle::cos_sin(turn);
        let c = (cosine.to_num::<f64>() - angle.cos()).abs();
        c.max((sine.to_num::<f64>() - angle.sin()).abs()) / ulp
    });
    assert!(
        (3.0..=5.0).contains(&found),
        "the stated bound is 5 ulp and should be tight: {found}"
    );
}

#[test]
fn parabolas_stay_within_their_stated_errors() {
    let ulp = 2f64.powi(-16);
    let plain = worst(|turn, angle| (angle::parabolic_sine(turn).to_num::<f64>() - angle.sin()).abs() / ulp);
    let refined =
        worst(|turn, angle| (angle::refined_parabolic_sine(turn).to_num::<f64>() - angle.sin()).abs() / ulp);
    assert!((3660.0..=3678.0).contains(&plain), "{plain}");
    assert!((70.0..=80.0).contains(&refined), "{refined}");
}

#[test]
fn normalising_is_exact_to_three_ulp_at_every_length() {
    let mut random = Lcg64::new(5);
    let (mut worst_component, mut worst_length) = (0f64, 0f64);
    for _ in 0..2_000_000 {
        let shift = random.next_fraction() % 15;
        let v = [(); 3].map(|()| I2F30::from_bits(random.next_fraction() as i32 >> shift));
        let length = v.iter().map(|c| c.to_num::<f64>().powi(2)).sum::<f64>().sqrt();
        let Some(n) = unit::checked_normalised(v) else {
            assert!(length < 2f64.powi(-15));
            continue;
        };
        for (component, v) in n.iter().zip(v) {
            let error = component.to_num::<f64>() - v.to_num::<f64>() / length;
            worst_component = worst_component.max(error.abs() * 2f64.powi(30));
        }
        let found = n.iter().map(|c| c.to_num::<f64>().powi(2)).sum::<f64>().sqrt();
        worst_length = worst_length.max((found - 1.0).abs());
    }
    assert!(worst_component <= 3.0, "{worst_component} ulp");
    assert!(worst_length <= 2f64.powi(-28), "{worst_length:e}");
}

#[test]
fn normalising_the_longest_and_the_shortest() {
    let full = unit::checked_normalised([I2F30::MIN; 3]).unwrap();
    assert!(
        full.iter()
            .all(|c| (c.to_num::<f64>() + 1.0 / 3f64.sqrt()).abs() < 3e-9),
        "{full:?}"
    );
    let axis = [I2F30::ZERO, I2F30::from_bits(-(1 << 15)), I2F30::ZERO];
    let [x, y, z] = unit::checked_normalised(axis).unwrap();
    assert_eq!([x, z], [I2F30::ZERO; 2]);
    assert!((y.to_bits() + (1 << 30)).abs() <= 3, "{y}");
    assert_eq!(
        unit::checked_normalised([I2F30::ZERO, I2F30::from_bits((1 << 15) - 1), I2F30::ZERO]),
        None
    );
    assert_eq!(unit::checked_normalised([I2F30::ZERO; 3]), None);
}

#[test]
fn renormalising_squares_the_error_away() {
    let mut random = Lcg64::new(6);
    for _ in 0..200_000 {
        let v = [(); 3].map(|()| I2F30::from_bits(random.next_fraction() as i32 >> 2));
        let Some(n) = unit::checked_normalised(v) else {
            continue;
        };
        let stretch = 1.0 + (f64::from(random.next_fraction()) / 4_294_967_296.0 - 0.5) / 4.0;
        let off = n.map(|c| I2F30::from_num(c.to_num::<f64>() * stretch));
        let length = |v: [I2F30; 3]| v.iter().map(|c| c.to_num::<f64>().powi(2)).sum::<f64>().sqrt();
        let e = length(off) - 1.0;
        let left = length(unit::renormalised(off)) - 1.0;
        assert!(
            (left + 1.5 * e * e + 0.5 * e * e * e).abs() < 4e-9,
            "{e} left {left}"
        );
    }
}

#[test]
fn renormalising_the_longest_and_the_zero_vector() {
    for v in [
        [I2F30::MIN; 3],
        [I2F30::MAX; 3],
        [I2F30::ONE; 3],
        [I2F30::ZERO; 3],
    ] {
        assert_eq!(unit::renormalised(v), [I2F30::ZERO; 3], "{v:?}");
    }
}
