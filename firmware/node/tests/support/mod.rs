//! A core in a box: a worker, a network that loses what the test says, a clock that only moves when told, and a host played by
//! the test.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

use fixedmath::U48F16;
use node::{Clock, Fault, Network, Outcome, SendError, StackUse, Worker};
use tracer::unit::Sums;
use wire::boot::{PixelOrder, Termination};
use wire::{Boot, Command, FaultInfo, FromCore, MAX_PAYLOAD, Message, Name, Pixels, ToCore};

pub(crate) const SESSION: u32 = 0xCAFE_F00D;
pub(crate) const RENDER_TICKS: u32 = 1000;
pub(crate) const STACK: StackUse = StackUse {
    used: 321,
    size: 4096,
};

/// A job of 12 runs and 2 passes: 24 units; the last run has 4 pixels.
pub(crate) fn boot(order: PixelOrder) -> Boot<'static> {
    Boot {
        core: 1,
        cores: 4,
        session: SESSION,
        epoch: 5,
        width: 20,
        height: 9,
        samples_per_unit: 16,
        spp: 24,
        seed: 1,
        epsilon: 16,
        termination: Termination::Roulette,
        order,
        profile: Name::new("precise"),
        collector: [10, 0, 2, 2],
        port: 17893,
        address: [10, 0, 2, 15],
        camera: b"camera",
        scene: b"scene",
    }
}

/// What a core said, kept apart from the packet's buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Said {
    pub(crate) seq: u16,
    pub(crate) message: Message<'static>,
}

impl Said {
    pub(crate) fn pixels(&self) -> Option<Pixels> {
        match self.message {
            Message::Pixels(pixels) => Some(pixels),
            _ => None,
        }
    }

    pub(crate) fn is_hello(&self) -> bool {
        matches!(self.message, Message::Hello(_))
    }
}

/// What the network and the clock share.
#[derive(Default)]
pub(crate) struct World {
    pub(crate) now: u32,
    pub(crate) inbox: VecDeque<Vec<u8>>,
    pub(crate) said: Vec<Said>,
    /// Sends that fail before one gets through.
    pub(crate) refuse_sends: u32,
}

impl World {
    pub(crate) fn post(&mut self, command: Command) {
        self.inbox.push_back(packet(1, SESSION, command));
    }

    pub(crate) fn lease(&mut self, number: u16, first: u32, count: u32) {
        self.post(Command::Lease { number, first, count });
    }

    pub(crate) fn units(&self) -> Vec<u32> {
        self.said
            .iter()
            .filter_map(Said::pixels)
            .map(|pixels| pixels.unit)
            .collect()
    }
}

pub(crate) fn packet(core: u16, session: u32, command: Command) -> Vec<u8> {
    let mut out = [0; MAX_PAYLOAD];
    let len = ToCore {
        core,
        session,
        command,
    }
    .encode(&mut out);
    out[..len].to_vec()
}

/// The network calls `host` with everything that arrives there.
struct FakeNetwork<H> {
    world: Rc<RefCell<World>>,
    host: H,
}

impl<H: FnMut(&mut World, Said)> Network for FakeNetwork<H> {
    fn send(&mut self, payload: &[u8]) -> Result<(), SendError> {
        let mut world = self.world.borrow_mut();
        if world.refuse_sends > 0 {
            world.refuse_sends -= 1;
            return Err(SendError);
        }
        let FromCore {
            core,
            seq,
            session,
            message,
        } = FromCore::decode(payload).expect("a core sends valid packets");
        assert_eq!((core, session), (1, SESSION));
        let said = Said {
            seq,
            message: owned(message),
        };
        world.said.push(said);
        assert!(world.said.len() < 10_000, "the worker does not come to an end");
        (self.host)(&mut world, said);
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8]) -> Option<usize> {
        let payload = self.world.borrow_mut().inbox.pop_front()?;
        let len = payload.len().min(buffer.len());
        buffer[..len].copy_from_slice(&payload[..len]);
        Some(len)
    }

    fn wait(&mut self, ticks: u32) {
        let mut world = self.world.borrow_mut();
        if world.inbox.is_empty() {
            world.now = world.now.wrapping_add(ticks);
        }
    }
}

fn owned(message: Message<'_>) -> Message<'static> {
    match message {
        Message::Fault(fault) => Message::Fault(FaultInfo {
            address: fault.address,
            reason: String::from(fault.reason).leak(),
        }),
        Message::Hello(hello) => Message::Hello(hello),
        Message::Pixels(pixels) => Message::Pixels(pixels),
        Message::Farewell(farewell) => Message::Farewell(farewell),
    }
}

struct FakeClock(Rc<RefCell<World>>);

impl Clock for FakeClock {
    fn ticks(&mut self) -> u32 {
        self.0.borrow().now
    }
}

/// Runs a core until it ends. A unit takes [`RENDER_TICKS`], and its first sum is its id.
pub(crate) fn run(
    boot: &Boot<'_>,
    world: World,
    host: impl FnMut(&mut World, Said),
) -> (Result<Outcome, Fault>, World) {
    let world = Rc::new(RefCell::new(world));
    let mut network = FakeNetwork {
        world: world.clone(),
        host,
    };
    let mut renderer = |unit: u32, sums: &mut Sums| {
        let mut world = world.borrow_mut();
        world.now = world.now.wrapping_add(RENDER_TICKS);
        sums[0] = [u64::from(unit), 0, wire::SUM_MAX].map(U48F16::from_bits);
        7
    };
    let mut clock = FakeClock(world.clone());
    let board = Name::new("fake");
    let worker = Worker::new(
        boot,
        node::plan(boot),
        board,
        &mut renderer,
        &mut network,
        &mut clock,
    );
    let outcome = worker.and_then(|worker| worker.run(|| STACK));
    (outcome, world.take())
}
