//! Roots against integers wide enough to be exact.
use fixedmath::{I2F30, I16F16, I32F32, root};
use proptest::prelude::*;

fn exact_floor(v: u64) -> u32 {
    u32::try_from(v.isqrt()).unwrap()
}

fn exact_nearest(v: u64) -> u32 {
    let root = v.isqrt();
    u32::try_from(root + u64::from(v - root * root > root)).unwrap_or(u32::MAX)
}

fn agree(v: u64) {
    assert_eq!(root::floor(v), exact_floor(v), "floor of {v:#x}");
    assert_eq!(root::nearest(v), exact_nearest(v), "nearest of {v:#x}");
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
        let found = i64::from(root::split(fixed::types::I48F16::from_bits(wide)).to_bits());
        assert!(
            (0..=(1 << k) + (1 << k) / 100).contains(&(exact - found)),
            "{wide}: {found} for {exact}"
        );
    }
    assert_eq!(root::split(fixed::types::I48F16::MAX), I16F16::MAX);
}

#[test]
fn negative_arguments_give_zero() {
    for bits in [-1, i32::MIN, -65536] {
        assert_eq!(root::restoring(I16F16::from_bits(bits)), I16F16::ZERO);
        assert_eq!(root::of_length(I16F16::from_bits(bits)), I16F16::ZERO);
        assert_eq!(root::of_fraction(I2F30::from_bits(bits)), I2F30::ZERO);
    }
    assert_eq!(root::split(fixed::types::I48F16::MIN), I16F16::ZERO);
    assert_eq!(root::of_square(I32F32::MIN), I16F16::ZERO);
    assert_eq!(root::of_square(I32F32::MAX), I16F16::MAX);
}

proptest! {
    #[test]
    fn any_argument(v: u64) {
        agree(v);
    }
}
