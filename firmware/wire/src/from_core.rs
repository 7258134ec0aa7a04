//! What a core tells the host.
//!
//! The sequence number means one thing in all of them: PIXELS packets this core had sent before this packet, modulo 2^16. The
//! host sees a gap in it as lost packets, and FAREWELL shows even the loss of the last one.
//!
//! # HELLO (0x0101)
//!
//! I have nothing to do.
//!
//! | offset | bytes | field                              |
//! | ------ | ----- | ---------------------------------- |
//! | 18     | 4     | version: of the wire               |
//! | 22     | 4     | scene: its id                      |
//! | 26     | 12    | board: its name, see [`Name`]      |
//! | 38     | 12    | profile: its name, likewise        |
//!
//! # PIXELS (0x0102)
//!
//! A unit is done.
//!
//! | offset | bytes  | field                                                             |
//! | ------ | ------ | ----------------------------------------------------------------- |
//! | 18     | 4      | unit: its id                                                      |
//! | 22     | 2      | epoch: the camera's                                               |
//! | 24     | 2      | samples: of each pixel                                            |
//! | 26     | 4      | scene: its id                                                     |
//! | 30     | 4      | ticks: of 24 MHz, spent rendering the unit, and on nothing else   |
//! | 34     | 4      | rays: how many were traced                                        |
//! | 38     | 15 n   | the sums of 1 to 16 pixels, see [`PixelSums`]                     |
//!
//! # FAREWELL (0x0103)
//!
//! I was told to stop and halt now.
//!
//! | offset | bytes | field                                          |
//! | ------ | ----- | ---------------------------------------------- |
//! | 18     | 4     | rejected: packets that were not for this core  |
//! | 22     | 4     | stack used: the most there ever was, in bytes  |
//! | 26     | 4     | stack size: in bytes                           |
//!
//! # FAULT (0x0104)
//!
//! I fail.
//!
//! | offset | bytes | field                                                                      |
//! | ------ | ----- | -------------------------------------------------------------------------- |
//! | 18     | 4     | address: of the instruction that failed, zero where nobody knows it        |
//! | 22     | 4     | address known: 1 where it is, else 0                                       |
//! | 26     | 0-256 | why, UTF-8                                                                 |

use crate::frame::Frame;
use crate::layout::{Layout, layout};
use crate::{DecodeError, MAX_PAYLOAD, MAX_SAMPLES, Name, PixelSums};

const HELLO: u16 = 0x0101;
const PIXELS: u16 = 0x0102;
const FAREWELL: u16 = 0x0103;
const FAULT: u16 = 0x0104;

layout! {
    struct HelloBody[18..50] {
        18 => version: u32,
        22 => scene: u32,
        26 => board: [u8; Name::LEN],
        38 => profile: [u8; Name::LEN],
    }
}

layout! {
    struct PixelsBody[18..38] {
        18 => unit: u32,
        22 => epoch: u16,
        24 => samples: u16,
        26 => scene: u32,
        30 => ticks: u32,
        34 => rays: u32,
    }
}

layout! {
    struct FarewellBody[18..30] {
        18 => rejected: u32,
        22 => stack_used: u32,
        26 => stack_size: u32,
    }
}

layout! {
    struct FaultBody[18..26] {
        18 => address: u32,
        22 => address_known: u32,
    }
}

/// The most bytes of a fault's reason.
pub const MAX_REASON: usize = MAX_PAYLOAD - FaultBody::END;

// The largest unit fills no more than a packet.
const _: () = assert!(PixelsBody::END + PixelSums::MAX_LEN <= MAX_PAYLOAD);

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
    pub message: Message<'a>,
}

/// What a packet from a core says.
#[expect(
    clippy::large_enum_variant,
    reason = "no_std without an allocator, and PIXELS is what nearly every packet is"
)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Message<'a> {
    /// "I have nothing to do."
    Hello(Hello),
    /// "This unit is done."
    Pixels(Pixels),
    /// "I was told to stop, and halt now."
    Farewell(Farewell),
    /// "I fail."
    Fault(FaultInfo<'a>),
}

/// A core without work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hello {
    /// Version of the wire the core speaks.
    pub version: u16,
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
    /// Packets it has rejected: malformed, of another session, or for another core.
    pub rejected: u32,
    /// The most stack it ever used, in bytes. Zero where nobody measured.
    pub stack_used: u32,
    /// The stack it had, in bytes.
    pub stack_size: u32,
}

/// Why a core fails, and where.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FaultInfo<'a> {
    /// The instruction that failed, where the core knows it.
    pub address: Option<u32>,
    /// The cause in words. Encoding cuts them to [`MAX_REASON`] bytes.
    pub reason: &'a str,
}

impl<'a> FromCore<'a> {
    /// Writes the packet and returns its length. The rest of `out` stays as it is.
    pub fn encode(&self, out: &mut [u8; MAX_PAYLOAD]) -> usize {
        let (command, len) = match &self.message {
            Message::Hello(hello) => (HELLO, hello.encode(out)),
            Message::Pixels(pixels) => (PIXELS, pixels.encode(out)),
            Message::Farewell(farewell) => (FAREWELL, farewell.encode(out)),
            Message::Fault(fault) => (FAULT, fault.encode(out)),
        };
        let (core, seq, session) = (self.core, self.seq, self.session);
        Frame {
            core,
            command,
            seq,
            session,
        }
        .write_to_host(out);
        len
    }

