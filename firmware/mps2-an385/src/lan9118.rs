//! The LAN9118 Ethernet controller, polled.
//!
//! Its registers are words. Frames go through two first-in-first-out memories of words, one a direction, with two smaller ones
//! beside them that hold a status word a frame. Received frames have memory of their own here, so that reception never keeps
//! transmission waiting. The controller's own processor of addresses and checksums, the MAC, has registers behind a window of two.
//!
//! Sections and bits are those of SMSC's *LAN9118 Datasheet*, revision 1.5.

use node::SendError;
use node::ethernet::Device;
use runtime::registers::Register;

use crate::sleep;

const BASE: usize = 0x4020_0000;

/// The register at this offset.
const fn word(offset: usize) -> Register<u32> {
    // SAFETY: the controller's registers may be accessed as words; it has no DMA.
    unsafe { Register::new(BASE + offset) }
}

const RECEIVE_DATA: Register<u32> = word(0x00);
const TRANSMIT_DATA: Register<u32> = word(0x20);
const RECEIVE_STATUS: Register<u32> = word(0x40);
const TRANSMIT_STATUS: Register<u32> = word(0x48);
const INTERRUPT_CONFIGURATION: Register<u32> = word(0x54);
const INTERRUPTS: Register<u32> = word(0x58);
const INTERRUPT_MASK: Register<u32> = word(0x5C);
const BYTE_TEST: Register<u32> = word(0x64);
const FIFO_LEVELS: Register<u32> = word(0x68);
const RECEIVE_CONFIGURATION: Register<u32> = word(0x6C);
const TRANSMIT_CONFIGURATION: Register<u32> = word(0x70);
const HARDWARE: Register<u32> = word(0x74);
const RECEIVE_FIFOS: Register<u32> = word(0x7C);
const TRANSMIT_FIFOS: Register<u32> = word(0x80);
const MAC_COMMAND: Register<u32> = word(0xA4);
const MAC_DATA: Register<u32> = word(0xA8);

/// What BYTE_TEST reads as, which tells the controller from empty space, and that it is awake.
const BYTES_IN_ORDER: u32 = 0x8765_4321;

const SOFT_RESET: u32 = 1;
/// Transmit whole frames only; five of the memory's 16 KiB are for them.
const STORE_AND_FORWARD: u32 = 1 << 20 | 5 << 16;
const TRANSMIT_ON: u32 = 1 << 1;

/// The interrupt is a pushed and pulled line, high when active.
const INTERRUPT_ON: u32 = 1 << 8 | 1 << 4 | 1;
/// More frames received than the level in FIFO_LEVELS, which is none.
const INTERRUPT_RECEIVED: u32 = 1 << 3;

/// A frame's first and last, and only, part.
const WHOLE_FRAME: u32 = 1 << 13 | 1 << 12;
/// Words that come before a frame's data.
const COMMANDS: usize = 2;
const MAX_FRAME: usize = 1514;

const RECEIVE_ERROR: u32 = 1 << 15;
const CHECKSUM: usize = 4;

const MAC_BUSY: u32 = 1 << 31;
const MAC_CONTROL: u32 = 1;
const MAC_ADDRESS_HIGH: u32 = 2;
const MAC_ADDRESS_LOW: u32 = 3;
const PHY_COMMAND: u32 = 6;
const PHY_DATA: u32 = 7;
/// Full duplex, transmit, receive.
const MAC_ON: u32 = 1 << 20 | 1 << 3 | 1 << 2;
/// Write the control register of the PHY of address 1, which is the controller's own.
const WRITE_PHY_CONTROL: u32 = 1 << 11 | 1 << 1 | 1;
/// Negotiate anew.
const NEGOTIATE: u32 = 1 << 12 | 1 << 9;

/// Looks at a busy flag before giving up. QEMU is never busy; the real controller takes microseconds.
const PATIENCE: u32 = 1000;

/// The controller, started.
#[derive(Debug)]
pub struct Lan9118(());

