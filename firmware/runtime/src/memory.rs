//! What the linker and the loader have put into data memory: the boot block and the stack.
//!
//! `memory.x` and the board's `board.x` say where: they define the symbols `__boot_block`, `__boot_block_size`,
//! `_work_stack_low_end` and `_work_stack_high_end`.

use core::ops::Range;

use node::StackUse;

unsafe extern "C" {
    /// Start and size of the boot block's memory, of which only the addresses mean something: see `memory.x`.
    static __boot_block: u8;
    static __boot_block_size: u8;
    /// Lowest and highest end of the stack that all work is done on, likewise.
    static _work_stack_low_end: u32;
    static _work_stack_high_end: u32;
}

/// What unused stack looks like: no address, no small number, and odd.
const PAINT: u32 = 0xDEAD_57AC | 1;

/// The boot block, as far as it may reach. It begins at a multiple of [`wire::boot::ALIGNMENT`].
pub fn boot_block() -> &'static [u8] {
    let (start, size) = (&raw const __boot_block, &raw const __boot_block_size);
    // SAFETY:
    // - `memory.x` gives the region to nobody else and lets the linker put nothing in it, so nothing ever writes to it;
    // - the loader has written it before the core started, and memory it did not write reads as something.
    unsafe { core::slice::from_raw_parts(start, size.addr()) }
}

/// The stack that all work is done on, lowest address first.
fn stack() -> Range<*mut u32> {
    let (start, end) = (&raw const _work_stack_low_end, &raw const _work_stack_high_end);
    start.cast_mut()..end.cast_mut()
}

/// Words below the stack pointer that are not painted: room for what this function itself saves.
const MARGIN: usize = 16;

/// Paints the unused part of the stack. To be called once, from the first function.
#[inline(never)]
pub fn paint_stack() {
    let pointer: *mut u32;
    // SAFETY: reads the stack pointer, and nothing else.
    unsafe { core::arch::asm!("mov {}, sp", out(reg) pointer, options(nomem, nostack, preserves_flags)) };
    let (mut word, end) = (stack().start, pointer.wrapping_sub(MARGIN));
    while word < end {
        // SAFETY:
        // - `word` is in the stack's memory, and so far below the stack pointer that no variable is there, nor what this function
        //   saves, wherever in it the compiler puts that;
        // - the write is volatile, so that no call to a fill function, whose frame would be painted over, is made of the loop.
        unsafe { word.write_volatile(PAINT) };
        word = word.wrapping_add(1);
    }
}

/// How much of the stack has been used since it was painted.
pub fn stack_use() -> StackUse {
    let Range { start, end } = stack();
    let mut word = start;
    // SAFETY: `word` stays within the stack's memory; whatever is there is a valid u32.
    while word < end && unsafe { word.read_volatile() } == PAINT {
        word = word.wrapping_add(1);
    }
    StackUse {
        used: (end.addr() - word.addr()) as u32,
        size: (end.addr() - start.addr()) as u32,
    }
}
