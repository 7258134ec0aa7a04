//! Products and quotients against `i128`, over edges and at random.
use fixedmath::{I2F30, I16F16, I32F32, division, product, random::Lcg64};

const EDGES: [i32; 15] = [
    0,
    1,
    -1,
    2,
    -2,
    3,
    32767,
    32768,
    65535,
    65536,
    -65536,
    i32::MAX,
    i32::MAX - 1,
    i32::MIN,
    i32::MIN + 1,
];

fn pairs() -> impl Iterator<Item = (i32, i32)> {
    let edges = EDGES
        .into_iter()
        .flat_map(|a| EDGES.into_iter().map(move |b| (a, b)));
    let mut random = Lcg64::new(3);
    let drawn = (0..2_000_000).map(move |_| {
        let mut draw = || (random.next_fraction() as i32) >> (random.next_fraction() >> 27);
        (draw(), draw())
    });
    edges.chain(drawn)
}

fn clamp(value: i128) -> i32 {
    value.clamp(i32::MIN.into(), i32::MAX.into()) as i32
}

/// What fits, or nothing.
fn fitting(value: i128) -> Option<i32> {
    i32::try_from(value).ok()
}

fn length(bits: i32) -> I16F16 {
    I16F16::from_bits(bits)
}

fn unit(bits: i32) -> I2F30 {
    I2F30::from_bits(bits)
}

#[test]
fn products_of_lengths_round_saturate_wrap_and_refuse_as_they_say() {
    for (a, b) in pairs() {
        let exact = i128::from(a) * i128::from(b);
        let (x, y) = (length(a), length(b));
        let down = exact >> 16;
        assert_eq!(product::truncated(x, y).to_bits(), clamp(down), "{a} {b}");
        assert_eq!(
            product::wrapping_truncated(x, y).to_bits(),
            down as i32,
            "{a} {b}"
        );
        assert_eq!(
            product::checked_truncated(x, y).map(I16F16::to_bits),
            fitting(down)
        );
        let near = (exact + (1 << 15)) >> 16;
        assert_eq!(product::nearest(x, y).to_bits(), clamp(near), "{a} {b}");
        assert_eq!(product::wrapping_nearest(x, y).to_bits(), near as i32, "{a} {b}");
        assert_eq!(product::checked_nearest(x, y).map(I16F16::to_bits), fitting(near));
    }
}

#[test]
fn products_with_components_round_saturate_wrap_and_refuse_as_they_say() {
    for (a, b) in pairs() {
        let exact = i128::from(a) * i128::from(b);
        let (x, u) = (length(a), unit(b));
        let (down, near) = (exact >> 30, (exact + (1 << 29)) >> 30);
        assert_eq!(product::truncated_scaled(x, u).to_bits(), clamp(down), "{a} {b}");
        assert_eq!(
            product::checked_truncated_scaled(x, u).map(I16F16::to_bits),
            fitting(down)
        );
        assert_eq!(product::scaled(x, u).to_bits(), clamp(near), "{a} {b}");
        assert_eq!(product::wrapping_scaled(x, u).to_bits(), near as i32, "{a} {b}");
        assert_eq!(product::checked_scaled(x, u).map(I16F16::to_bits), fitting(near));
        let v = unit(a);
        assert_eq!(product::of_units(v, u).to_bits(), clamp(near), "{a} {b}");
        assert_eq!(product::wrapping_of_units(v, u).to_bits(), down as i32, "{a} {b}");
        assert_eq!(product::checked_of_units(v, u).map(I2F30::to_bits), fitting(near));
    }
}

/// Vectors of edges, of any bits, and of what a scene has.
fn vectors() -> impl Iterator<Item = ([i32; 3], [i32; 3])> {
    let mut random = Lcg64::new(4);
    (0..500_000).map(move |round| {
        let mut draw = || match round % 4 {
            0 => EDGES[random.next_fraction() as usize % EDGES.len()],
            1 => random.next_fraction() as i32,
            _ => random.next_fraction() as i32 >> 2,
        };
        ([draw(), draw(), draw()], [draw(), draw(), draw()])
    })
}

