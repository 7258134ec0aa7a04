//! The SDP and SCP headers that every packet starts with.
//!
//! | offset | bytes | field                                                                  |
//! | ------ | ----- | ---------------------------------------------------------------------- |
//! | 0      | 2     | padding, zero                                                          |
//! | 2      | 1     | SDP flags: 0x07, no reply wanted (ignored on receipt)                  |
//! | 3      | 1     | SDP tag: 1 towards the host, 0xFF towards a core (ignored on receipt)  |
//! | 4      | 1     | destination port << 5 or processor                                     |
//! | 5      | 1     | source port << 5 or processor                                          |
//! | 6      | 1     | destination chip y                                                     |
//! | 7      | 1     | destination chip x                                                     |
//! | 8      | 1     | source chip y                                                          |
//! | 9      | 1     | source chip x                                                          |
//! | 10     | 2     | SCP command                                                            |
//! | 12     | 2     | SCP sequence number                                                    |
//! | 14     | 4     | argument 1: the session                                                |
//! | 18     | 4     | argument 2                                                             |
//! | 22     | 4     | argument 3                                                             |
//! | 26     | 0-256 | data                                                                   |

use crate::address::Address;
use crate::bytes::{Reader, Writer};
use crate::{DecodeError, HEADER_LEN, MAX_PAYLOAD};

/// "No reply wanted", as SpiNNaker's own tools set it.
const FLAGS: u8 = 0x07;
/// The IP tag through which a board's packets reach the host.
const TAG_TO_HOST: u8 = 1;
/// "No IP tag": the packet goes to a core.
const TAG_TO_CORE: u8 = 0xFF;

/// A view of a UDP payload whose headers are all there. Its fields are as they came; nothing but the length, the padding and the
/// presence of a core at one end and the host at the other has been checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<'a> {
    /// The core at one end.
    pub core: u16,
    /// SCP command.
    pub command: u16,
    /// SCP sequence number.
    pub seq: u16,
    /// SCP argument 1: the session.
    pub session: u32,
    /// SCP argument 2.
    pub arg2: u32,
    /// SCP argument 3.
    pub arg3: u32,
    /// What follows the headers.
    pub data: &'a [u8],
}

impl<'a> Frame<'a> {
    /// Takes the headers off a payload that came from a core.
    pub fn from_core(payload: &'a [u8]) -> Result<Self, DecodeError> {
        let (frame, destination, source) = Self::split(payload)?;
        if destination != Address::HOST {
            return Err(DecodeError::Address);
        }
        Ok(Self {
            core: source.core()?,
            ..frame
        })
    }

    /// Takes the headers off a payload that came from the host.
    pub fn to_core(payload: &'a [u8]) -> Result<Self, DecodeError> {
        let (frame, destination, source) = Self::split(payload)?;
        if source != Address::HOST {
            return Err(DecodeError::Address);
        }
        Ok(Self {
            core: destination.core()?,
            ..frame
        })
    }

    /// The fields, the destination and the source. The core is not known yet.
    fn split(payload: &'a [u8]) -> Result<(Self, Address, Address), DecodeError> {
        if payload.len() > MAX_PAYLOAD {
            return Err(DecodeError::TooLong);
        }
        let mut reader = Reader::new(payload);
        if reader.u16()? != 0 {
            return Err(DecodeError::Padding);
        }
        let [_flags, _tag, to_port, from_port, to_y, to_x, from_y, from_x] = reader.array()?;
        let frame = Self {
            core: 0,
            command: reader.u16()?,
            seq: reader.u16()?,
            session: reader.u32()?,
            arg2: reader.u32()?,
            arg3: reader.u32()?,
            data: reader.rest(),
        };
        let destination = Address {
            port_cpu: to_port,
            y: to_y,
            x: to_x,
        };
        let source = Address {
            port_cpu: from_port,
            y: from_y,
            x: from_x,
        };
        Ok((frame, destination, source))
    }

    /// Writes the headers for a packet to the host and gives a writer for the data.
    pub(crate) fn start_to_host(self, out: &mut [u8; MAX_PAYLOAD]) -> Writer<'_> {
        self.start(out, TAG_TO_HOST, Address::HOST, Address::of_core(self.core))
    }

    /// Writes the headers for a packet to the core and gives a writer for the data.
    pub(crate) fn start_to_core(self, out: &mut [u8; MAX_PAYLOAD]) -> Writer<'_> {
        self.start(out, TAG_TO_CORE, Address::of_core(self.core), Address::HOST)
    }

    fn start(self, out: &mut [u8; MAX_PAYLOAD], tag: u8, to: Address, from: Address) -> Writer<'_> {
        let mut writer = Writer::new(out);
        writer.bytes(&[
            0,
            0,
            FLAGS,
            tag,
            to.port_cpu,
            from.port_cpu,
            to.y,
            to.x,
            from.y,
            from.x,
        ]);
        writer.u16(self.command);
        writer.u16(self.seq);
        writer.u32(self.session);
        writer.u32(self.arg2);
        writer.u32(self.arg3);
        debug_assert_eq!(writer.len(), HEADER_LEN);
        writer
    }
}
