//! Our number formats against double precision: every operation within its stated bound.

use fixedmath::{I1F31, I2F30, I4F28, I16F16, U0F32, U19F45, random::Lcg64};
use tracer::arithmetic::{Directions, Mixed, Sampling};
use tracer::camera::FilmNumbers;
use tracer::geometry::sphere::{Reciprocal, SphereNumbers};
use tracer::material::DielectricNumbers;

const ULP30: f64 = 1.0 / (1u64 << 30) as f64;

struct Draw(Lcg64);

impl Draw {
    fn new(seed: u64) -> Self {
        Self(Lcg64::new(seed))
    }

    fn fraction(&mut self) -> f64 {
        f64::from(self.0.next_fraction()) / 4_294_967_296.0
    }

    fn length(&mut self, limit: f64) -> I16F16 {
        I16F16::from_num((2.0 * self.fraction() - 1.0) * limit)
    }

    fn direction(&mut self) -> [I2F30; 3] {
        loop {
            let v = [(); 3].map(|()| 2.0 * self.fraction() - 1.0);
            let length = v.iter().map(|c| c * c).sum::<f64>().sqrt();
            if length > 0.01 && length <= 1.0 {
                return v.map(|c| I2F30::from_num(c / length));
            }
        }
    }
}

fn double(v: [I2F30; 3]) -> [f64; 3] {
    v.map(|c| c.to_num())
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[test]
fn projections_are_exact_and_their_squares_within_two_ulp() {
    let mut draw = Draw::new(1);
    for _ in 0..500_000 {
        let limit = if draw.fraction() < 0.5 { 100.0 } else { 6300.0 };
        let v = [draw.length(limit), draw.length(limit), draw.length(limit)];
        let exactly = Mixed::project(v, draw.direction());
        let projection = exactly.to_bits();
        let exact = projection as i128 * projection as i128;
        // 36:92 against 32:32.
        let found = i128::from(Mixed::squared(exactly).to_bits()) << 60;
        // Rounded down, and without the square of what is less than an ulp.
        let bound = 2 << 60;
        assert!(
            (0..=bound).contains(&(exact - found)),
            "{projection}: {}",
            exact - found
        );
    }
}

/// Within 2^-43 of a unit of `v . d / |d|`, and left as it is up to 64 roots of the radius.
#[test]
fn projections_on_a_unit_vector_forget_how_long_the_direction_is() {
    let mut draw = Draw::new(6);
    let mut moved = 0;
    for _ in 0..500_000 {
        let limit = if draw.fraction() < 0.5 { 100.0 } else { 12_000.0 };
        let v = [draw.length(limit), draw.length(limit), draw.length(limit)];
        let d = draw.direction();
        let projection = Mixed::project(v, d);
        let radius = I16F16::from_num(1.0 / 256.0 + draw.fraction());
        let found = Mixed::on_unit(projection, d, radius);
        let distance = projection.to_num::<f64>().abs();
        // By how much the direction's square is more than 1, exactly.
        let excess: i64 = d.iter().map(|c| i64::from(c.to_bits()).pow(2)).sum::<i64>() - (1 << 60);
        let shorter = distance * 0.5 * excess as f64 / (1u64 << 60) as f64;
        let by = (projection - found).to_num::<f64>() * projection.to_num::<f64>().signum();
        if distance < 64.0 * radius.to_num::<f64>().sqrt() - 1.0 {
            assert_eq!(by, 0.0, "{v:?} {d:?} {radius}");
        } else if distance > 64.0 * radius.to_num::<f64>().sqrt() + 1.0 {
            assert!(
                (by - shorter).abs() < 2f64.powi(-43),
                "{v:?} {d:?}: {by}, {shorter}"
            );
            moved += u32::from(by != 0.0);
        }
    }
    assert!(moved > 200_000, "{moved}");
}

#[test]
fn normals_are_unit_vectors_along_the_radius() {
    let mut draw = Draw::new(2);
    for radius in [1.0 / 256.0, 0.4, 16.5, 600.0, 1e4, 10_900.0] {
        let bits = (radius * 65536.0) as i32;
        let shift = bits.leading_zeros() - 2;
        let mantissa = ((1i64 << 60) / (i64::from(bits) << shift)).min(i32::MAX.into()) as i32;
        let reciprocal = Reciprocal {
            mantissa: I1F31::from_bits(mantissa),
            shift: shift as u8,
        };
        for _ in 0..100_000 {
            let n = double(draw.direction());
            let p = n.map(|c| I16F16::from_num(c * radius));
            let found = double(Mixed::normal(p, I16F16::from_bits(bits), reciprocal));
            // The point's own rounding moves it half an ulp off the sphere.
            let off = 0.5f64 / 65536.0 / radius;
            let length = dot(found, found).sqrt();
            assert!(
                (length - 1.0).abs() <= 4.0 * ULP30 + 1.5 * 3.0 * off * off,
                "{radius}: {length}"
            );
            for i in 0..3 {
                assert!(
                    (found[i] - n[i]).abs() <= 2.0 * off + 8.0 * ULP30,
                    "{radius}: {found:?} for {n:?}"
                );
            }
        }
    }
}

#[test]
fn refraction_follows_snell() {
    let mut draw = Draw::new(3);
    for index in [1.01, 1.5, 2.42, 4.0] {
        let mut refracted = 0;
        for _ in 0..200_000 {
            let (d, n) = (draw.direction(), draw.direction());
            let ratio_value = if draw.fraction() < 0.5 { index } else { 1.0 / index };
            let ratio = Mixed::ratio(I4F28::from_bits((ratio_value * f64::from(1 << 28)) as i32));
            let cosine = -Mixed::cosine(d, n);
            if cosine <= I2F30::ZERO {
                continue;
            }
            let square = Mixed::refracted_square(cosine, Mixed::ratio_squared(ratio));
            let (df, nf) = (double(d), double(n));
            let c = -dot(df, nf);
            let exact = 1.0 - ratio_value * ratio_value * (1.0 - c * c);
            assert!((square.to_num::<f64>() - exact).abs() < 2e-7, "{index}");
            if !Mixed::is_refracted(square) {
                continue;
            }
            refracted += 1;
            let out = Mixed::refract(ratio, d, cosine, Mixed::root_of_ratio(square), n);
            let out = double(Mixed::renormalised(out));
            assert!((dot(out, out).sqrt() - 1.0).abs() < 4.0 * ULP30);
            // What is parallel to the surface is stretched by the ratio of indices. Near the critical angle the root
            // magnifies what rounding did to its square.
            let along = |v: [f64; 3], i: usize| v[i] - dot(v, nf) * nf[i];
            let slack = 4e-7 / exact.max(1e-6).sqrt();
            for i in 0..3 {
                assert!(
                    (along(out, i) - ratio_value * along(df, i)).abs() < slack + 1e-7,
                    "{index} {exact}"
                );
            }
        }
        assert!(refracted > 50_000, "{refracted}");
    }
}

#[test]
fn film_positions_step_evenly_over_the_whole_width() {
    let mut draw = Draw::new(4);
    for pixels in [1u32, 2, 3, 64, 255, 256, 1000, 4095, 65_535] {
        let subpixels = 2 * pixels;
        let reciprocal = U19F45::from_bits((1 << 45) / u64::from(subpixels));
        for k in [0, 1, subpixels / 2, subpixels - 1] {
            let jitter = 2.0 * draw.fraction() - 1.0;
            let found = Mixed::across(k, I2F30::from_num(jitter), subpixels, reciprocal).to_num::<f64>();
            let exact = (f64::from(k) + 0.5 + jitter) / f64::from(subpixels) - 0.5;
            assert!(
                (found - exact).abs() <= 4.0 * ULP30,
                "{k} of {subpixels}: {found} for {exact}"
            );
        }
    }
}

#[test]
fn roots_of_fractions_are_exact_to_half_an_ulp() {
    let mut draw = Draw::new(5);
    for _ in 0..500_000 {
        let fraction = U0F32::from_bits(draw.0.next_fraction() >> (draw.0.next_fraction() >> 28));
        let exact = f64::from(fraction).sqrt();
        assert!((Mixed::root_of(fraction).to_num::<f64>() - exact).abs() <= 0.5001 * ULP30);
    }
}
