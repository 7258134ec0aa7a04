//! A machine of many cores in virtual time: what units cost is known, all else is simulated event by event.
//!
//! ```text
//!   core: rendering, packet ──> wire: one server, first come first served ──> collector: its own lease table
//!     ^                                                                              │
//!     └───────────────────────── the collector's answer time ────────────────────────┘
//! ```
//!
//! Cores do what a node does: they say HELLO, work through the leases that they hold, send a packet a unit, and say HELLO again when they
//! have nothing to do. Leases are granted by [`Leases`], the very table of the collector, which goes by the time that it is told. So
//! nothing here depends on the host's clock or load. What waits for the wire is kept, however much it is; leases bound it.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};
use std::ops::Range;
use std::time::Duration;

use crate::collector::leases::{Grant, Leases};

/// A core that has just become idle says HELLO after this time again, and then after twice the time before, as `node::worker` has it.
const FIRST_HELLO: Duration = Duration::from_millis(50);
/// The longest time between two, likewise.
const LAST_HELLO: Duration = Duration::from_millis(800);
/// Lease numbers that a core remembers, likewise.
const REMEMBERED: usize = 16;
const NANOSECONDS: u64 = 1_000_000_000;

/// What is simulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Machine {
    /// Its cores.
    pub cores: u16,
    /// Packets that leave it in a second at most; none for a wire without a limit, and then none waits.
    pub packets_per_second: Option<u32>,
    /// The time from when a packet has left the machine until what the collector answers has reached its core.
    pub answer: Duration,
    /// Its cores say HELLO once and never again, as they do not: what the wire carries where it is the units' alone.
    pub quiet: bool,
}

/// What came of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Course {
    /// When the first unit was in, and the last.
    pub first: Duration,
    /// As said.
    pub last: Duration,
    /// Packets that left the machine until then, HELLOs among them.
    pub packets: u64,
    /// The longest that one of them waited until it had left.
    pub longest_wait: Duration,
}

/// What happens.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Event {
    /// A core has rendered a unit and put its packet together.
    Done { core: u16, unit: u32 },
    /// An idle core looks whether it is time for a HELLO.
    Wakes { core: u16 },
    /// A packet has left the machine, a unit or a HELLO, that was sent then.
    Arrives {
        core: u16,
        unit: Option<u32>,
        sent: Duration,
    },
    /// A lease reaches its core.
    Lease {
        core: u16,
        number: u16,
        first: u32,
        count: u32,
    },
}

/// One core.
#[derive(Clone, Debug, Default)]
struct Core {
    leases: VecDeque<Range<u32>>,
    seen: VecDeque<u16>,
    busy: bool,
    /// When it says HELLO if it is idle then, and how long it waits for the one after.
    wakes: Duration,
    interval: Duration,
    said: Duration,
}

/// The way out of the machine.
#[derive(Debug)]
struct Wire {
    packets_per_second: Option<u32>,
    /// When it was last found idle, the packets since, and when the last of them has left.
    since: Duration,
    count: u64,
    free: Duration,
}

impl Wire {
    /// When a packet that comes now has left.
    fn send(&mut self, now: Duration) -> Duration {
        let Some(rate) = self.packets_per_second else {
            return now;
        };
        if now >= self.free {
            (self.since, self.count) = (now, 0);
        }
        self.count += 1;
        self.free = self.since + Duration::from_nanos(self.count * NANOSECONDS / u64::from(rate.max(1)));
        self.free
    }
}

struct Simulation<'a> {
    machine: Machine,
    costs: &'a [Duration],
    events: BinaryHeap<Reverse<(Duration, u64, Event)>>,
    /// Of the events of one moment, the first to be planned comes first.
    order: u64,
    cores: Vec<Core>,
    wire: Wire,
    leases: Leases,
    course: Course,
}

