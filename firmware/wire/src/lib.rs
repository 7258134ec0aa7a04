//! Where bytes live: the packets that cores and host exchange, and the block a core boots from.
//!
//! Both ends use this one crate, so there is one encoder and one decoder of everything.
//!
//! # From the outside in
//!
//! A UDP payload is a SpiNNaker datagram as a real board's Ethernet core would send it:
//!
//! | offset | bytes | what                                                             | module      |
//! | ------ | ----- | ---------------------------------------------------------------- | ----------- |
//! | 0      | 2     | padding, zero                                                    | [`frame`]   |
//! | 2      | 8     | SDP header: flags, tag, ports, chips                             | [`frame`]   |
//! | 10     | 4     | SCP command and sequence number                                  | [`frame`]   |
//! | 14     | 12    | SCP arguments 1 to 3; argument 1 is always the session           | [`frame`]   |
//! | 26     | 0-256 | data, laid out by the command                                    | [`from_core`], [`to_core`] |
//!
//! All numbers are little-endian. [`Frame`] is the *view*: it checks that the headers are there and gives their fields raw.
//! [`FromCore`] and [`ToCore`] are the *parsed forms*: a value of theirs has passed every check that needs no context.
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

mod address;
pub mod boot;
mod bytes;
mod error;
pub mod frame;
pub mod from_core;
mod layout;
mod name;
mod sums;
pub mod to_core;

pub use address::CORES_PER_CHIP;
pub use boot::Boot;
pub use bytes::crc32;
pub use error::DecodeError;
pub use frame::Frame;
pub use from_core::{Farewell, FromCore, Hello, LastWords, Pixels, Report};
pub use name::Name;
pub use sums::{PixelSums, SUM_MAX, SumsError};
pub use to_core::{Order, ToCore};

/// Version of everything in this crate; a core says it in HELLO, and the boot block carries it.
pub const VERSION: u16 = 3;

/// The collector's UDP port unless a job says otherwise.
pub const DEFAULT_PORT: u16 = 17893;

/// Bytes before the data: padding, SDP header, SCP header.
pub const HEADER_LEN: usize = 26;

/// The most data bytes a packet carries.
pub const MAX_DATA: usize = 256;

/// The longest UDP payload.
pub const MAX_PAYLOAD: usize = HEADER_LEN + MAX_DATA;

/// The most pixels in one PIXELS packet.
pub const MAX_PIXELS: usize = 16;

/// The most samples of one pixel in one PIXELS packet: as many as a sum has room for (see [`SUM_MAX`]).
pub const MAX_SAMPLES: u16 = 4096;
