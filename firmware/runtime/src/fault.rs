//! What is said when a core fails, and where: on the console, and to the host if the network lets it.

use core::panic::PanicInfo;

use node::Words;
use node::ethernet::Ethernet;
use wire::Boot;

use crate::{Board, Exit, memory};

/// Says why on the console and to the host, and ends.
pub fn die<B: Board>(words: &Words, code: Exit) -> ! {
    die_at::<B>(None, words, code)
}

/// The same where the instruction is known that failed: the host, which has the image, says whose it is.
#[cold]
#[inline(never)]
fn die_at<B: Board>(address: Option<u32>, words: &Words, code: Exit) -> ! {
    B::say(words.as_str());
    if dying::again() {
        B::exit(code);
    }
    if let Ok(boot) = Boot::decode(memory::boot_block())
        && let Some(mut controller) = B::controller(boot.mac())
    {
        let mut network = Ethernet::new(&boot, &mut controller);
        // There is nobody left to tell if this fails; the console has it.
        let _ = node::last_words(&boot, &mut network, address, words.as_str());
    }
    #[cfg(feature = "log")]
    defmt::error!("{=str}", words.as_str());
    B::exit(code)
}

/// What a board's panic handler does.
pub fn panicked<B: Board>(info: &PanicInfo<'_>) -> ! {
    let mut words = Words::of("panic");
    if let Some(place) = info.location() {
        words.and(" at ").and(place.file()).and(":").decimal(place.line());
    }
    // Messages with numbers in them would need `core::fmt`; the place says enough.
    if let Some(message) = info.message().as_str() {
        words.and(": ").and(message);
    }
    die::<B>(&words, Exit::Panic)
}

/// What a board's handlers of processor exceptions do: `what` went wrong, and the address of the instruction.
pub fn exception<B: Board>(what: &str, address: usize) -> ! {
    let address = address as u32;
    let mut words = Words::of(what);
    words.and(" at 0x").hexadecimal(address);
    die_at::<B>(Some(address), &words, Exit::Exception)
}

/// Remembers that the core is already dying, so that a fault in [`die_at`] does not end in a circle.
mod dying {
    use core::cell::Cell;

    struct OneCore(Cell<bool>);

    // SAFETY: there is one core and no interrupt handler, so there is one thread.
    unsafe impl Sync for OneCore {}

    static DYING: OneCore = OneCore(Cell::new(false));

    /// True from the second call on.
    pub(super) fn again() -> bool {
        DYING.0.replace(true)
    }
}
