//! The headers that every packet starts with: SpiNNaker's SDP, and of SCP what is common to all commands.

use crate::address::Address;
use crate::layout::{Layout, layout};
use crate::{DecodeError, MAX_PAYLOAD};

layout! {
    struct Header[0..18] {
        0 => padding: u16,
        2 => flags: u8,
        3 => tag: u8,
        4 => dest_port_cpu: u8,
        5 => srce_port_cpu: u8,
        6 => dest_y: u8,
        7 => dest_x: u8,
        8 => srce_y: u8,
        9 => srce_x: u8,
        10 => cmd_rc: u16,
        12 => seq: u16,
        14 => arg1: u32,
    }
}

/// "No reply wanted", as SpiNNaker's own tools set it.
const FLAGS: u8 = 0x07;
/// The IP tag through which a board's packets reach the host.
const TAG_TO_HOST: u8 = 1;
/// "No IP tag": the packet goes to a core.
const TAG_TO_CORE: u8 = 0xFF;

/// What the headers say. Nothing but the length, the padding and the presence of a core at one end and the host at the other has
/// been checked.
#[derive(Clone, Copy)]
pub(crate) struct Frame {
    /// The core at one end.
    pub(crate) core: u16,
    /// SCP command.
    pub(crate) command: u16,
    /// SCP sequence number.
    pub(crate) seq: u16,
    /// SCP argument 1: the session.
    pub(crate) session: u32,
}

impl Frame {
    /// The headers of a payload that came from a core.
    pub(crate) fn from_core(payload: &[u8]) -> Result<Self, DecodeError> {
        let header = read(payload)?;
        if header.destination() != Address::HOST {
            return Err(DecodeError::Address);
        }
        Ok(Self::of(&header, header.source().core()?))
    }

    /// The headers of a payload that came from the host.
    pub(crate) fn to_core(payload: &[u8]) -> Result<Self, DecodeError> {
        let header = read(payload)?;
        if header.source() != Address::HOST {
            return Err(DecodeError::Address);
        }
        Ok(Self::of(&header, header.destination().core()?))
    }

    fn of(header: &Header, core: u16) -> Self {
        Self {
            core,
            command: header.cmd_rc,
            seq: header.seq,
            session: header.arg1,
        }
    }

    /// Writes the headers of a packet to the host.
    pub(crate) fn write_to_host(self, out: &mut [u8; MAX_PAYLOAD]) {
        self.write(out, TAG_TO_HOST, Address::HOST, Address::of_core(self.core));
    }

    /// Writes the headers of a packet to the core.
    pub(crate) fn write_to_core(self, out: &mut [u8; MAX_PAYLOAD]) {
        self.write(out, TAG_TO_CORE, Address::of_core(self.core), Address::HOST);
    }

    fn write(self, out: &mut [u8; MAX_PAYLOAD], tag: u8, destination: Address, source: Address) {
        Header {
            padding: 0,
            flags: FLAGS,
            tag,
            dest_port_cpu: destination.port_cpu,
            srce_port_cpu: source.port_cpu,
            dest_y: destination.y,
            dest_x: destination.x,
            srce_y: source.y,
            srce_x: source.x,
            cmd_rc: self.command,
            seq: self.seq,
            arg1: self.session,
        }
        .write(out);
    }
}

fn read(payload: &[u8]) -> Result<Header, DecodeError> {
    if payload.len() > MAX_PAYLOAD {
        return Err(DecodeError::TooLong);
    }
    let (header, _) = Header::split(payload)?;
    match header.padding {
        0 => Ok(header),
        _ => Err(DecodeError::Padding),
    }
}

impl Header {
    fn destination(&self) -> Address {
        Address {
            port_cpu: self.dest_port_cpu,
            y: self.dest_y,
            x: self.dest_x,
        }
    }

    fn source(&self) -> Address {
        Address {
            port_cpu: self.srce_port_cpu,
            y: self.srce_y,
            x: self.srce_x,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::tests::{assert_documented, assert_placed, dissector};

    #[test]
    fn the_headers_are_as_documented_and_as_wireshark_shows_them() {
        assert_documented(include_str!("lib.rs"), "# From the outside in", Header::FIELDS);
        assert_placed(dissector("local function add_headers", "\nend"), Header::FIELDS);
    }
}
