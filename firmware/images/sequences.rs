//! Short functions whose cycles are counted by hand: the whole way from the emulator to a price is tested on them. The same text
//! is assembled for every board.
#![no_std]
#![no_main]

use board::Core;
use panic_halt as _;
use runtime::{Board, ExitCode};

/// Functions of these instructions, and a program that calls each once.
macro_rules! sequences {
    ($($(#[$doc:meta])* $name:ident: $($line:literal),+;)+) => {
        $(
            $(#[$doc])*
            #[unsafe(naked)]
            extern "C" fn $name() {
                core::arch::naked_asm!($($line),+)
            }
        )+

        #[board::entry]
        fn start() -> ! {
            $($name();)+
            Core::exit(ExitCode::Success)
        }
    };
}

sequences! {
    /// A sum.
    sum: "add r0, r0, r1", "bx lr";
    /// A branch that is taken nine times, and then is not.
    repeated: "mov r0, #10", "1: subs r0, r0, #1", "bne 1b", "bx lr";
    /// A loaded byte that is used beyond a branch, at which the emulator begins another block.
    byte_across_branch: "cmp r1, r1", "ldrb r0, [sp]", "bne 1f", "add r2, r0, r0", "1: bx lr";
    /// A load whose condition fails, and one whose condition holds.
    conditional_loads: "cmp r0, r0", "it ne", "ldrne r1, [sp]", "it eq", "ldreq r2, [sp]", "add r3, r2, r2", "bx lr";
    /// A load that happens every other time.
    alternating_load:
        "mov r0, #4", "1: tst r0, #1", "it ne", "ldrne r1, [sp]", "subs r0, r0, #1", "bne 1b", "bx lr";
    /// Registers saved, and restored with the return.
    saved_registers: "push {{r4, r5, r6, lr}}", "add r4, r0, r1", "pop {{r4, r5, r6, pc}}";
    /// The last of many loaded registers is used at once.
    loaded_registers: "ldm sp, {{r0, r1, r2}}", "add r3, r2, r2", "bx lr";
    /// A loaded word is stored.
    copied_word: "ldr r0, [sp]", "str r0, [sp]", "bx lr";
    /// A long product, a sum of another, and a use of its upper word.
    long_products: "umull r0, r1, r2, r3", "umlal r0, r1, r2, r3", "add r0, r1, r1", "bx lr";
    /// A shift by a register.
    register_shift: "lsl r0, r0, r1", "bx lr";
    /// A call, and a product in what is called.
    nested_call: "push {{r4, lr}}", "bl 2f", "pop {{r4, pc}}", "2: mul r0, r0, r1", "bx lr";
}