fn terms(a: [i32; 3], b: [i32; 3]) -> [i128; 3] {
    [0, 1, 2].map(|i| i128::from(a[i]) * i128::from(b[i]))
}

#[test]
fn dot_products_are_exact_or_saturated() {
    let saturated = |v: i128| v.clamp(i64::MIN.into(), i64::MAX.into());
    for (a, b) in vectors() {
        let [x, y, z] = terms(a, b);
        let exact = x + y + z;
        // Saturation is a step at a time, as the sums are.
        let steps = saturated(saturated(x + y) + z);
        let fits = i64::try_from(x + y).is_ok() && i64::try_from(exact).is_ok();
        let (a, b) = (a.map(length), b.map(length));
        assert_eq!(i128::from(product::dot(a, b).to_bits()), steps);
        assert_eq!(product::wrapping_dot(a, b).to_bits(), exact as i64);
        assert_eq!(
            product::checked_dot(a, b).map(I32F32::to_bits),
            fits.then_some(exact as i64)
        );
        let near = (exact + (1 << 15)) >> 16;
        if fits {
            assert_eq!(product::rounded_dot(a, b).to_bits(), clamp(near));
            assert_eq!(
                product::rounded(product::dot(a, b)).to_bits(),
                clamp(near),
                "{a:?} {b:?}"
            );
        }
        let checked = product::checked_rounded_dot(a, b).map(I16F16::to_bits);
        assert_eq!(checked, if fits { fitting(near) } else { None });
    }
}

#[test]
fn sums_accumulate_exactly_or_saturate() {
    for (a, b) in vectors() {
        let sum = (i64::from(a[0]) << 32) | i64::from(a[1] as u32);
        let exact = i128::from(sum) + i128::from(a[2]) * i128::from(b[2]);
        let (start, x, y) = (I32F32::from_bits(sum), length(a[2]), length(b[2]));
        let saturated = exact.clamp(i64::MIN.into(), i64::MAX.into());
        assert_eq!(i128::from(product::accumulate(start, x, y).to_bits()), saturated);
        assert_eq!(product::wrapping_accumulate(start, x, y).to_bits(), exact as i64);
        let checked = product::checked_accumulate(start, x, y).map(I32F32::to_bits);
        assert_eq!(checked, i64::try_from(exact).ok());
        let near = (i128::from(sum) + (1 << 15)) >> 16;
        assert_eq!(product::rounded(start).to_bits(), clamp(near));
        let checked = product::checked_rounded(start).map(I16F16::to_bits);
        assert_eq!(checked, fitting(near));
    }
}

#[test]
fn projections_and_cosines_are_rounded_once() {
    for (a, b) in vectors() {
        let exact: i128 = terms(a, b).iter().sum();
        let near = (exact + (1 << 29)) >> 30;
        let partial = i64::try_from(exact - terms(a, b)[2]).is_ok();
        let fits = partial && i64::try_from(exact + (1 << 29)).is_ok();
        let (v, d) = (a.map(length), b.map(unit));
        let checked = product::checked_projection(v, d).map(I16F16::to_bits);
        assert_eq!(checked, if fits { fitting(near) } else { None });
        let checked = product::checked_cosine(a.map(unit), d).map(I2F30::to_bits);
        assert_eq!(checked, if fits { fitting(near) } else { None });
        if b.iter().all(|c| c.unsigned_abs() <= 1 << 30) {
            assert_eq!(product::projection(v, d).to_bits(), clamp(near), "{a:?} {b:?}");
        }
        if fits && fitting(near).is_some() {
            assert_eq!(product::cosine(a.map(unit), d).to_bits(), near as i32);
        }
    }
}

