//! Roots against integers wide enough to be exact.
use fixedmath::{I2F30, I16F16, I32F32, I48F16, root};
use proptest::prelude::*;

fn exact_floor(v: u64) -> u32 {
    u32::try_from(v.isqrt()).unwrap()
}

fn fitting_nearest(v: u64) -> Option<u32> {
    let root = v.isqrt();
    u32::try_from(root + u64::from(v - root * root > root)).ok()
}

fn exact_nearest(v: u64) -> u32 {
    fitting_nearest(v).unwrap_or(u32::MAX)
}

fn agree(v: u64) {
    assert_eq!(root::floor(v), exact_floor(v), "floor of {v:#x}");
    assert_eq!(root::nearest(v), exact_nearest(v), "nearest of {v:#x}");
    assert_eq!(root::checked_nearest(v), fitting_nearest(v), "nearest of {v:#x}");
}

#[test]
fn edges_and_neighbours_of_squares() {
    for v in [
        0,
        1,
        2,
        3,
        u64::MAX,
        u64::MAX - 1,
        0xffff_ffff_0000_0000,
        0xffff_ffff_0000_0001,
        1 << 63,
        (1 << 62) - 1,
        1 << 62,
    ] {
        agree(v);
    }
    for shift in 0..32 {
        for root in [
            1u64 << shift,
            (1 << shift) + 1,
            (2 << shift) - 1,
            (3 << shift) >> 1,
        ] {
            let square = root * root;
            for v in [
                square.saturating_sub(1),
                square,
                square + 1,
                square + root,
                square + root + 1,
            ] {
                agree(v);
            }
        }
    }
}

#[test]
fn dense_sample_over_every_magnitude() {
    let mut random = fixedmath::random::Lcg64::new(1);
    for _ in 0..4_000_000 {
        let v = u64::from(random.next_fraction()) << 32 | u64::from(random.next_fraction());
        agree(v >> (random.next_fraction() >> 26));
        let root = v >> 32;
        agree(root * root);
        agree((root * root).wrapping_sub(1));
        agree((root * root).wrapping_add(root));
    }
}

/// Every root in 16:16 and 2:30 by its integer definition, at edges, next to squares, and over every magnitude.
#[test]
fn roots_of_each_format_are_correctly_rounded_or_refused() {
    let mut random = fixedmath::random::Lcg64::new(11);
    let edges = [
        0,
        1,
        2,
        (1 << 30) - 1,
        1 << 30,
        i64::MAX,
        i64::MIN,
        -1,
        (1 << 46) - (1 << 15),
        (1 << 46) - (1 << 15) + 1,
        (1 << 62) - (1 << 31),
        (1 << 62) - (1 << 31) + 1,
        1 << 46,
        (1 << 46) - 1,
    ];
    let drawn = (0..2_000_000).map(|_| {
        let wide = i64::from(random.next_fraction() as i32) << 32 | i64::from(random.next_fraction());
        wide >> (random.next_fraction() >> 26)
    });
    for x in drawn.collect::<Vec<_>>().into_iter().chain(edges) {
        let root = |shift: u32| {
            u128::try_from(x).ok().map(|x| {
                let floor = (x << shift).isqrt();
                floor + u128::from((x << shift) - floor * floor > floor)
            })
        };
        let fitting = |shift: u32| root(shift).and_then(|root| i32::try_from(root).ok());
        let stated = |shift: u32| fitting(shift).unwrap_or(if x < 0 { 0 } else { i32::MAX });
        let square = I32F32::from_bits(x);
        assert_eq!(root::of_square(square).to_bits(), stated(0), "{x}");
        assert_eq!(
            root::checked_of_square(square).map(I16F16::to_bits),
            fitting(0),
            "{x}"
        );
        let wide = I48F16::from_bits(x);
        assert_eq!(root::of_wide(wide).to_bits(), stated(16), "{x}");
        assert_eq!(
            root::checked_of_wide(wide).map(I16F16::to_bits),
            fitting(16),
            "{x}"
        );
        let Ok(narrow) = i32::try_from(x) else { continue };
        let length = I16F16::from_bits(narrow);
        assert_eq!(root::of_length(length).to_bits(), stated(16), "{x}");
        assert_eq!(
            root::checked_of_length(length).map(I16F16::to_bits),
            fitting(16),
            "{x}"
        );
        let fraction = I2F30::from_bits(narrow);
        assert_eq!(root::of_fraction(fraction).to_bits(), stated(30), "{x}");
        assert_eq!(
            root::checked_of_fraction(fraction).map(I2F30::to_bits),
            fitting(30),
            "{x}"
        );
    }
}