impl Lan9118 {
    /// Resets and starts the controller. None where there is no such controller.
    #[inline(never)]
    pub fn start(mac: [u8; 6]) -> Option<Self> {
        wait_until(|| BYTE_TEST.read() == BYTES_IN_ORDER)?;
        HARDWARE.write(SOFT_RESET);
        wait_until(|| HARDWARE.read() & SOFT_RESET == 0)?;
        HARDWARE.write(STORE_AND_FORWARD);
        FIFO_LEVELS.write(0);
        RECEIVE_CONFIGURATION.write(0);
        INTERRUPT_MASK.write(0);
        INTERRUPT_CONFIGURATION.write(INTERRUPT_ON);
        let [a, b, c, d, e, f] = mac;
        write_mac(MAC_ADDRESS_LOW, u32::from_le_bytes([a, b, c, d]));
        write_mac(MAC_ADDRESS_HIGH, u32::from_le_bytes([e, f, 0, 0]));
        write_mac(PHY_DATA, NEGOTIATE);
        write_mac(PHY_COMMAND, WRITE_PHY_CONTROL);
        write_mac(MAC_CONTROL, MAC_ON);
        TRANSMIT_CONFIGURATION.write(TRANSMIT_ON);
        Some(Self(()))
    }

    /// Frames that have been received.
    fn received() -> u32 {
        RECEIVE_FIFOS.read() >> 16 & 0xFF
    }

    /// Forgets how transmissions went: what is lost is made good at a higher level, and the controller stops when nobody asks.
    fn forget_sent() {
        for _ in 0..TRANSMIT_FIFOS.read() >> 16 & 0xFF {
            TRANSMIT_STATUS.read();
        }
    }
}

impl Device for Lan9118 {
    fn transmit(&mut self, frame: &[u8]) -> Result<(), SendError> {
        if frame.len() > MAX_FRAME {
            return Err(SendError);
        }
        Self::forget_sent();
        let room = 4 * (COMMANDS + frame.len().div_ceil(4)) as u32;
        wait_until(|| TRANSMIT_FIFOS.read() & 0xFFFF >= room).ok_or(SendError)?;
        let len = frame.len() as u32;
        TRANSMIT_DATA.write(WHOLE_FRAME | len);
        TRANSMIT_DATA.write(len);
        let (words, rest) = frame.as_chunks::<4>();
        for &word in words {
            TRANSMIT_DATA.write(u32::from_le_bytes(word));
        }
        if !rest.is_empty() {
            let mut last = [0; 4];
            last[..rest.len()].copy_from_slice(rest);
            TRANSMIT_DATA.write(u32::from_le_bytes(last));
        }
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8]) -> Option<usize> {
        while Self::received() > 0 {
            let status = RECEIVE_STATUS.read();
            let all = (status >> 16 & 0x3FFF) as usize;
            let len = all.saturating_sub(CHECKSUM);
            let frame = buffer.get_mut(..len).filter(|_| status & RECEIVE_ERROR == 0);
            let wanted = frame.is_some();
            read(frame.unwrap_or_default(), all);
            if wanted {
                return Some(len);
            }
        }
        None
    }

    fn wait(&mut self, ticks: u32) {
        INTERRUPTS.write(INTERRUPT_RECEIVED);
        if Self::received() > 0 {
            return;
        }
        INTERRUPT_MASK.write(INTERRUPT_RECEIVED);
        sleep::until_packet_or_timeout(ticks);
        INTERRUPT_MASK.write(0);
    }
}

/// Takes a frame of `all` bytes out of the memory, the first of them into `frame`.
///
/// The controller can skip the rest of a frame, but QEMU's then forgets to free the memory it was in.
fn read(frame: &mut [u8], all: usize) {
    let mut parts = frame.chunks_mut(4);
    for _ in 0..all.div_ceil(4) {
        let word = RECEIVE_DATA.read().to_le_bytes();
        if let Some(part) = parts.next() {
            part.copy_from_slice(&word[..part.len()]);
        }
    }
}

fn write_mac(register: u32, value: u32) {
    MAC_DATA.write(value);
    MAC_COMMAND.write(MAC_BUSY | register);
    // A controller that stays busy shows in the first transmission.
    let _ = wait_until(|| MAC_COMMAND.read() & MAC_BUSY == 0);
}

fn wait_until(mut done: impl FnMut() -> bool) -> Option<()> {
    (0..PATIENCE).any(|_| done()).then_some(())
}