/// Dividends and divisors whose quotient is next to half an ulp or to a whole one, and the edges of the format.
fn quotients() -> impl Iterator<Item = (i32, i32)> {
    let powers = (0..31).flat_map(|k| [-2, -1, 0, 1, 2].map(|d| (1i32 << k).wrapping_add(d)));
    let edges: Vec<i32> = powers.flat_map(|v| [v, v.wrapping_neg()]).chain(EDGES).collect();
    let others = edges.clone();
    let edges = edges
        .into_iter()
        .flat_map(move |a| others.clone().into_iter().map(move |b| (a, b)));
    let mut random = Lcg64::new(7);
    let near = (0..2_000_000).map(move |_| {
        let mut draw = || u64::from((random.next_fraction() >> 1 >> (random.next_fraction() >> 27)).max(1));
        let (quotient, divisor) = (draw(), draw());
        let step = random.next_fraction() % 3;
        let halves = 2 * quotient + u64::from(random.next_fraction() & 1);
        let dividend = ((halves * divisor) >> 17) + u64::from(step);
        (dividend.min(1 << 31) as i32, divisor as i32)
    });
    edges.chain(near).chain(pairs())
}

#[test]
fn division_is_correctly_rounded_and_saturates() {
    for (a, b) in quotients() {
        let (dividend, divisor) = (i128::from(a).abs() << 16, i128::from(b).abs());
        let sign = if (a < 0) == (b < 0) { 1 } else { -1 };
        let zero = match a {
            0 => 0,
            1.. => i32::MAX,
            _ => i32::MIN,
        };
        let rounded = (b != 0).then(|| sign * ((2 * dividend + divisor) / (2 * divisor)));
        let cut = (b != 0).then(|| sign * (dividend / divisor));
        let (x, y) = (length(a), length(b));
        assert_eq!(
            division::nearest(x, y).to_bits(),
            rounded.map_or(zero, clamp),
            "{a} / {b}"
        );
        assert_eq!(
            division::restoring(x, y).to_bits(),
            cut.map_or(zero, clamp),
            "{a} / {b}"
        );
        let checked = division::checked_nearest(x, y).map(I16F16::to_bits);
        assert_eq!(checked, rounded.and_then(fitting), "{a} / {b}");
        let checked = division::checked_restoring(x, y).map(I16F16::to_bits);
        assert_eq!(checked, cut.and_then(fitting), "{a} / {b}");
    }
}

#[test]
fn reciprocals_are_correctly_rounded_and_saturate() {
    let dense = (0..1 << 22).map(|k: i32| k.wrapping_mul(0x3ff) ^ (k << 21));
    for x in dense.chain(-70_000..70_000).chain(EDGES) {
        let divisor = i128::from(x).abs();
        let exact = (x != 0).then(|| i128::from(x.signum()) * (((1i128 << 33) + divisor) / (2 * divisor)));
        let found = division::reciprocal(length(x)).to_bits();
        assert_eq!(found, exact.map_or(i32::MAX, clamp), "1 / {x}");
        let checked = division::checked_reciprocal(length(x)).map(I16F16::to_bits);
        assert_eq!(checked, exact.and_then(fitting), "1 / {x}");
    }
}

#[test]
fn long_quotients_are_rounded_down_and_saturate() {
    let mut random = Lcg64::new(7);
    let mut draw = || u64::from(random.next_fraction());
    for _ in 0..2_000_000 {
        let divisor = (draw() as u32) >> (draw() >> 27);
        let dividend = (draw() << 32 | draw()) >> (draw() >> 26);
        // Next to a multiple, where a quotient that is one off shows.
        let multiple = (u64::from(divisor) * draw())
            .wrapping_add(draw() % 3)
            .wrapping_sub(1);
        for dividend in [dividend, multiple] {
            let exact = dividend.checked_div(divisor.into()).unwrap_or(u64::MAX);
            let found = division::long(dividend, divisor);
            assert_eq!(
                u64::from(found),
                exact.min(u32::MAX.into()),
                "{dividend} / {divisor}"
            );
        }
    }
}
