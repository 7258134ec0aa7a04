//! The SMC91C111 Ethernet controller, polled.
//!
//! Sixteen bytes of registers in four banks; the last word chooses the bank. Packets lie in 8 KiB of the controller's own memory,
//! shared by both directions, and are read and written through one data register behind a pointer. Reception can fill all of that
//! memory, so whoever waits for a transmit buffer takes received packets first: [`Device::transmit`] gives up after a moment, and
//! the caller receives and tries again.
//!
//! A packet in that memory:
//!
//! | offset    | bytes | what                                                                        |
//! | --------- | ----- | --------------------------------------------------------------------------- |
//! | 0         | 2     | status: zero to send, flags on receipt                                      |
//! | 2         | 2     | count: bytes of all of this, always even                                    |
//! | 4         | n     | the frame, without its last byte if n is odd                                |
//! | count - 2 | 2     | control in the upper byte; the last byte of an odd frame in the lower       |

use node::SendError;
use node::ethernet::Device;

use crate::sleep;
use runtime::registers::Register;

const BASE: usize = 0x1001_0000;

/// The register at this offset of the chosen bank.
const fn word(offset: usize) -> Register<u16> {
    // SAFETY: the controller's sixteen bytes may be accessed as words; it has no DMA.
    unsafe { Register::new(BASE + offset) }
}

const fn byte(offset: usize) -> Register<u8> {
    // SAFETY: as above, as bytes.
    unsafe { Register::new(BASE + offset) }
}

/// In every bank. The upper byte reads 0x33, which tells the controller from empty space.
const BANK: Register<u16> = word(14);
const BANK_MARK: u16 = 0x3300;

// Bank 0.
const TRANSMIT_CONTROL: Register<u16> = word(0);
const RECEIVE_CONTROL: Register<u16> = word(4);
/// Enable; pad short frames.
const TRANSMIT_ON: u16 = 0x0081;
/// Enable; strip the checksum.
const RECEIVE_ON: u16 = 0x0300;
const SOFT_RESET: u16 = 0x8000;

// Bank 2.
const COMMAND: Register<u16> = word(0);
const PACKET: Register<u8> = byte(2);
const ALLOCATED: Register<u8> = byte(3);
const SENT: Register<u8> = byte(4);
const RECEIVED: Register<u8> = byte(5);
const POINTER: Register<u16> = word(6);
const DATA: Register<u16> = word(8);
const INTERRUPTS: Register<u8> = byte(12);
const INTERRUPT_MASK: Register<u8> = byte(13);

const ALLOCATE: u16 = 1 << 5;
const RESET_MEMORY: u16 = 2 << 5;
const RELEASE_RECEIVED: u16 = 4 << 5;
const RELEASE: u16 = 5 << 5;
const ENQUEUE: u16 = 6 << 5;
const BUSY: u16 = 1;
/// In ALLOCATED: it failed. In SENT and RECEIVED: there is none.
const NONE: u8 = 0x80;
const POINT_TO_SEND: u16 = 0x4000;
const POINT_TO_RECEIVED: u16 = 0xE000;
const INTERRUPT_RECEIVED: u8 = 0x01;
const INTERRUPT_SENT: u8 = 0x02;
const INTERRUPT_ALLOCATED: u8 = 0x08;

/// Status of a received packet: alignment, checksum, too long, too short.
const RECEIVE_ERRORS: u16 = 0x8000 | 0x2000 | 0x0800 | 0x0400;
const RECEIVE_ODD: u16 = 0x1000;
const CONTROL_ODD: u16 = 0x2000;

/// Bytes of status, count and control.
const AROUND: usize = 6;
/// Eleven bits of the count mean something.
const COUNT_MASK: u16 = 0x07FF;
const MAX_FRAME: usize = 1514;

/// Buffers of 2 KiB.
const BUFFERS: u32 = 4;

/// Looks at a busy flag before giving up. QEMU is never busy; the real controller takes microseconds.
const PATIENCE: u32 = 1000;

/// The controller, started.
#[derive(Debug)]
pub struct Smc91c111 {
    /// A buffer has been asked for and not been given yet. It must not be asked for twice.
    allocating: bool,
}

