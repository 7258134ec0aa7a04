//! Where bytes live: the packets that cores and host exchange, and the block a core boots from.
//!
//! Both ends use this one crate, so there is one encoder and one decoder of everything.
//!
//! # From the outside in
//!
//! A UDP payload is a SpiNNaker datagram as a real board's Ethernet core would send it:
//!
//! | offset | bytes | field                                                                         |
//! | ------ | ----- | ----------------------------------------------------------------------------- |
//! | 0      | 2     | padding: zero                                                                 |
//! | 2      | 1     | flags: of SDP, 0x07, no reply wanted (ignored on receipt)                     |
//! | 3      | 1     | tag: of SDP, 1 towards the host, 0xFF towards a core (ignored on receipt)     |
//! | 4      | 1     | dest port cpu: destination port << 5 or processor                             |
//! | 5      | 1     | srce port cpu: source port << 5 or processor                                  |
//! | 6      | 1     | dest y: destination chip                                                      |
//! | 7      | 1     | dest x                                                                        |
//! | 8      | 1     | srce y: source chip                                                           |
//! | 9      | 1     | srce x                                                                        |
//! | 10     | 2     | cmd rc: the SCP command                                                       |
//! | 12     | 2     | seq: the SCP sequence number                                                  |
//! | 14     | 4     | arg1: the first argument of SCP, the session                                  |
//! | 18     | 8-264 | arguments 2 and 3 and data, laid out by the command: [`from_core`], [`to_core`] |
//!
//! All numbers are little-endian. A value of [`FromCore`] or [`ToCore`] has passed every check that needs no context.
//!
//! # The contract of decoding
//!
//! Decoding is a total function: it returns a value or a [`DecodeError`] for every possible input, never panics, never reads
//! outside the slice it was given and never allocates. What decodes encodes again to the same bytes, but for the SDP flags and
//! tag, which a router may change and which decoding ignores.
//!
//! What a decoder cannot know it does not judge: whether the session is the current one, the scene the right one and the unit
//! one of the plan is for the caller to say, and to count.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod address;
pub mod boot;
mod crc;
mod error;
mod frame;
pub mod from_core;
mod layout;
mod name;
mod sums;
pub mod to_core;

pub use address::CORES_PER_CHIP;
pub use boot::Boot;
pub use crc::crc32;
pub use error::DecodeError;
pub use from_core::{Farewell, FaultInfo, FromCore, Hello, MAX_REASON, Message, Pixels};
pub use name::Name;
pub use sums::{PixelSums, SUM_MAX, SumsError};
pub use to_core::{Command, ToCore};

/// Version of everything in this crate; a core says it in HELLO, and the boot block carries it.
pub const VERSION: u16 = 3;

/// The collector's UDP port unless a job says otherwise.
pub const DEFAULT_PORT: u16 = 17893;

/// The longest UDP payload: SCP's headers and 256 bytes of data, as much as SDP allows.
pub const MAX_PAYLOAD: usize = 26 + 256;

/// The most pixels in one PIXELS packet.
pub const MAX_PIXELS: usize = 16;

/// The most samples of one pixel in one PIXELS packet: as many as a sum has room for (see [`SUM_MAX`]).
pub const MAX_SAMPLES: u16 = 4096;