/// The course of a picture whose units cost a core these times, packet and all.
pub fn simulate(machine: Machine, costs: &[Duration]) -> Course {
    let idle = Core {
        interval: FIRST_HELLO,
        ..Core::default()
    };
    let mut simulation = Simulation {
        machine,
        costs,
        events: BinaryHeap::new(),
        order: 0,
        cores: vec![idle; machine.cores.into()],
        wire: Wire {
            packets_per_second: machine.packets_per_second,
            since: Duration::ZERO,
            count: 0,
            free: Duration::ZERO,
        },
        leases: Leases::new(u32::try_from(costs.len()).unwrap_or(u32::MAX)),
        course: Course::default(),
    };
    for core in 0..machine.cores {
        simulation.at(Duration::ZERO, Event::Wakes { core });
    }
    simulation.run();
    simulation.course
}

impl Simulation<'_> {
    fn at(&mut self, time: Duration, event: Event) {
        self.order += 1;
        self.events.push(Reverse((time, self.order, event)));
    }

    fn run(&mut self) {
        while self.leases.done() < self.costs.len()
            && let Some(Reverse((now, _, event))) = self.events.pop()
        {
            match event {
                Event::Done { core, unit } => self.done(core, unit, now),
                Event::Wakes { core } => self.wakes(core, now),
                Event::Arrives { core, unit, sent } => {
                    self.course.longest_wait = self.course.longest_wait.max(now - sent);
                    self.arrives(core, unit, now);
                }
                Event::Lease {
                    core,
                    number,
                    first,
                    count,
                } => self.lease(core, number, first..first + count, now),
            }
        }
    }

    fn send(&mut self, core: u16, unit: Option<u32>, now: Duration) {
        let left = self.wire.send(now);
        let sent = now;
        self.at(left, Event::Arrives { core, unit, sent });
    }

    fn done(&mut self, core: u16, unit: u32, now: Duration) {
        self.send(core, Some(unit), now);
        let state = &mut self.cores[usize::from(core)];
        (state.busy, state.interval) = (false, FIRST_HELLO);
        self.go_on(core, now);
    }

    /// Begins the core's next unit; else it is idle.
    fn go_on(&mut self, core: u16, now: Duration) {
        let state = &mut self.cores[usize::from(core)];
        while state.leases.front().is_some_and(Range::is_empty) {
            state.leases.pop_front();
        }
        if let Some(unit) = state.leases.front_mut().and_then(Range::next) {
            state.busy = true;
            self.at(now + self.costs[unit as usize], Event::Done { core, unit });
        } else if !self.machine.quiet {
            state.wakes = now.max(state.said + state.interval);
            let wakes = state.wakes;
            self.at(wakes, Event::Wakes { core });
        }
    }

    fn wakes(&mut self, core: u16, now: Duration) {
        let state = &mut self.cores[usize::from(core)];
        if state.busy || state.wakes != now {
            return;
        }
        state.wakes = now + state.interval;
        (state.said, state.interval) = (now, (2 * state.interval).min(LAST_HELLO));
        let wakes = state.wakes;
        self.send(core, None, now);
        if !self.machine.quiet {
            self.at(wakes, Event::Wakes { core });
        }
    }

    /// What the collector does with a packet. None is ever lost, so no number is skipped.
    fn arrives(&mut self, core: u16, unit: Option<u32>, now: Duration) {
        self.course.packets += 1;
        match unit {
            Some(unit) => {
                self.leases.arrived(core, unit, Some(0), now);
                if self.course.first.is_zero() {
                    self.course.first = now;
                }
                self.course.last = now;
            }
            None => self.leases.idle(core, 0, now),
        }
        for grant in self.leases.again(core, now, now) {
            self.tell(core, grant, now);
        }
        while let Some(grant) = self.leases.grant(core, now) {
            self.tell(core, grant, now);
        }
    }

    fn tell(&mut self, core: u16, grant: Grant, now: Duration) {
        let Grant { number, first, count } = grant;
        let lease = Event::Lease {
            core,
            number,
            first,
            count,
        };
        self.at(now + self.machine.answer, lease);
    }

    /// A core takes none twice.
    fn lease(&mut self, core: u16, number: u16, units: Range<u32>, now: Duration) {
        let state = &mut self.cores[usize::from(core)];
        if state.seen.contains(&number) {
            return;
        }
        state.seen.push_back(number);
        if state.seen.len() > REMEMBERED {
            state.seen.pop_front();
        }
        state.leases.push_back(units);
        if !state.busy {
            self.go_on(core, now);
        }
    }
}
