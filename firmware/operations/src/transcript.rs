//! All that an operation answers, in one number: the same on every core and on the host.

use fixedmath::random::Lcg64;

use crate::number::{Input, Number};
use crate::price::called;
use crate::variant::{Variant, accepts};

/// The hash of the outputs for `cases` drawn inputs: FNV-1a of 64 bits, a word at a time.
#[inline(never)]
pub fn transcript<V: Variant>(cases: u32) -> u64 {
    const START: u64 = 0xcbf2_9ce4_8422_2325;
    const PRIME: u64 = 0x0100_0000_01b3;
    let mut random = Lcg64::new(2);
    let mut hash = START;
    for _ in 0..cases {
        let input = Input::draw(&mut random);
        if V::TOTAL || accepts::<V>(input) {
            called::<V>(V::given(input)).through(&mut |word| {
                hash = (hash ^ u64::from(word)).wrapping_mul(PRIME);
                word
            });
        }
    }
    hash
}
