//! What a core tells the host.
//!
//! The sequence number means one thing in all of them: PIXELS packets this core had sent before this packet, modulo 2^16. The
//! host sees a gap in it as lost packets, and FAREWELL shows even the loss of the last one.
//!
//! HELLO (0x0101): I have nothing to do. Argument 2: the version of the wire. Argument 3: free places in the lease queue.
//!
//! | data offset | bytes | field                          |
//! | ----------- | ----- | ------------------------------ |
//! | 0           | 4     | scene id                       |
//! | 4           | 12    | board name, ASCII, zero-padded |
//! | 16          | 12    | profile name, likewise         |
//!
//! PIXELS (0x0102): a unit is done. Argument 2: its id. Argument 3: camera epoch in the lower, samples per pixel in the upper 16 bits.
//!
//! | data offset | bytes  | field                                                      |
//! | ----------- | ------ | ---------------------------------------------------------- |
//! | 0           | 4      | scene id                                                   |
//! | 4           | 1      | pixels, 1 to 16                                            |
//! | 5           | 1      | free places in the lease queue                             |
//! | 6           | 2      | packets rejected so far, modulo 2^16                       |
//! | 8           | 4      | 24 MHz ticks spent rendering the unit, and on nothing else |
//! | 12          | 4      | rays traced                                                |
//! | 16          | 15 n   | sums, see [`PixelSums`]                                    |
//!
//! FAREWELL (0x0103): I was told to stop and halt now. Argument 2: units done. Argument 3: packets rejected.
//!
//! | data offset | bytes | field                              |
//! | ----------- | ----- | ---------------------------------- |
//! | 0           | 4     | the most stack ever used, in bytes |
//! | 4           | 4     | size of the stack in bytes         |
//!
//! FAULT (0x0104): I fail. Argument 2: the address of the instruction that failed, zero where nobody knows it. Argument 3: 1 where
//! that address is known, else 0. Data: last words, UTF-8, at most 256 bytes.

use crate::bytes::Reader;
use crate::{DecodeError, Frame, MAX_DATA, MAX_PAYLOAD, MAX_SAMPLES, Name, PixelSums};

const HELLO: u16 = 0x0101;
const PIXELS: u16 = 0x0102;
const FAREWELL: u16 = 0x0103;
const FAULT: u16 = 0x0104;

/// A packet from a core.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FromCore<'a> {
    /// The core that sent it.
    pub core: u16,
    /// PIXELS packets the core had sent before this packet, modulo 2^16.
    pub seq: u16,
    /// The run this packet belongs to.
    pub session: u32,
    /// What it says.
    pub report: Report<'a>,
}

/// What a packet from a core says.
#[expect(
    clippy::large_enum_variant,
    reason = "no_std without an allocator, and PIXELS is what nearly every packet is"
)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Report<'a> {
    /// "I have nothing to do."
    Hello(Hello),
    /// "This unit is done."
    Pixels(Pixels),
    /// "I was told to stop, and halt now."
    Farewell(Farewell),
    /// "I fail."
    Fault(LastWords<'a>),
}

/// A core without work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hello {
    /// Version of the wire the core speaks.
    pub version: u16,
    /// Leases it has room for.
    pub free_leases: u8,
    /// The scene it was booted with.
    pub scene: u32,
    /// Its board.
    pub board: Name,
    /// Its arithmetic profile.
    pub profile: Name,
}

/// A unit's result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pixels {
    /// The unit.
    pub unit: u32,
    /// The camera it was rendered for.
    pub epoch: u16,
    /// Samples in each pixel's sums: a multiple of 4, 4 to 4096.
    pub samples: u16,
    /// The scene it was rendered from.
    pub scene: u32,
    /// Leases the core has room for.
    pub free_leases: u8,
    /// Packets the core has rejected so far, modulo 2^16.
    pub rejected: u16,
    /// 24 MHz ticks spent rendering this unit, and on nothing else.
    pub ticks: u32,
    /// Rays traced.
    pub rays: u32,
    /// The sums of the unit's pixels.
    pub sums: PixelSums,
}

/// A core that halts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Farewell {
    /// Units it has rendered.
    pub units: u32,
    /// Packets it has rejected: malformed, of another session, or for another core.
    pub rejected: u32,
    /// The most stack it ever used, in bytes. Zero where nobody measured.
    pub stack_used: u32,
    /// The stack it had, in bytes.
    pub stack_size: u32,
}

/// Why a core fails, and where.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LastWords<'a> {
    /// The instruction that failed, where the core knows it.
    pub address: Option<u32>,
    /// The cause in words. Encoding cuts them to the 256 bytes there is room for.
    pub words: &'a str,
}