    /// Reads a packet. Total: see the crate's contract of decoding.
    pub fn decode(payload: &'a [u8]) -> Result<Self, DecodeError> {
        let Frame {
            core,
            command,
            seq,
            session,
        } = Frame::from_core(payload)?;
        let message = match command {
            HELLO => Message::Hello(Hello::decode(payload)?),
            PIXELS => Message::Pixels(Pixels::decode(payload)?),
            FAREWELL => Message::Farewell(Farewell::decode(payload)?),
            FAULT => Message::Fault(FaultInfo::decode(payload)?),
            other => return Err(DecodeError::Command(other)),
        };
        Ok(Self {
            core,
            seq,
            session,
            message,
        })
    }
}

impl Hello {
    fn encode(&self, out: &mut [u8; MAX_PAYLOAD]) -> usize {
        HelloBody {
            version: self.version.into(),
            scene: self.scene,
            board: self.board.to_bytes(),
            profile: self.profile.to_bytes(),
        }
        .write(out);
        HelloBody::END
    }

    fn decode(payload: &[u8]) -> Result<Self, DecodeError> {
        let body = HelloBody::whole(payload)?;
        Ok(Self {
            version: u16::try_from(body.version).map_err(|_| DecodeError::Range)?,
            scene: body.scene,
            board: Name::from_bytes(body.board)?,
            profile: Name::from_bytes(body.profile)?,
        })
    }
}

impl Pixels {
    fn encode(&self, out: &mut [u8; MAX_PAYLOAD]) -> usize {
        PixelsBody {
            unit: self.unit,
            epoch: self.epoch,
            samples: self.samples,
            scene: self.scene,
            ticks: self.ticks,
            rays: self.rays,
        }
        .write(out);
        append(out, PixelsBody::END, self.sums.bytes())
    }

    fn decode(payload: &[u8]) -> Result<Self, DecodeError> {
        let (body, sums) = PixelsBody::split(payload)?;
        if body.samples == 0 || !body.samples.is_multiple_of(4) || body.samples > MAX_SAMPLES {
            return Err(DecodeError::Range);
        }
        Ok(Self {
            unit: body.unit,
            epoch: body.epoch,
            samples: body.samples,
            scene: body.scene,
            ticks: body.ticks,
            rays: body.rays,
            sums: PixelSums::from_bytes(sums)?,
        })
    }
}

impl Farewell {
    fn encode(&self, out: &mut [u8; MAX_PAYLOAD]) -> usize {
        FarewellBody {
            rejected: self.rejected,
            stack_used: self.stack_used,
            stack_size: self.stack_size,
        }
        .write(out);
        FarewellBody::END
    }

    fn decode(payload: &[u8]) -> Result<Self, DecodeError> {
        let body = FarewellBody::whole(payload)?;
        Ok(Self {
            rejected: body.rejected,
            stack_used: body.stack_used,
            stack_size: body.stack_size,
        })
    }
}

impl<'a> FaultInfo<'a> {
    fn encode(&self, out: &mut [u8; MAX_PAYLOAD]) -> usize {
        FaultBody {
            address: self.address.unwrap_or(0),
            address_known: self.address.is_some().into(),
        }
        .write(out);
        // As many whole characters as there is room for.
        let end = self.reason.floor_char_boundary(MAX_REASON);
        let reason = self.reason.get(..end).unwrap_or(self.reason);
        append(out, FaultBody::END, reason.as_bytes())
    }

    fn decode(payload: &'a [u8]) -> Result<Self, DecodeError> {
        let (body, reason) = FaultBody::split(payload)?;
        let address = match (body.address, body.address_known) {
            (0, 0) => None,
            (address, 1) => Some(address),
            _ => return Err(DecodeError::Range),
        };
        let reason = core::str::from_utf8(reason).map_err(|_| DecodeError::Text)?;
        Ok(Self { address, reason })
    }
}

/// Puts the last part of a message at `at`, cut where there is no room for more, and says where it ends.
fn append(out: &mut [u8; MAX_PAYLOAD], at: usize, part: &[u8]) -> usize {
    let room = out.iter_mut().skip(at).zip(part);
    room.fold(at, |end, (to, &byte)| {
        *to = byte;
        end + 1
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::Place;
    use crate::layout::tests::{assert_dissected, assert_documented};

    #[test]
    fn the_messages_are_as_documented_and_as_wireshark_shows_them() {
        let pixel = PixelSums::MAX_LEN / crate::MAX_PIXELS;
        let messages: [(_, _, &[Place], _); 4] = [
            ("HELLO", HELLO, HelloBody::FIELDS, HelloBody::END),
            ("PIXELS", PIXELS, PixelsBody::FIELDS, PixelsBody::END + pixel),
            ("FAREWELL", FAREWELL, FarewellBody::FIELDS, FarewellBody::END),
            ("FAULT", FAULT, FaultBody::FIELDS, FaultBody::END),
        ];
        for (name, command, fields, least) in messages {
            let heading = std::format!("# {name} ({command:#06x})");
            assert_documented(include_str!("from_core.rs"), &heading, fields);
            assert_dissected(name, command, fields, least);
        }
    }
}
