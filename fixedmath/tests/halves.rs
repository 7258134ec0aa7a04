//! Pairs of 16-bit numbers against plain products.
use fixedmath::halves::{self, Halves};
use proptest::prelude::*;

proptest! {
    #[test]
    fn sums_of_products_are_modular(sum: i32, a: i32, b: i32) {
        let (a, b) = (Halves::from_bits(a), Halves::from_bits(b));
        let product = |x: i16, y: i16| i32::from(x) * i32::from(y);
        let lower = sum.wrapping_add(product(a.lower(), b.lower()));
        prop_assert_eq!(halves::wrapping_lower(sum, a, b), lower);
        prop_assert_eq!(halves::wrapping_lower_upper(sum, a, b), sum.wrapping_add(product(a.lower(), b.upper())));
        prop_assert_eq!(halves::wrapping_dot(sum, a, b), lower.wrapping_add(product(a.upper(), b.upper())));
    }

    #[test]
    fn pairs_are_made_of_halves(a: i32, b: i32) {
        let lower = Halves::of_lower(a, b);
        prop_assert_eq!((lower.lower(), lower.upper()), (a as i16, b as i16));
        let upper = Halves::of_upper(a, b);
        prop_assert_eq!((upper.lower(), upper.upper()), ((a >> 16) as i16, (b >> 16) as i16));
        prop_assert_eq!(Halves::new(a as i16, b as i16), lower);
        prop_assert_eq!(Halves::from_bits(lower.to_bits()), lower);
    }
}