impl<'a> FromCore<'a> {
    /// Writes the packet and returns its length. The rest of `out` stays as it is.
    pub fn encode(&self, out: &mut [u8; MAX_PAYLOAD]) -> usize {
        let (command, arg2, arg3) = match &self.report {
            Report::Hello(hello) => (HELLO, u32::from(hello.version), u32::from(hello.free_leases)),
            Report::Pixels(pixels) => (
                PIXELS,
                pixels.unit,
                u32::from(pixels.samples) << 16 | u32::from(pixels.epoch),
            ),
            Report::Farewell(farewell) => (FAREWELL, farewell.units, farewell.rejected),
            Report::Fault(fault) => (
                FAULT,
                fault.address.unwrap_or(0),
                u32::from(fault.address.is_some()),
            ),
        };
        let (core, seq, session) = (self.core, self.seq, self.session);
        let mut writer = Frame {
            core,
            command,
            seq,
            session,
            arg2,
            arg3,
            data: &[],
        }
        .start_to_host(out);
        match &self.report {
            Report::Hello(hello) => {
                writer.u32(hello.scene);
                writer.bytes(&hello.board.to_bytes());
                writer.bytes(&hello.profile.to_bytes());
            }
            Report::Pixels(pixels) => {
                writer.u32(pixels.scene);
                writer.u8(pixels.sums.pixels());
                writer.u8(pixels.free_leases);
                writer.u16(pixels.rejected);
                writer.u32(pixels.ticks);
                writer.u32(pixels.rays);
                writer.bytes(pixels.sums.bytes());
            }
            Report::Farewell(farewell) => {
                writer.u32(farewell.stack_used);
                writer.u32(farewell.stack_size);
            }
            Report::Fault(fault) => writer.bytes(cut(fault.words).as_bytes()),
        }
        writer.len()
    }

    /// Reads a packet. Total: see the crate's contract of decoding.
    pub fn decode(payload: &'a [u8]) -> Result<Self, DecodeError> {
        let frame = Frame::from_core(payload)?;
        let report = match frame.command {
            HELLO => Report::Hello(Hello::decode(&frame)?),
            PIXELS => Report::Pixels(Pixels::decode(&frame)?),
            FAREWELL => Report::Farewell(Farewell::decode(&frame)?),
            FAULT => Report::Fault(LastWords::decode(&frame)?),
            other => return Err(DecodeError::Command(other)),
        };
        Ok(Self {
            core: frame.core,
            seq: frame.seq,
            session: frame.session,
            report,
        })
    }
}

impl Hello {
    fn decode(frame: &Frame<'_>) -> Result<Self, DecodeError> {
        let mut reader = Reader::new(frame.data);
        let hello = Self {
            version: u16::try_from(frame.arg2).map_err(|_| DecodeError::Range)?,
            free_leases: u8::try_from(frame.arg3).map_err(|_| DecodeError::Range)?,
            scene: reader.u32()?,
            board: Name::from_bytes(reader.array()?)?,
            profile: Name::from_bytes(reader.array()?)?,
        };
        reader.end()?;
        Ok(hello)
    }
}

impl Pixels {
    fn decode(frame: &Frame<'_>) -> Result<Self, DecodeError> {
        let samples = (frame.arg3 >> 16) as u16;
        if samples == 0 || !samples.is_multiple_of(4) || samples > MAX_SAMPLES {
            return Err(DecodeError::Range);
        }
        let mut reader = Reader::new(frame.data);
        let scene = reader.u32()?;
        let count = reader.u8()?;
        Ok(Self {
            unit: frame.arg2,
            epoch: frame.arg3 as u16,
            samples,
            scene,
            free_leases: reader.u8()?,
            rejected: reader.u16()?,
            ticks: reader.u32()?,
            rays: reader.u32()?,
            sums: PixelSums::from_bytes(reader.rest(), count)?,
        })
    }
}

impl Farewell {
    fn decode(frame: &Frame<'_>) -> Result<Self, DecodeError> {
        let mut reader = Reader::new(frame.data);
        let farewell = Self {
            units: frame.arg2,
            rejected: frame.arg3,
            stack_used: reader.u32()?,
            stack_size: reader.u32()?,
        };
        reader.end()?;
        Ok(farewell)
    }
}

impl<'a> LastWords<'a> {
    fn decode(frame: &Frame<'a>) -> Result<Self, DecodeError> {
        let address = match (frame.arg2, frame.arg3) {
            (0, 0) => None,
            (address, 1) => Some(address),
            _ => return Err(DecodeError::Range),
        };
        let words = core::str::from_utf8(frame.data).map_err(|_| DecodeError::Text)?;
        Ok(Self { address, words })
    }
}

/// As many whole characters as a packet has room for.
fn cut(words: &str) -> &str {
    words.get(..words.floor_char_boundary(MAX_DATA)).unwrap_or(words)
}
