//! What an operation costs: the same loop over the same inputs with the operation and without, by a core's own clock.
//!
//! The two loops must be alike to the instruction, so the compiler must not be able to see through anything but the
//! operation. Every word of an input passes through [`Bench::opaque`] right after it is loaded, and so does every word of
//! an output: there is no instruction in it, but the word has to be in a register there, loads stay where they are, and
//! nothing can be hoisted, dropped or folded into an addressing mode. The index passes through it, too, so that both
//! loops count and address in the same way.

use fixedmath::random::Lcg64;

use crate::number::Number;
use crate::variant::{Variant, draw};

/// Inputs drawn for a price.
pub const CASES: usize = 256;
/// How often a loop goes through them.
pub const ROUNDS: u32 = 256;

/// A core that can measure itself.
pub trait Bench {
    /// The clock.
    fn ticks(&mut self) -> u32;

    /// Gives back a word, in a register and without an instruction, and the compiler cannot know that it does; nor may it
    /// move memory accesses across.
    fn opaque(word: u32) -> u32;
}

/// Clock ticks of [`CASES`] times [`ROUNDS`] turns of a loop.
#[derive(Clone, Copy, Debug)]
pub struct Price {
    /// The loop, with inputs but without the operation.
    pub baseline: u32,
    /// The loop with the operation in line.
    pub inline: u32,
    /// The loop with a call of [`called`].
    pub called: u32,
}

/// Takes the price of a variant.
pub fn price<V: Variant>(bench: &mut impl Bench) -> Price {
    let mut random = Lcg64::new(1);
    let inputs = [(); CASES].map(|()| V::given(draw::<V>(&mut random)));
    price_of(bench, &inputs, V::apply, called::<V>)
}

/// Takes the price of what is done with these inputs, in line and as a function that is called.
pub fn price_of<Given: Number, Found: Number>(
    bench: &mut impl Bench,
    inputs: &[Given; CASES],
    inline: impl Fn(Given) -> Found,
    called: impl Fn(Given) -> Found,
) -> Price {
    Price {
        baseline: timed(bench, inputs, |_| ()),
        inline: timed(bench, inputs, inline),
        called: timed(bench, inputs, called),
    }
}

/// The operation as a function that is never compiled in line.
#[inline(never)]
pub fn called<V: Variant>(given: V::Given) -> V::Found {
    V::apply(given)
}

/// Ticks that the loop takes around `body`.
#[inline(never)]
fn timed<B: Bench, Given: Number, Found: Number>(
    bench: &mut B,
    inputs: &[Given; CASES],
    body: impl Fn(Given) -> Found,
) -> u32 {
    let start = bench.ticks();
    for _ in 0..ROUNDS {
        let mut at = 0;
        while let Some(given) = inputs.get(at as usize) {
            body(given.through(&mut B::opaque)).through(&mut B::opaque);
            at = B::opaque(at + 1);
        }
    }
    bench.ticks().wrapping_sub(start)
}
