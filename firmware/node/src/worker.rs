//! The loop.

use tracer::unit::{Plan, SPAN, Sums};
use wire::{
    Boot, Command, Farewell, FromCore, Hello, MAX_PAYLOAD, Message, Name, PixelSums, Pixels, ToCore, VERSION,
};

use crate::clock::{Clock, TICKS_PER_SECOND};
use crate::fault::Fault;
use crate::leases::Leases;
use crate::log;
use crate::network::Network;
use crate::unit_source::UnitSource;

/// A core that has just become idle asks for work after this time again, and then after twice the time before...
const FIRST_HELLO_INTERVAL: u32 = TICKS_PER_SECOND / 20;

/// ...but at least this often: idle cores, however many, leave the host its time.
const LAST_HELLO_INTERVAL: u32 = 16 * FIRST_HELLO_INTERVAL;

/// Times a packet is tried before the core gives up. Between two tries it takes what has arrived, which frees buffers, and waits.
const SEND_TRIES: u32 = 16;

/// The wait between two tries: a millisecond.
const RETRY_INTERVAL: u32 = TICKS_PER_SECOND / 1000;

/// Packets taken at once at most, so that a flood of them cannot keep a core from its work.
const RECEIVED_AT_ONCE: u32 = 16;

/// FAREWELL is not answered, so it is said often enough for one to arrive.
const FAREWELLS: u32 = 3;

/// Renders one unit into the sums and returns how many rays it took.
pub trait Renderer {
    /// Overwrites `sums` with the unit's.
    fn render(&mut self, unit: u32, sums: &mut Sums) -> u32;
}

impl<F: FnMut(u32, &mut Sums) -> u32> Renderer for F {
    fn render(&mut self, unit: u32, sums: &mut Sums) -> u32 {
        self(unit, sums)
    }
}

/// How much of its stack a core has used. All zero where nobody measures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StackUse {
    /// High-water mark in bytes.
    pub used: u32,
    /// Size in bytes.
    pub size: u32,
}

/// What a core that was told to stop has done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// Units rendered.
    pub units: u32,
    /// Packets rejected.
    pub rejected: u32,
    /// Stack used.
    pub stack: StackUse,
}

/// One core at work.
///
/// The three traits are called through pointers, a few times a unit: that keeps the loop one piece of code, compiled for size,
/// apart from the renderer, compiled for speed.
pub struct Worker<'a> {
    boot: &'a Boot<'a>,
    scene: u32,
    plan: Plan,
    units: u32,
    board: Name,
    renderer: &'a mut dyn Renderer,
    network: &'a mut dyn Network,
    clock: &'a mut dyn Clock,
    source: UnitSource,
    leases: Leases,
    done: u32,
    rejected: u32,
    stopped: bool,
}

impl<'a> Worker<'a> {
    /// A worker that has said nothing yet.
    #[inline(never)]
    pub fn new(
        boot: &'a Boot<'a>,
        plan: Plan,
        board: Name,
        renderer: &'a mut dyn Renderer,
        network: &'a mut dyn Network,
        clock: &'a mut dyn Clock,
    ) -> Result<Self, Fault> {
        let units = plan.units().ok_or(Fault::Units)?;
        let source = UnitSource::new(boot, plan.spans(), units);
        let (scene, leases) = (boot.scene_id(), Leases::default());
        let (done, rejected, stopped) = (0, 0, false);
        Ok(Self {
            boot,
            scene,
            plan,
            units,
            board,
            renderer,
            network,
            clock,
            source,
            leases,
            done,
            rejected,
            stopped,
        })
    }

    /// Works until told to stop.
    #[inline(never)] // a caller compiled for speed would copy the loop's parts into itself
    pub fn run(mut self, stack: fn() -> StackUse) -> Result<Outcome, Fault> {
        log::info!(
            "core {=u16} of {=u16}: session {=u32:08x}, scene {=u32:08x}, {=u32} units",
            self.boot.core,
            self.boot.cores,
            self.boot.session,
            self.scene,
            self.units
        );
        self.send_hello()?;
        let (mut last_hello, mut interval) = (self.clock.ticks(), FIRST_HELLO_INTERVAL);
        loop {
            self.receive();
            if self.stopped {
                return self.send_farewell(stack());
            }
            if let Some(unit) = self.source.next(&mut self.leases) {
                self.work(unit)?;
                interval = FIRST_HELLO_INTERVAL;
                continue;
            }
            let since = self.clock.ticks().wrapping_sub(last_hello);
            if since >= interval {
                self.send_hello()?;
                last_hello = self.clock.ticks();
                interval = (2 * interval).min(LAST_HELLO_INTERVAL);
            } else {
                self.network.wait(interval - since);
            }
        }
    }

