//! For ARM's enhanced DSP instructions (*ARM Architecture Reference Manual*, ARM DDI 0100I, A4.1.74): a compiler finds them, too,
//! but takes pairs apart where it has no registers left for what comes of it.

use core::arch::asm;

/// The lower halves of `lower` and `upper`.
#[inline]
pub(crate) fn lower_halves(lower: i32, upper: i32) -> i32 {
    let pair;
    // SAFETY:
    // - reads and writes the named registers; `pair` is written while `lower` is still needed, and is no `lateout`;
    // - touches no memory and no stack.
    unsafe {
        asm!(
            "lsl {pair}, {upper}, #16",
            "lsl {word}, {word}, #16",
            "orr {pair}, {pair}, {word}, lsr #16",
            pair = out(reg) pair,
            upper = in(reg) upper,
            word = inout(reg) lower => _,
            options(pure, nomem, nostack, preserves_flags),
        );
    }
    pair
}

/// The upper halves of `lower` and `upper`.
#[inline]
pub(crate) fn upper_halves(lower: i32, upper: i32) -> i32 {
    let pair;
    // SAFETY: as above.
    unsafe {
        asm!(
            "lsr {pair}, {upper}, #16",
            "lsl {pair}, {pair}, #16",
            "orr {pair}, {pair}, {lower}, lsr #16",
            pair = out(reg) pair,
            upper = in(reg) upper,
            lower = in(reg) lower,
            options(pure, nomem, nostack, preserves_flags),
        );
    }
    pair
}

macro_rules! products {
    ($($(#[$meta:meta])* $name:ident: $instruction:literal;)+) => {
        $(
            $(#[$meta])*
            #[inline]
            pub(crate) fn $name(sum: i32, a: i32, b: i32) -> i32 {
                let result;
                // SAFETY:
                // - reads and writes the named registers, and the sticky overflow flag, which nothing of ours reads and no
                //   compiler keeps anything in;
                // - touches no memory and no stack.
                unsafe {
                    asm!(
                        concat!($instruction, " {result}, {a}, {b}, {sum}"),
                        result = lateout(reg) result,
                        a = in(reg) a,
                        b = in(reg) b,
                        sum = in(reg) sum,
                        options(pure, nomem, nostack, preserves_flags),
                    );
                }
                result
            }
        )+
    };
}

products! {
    /// `sum` plus the product of both lower halves, modulo 2^32.
    lower_lower: "smlabb";
    /// `sum` plus the product of `a`'s lower and `b`'s upper half, modulo 2^32.
    lower_upper: "smlabt";
    /// `sum` plus the product of both upper halves, modulo 2^32.
    upper_upper: "smlatt";
}
