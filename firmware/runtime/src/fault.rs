//! What is reported when a core fails, and where: on the console, and to the host if the network lets it.

use core::panic::PanicInfo;

use node::Text;
use node::ethernet::Interface;
use wire::Boot;

use crate::board::Board;
use crate::exit_code::ExitCode;
use crate::memory;

/// Reports a fault on the console and to the host, and ends the program.
pub fn report_fault<B: Board>(reason: &Text, code: ExitCode) -> ! {
    report::<B>(None, reason, code)
}

/// What a panic handler does.
pub fn report_panic<B: Board>(info: &PanicInfo<'_>) -> ! {
    let mut reason = Text::from("panic");
    if let Some(place) = info.location() {
        reason
            .push_str(" at ")
            .push_str(place.file())
            .push_str(":")
            .push_decimal(place.line());
    }
    // Messages with numbers in them would need `core::fmt`; the place says enough.
    if let Some(message) = info.message().as_str() {
        reason.push_str(": ").push_str(message);
    }
    report_fault::<B>(&reason, ExitCode::Panic)
}

/// What a board's handlers of processor exceptions do: the cause, and the address of the instruction.
pub fn report_exception<B: Board>(cause: &str, address: usize) -> ! {
    let address = address as u32;
    let mut reason = Text::from(cause);
    reason.push_str(" at 0x").push_hex(address);
    report::<B>(Some(address), &reason, ExitCode::Exception)
}

/// Where the failed instruction's address is known, the host, which has the image, says whose it is.
#[cold]
#[inline(never)]
fn report<B: Board>(address: Option<u32>, reason: &Text, code: ExitCode) -> ! {
    B::println(reason.as_str());
    if double_fault::enter() {
        B::exit(code);
    }
    if let Ok(boot) = Boot::decode(memory::boot_block())
        && let Some(mut controller) = B::controller(boot.mac())
    {
        let mut network = Interface::new(&boot, &mut controller);
        // There is nobody left to tell if this fails; the console has it.
        let _ = node::send_fault(&boot, &mut network, address, reason.as_str());
    }
    #[cfg(feature = "log")]
    defmt::error!("{=str}", reason.as_str());
    B::exit(code)
}

/// Remembers that a fault is being reported, so that one in [`report`] itself does not end in a circle.
mod double_fault {
    use core::cell::Cell;

    struct OneCore(Cell<bool>);

    // SAFETY: there is one core and no interrupt handler, so there is one thread.
    unsafe impl Sync for OneCore {}

    static REPORTING: OneCore = OneCore(Cell::new(false));

    /// True from the second call on.
    pub(super) fn enter() -> bool {
        REPORTING.0.replace(true)
    }
}
