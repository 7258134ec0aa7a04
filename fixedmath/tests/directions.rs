//! Angles and unit vectors against double precision.
use fixedmath::{I2F30, I16F16, angle, random::Lcg64, unit, warp};
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
fn turning_on_from_nodes_stays_within_its_stated_errors() {
    let ulp = 2f64.powi(-16);
    let of = |(cosine, sine): (I2F30, I2F30), angle: f64| {
        let c = (cosine.to_num::<f64>() - angle.cos()).abs();
        c.max((sine.to_num::<f64>() - angle.sin()).abs()) / ulp
    };
    let linear = worst(|turn, angle| of(angle::linear_cos_sin(turn), angle));
    assert!((9.8..=10.0).contains(&linear), "{linear}");
    let quadratic = worst(|turn, angle| of(angle::quadratic_cos_sin(turn), angle));
    assert!((0.11..=0.12).contains(&quadratic), "{quadratic}");
    let single = worst(|turn, angle| {
        let s = (angle::sine(turn).to_num::<f64>() - angle.sin()).abs();
        s.max((angle::cosine(turn).to_num::<f64>() - angle.cos()).abs()) / ulp
    });
    assert!((0.6..=0.62).contains(&single), "{single}");
}

#[test]
fn the_angle_of_a_vector_is_its_arc_tangent() {
    let mut random = Lcg64::new(10);
    let mut draw = || random.next_fraction() as i32 >> (random.next_fraction() >> 27);
    let drawn = (0..2_000_000).map(|_| (draw(), draw())).collect::<Vec<_>>();
    let edges = [0, 1, -1, i32::MAX, i32::MIN].map(|x| [0, 1, -1, i32::MAX, i32::MIN].map(|y| (x, y)));
    let mut found = 0f64;
    for (x, y) in drawn.into_iter().chain(edges.into_iter().flatten()) {
        let (length_x, length_y) = (I16F16::from_bits(x), I16F16::from_bits(y));
        let turn = angle::of_vector(length_x, length_y);
        if (x, y) == (0, 0) {
            assert_eq!((turn, angle::checked_of_vector(length_x, length_y)), (0, None));
            continue;
        }
        assert_eq!(angle::checked_of_vector(length_x, length_y), Some(turn));
        let exact = f64::from(y).atan2(f64::from(x));
        // One way or the other round the circle.
        let apart = (f64::from(turn as i32) / 4_294_967_296.0 * TAU - exact).abs();
        found = found.max(apart.min(TAU - apart) * 65_536.0);
    }
    assert!((0.0024..=0.003).contains(&found), "{found} ulp of 2^-16 radians");
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
fn normalising_is_exact_to_four_ulp_at_every_length() {
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
    assert!((3.0..=4.0).contains(&worst_component), "{worst_component} ulp");
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

/// The length of a direction in 2:30 is 1 to 2^-28, of vectors as short as 1 ulp and as long as the format holds.
#[test]
fn every_vector_but_zero_has_a_direction() {
    let mut random = Lcg64::new(8);
    let mut draw = || random.next_fraction() as i32 >> (random.next_fraction() >> 27);
    let drawn = (0..2_000_000)
        .map(|_| [draw(), draw(), draw()])
        .collect::<Vec<_>>();
    let small = (0..1000).map(|k| [k % 10 - 5, k / 10 % 10 - 5, k / 100 - 5]);
    let edges = [[i32::MIN; 3], [i32::MAX; 3], [i32::MIN, 0, 1], [0, 0, i32::MIN]];
    let (mut worst_component, mut worst_length) = (0f64, 0f64);
    for v in drawn.into_iter().chain(small).chain(edges) {
        let lengths = v.map(I16F16::from_bits);
        let direction = unit::of_vector(lengths);
        if v == [0; 3] {
            assert_eq!(direction, [I2F30::ZERO; 3]);
            assert_eq!(unit::checked_of_vector(lengths), None);
            continue;
        }
        assert_eq!(unit::checked_of_vector(lengths), Some(direction));
        let length = v.iter().map(|&c| f64::from(c).powi(2)).sum::<f64>().sqrt();
        for (component, c) in direction.iter().zip(v) {
            let error = component.to_num::<f64>() - f64::from(c) / length;
            worst_component = worst_component.max(error.abs() * 2f64.powi(30));
        }
        let found = direction
            .iter()
            .map(|c| c.to_num::<f64>().powi(2))
            .sum::<f64>()
            .sqrt();
        worst_length = worst_length.max((found - 1.0).abs());
    }
    assert!((3.0..=4.0).contains(&worst_component), "{worst_component} ulp");
    assert!(worst_length <= 2f64.powi(-28), "{worst_length:e}");
}

#[test]
fn lengths_are_correctly_rounded_and_saturate() {
    let mut random = Lcg64::new(9);
    let mut draw = || random.next_fraction() as i32 >> (random.next_fraction() >> 27);
    let edges = [
        [i32::MIN; 3],
        [i32::MAX, 0, 0],
        [i32::MIN, 0, 0],
        [0; 3],
        [1, 0, 0],
    ];
    for v in (0..1_000_000)
        .map(|_| [draw(), draw(), draw()])
        .collect::<Vec<_>>()
        .into_iter()
        .chain(edges)
    {
        let square: u128 = v.iter().map(|&c| u128::from(c.unsigned_abs()).pow(2)).sum();
        let floor = square.isqrt();
        let exact = floor + u128::from(square - floor * floor > floor);
        let v = v.map(I16F16::from_bits);
        let fits = i32::try_from(exact).ok();
        assert_eq!(unit::length(v).to_bits(), fits.unwrap_or(i32::MAX), "{v:?}");
        assert_eq!(unit::checked_length(v).map(I16F16::to_bits), fits, "{v:?}");
    }
}

#[test]
fn opposite_directions_have_no_bisector() {
    let up = [I2F30::ZERO, I2F30::ZERO, I2F30::ONE];
    assert_eq!(unit::checked_bisector(up, up.map(|c| -c)), None);
    let right = [I2F30::ONE, I2F30::ZERO, I2F30::ZERO];
    let halfway = unit::checked_bisector(up, right).unwrap();
    assert!(
        halfway
            .iter()
            .zip([0.5f64.sqrt(), 0.0, 0.5f64.sqrt()])
            .all(|(c, e)| (c.to_num::<f64>() - e).abs() < 4e-9)
    );
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
        assert_eq!(unit::checked_renormalised(off), Some(unit::renormalised(off)));
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
        assert_eq!(unit::checked_renormalised(v), None, "{v:?}");
    }
    let nearly = [I2F30::ONE, I2F30::ONE, I2F30::DELTA - I2F30::ONE];
    assert_eq!(
        unit::checked_renormalised(nearly),
        Some(unit::renormalised(nearly))
    );
}

/// A frame's three axes, by what `around` makes of (1, 0, 0), (0, 1, 0) and (0, 0, 1): orthonormal, the third the axis itself; and any
/// vector keeps its length and its cosine with it. For axes everywhere, next to the poles and next to the equator.
#[test]
fn a_frame_is_orthonormal_around_every_axis() {
    let mut random = Lcg64::new(15);
    let mut unit = move || {
        let tilt = random.next_fraction() >> (random.next_fraction() >> 27);
        unit::normalised(warp::sphere(tilt, random.next_fraction()))
    };
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let real = |v: [I2F30; 3]| v.map(|c| c.to_num::<f64>());
    let (zero, one) = (I2F30::ZERO, I2F30::ONE);
    let mut worst = 0f64;
    let ulp = I2F30::from_bits(1);
    for pole in [one, -one, one - ulp, one + ulp, one + ulp + ulp, -one - ulp] {
        for [x, y] in [
            [zero, zero],
            [ulp, -ulp],
            [I2F30::from_bits(20_000), I2F30::from_bits(-12_345)],
        ] {
            let across = real(unit::around([x, y, pole], [one, zero, zero]));
            worst = worst
                .max((dot(across, across) - 1.0).abs())
                .max(dot(across, real([x, y, pole])).abs());
        }
    }
    for turn in 0..500_000 {
        let [x, y, z] = unit();
        let axis = [[x, y, z], [x, y, -z], [z, x, y], [y, -z, x]][turn % 4];
        let frame =
            [[one, zero, zero], [zero, one, zero], [zero, zero, one]].map(|v| real(unit::around(axis, v)));
        for (i, a) in frame.iter().enumerate() {
            for (j, b) in frame.iter().enumerate() {
                worst = worst.max((dot(*a, *b) - f64::from(u8::from(i == j))).abs());
            }
        }
        worst = worst.max((dot(frame[2], real(axis)) - 1.0).abs());
        let v = unit();
        let turned = real(unit::around(axis, v));
        worst = worst.max((dot(turned, turned) - 1.0).abs());
        worst = worst.max((dot(turned, real(axis)) - v[2].to_num::<f64>()).abs());
    }
    // In units of 2^-30; an axis itself is of unit length to 4.
    let ulp = worst * 1_073_741_824.0;
    assert!((2.0..=16.0).contains(&ulp), "{ulp} ulp of 2^-30");
}
