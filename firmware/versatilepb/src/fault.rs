//! What is said when a core fails, and where: on the console, and to the host if the network lets it.

use core::panic::PanicInfo;

use node::Words;
use node::ethernet::Ethernet;
use wire::Boot;

use crate::semihosting::{Exit, exit};
use crate::smc91c111::Smc91c111;
use crate::{console, memory};

/// Says why on the console and to the host, and ends.
#[cold]
#[inline(never)]
pub fn die(words: &Words, code: Exit) -> ! {
    console::line(words.as_str());
    if dying::again() {
        exit(code);
    }
    if let Ok(boot) = Boot::decode(memory::boot_block()) {
        // Whatever state the card was in: it starts anew.
        if let Some(mut card) = Smc91c111::start(boot.mac()) {
            // There is nobody left to tell if this fails; the console has it.
            let _ = node::last_words(&boot, &mut Ethernet::new(&boot, &mut card), words.as_str());
        }
    }
    exit(code)
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    let mut words = Words::of("panic");
    if let Some(place) = info.location() {
        words.and(" at ").and(place.file()).and(":").decimal(place.line());
    }
    // Messages with numbers in them would need `core::fmt`; the place says enough.
    if let Some(message) = info.message().as_str() {
        words.and(": ").and(message);
    }
    die(&words, Exit::Panic)
}

#[aarch32_rt::exception(Undefined)]
fn undefined(addr: usize) -> ! {
    exception("undefined instruction at 0x", addr)
}

#[aarch32_rt::exception(PrefetchAbort)]
fn prefetch_abort(addr: usize) -> ! {
    exception("prefetch abort at 0x", addr)
}

#[aarch32_rt::exception(DataAbort)]
fn data_abort(addr: usize) -> ! {
    exception("data abort by the instruction at 0x", addr)
}

fn exception(what: &str, address: usize) -> ! {
    let mut words = Words::of(what);
    words.hexadecimal(address as u32);
    die(&words, Exit::Exception)
}

/// Remembers that the core is already dying, so that a fault in [`die`] does not end in a circle.
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
