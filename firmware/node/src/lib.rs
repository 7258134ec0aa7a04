//! The work of one core: ask for units, render them, send the pixels, stop when told.
//!
//! A board gives three things: a [`Network`] that carries UDP payloads, a [`Clock`], and a way to say how much stack was used.
//! Boards with an Ethernet controller only drive the controller ([`ethernet::Frames`]); Ethernet, ARP, IPv4 and UDP are done once
//! for all of them by [`ethernet::Ethernet`]. The same worker runs in a thread of the host, over its sockets, as the native
//! backend: this crate does not know which of the two it is in.
//!
//! # One core's life
//!
//! ```text
//!          HELLO (again after 50, 100, ... 800 ms)       STOP
//!   boot ------> idle <----------------------+   any ---------> FAREWELL, 3 times, halt
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
pub mod ethernet;
mod fault;
mod leases;
pub mod log;
mod unit_source;
mod words;
mod worker;

pub use fault::Fault;
pub use leases::LEASES;
pub use words::Words;
pub use worker::{Outcome, Renderer, StackUse, Worker};

use fixedmath::I16F16;
use tracer::camera::{Camera, CameraRecord};
use tracer::integrator::Integrator;
use tracer::profile::Profile;
use tracer::scene::Scene;
use tracer::unit::{Plan, Sums, Termination};
use wire::{Boot, FaultInfo, FromCore, MAX_PAYLOAD, Message, Name, boot};

/// Ticks of a [`Clock`] in a second.
pub const TICKS_PER_SECOND: u32 = 24_000_000;

/// Carries UDP payloads to the collector and back.
pub trait Network {
    /// Sends one payload to the collector. On an error the packet has not left, and the worker tries again a few times.
    fn send(&mut self, payload: &[u8]) -> Result<(), SendError>;

    /// Takes the next payload, if one has arrived, and returns how many bytes of `buffer` it fills. A payload that is longer than
    /// the buffer is cut; the worker's buffer is a byte longer than the longest valid packet, so that such a one is noticed.
    fn receive(&mut self, buffer: &mut [u8]) -> Option<usize>;

    /// Rests until a payload may have arrived, or about `ticks` have passed. May return early; must not return much later.
    fn wait(&mut self, ticks: u32);

    /// Packets for this core that the network has dropped because they were malformed. They count as rejected.
    fn refused(&self) -> u32 {
        0
    }
}

/// A free-running counter.
pub trait Clock {
    /// [`TICKS_PER_SECOND`] ticks a second; wraps every three minutes.
    fn ticks(&mut self) -> u32;
}

/// The packet has not left: no buffer is free, or nobody takes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SendError;

impl core::fmt::Display for SendError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the packet could not be sent")
    }
}

impl core::error::Error for SendError {}

/// Runs the core that `boot` describes until it is told to stop.
///
/// `board` is the name that HELLO gives. `stack` measures the stack when the work is over.
pub fn run<P: Profile, I: Integrator<P>>(
    boot: &Boot<'_>,
    board: Name,
    network: &mut dyn Network,
    clock: &mut dyn Clock,
    stack: fn() -> StackUse,
) -> Result<Outcome, Fault> {
    if boot.profile != Name::new(P::NAME) {
        return Err(Fault::Profile);
    }
    let record = CameraRecord::of_bytes(boot.camera).ok_or(Fault::Scene)?;
    let scene = Scene::view(boot.scene, I::CAPABILITIES)?.seen_from(record, I::CAPABILITIES)?;
    let plan = plan(boot);
    let (camera, integrator) = (Camera::new(record), I::new(&plan));
    let mut renderer =
        |unit, sums: &mut Sums| tracer::unit::render::<P>(&integrator, &scene, &camera, &plan, unit, sums);
    Worker::new(boot, plan, board, &mut renderer, network, clock)?.run(stack)
}

/// Tells the host why this core ends, and at which instruction where that is known. Tries once: who sends this has little left to
/// rely on.
#[inline(never)]
pub fn last_words(
    boot: &Boot<'_>,
    network: &mut dyn Network,
    address: Option<u32>,
    reason: &str,
) -> Result<(), SendError> {
    let mut packet = [0; MAX_PAYLOAD];
    let message = Message::Fault(FaultInfo { address, reason });
    let len = FromCore {
        core: boot.core,
        seq: 0,
        session: boot.session,
        message,
    }
    .encode(&mut packet);
    network.send(packet.get(..len).unwrap_or_default())
}

/// What the tracer has to know of the boot block.
#[inline(never)]
pub fn plan(boot: &Boot<'_>) -> Plan {
    Plan {
        width: boot.width,
        height: boot.height,
        spp: boot.spp,
        samples_per_unit: boot.samples_per_unit,
        seed: boot.seed,
        termination: match boot.termination {
            boot::Termination::Roulette => Termination::Roulette,
            boot::Termination::Depth(depth) => Termination::Depth(depth.get()),
        },
        epsilon: I16F16::from_bits(boot.epsilon),
    }
}