impl Smc91c111 {
    /// Resets and starts the controller. None where there is no such controller.
    #[inline(never)]
    pub fn start(mac: [u8; 6]) -> Option<Self> {
        BANK.write(0);
        if BANK.read() & 0xFF00 != BANK_MARK {
            return None;
        }
        RECEIVE_CONTROL.write(SOFT_RESET);
        RECEIVE_CONTROL.write(0);
        BANK.write(1);
        for (offset, part) in (4..).zip(mac) {
            byte(offset).write(part);
        }
        BANK.write(2);
        command(RESET_MEMORY);
        INTERRUPT_MASK.write(0);
        BANK.write(0);
        TRANSMIT_CONTROL.write(TRANSMIT_ON);
        RECEIVE_CONTROL.write(RECEIVE_ON);
        // All that is left to do is in bank 2.
        BANK.write(2);
        Some(Self { allocating: false })
    }

    /// Frees the buffers of packets that have left.
    ///
    /// The controller could do that by itself (AUTO RELEASE), but QEMU's then frees a buffer before it sends what is in it, and lets
    /// a waiting received packet overwrite it: under load, packets are lost without a trace.
    #[inline(never)]
    fn release_sent() {
        for _ in 0..BUFFERS {
            let buffer = SENT.read();
            if buffer & NONE != 0 {
                return;
            }
            PACKET.write(buffer);
            command(RELEASE);
            INTERRUPTS.write(INTERRUPT_SENT);
        }
    }

    /// Waits a moment for a transmit buffer and chooses it.
    fn allocate(&mut self) -> Result<(), SendError> {
        Self::release_sent();
        if !self.allocating {
            command(ALLOCATE);
            self.allocating = true;
        }
        wait_until(|| INTERRUPTS.read() & INTERRUPT_ALLOCATED != 0).ok_or(SendError)?;
        let buffer = ALLOCATED.read();
        self.allocating = false;
        if buffer & NONE != 0 {
            return Err(SendError);
        }
        PACKET.write(buffer);
        Ok(())
    }
}

impl Device for Smc91c111 {
    fn transmit(&mut self, frame: &[u8]) -> Result<(), SendError> {
        if frame.len() > MAX_FRAME {
            return Err(SendError);
        }
        self.allocate()?;
        let (pairs, last) = frame.as_chunks::<2>();
        POINTER.write(POINT_TO_SEND);
        DATA.write(0);
        DATA.write((AROUND + 2 * pairs.len()) as u16);
        for pair in pairs {
            DATA.write(u16::from_le_bytes(*pair));
        }
        DATA.write(last.first().map_or(0, |&last| CONTROL_ODD | u16::from(last)));
        command(ENQUEUE);
        Self::release_sent();
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8]) -> Option<usize> {
        while RECEIVED.read() & NONE == 0 {
            POINTER.write(POINT_TO_RECEIVED);
            let (status, count) = (DATA.read(), usize::from(DATA.read() & COUNT_MASK));
            let odd = usize::from(status & RECEIVE_ODD != 0);
            let len = count.checked_sub(AROUND).map(|even| (even & !1) + odd);
            let frame = len
                .and_then(|len| buffer.get_mut(..len))
                .filter(|_| status & RECEIVE_ERRORS == 0);
            let len = frame.map(read_frame);
            command(RELEASE_RECEIVED);
            if len.is_some() {
                return len;
            }
        }
        None
    }

    fn wait(&mut self, ticks: u32) {
        INTERRUPT_MASK.write(INTERRUPT_RECEIVED);
        sleep::until_packet_or_timeout(ticks);
        INTERRUPT_MASK.write(0);
    }
}

/// Fills `frame` from the data register.
fn read_frame(frame: &mut [u8]) -> usize {
    let (pairs, last) = frame.as_chunks_mut::<2>();
    for pair in pairs {
        *pair = DATA.read().to_le_bytes();
    }
    if let [last] = last {
        *last = DATA.read() as u8;
    }
    frame.len()
}

fn command(command: u16) {
    COMMAND.write(command);
    // A controller that stays busy shows in the next transmission.
    let _ = wait_until(|| COMMAND.read() & BUSY == 0);
}

fn wait_until(mut done: impl FnMut() -> bool) -> Option<()> {
    (0..PATIENCE).any(|_| done()).then_some(())
}
