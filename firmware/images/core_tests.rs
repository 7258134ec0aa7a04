//! Tests on a core that need nobody else: the wire, the stack's high-water mark.
#![no_std]
#![no_main]

mod harness;
#[path = "shared/wire_cases.rs"]
mod wire_cases;

use core::hint::black_box;

use harness::Verdict;
use runtime::memory::{paint_stack, stack_use};

#[board::entry]
fn start() -> ! {
    paint_stack();
    harness::run(
        (),
        &[
            ("the stack that is used shows, and no more", stack_that_is_used),
            ("packets and boot blocks come back as they were", wire_round_trips),
        ],
    )
}

// Its packets must not be in the frame of the function that runs it before the other test.
#[inline(never)]
fn wire_round_trips(_: &mut ()) -> Verdict {
    wire_cases::transcript().map(Some)
}

/// Bytes of stack that [`deep`] takes.
const DEPTH: u32 = 8 * 1024;
/// What calls and the test itself may take beyond that.
const AROUND: u32 = 1024;

fn stack_that_is_used(_: &mut ()) -> Verdict {
    let before = stack_use().used;
    if before == 0 || before > AROUND {
        return Err("the stack is not as empty as it should be");
    }
    deep();
    let after = stack_use().used;
    if (DEPTH..DEPTH + AROUND).contains(&after) {
        Ok(None)
    } else {
        Err("the mark does not show what was used")
    }
}

#[inline(never)]
fn deep() {
    black_box([1u8; DEPTH as usize]);
}
