//! Generators: jumps equal steps, and the published low bits are as short as they say.
use fixedmath::random::{Lcg32, Lcg64};
use proptest::prelude::*;

#[test]
fn published_low_bits_repeat_after_65536_draws() {
    let mut generator = Lcg32::new(1);
    let first: Vec<u16> = (0..65_536).map(|_| generator.low_bits()).collect();
    let second: Vec<u16> = (0..65_536).map(|_| generator.low_bits()).collect();
    assert_eq!(first, second);
    let mut sorted = first;
    sorted.sort_unstable();
    assert!(
        sorted.iter().enumerate().all(|(i, &v)| i == usize::from(v)),
        "each value once a period"
    );
}

#[test]
fn full_period_by_jumping_round() {
    let mut generator = Lcg64::new(42);
    generator.jump(u64::MAX);
    assert_ne!(generator, Lcg64::new(42));
    generator.next_fraction();
    assert_eq!(generator, Lcg64::new(42));
    // Hull and Dobell's condition: the period is 2^64 exactly when half of it leads elsewhere.
    generator.jump(1 << 63);
    assert_ne!(generator, Lcg64::new(42));
}

/// Bit `k` of a state has period 2^(k+1), and half of that inverts it; fractions are the upper half of a state.
#[test]
fn each_bit_has_its_own_period() {
    let fraction_after = |steps: u64| {
        let mut generator = Lcg64::new(42);
        generator.jump(steps);
        generator.next_fraction()
    };
    let first = fraction_after(0);
    for bit in 0..32 {
        let below = u32::MAX >> (31 - bit);
        let (half, whole) = (1 << (32 + bit), (1u64 << (32 + bit)).wrapping_mul(2));
        assert_eq!((fraction_after(half) ^ first) & below, 1 << bit, "bit {bit}");
        assert_eq!((fraction_after(whole) ^ first) & below, 0, "bit {bit}");
    }
    let low_bits_after = |steps: u32| {
        let mut generator = Lcg32::new(42);
        generator.jump(steps);
        generator.low_bits()
    };
    let first = low_bits_after(0);
    for bit in 0..16 {
        assert_eq!(
            (low_bits_after(1 << bit) ^ first) & ((2 << bit) - 1) as u16,
            1 << bit,
            "bit {bit}"
        );
        assert_eq!(
            (low_bits_after(2 << bit) ^ first) & ((2 << bit) - 1) as u16,
            0,
            "bit {bit}"
        );
    }
}

proptest! {
    #[test]
    fn jumps_equal_steps(seed: u64, steps in 0u32..5000) {
        let (mut walked, mut jumped) = (Lcg64::new(seed), Lcg64::new(seed));
        (0..steps).for_each(|_| { walked.next_fraction(); });
        jumped.jump(steps.into());
        prop_assert_eq!(walked, jumped);
        let (mut walked, mut jumped) = (Lcg32::new(seed as u32), Lcg32::new(seed as u32));
        (0..steps).for_each(|_| { walked.low_bits(); });
        jumped.jump(steps);
        prop_assert_eq!(walked, jumped);
    }

    #[test]
    fn jumps_add_up(seed: u64, a: u64, b: u64) {
        let (mut twice, mut once) = (Lcg64::new(seed), Lcg64::new(seed));
        twice.jump(a);
        twice.jump(b);
        once.jump(a.wrapping_add(b));
        prop_assert_eq!(twice, once);
    }
}
