//! What the host tells a core.
//!
//! # LEASE (0x0201)
//!
//! Render these units. The sequence number is the lease's own: a core that sees the number of one of its last few leases again
//! ignores it, so a host that wants a unit done *again* gives a new number.
//!
//! | offset | bytes | field                   |
//! | ------ | ----- | ----------------------- |
//! | 18     | 4     | first: the first unit   |
//! | 22     | 4     | count: how many units   |
//!
//! # STOP (0x0202)
//!
//! Answer FAREWELL and halt. The sequence number is zero.
//!
//! | offset | bytes | field        |
//! | ------ | ----- | ------------ |
//! | 18     | 8     | unused: zero |

use crate::frame::Frame;
use crate::layout::{Layout, layout};
use crate::{DecodeError, MAX_PAYLOAD};

const LEASE: u16 = 0x0201;
const STOP: u16 = 0x0202;

layout! {
    struct LeaseBody[18..26] {
        18 => first: u32,
        22 => count: u32,
    }
}

layout! {
    struct StopBody[18..26] {
        // Arguments 2 and 3 of SCP, which are always there.
        18 => unused: u64,
    }
}

/// A packet to a core.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ToCore {
    /// The core it is for.
    pub core: u16,
    /// The run it belongs to.
    pub session: u32,
    /// What the core is to do.
    pub command: Command,
}

/// What a core is to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Render units `first` to `first + count - 1`.
    Lease {
        /// The lease's own number.
        number: u16,
        /// The first unit.
        first: u32,
        /// How many units, at least 1; the last one's id still fits 32 bits.
        count: u32,
    },
    /// Answer FAREWELL and halt.
    Stop,
}

impl ToCore {
    /// Writes the packet and returns its length. The rest of `out` stays as it is.
    pub fn encode(&self, out: &mut [u8; MAX_PAYLOAD]) -> usize {
        let (command, seq, len) = match self.command {
            Command::Lease { number, first, count } => {
                LeaseBody { first, count }.write(out);
                (LEASE, number, LeaseBody::END)
            }
            Command::Stop => {
                StopBody { unused: 0 }.write(out);
                (STOP, 0, StopBody::END)
            }
        };
        let (core, session) = (self.core, self.session);
        Frame {
            core,
            command,
            seq,
            session,
        }
        .write_to_core(out);
        len
    }

    /// Reads a packet. Total: see the crate's contract of decoding.
    pub fn decode(payload: &[u8]) -> Result<Self, DecodeError> {
        let Frame {
            core,
            command,
            seq,
            session,
        } = Frame::to_core(payload)?;
        let command = match command {
            LEASE => lease(seq, LeaseBody::whole(payload)?)?,
            STOP if seq != 0 || StopBody::whole(payload)?.unused != 0 => return Err(DecodeError::Range),
            STOP => Command::Stop,
            other => return Err(DecodeError::Command(other)),
        };
        Ok(Self {
            core,
            session,
            command,
        })
    }
}

fn lease(number: u16, LeaseBody { first, count }: LeaseBody) -> Result<Command, DecodeError> {
    if count == 0 || first.checked_add(count - 1).is_none() {
        return Err(DecodeError::Range);
    }
    Ok(Command::Lease { number, first, count })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::tests::{assert_dissected, assert_documented};

    #[test]
    fn the_commands_are_as_documented_and_as_wireshark_shows_them() {
        let text = include_str!("to_core.rs");
        assert_documented(text, &std::format!("# LEASE ({LEASE:#06x})"), LeaseBody::FIELDS);
        assert_documented(text, &std::format!("# STOP ({STOP:#06x})"), StopBody::FIELDS);
        assert_dissected("LEASE", LEASE, LeaseBody::FIELDS, LeaseBody::END);
        assert_dissected("STOP", STOP, &[], StopBody::END);
    }
}