    /// Renders one unit and sends it.
    fn work(&mut self, unit: u32) -> Result<(), Fault> {
        log::trace!("unit {=u32} begins", unit);
        let mut sums = Sums::default();
        let start = self.clock.ticks();
        let rays = self.renderer.render(unit, &mut sums);
        let ticks = self.clock.ticks().wrapping_sub(start);
        log::debug!(
            "unit {=u32} is done: {=u32} ticks, {=u32} rays",
            unit,
            ticks,
            rays
        );
        let extent = self.plan.extent(unit);
        let sums: &[[u64; 3]; SPAN] = bytemuck::must_cast_ref(&sums);
        let sums =
            PixelSums::new(&sums[..usize::from(extent.pixels).min(sums.len())]).map_err(Fault::Sums)?;
        self.send(Message::Pixels(Pixels {
            unit,
            epoch: self.boot.epoch,
            samples: extent.samples,
            scene: self.scene,
            ticks,
            rays,
            sums,
        }))?;
        self.done = self.done.wrapping_add(1);
        Ok(())
    }

    /// Takes the packets that have arrived.
    fn receive(&mut self) {
        let mut buffer = [0; MAX_PAYLOAD + 1];
        for _ in 0..RECEIVED_AT_ONCE {
            let Some(len) = self.network.receive(&mut buffer) else {
                return;
            };
            if !buffer.get(..len).is_some_and(|payload| self.process(payload)) {
                self.rejected = self.rejected.wrapping_add(1);
            }
        }
    }

    /// Does what a packet says; false where it is not for this core now.
    fn process(&mut self, payload: &[u8]) -> bool {
        let ToCore {
            core,
            session,
            command,
        } = match ToCore::decode(payload) {
            Ok(packet) => packet,
            Err(error) => {
                log::warn!("packet rejected: {=str}", error.as_str());
                return false;
            }
        };
        if core != self.boot.core || session != self.boot.session {
            log::warn!(
                "packet rejected: it is for core {=u16} of session {=u32:08x}",
                core,
                session
            );
            return false;
        }
        match command {
            Command::Lease { number, first, count } => {
                let last = first + (count - 1);
                let wanted = matches!(self.source, UnitSource::Leased) && last < self.units;
                let taken = wanted && self.leases.take(number, first, last).is_ok();
                if !taken {
                    log::warn!(
                        "lease {=u16} refused: units {=u32} to {=u32} of {=u32}",
                        number,
                        first,
                        last,
                        self.units
                    );
                }
                taken
            }
            Command::Stop => {
                log::info!("told to stop");
                self.stopped = true;
                true
            }
        }
    }

    fn send_hello(&mut self) -> Result<(), Fault> {
        log::debug!("HELLO");
        self.send(Message::Hello(Hello {
            version: VERSION,
            scene: self.scene,
            board: self.board,
            profile: self.boot.profile,
        }))
    }

    fn send_farewell(&mut self, stack: StackUse) -> Result<Outcome, Fault> {
        let outcome = Outcome {
            units: self.done,
            rejected: self.all_rejected(),
            stack,
        };
        log::info!(
            "done: {=u32} units, {=u32} packets rejected, {=u32} of {=u32} bytes of stack used",
            outcome.units,
            outcome.rejected,
            stack.used,
            stack.size
        );
        for _ in 0..FAREWELLS {
            self.send(Message::Farewell(Farewell {
                rejected: outcome.rejected,
                stack_used: stack.used,
                stack_size: stack.size,
            }))?;
        }
        Ok(outcome)
    }

    #[inline(never)]
    fn send(&mut self, message: Message<'_>) -> Result<(), Fault> {
        let mut packet = [0; MAX_PAYLOAD];
        // One PIXELS packet a unit, so the units done are the packet's number.
        let seq = self.done as u16;
        let len = FromCore {
            core: self.boot.core,
            seq,
            session: self.boot.session,
            message,
        }
        .encode(&mut packet);
        let packet = packet.get(..len).unwrap_or_default();
        for failed in 0..SEND_TRIES {
            if self.network.send(packet).is_ok() {
                log::trace!("packet {=u16} of {=usize} bytes sent", seq, len);
                return Ok(());
            }
            log::debug!(
                "packet {=u16} not sent, {=u32} tries left",
                seq,
                SEND_TRIES - 1 - failed
            );
            self.receive();
            self.network.wait(RETRY_INTERVAL);
        }
        Err(Fault::Network)
    }

    fn all_rejected(&self) -> u32 {
        self.rejected.wrapping_add(self.network.malformed())
    }
}
