//! For ARM's 32-bit instruction set and for Thumb-2, which share this text: an operand that is shifted on its way, and
//! flags from a shift (*ARM Architecture Reference Manual*, ARM DDI 0100I, A5.1, and ARM DDI 0403E, A6.7). `IT` makes no
//! code in ARM state.

use core::arch::asm;

/// `sum` without its lowest `SHIFT` bits, to the nearest, halves up, modulo 2^32. `SHIFT` is 1 to 31.
#[inline]
pub(crate) fn rounded<const SHIFT: u32>(sum: i64) -> i32 {
    let mut word = sum as u32;
    // SAFETY:
    // - reads and writes the named registers and the flags, which an `asm!` may change unless it says otherwise;
    // - touches no memory and no stack;
    // - shifts by 1 to 31, which both encodings have.
    unsafe {
        asm!(
            "lsrs {word}, {word}, #{shift}",
            "adc {word}, {word}, {upper}, lsl #{rest}",
            word = inout(reg) word,
            upper = in(reg) (sum >> 32) as u32,
            shift = const SHIFT,
            rest = const 32 - SHIFT,
            options(pure, nomem, nostack),
        );
    }
    word as i32
}

/// As [`rounded`], saturated, also where the rounding itself would wrap.
///
/// `CMPVC` looks for an upper word that is not the sign extension of its part in the result; where the rounding has
/// overflowed it is skipped, and `NE` holds because that result is never zero.
#[inline]
pub(crate) fn saturated<const SHIFT: u32>(sum: i64) -> i32 {
    let mut word = sum as u32;
    // SAFETY:
    // - reads and writes the named registers and the flags, which an `asm!` may change unless it says otherwise; `top` is
    //   written while `upper` and `limit` are still needed, and is no `lateout`;
    // - touches no memory and no stack;
    // - shifts by 1 to 31, which all encodings have.
    unsafe {
        asm!(
            "lsl {top}, {upper}, #{rest}",
            "lsrs {word}, {word}, #{shift}",
            "adcs {word}, {word}, {top}",
            "it vc",
            "cmpvc {upper}, {top}, asr #{rest}",
            "it ne",
            "eorne {word}, {limit}, {upper}, asr #31",
            word = inout(reg) word,
            upper = in(reg) (sum >> 32) as u32,
            limit = in(reg) i32::MAX,
            top = out(reg) _,
            shift = const SHIFT,
            rest = const 32 - SHIFT,
            options(pure, nomem, nostack),
        );
    }
    word as i32
}