/// From a grazing wall's square to the largest: at every magnitude, dense, at both ends of each, and around squares. Elsewhere it is
/// the nearest.
#[test]
fn near_roots_stay_within_their_bound() {
    let error = |v: u64| {
        let x = I32F32::from_bits(v as i64);
        f64::from(root::near_square(x).to_bits()) - (v as f64).sqrt()
    };
    let (mut low, mut high) = (0f64, 0f64);
    for magnitude in 43..60 {
        let from = 1u64 << magnitude;
        let step = from >> 17;
        let around = |v: u64| [v - 1, v, v + 1, v + v.isqrt(), v + v.isqrt() + 1];
        let squares = (0..1000).map(|k| (from + k * (from / 1000)).isqrt().pow(2));
        let dense = (0..1 << 17).map(|k| from + k * step + (k * 0x9e37_79b9) % step);
        let ends = [from, 2 * from - 1].into_iter();
        for v in dense.chain(ends).chain(squares.flat_map(around)) {
            let error = error(v.clamp(1 << 43, (1 << 60) - 1));
            (low, high) = (low.min(error), high.max(error));
        }
    }
    assert!(
        low > -1.2 && high < 1.2 && high - low > 1.0,
        "{low} to {high} ulp"
    );
    for bits in [-1, 0, 1, (1 << 43) - 1, 1 << 60, i64::MAX] {
        let x = I32F32::from_bits(bits);
        assert_eq!(root::near_square(x), root::of_square(x));
    }
}

#[test]
fn reciprocal_roots_stay_within_their_bound() {
    let mut worst = 0f64;
    for x in (1..1 << 20)
        .chain((1..1 << 20).map(|k| k << 11))
        .chain([i32::MAX])
    {
        let length = I16F16::from_bits(x);
        let found = root::reciprocal_of_length(length);
        assert_eq!(root::checked_reciprocal_of_length(length), Some(found));
        worst = worst.max((f64::from(found.to_bits()) - 16_777_216.0 / f64::from(x).sqrt()).abs());
    }
    assert!((0.5005..=0.501).contains(&worst), "{worst} ulp");
    for x in [0, -1, i32::MIN] {
        let length = I16F16::from_bits(x);
        assert_eq!(root::reciprocal_of_length(length), I16F16::MAX);
        assert_eq!(root::checked_reciprocal_of_length(length), None);
    }
}

#[test]
fn published_roots_round_down_within_their_bound() {
    let mut random = fixedmath::random::Lcg64::new(2);
    for _ in 0..1_000_000 {
        let x = (random.next_fraction() >> 1) as i32;
        assert_eq!(
            root::restoring(I16F16::from_bits(x)).to_bits() as u32,
            exact_floor((x as u64) << 16)
        );
        let wide = i64::from(random.next_fraction()) << 14 | i64::from(random.next_fraction() >> 18);
        let k = (64 - wide.leading_zeros()).saturating_sub(31).div_ceil(2);
        let exact = i64::from(exact_floor((wide as u64) << 16).min(i32::MAX as u32));
        let found = i64::from(root::split(I48F16::from_bits(wide)).to_bits());
        assert!(
            (0..=(1 << k) + (1 << k) / 100).contains(&(exact - found)),
            "{wide}: {found} for {exact}"
        );
    }
    assert_eq!(root::split(I48F16::MAX), I16F16::MAX);
}

#[test]
fn negative_arguments_give_zero() {
    for bits in [-1, i32::MIN, -65536] {
        assert_eq!(root::restoring(I16F16::from_bits(bits)), I16F16::ZERO);
        assert_eq!(root::of_length(I16F16::from_bits(bits)), I16F16::ZERO);
        assert_eq!(root::of_fraction(I2F30::from_bits(bits)), I2F30::ZERO);
    }
    for bits in [-1, i32::MIN, -65536] {
        assert_eq!(root::checked_restoring(I16F16::from_bits(bits)), None);
        assert_eq!(root::checked_split(I48F16::from_bits(bits.into())), None);
    }
    assert_eq!(root::checked_split(I48F16::MAX), None);
    let widest = I48F16::from_bits((1 << 46) - 1);
    assert_eq!(root::checked_split(widest), Some(root::split(widest)));
    assert_eq!(root::checked_restoring(I16F16::ONE), Some(I16F16::ONE));
    assert_eq!(root::split(I48F16::MIN), I16F16::ZERO);
    assert_eq!(root::of_square(I32F32::MIN), I16F16::ZERO);
    assert_eq!(root::of_square(I32F32::MAX), I16F16::MAX);
}

proptest! {
    #[test]
    fn any_argument(v: u64) {
        agree(v);
    }
}
