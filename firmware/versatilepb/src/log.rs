//! The log: `defmt`'s frames, over the second PL011 UART, each with the time by the core's clock.
//!
//! No transport that others wrote is for ARMv5TE. This one waits for every byte to leave, so it loses none, and costs time.

use core::cell::RefCell;

// Says what a critical section is; nothing else of it is called by name.
use aarch32_cpu as _;
use critical_section::Mutex;
use defmt::{Encoder, Logger};
use runtime::registers::Register;

// SAFETY: the PL011's data and flag registers, 32 bits wide, without DMA.
const DATA: Register<u32> = unsafe { Register::new(0x101F_2000) };
// SAFETY: as above.
const FLAGS: Register<u32> = unsafe { Register::new(0x101F_2018) };

const TRANSMIT_FULL: u32 = 1 << 5;
const BUSY: u32 = 1 << 3;

static ENCODER: Mutex<RefCell<Encoder>> = Mutex::new(RefCell::new(Encoder::new()));

defmt::timestamp!("{=u64:us}", runtime::log::uptime::<crate::Core>());

#[defmt::global_logger]
struct SecondUart;

// SAFETY: there is one core and no interrupt handler, so there is one context; what the methods share is in a mutex. A frame that a
// fault cuts short is followed by the fault's own, and the host drops both: the frames' encoding allows it.
unsafe impl Logger for SecondUart {
    fn acquire() {
        encode(|encoder| encoder.start_frame(send));
    }

    unsafe fn flush() {
        while FLAGS.read() & BUSY != 0 {}
    }

    unsafe fn release() {
        encode(|encoder| encoder.end_frame(send));
    }

    unsafe fn write(bytes: &[u8]) {
        encode(|encoder| encoder.write(bytes, send));
    }
}

fn encode(step: impl FnOnce(&mut Encoder)) {
    critical_section::with(|section| {
        // Taken only when a fault came in the middle of a step; its words go to the console and the network.
        if let Ok(mut encoder) = ENCODER.borrow(section).try_borrow_mut() {
            step(&mut encoder);
        }
    });
}

/// Never inlined: the encoder says this in six places.
#[inline(never)]
fn send(bytes: &[u8]) {
    for &byte in bytes {
        while FLAGS.read() & TRANSMIT_FULL != 0 {}
        DATA.write(byte.into());
    }
}
