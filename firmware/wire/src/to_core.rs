//! What the host tells a core.
//!
//! LEASE (0x0201): render these units. The sequence number is the lease's own: a core that sees the number of one of its last few
//! leases again ignores it, so a host that wants a unit done *again* gives a new number. Argument 2: the first unit. Argument 3:
//! how many. No data.
//!
//! STOP (0x0202): answer FAREWELL and halt. The sequence number and the arguments 2 and 3 are zero. No data.

use crate::bytes::Reader;
use crate::{DecodeError, Frame, MAX_PAYLOAD};

const LEASE: u16 = 0x0201;
const STOP: u16 = 0x0202;

/// A packet to a core.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ToCore {
    /// The core it is for.
    pub core: u16,
    /// The run it belongs to.
    pub session: u32,
    /// What it says.
    pub order: Order,
}

/// What a packet to a core says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
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
        let (command, seq, arg2, arg3) = match self.order {
            Order::Lease { number, first, count } => (LEASE, number, first, count),
            Order::Stop => (STOP, 0, 0, 0),
        };
        let (core, session) = (self.core, self.session);
        Frame {
            core,
            command,
            seq,
            session,
            arg2,
            arg3,
            data: &[],
        }
        .start_to_core(out)
        .len()
    }

    /// Reads a packet. Total: see the crate's contract of decoding.
    pub fn decode(payload: &[u8]) -> Result<Self, DecodeError> {
        let frame = Frame::to_core(payload)?;
        let Frame {
            core,
            session,
            seq,
            arg2,
            arg3,
            ..
        } = frame;
        let order = match frame.command {
            LEASE if arg3 == 0 || arg2.checked_add(arg3 - 1).is_none() => return Err(DecodeError::Range),
            LEASE => Order::Lease {
                number: seq,
                first: arg2,
                count: arg3,
            },
            STOP if seq != 0 || arg2 != 0 || arg3 != 0 => return Err(DecodeError::Range),
            STOP => Order::Stop,
            other => return Err(DecodeError::Command(other)),
        };
        Reader::new(frame.data).end()?;
        Ok(Self { core, session, order })
    }
}
