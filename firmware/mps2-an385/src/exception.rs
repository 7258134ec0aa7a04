//! The processor's exceptions.

use cortex_m::peripheral::SCB;
use cortex_m_rt::ExceptionFrame;
use runtime::report_exception;

use crate::Core;

/// All faults end here: none of the others is enabled.
#[cortex_m_rt::exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    // SAFETY: the configurable fault status register may be read at any time.
    let status = unsafe { (*SCB::PTR).cfsr.read() };
    report_exception::<Core>(cause(status), frame.pc() as usize)
}

/// The cause of a fault by the configurable fault status (*ARMv7-M Architecture Reference Manual*, ARM DDI 0403E, B3.2.15).
fn cause(status: u32) -> &'static str {
    const CAUSES: [(u32, &str); 5] = [
        (1 << 16, "undefined instruction"),
        (1 << 9, "data abort by the instruction"),
        (1 << 10, "data abort some time before the instruction"),
        (1 << 8 | 1, "prefetch abort"),
        (1 << 17, "attempt to leave Thumb state"),
    ];
    let known = CAUSES.iter().find(|(bits, _)| status & bits != 0);
    known.map_or("hard fault", |(_, cause)| cause)
}
