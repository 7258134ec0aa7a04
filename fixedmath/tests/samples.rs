//! The exponential and the sample warps against double precision.
use fixedmath::{I2F30, I16F16, exponential, product, random::Lcg64, warp};
use std::f64::consts::TAU;

#[test]
fn exponentials_stay_within_their_bound_saturate_and_vanish() {
    let mut worst = 0f64;
    for x in -900_000..681_392 {
        let argument = I16F16::from_bits(x);
        let found = exponential::natural(argument);
        assert_eq!(exponential::checked_natural(argument), Some(found));
        let exact = (f64::from(x) / 65_536.0).exp() * 65_536.0;
        worst = worst.max((f64::from(found.to_bits()) - exact).abs());
    }
    assert!((1.0..=1.1).contains(&worst), "{worst} ulp");
    for x in [681_392, 700_000, i32::MAX] {
        assert_eq!(exponential::natural(I16F16::from_bits(x)), I16F16::MAX);
        assert_eq!(exponential::checked_natural(I16F16::from_bits(x)), None);
    }
    assert_eq!(exponential::natural(I16F16::MIN), I16F16::ZERO);
    assert_eq!(
        exponential::natural(I16F16::from_bits(-772_243)),
        I16F16::from_bits(1)
    );
}

/// The middle of a fraction's part of [0, 1].
fn middle(fraction: u32) -> f64 {
    (f64::from(fraction) + 0.5) / 4_294_967_296.0
}

fn ulp(found: I2F30, exact: f64) -> f64 {
    (f64::from(found.to_bits()) - exact * 1_073_741_824.0).abs()
}

#[test]
fn the_tent_is_the_inverse_of_its_distribution() {
    let mut worst = 0f64;
    let dense = (0..1 << 22).map(|k: u32| k << 10 | k >> 12);
    for fraction in dense.chain([0, 1, 0x7fff_ffff, 0x8000_0000, 0xffff_ffff]) {
        let offset = 1.0 - (f64::from(fraction << 1 | 1) / 4_294_967_296.0).sqrt();
        let exact = if fraction >> 31 == 0 { -offset } else { offset };
        worst = worst.max(ulp(warp::tent(fraction), exact));
    }
    assert!((1.5..=4.0).contains(&worst), "{worst} ulp of 2^-30");
}

#[test]
fn the_sphere_is_uniform_in_height_and_angle_to_eight_ulp() {
    let mut random = Lcg64::new(12);
    let drawn = (0..2_000_000).map(|_| {
        let height = random.next_fraction() >> (random.next_fraction() >> 27);
        let height = if random.next_fraction() >> 31 == 0 {
            height
        } else {
            !height
        };
        (height, random.next_fraction())
    });
    let edges = [0, 1, 0x7fff_ffff, 0x8000_0000, 0xffff_ffff].map(|height| (height, 0x1234_5678));
    let mut worst = 0f64;
    for (height, turn) in drawn.collect::<Vec<_>>().into_iter().chain(edges) {
        let f = middle(height);
        let radius = 2.0 * (f * middle(!height)).sqrt();
        let (sine, cosine) = (f64::from(turn) / 4_294_967_296.0 * TAU).sin_cos();
        let exact = [cosine * radius, sine * radius, 2.0 * f - 1.0];
        for (found, exact) in warp::sphere(height, turn).into_iter().zip(exact) {
            worst = worst.max(ulp(found, exact));
        }
    }
    assert!((5.0..=8.0).contains(&worst), "{worst} ulp of 2^-30");
}

/// The squared cosine with the normal is uniform in [0, 1]: each of 64 equal parts gets its share to 5 standard deviations
/// of a binomial count, which a density off by 2.5 % anywhere would miss.
#[test]
fn the_hemisphere_follows_the_cosine() {
    const DRAWS: u32 = 2_000_000;
    let normal = [0.36, -0.48, 0.8].map(I2F30::from_num);
    let mut random = Lcg64::new(13);
    let mut counts = [0u32; 64];
    for _ in 0..DRAWS {
        let direction = warp::cosine_hemisphere(normal, random.next_fraction(), random.next_fraction());
        let cosine = product::cosine(normal, direction).to_num::<f64>();
        assert!(cosine >= -4e-9, "{direction:?}");
        counts[((cosine * cosine * 64.0) as usize).min(63)] += 1;
    }
    let expected = f64::from(DRAWS) / 64.0;
    let bound = 5.0 * expected.sqrt();
    assert!(
        counts
            .iter()
            .all(|&count| (f64::from(count) - expected).abs() < bound),
        "{counts:?}"
    );
}

#[test]
fn a_vanishing_sum_falls_back_on_the_normal() {
    // The sphere's lowest point is the normal's opposite.
    let normal = [I2F30::ZERO, I2F30::ZERO, I2F30::ONE];
    assert_eq!(warp::cosine_hemisphere(normal, 0, 0), normal);
}

/// Over every coordinate of the square's border and axes, and many points between: unit vectors over the middle of their part, and
/// none where that is not in the disc.
#[test]
fn points_of_the_disc_are_lifted_to_eight_ulp() {
    let mut random = Lcg64::new(14);
    let axes = (0..1u32 << 16).flat_map(|c| [c << 16, c, c << 16 | c, c << 16 | 0x7fff, 0x8000_0000 | c]);
    let drawn: Vec<u32> = (0..4_000_000).map(|_| random.next_fraction()).collect();
    let (mut worst, mut length, mut inside) = (0f64, 0f64, 0u32);
    for fraction in axes.chain(drawn.iter().copied()) {
        let coordinate = |bits: u32| (f64::from(bits as u16 as i16) + 0.5) / 32_768.0;
        let (u, v) = (coordinate(fraction >> 16), coordinate(fraction));
        let square = u * u + v * v;
        let Some(point) = warp::checked_hemisphere(fraction) else {
            assert!(square > 1.0 - 2f64.powi(-28), "{fraction:#x}");
            continue;
        };
        assert!(square < 1.0 + 2f64.powi(-28), "{fraction:#x}");
        // What the squares lose, 2 ulp, is much beside a small height, and never moves the point off the sphere.
        let height = (1.0 - square).max(0.0).sqrt();
        let loss = 2f64.powi(-29) / (2.0 * height.max(2f64.powi(-15)));
        worst = worst.max(ulp(point[0], u)).max(ulp(point[1], v));
        worst = worst.max(ulp(point[2], height) - loss * 1_073_741_824.0);
        let p = point.map(|c| c.to_num::<f64>());
        length = length.max((p[0] * p[0] + p[1] * p[1] + p[2] * p[2] - 1.0).abs());
    }
    assert!((1.0..=8.0).contains(&worst), "{worst} ulp of 2^-30");
    assert!(length < 2f64.powi(-27), "{length}");
    inside += drawn
        .iter()
        .filter(|&&f| warp::checked_hemisphere(f).is_some())
        .count() as u32;
    let expected = 4_000_000.0 * std::f64::consts::FRAC_PI_4;
    // Five standard deviations of a binomial count.
    assert!(
        (f64::from(inside) - expected).abs() < 5.0 * (expected * (1.0 - std::f64::consts::FRAC_PI_4)).sqrt()
    );
}
