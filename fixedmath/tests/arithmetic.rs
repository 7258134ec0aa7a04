//! Products and quotients against `i128`, over edges and at random.
use fixedmath::{I2F30, I16F16, division, product, random::Lcg64};

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

#[test]
fn products_round_as_they_say_and_saturate() {
    for (a, b) in pairs() {
        let exact = i128::from(a) * i128::from(b);
        let (x, y) = (I16F16::from_bits(a), I16F16::from_bits(b));
        assert_eq!(product::truncated(x, y).to_bits(), clamp(exact >> 16), "{a} {b}");
        assert_eq!(
            product::nearest(x, y).to_bits(),
            clamp((exact + (1 << 15)) >> 16),
            "{a} {b}"
        );
        let unit = I2F30::from_bits(b);
        assert_eq!(
            product::scaled(x, unit).to_bits(),
            clamp((exact + (1 << 29)) >> 30),
            "{a} {b}"
        );
        let units = product::of_units(I2F30::from_bits(a), unit);
        assert_eq!(units.to_bits(), clamp((exact + (1 << 29)) >> 30), "{a} {b}");
    }
}

#[test]
fn dot_products_are_exact_or_saturated() {
    let mut random = Lcg64::new(4);
    for round in 0..500_000 {
        let mut draw = || match round % 4 {
            0 => EDGES[random.next_fraction() as usize % EDGES.len()],
            _ => random.next_fraction() as i32,
        };
        let (a, b) = ([draw(), draw(), draw()], [draw(), draw(), draw()]);
        let terms: Vec<i128> = (0..3).map(|i| i128::from(a[i]) * i128::from(b[i])).collect();
        // Saturation is a step at a time, as the sums are.
        let clamp = |v: i128| v.clamp(i64::MIN.into(), i64::MAX.into());
        let expected = clamp(clamp(terms[0] + terms[1]) + terms[2]);
        let (a, b) = (a.map(I16F16::from_bits), b.map(I16F16::from_bits));
        assert_eq!(i128::from(product::dot(a, b).to_bits()), expected);
        let exact: i128 = terms.iter().sum();
        assert_eq!(product::wrapping_dot(a, b).to_bits(), exact as i64);
    }
}

#[test]
fn restoring_division_truncates_and_saturates() {
    for (a, b) in pairs() {
        let expected = match (a, b) {
            (0, _) => 0,
            (_, 0) if a > 0 => i32::MAX,
            (_, 0) => i32::MIN,
            _ => clamp((i128::from(a) << 16) / i128::from(b)),
        };
        let found = division::restoring(I16F16::from_bits(a), I16F16::from_bits(b)).to_bits();
        assert_eq!(found, expected, "{a} / {b}");
    }
}
