//! The work of one core: ask for units, render them, send the pixels, stop when told.
//!
//! A board gives three things: a [`Network`] that carries UDP payloads, a [`Clock`], and a way to say how much stack was used.
//! Boards with an Ethernet controller only drive the controller ([`ethernet::Device`]); Ethernet, ARP, IPv4 and UDP are done once
//! for all of them by [`ethernet::Interface`]. The same worker runs in a thread of the host, over its sockets, as the native
//! backend: this crate does not know which of the two it is in.
//!
//! # One core's life
//!
//! ```text
//!          HELLO (again after 50, 100, ... 800 ms)       STOP
//!   boot ------> idle <----------------------+   any ---------> FAREWELL, 3 times, exit
//!                 | LEASE                     | no lease left
//!                 v                           |
//!              render a unit -> PIXELS -> look for packets
//! ```
//!
//! Nothing here is retransmitted on a timer but HELLO. A lost LEASE shows as another HELLO, a lost PIXELS as a unit that the host
//! leases again, and a unit is a pure function, so doing one twice is harmless.
#![no_std]
#![forbid(unsafe_code)]

mod checksum;
mod clock;
mod division;
pub mod ethernet;
mod fault;
mod leases;
pub mod log;
mod network;
mod run;
mod text;
mod unit_source;
mod worker;

pub use clock::{Clock, TICKS_PER_SECOND};
pub use fault::{Fault, send_fault};
pub use leases::LEASES;
pub use network::{Network, SendError};
pub use run::{plan, run};
pub use text::Text;
pub use worker::{Outcome, Renderer, StackUse, Worker};
