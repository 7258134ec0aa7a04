//! The lease table against a simulated fleet.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap, VecDeque};

use proptest::prelude::*;
use rand_xoshiro::Xoshiro256StarStar;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

use super::leases::*;
use super::sequence::Sequence;
use std::time::Duration;

fn ms(milliseconds: u64) -> Duration {
    Duration::from_millis(milliseconds)
}

/// A fleet on a bad network, in simulated time. Cores do what a node does: queue four leases, ignore a lease number
/// they saw, say HELLO while idle: after 50 ms, and then after twice the time each, up to 800 ms.
struct Simulation {
    chance: Xoshiro256StarStar,
    faults: Faults,
    events: BinaryHeap<Reverse<(Duration, u64, Event)>>,
    order: u64,
}

#[derive(Clone, Copy, Debug)]
struct Faults {
    loss_percent: u64,
    duplicate_percent: u64,
    jitter_ms: u64,
    /// How long a lease waits at a core's door, because its host is busy.
    door_ms: u64,
}

const NONE: Faults = Faults {
    loss_percent: 0,
    duplicate_percent: 0,
    jitter_ms: 0,
    door_ms: 0,
};

/// What came of a simulation.
#[derive(Debug)]
struct Outcome {
    took: Duration,
    /// Units that arrived, twice or more often, over units of the picture.
    twice: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Event {
    /// A lease reaches a core.
    Lease {
        core: u16,
        number: u16,
        first: u32,
        count: u32,
    },
    /// A core goes on: renders a unit, or says HELLO.
    Step { core: u16 },
    /// A unit reaches the host.
    Unit { core: u16, seq: u16, unit: u32 },
    /// A HELLO reaches the host.
    Hello { core: u16, seq: u16 },
    /// A core dies.
    Death { core: u16 },
    /// The host notices that a core ended.
    Noticed { core: u16 },
}

#[derive(Default)]
struct SimulatedCore {
    queue: VecDeque<(u32, u32)>,
    seen: Vec<u16>,
    /// HELLOs said since it had work.
    hellos: u32,
    /// Units sent, which number its packets.
    sent: u16,
    dead: bool,
}

impl Simulation {
    fn percent(&mut self, percent: u64) -> bool {
        self.chance.next_u64() % 100 < percent
    }

    fn at(&mut self, time: Duration, event: Event) {
        self.order += 1;
        self.events.push(Reverse((time, self.order, event)));
    }

    /// Sends over the network: lost, delayed, overtaken, doubled.
    fn send(&mut self, now: Duration, event: Event) {
        let copies = 1 + u64::from(self.percent(self.faults.duplicate_percent));
        for _ in 0..copies {
            if !self.percent(self.faults.loss_percent) {
                let delay = 1 + self.chance.next_u64() % (self.faults.jitter_ms + 1);
                let is_lease = matches!(event, Event::Lease { .. });
                let door = if is_lease { self.faults.door_ms } else { 0 };
                self.at(now + ms(delay + door), event);
            }
        }
    }

    fn step(&mut self, now: Duration, core: u16, state: &mut SimulatedCore) {
        let pause = match state.queue.front_mut() {
            Some((next, count)) => {
                self.send(
                    now,
                    Event::Unit {
                        core,
                        seq: state.sent,
                        unit: *next,
                    },
                );
                state.hellos = 0;
                state.sent = state.sent.wrapping_add(1);
                *next += 1;
                *count -= 1;
                if *count == 0 {
                    state.queue.pop_front();
                }
                ms(5 + self.chance.next_u64() % 10)
            }
            None => {
                self.send(
                    now,
                    Event::Hello {
                        core,
                        seq: state.sent,
                    },
                );
                state.hellos += 1;
                ms(50 << (state.hellos - 1).min(4))
            }
        };
        self.at(now + pause, Event::Step { core });
    }

    /// Runs until every unit is in.
    fn run(mut self, units: u32, cores: u16, deaths: &[(u16, Duration, bool)]) -> Result<Outcome, String> {
        let mut host = Host::new(units, cores);
        let mut fleet: HashMap<u16, SimulatedCore> =
            (0..cores).map(|core| (core, SimulatedCore::default())).collect();
        for core in 0..cores {
            self.at(ms(u64::from(core)), Event::Step { core });
        }
        for &(core, time, noticed) in deaths {
            self.at(time, Event::Death { core });
            if noticed {
                self.at(time + ms(20), Event::Noticed { core });
            }
        }
        while let Some(Reverse((now, _, event))) = self.events.pop() {
            if now > Duration::from_secs(120) {
                return Err(format!("hangs with {} of {units} units in", host.leases.done()));
            }
            self.handle(now, event, &mut host, &mut fleet);
            if host.leases.done() == units as usize {
                return host.outcome(now);
            }
            host.leases.settle(now);
            host.leases.late(now);
            for core in host.leases.holders() {
                let heard = matches!(event, Event::Unit { core: of, .. } | Event::Hello { core: of, .. } if of == core);
                let again = if heard {
                    host.leases.again(core, now, now)
                } else {
                    Vec::new()
                };
                for grant in again {
                    self.tell(now, core, grant);
                }
                while let Some(grant) = host.leases.grant(core, now) {
                    self.tell(now, core, grant);
                }
            }
        }
        Err("nothing happens any more".to_owned())
    }

    fn tell(&mut self, now: Duration, core: u16, grant: Grant) {
        let Grant { number, first, count } = grant;
        self.send(
            now,
            Event::Lease {
                core,
                number,
                first,
                count,
            },
        );
    }

    fn handle(
        &mut self,
        now: Duration,
        event: Event,
        host: &mut Host,
        fleet: &mut HashMap<u16, SimulatedCore>,
    ) {
        match event {
            Event::Lease {
                core,
                number,
                first,
                count,
            } => {
                let state = core_of(fleet, core);
                if state.queue.len() < 4 && !state.seen.contains(&number) {
                    state.seen.push(number);
                    state.queue.push_back((first, count));
                }
            }
            Event::Step { core } if !core_of(fleet, core).dead => self.step(now, core, core_of(fleet, core)),
            Event::Step { .. } => {}
            Event::Unit { core, seq, unit } => {
                let skipped = host.sequences[usize::from(core)].received(seq);
                host.arrived[unit as usize] += 1;
                if host.leases.arrived(core, unit, skipped, now) == Arrival::First {
                    host.counted[unit as usize] += 1;
                }
            }
            Event::Hello { core, seq } => {
                if let Some(skipped) = host.sequences[usize::from(core)].sent_before(seq) {
                    host.leases.idle(core, skipped, now);
                }
            }
            Event::Death { core } => core_of(fleet, core).dead = true,
            Event::Noticed { core } => host.leases.ended(core),
        }
    }
}

/// What the collector knows.
struct Host {
    leases: Leases,
    sequences: Vec<Sequence>,
    arrived: Vec<u32>,
    counted: Vec<u32>,
}

impl Host {
    fn new(units: u32, cores: u16) -> Self {
        Self {
            leases: Leases::new(units),
            sequences: vec![Sequence::default(); usize::from(cores)],
            arrived: vec![0; units as usize],
            counted: vec![0; units as usize],
        }
    }

    fn outcome(self, took: Duration) -> Result<Outcome, String> {
        if let Some(unit) = self.counted.iter().position(|&times| times != 1) {
            return Err(format!("unit {unit} counted {} times", self.counted[unit]));
        }
        let twice: u32 = self.arrived.iter().map(|&times| times - 1).sum();
        let twice = f64::from(twice) / self.arrived.len() as f64;
        Ok(Outcome { took, twice })
    }
}

fn core_of(fleet: &mut HashMap<u16, SimulatedCore>, core: u16) -> &mut SimulatedCore {
    fleet.get_mut(&core).expect("a core of the fleet")
}

fn simulate(seed: u64, faults: Faults, units: u32, cores: u16, deaths: &[(u16, Duration, bool)]) -> Outcome {
    let chance = Xoshiro256StarStar::seed_from_u64(seed);
    let simulation = Simulation {
        chance,
        faults,
        events: BinaryHeap::new(),
        order: 0,
    };
    match simulation.run(units, cores, deaths) {
        Ok(outcome) => outcome,
        Err(what) => panic!("{what}: seed {seed}, {faults:?}, {cores} cores, deaths {deaths:?}"),
    }
}

#[test]
fn a_good_network_and_two_cores_take_half_the_time_of_one() {
    let took = |cores| simulate(1, NONE, 1_000, cores, &[]).took;
    let (one, two) = (took(1), took(2));
    assert!(one > ms(9_000) && one < ms(10_500), "{one:?}");
    assert!(two < one.mul_f64(0.55), "{two:?} against {one:?}");
}

#[test]
fn nothing_is_rendered_twice_because_packets_overtake_each_other_or_wait_at_a_door() {
    for (jitter_ms, door_ms) in [(5, 0), (30, 0), (0, 90), (5, 400), (5, 900)] {
        for cores in [2, 8, 32, 136] {
            let faults = Faults {
                jitter_ms,
                door_ms,
                ..NONE
            };
            let outcome = simulate(u64::from(cores), faults, 40 * u32::from(cores), cores, &[]);
            println!("{cores} cores, {faults:?}: {outcome:?}");
            assert!(outcome.twice <= 0.02, "{cores} cores, {faults:?}: {outcome:?}");
        }
    }
}

/// The rule before leased again at once whatever seemed lost. It took 4.95, 4.99 and 6.02 s in the mean of the same fleets (as of commit
/// be4a624). Means of 60 runs that spread by 2 s each are known to 0.26 s, and their differences to 0.37 s: 1 s is nearly three of these.
#[test]
fn a_third_of_all_packets_lost_cost_no_more_time_than_before() {
    for (cores, before) in [(2, 4.95), (8, 4.99), (32, 6.02)] {
        let faults = Faults {
            loss_percent: 30,
            jitter_ms: 2,
            ..NONE
        };
        let run = |seed| simulate(seed, faults, 100 * u32::from(cores), cores, &[]);
        let outcomes: Vec<Outcome> = (0..60).map(run).collect();
        let mean = |of: fn(&Outcome) -> f64| outcomes.iter().map(of).sum::<f64>() / 60.0;
        let (took, twice) = (
            mean(|outcome| outcome.took.as_secs_f64()),
            mean(|outcome| outcome.twice),
        );
        println!("{cores} cores: {took:.2} s, {:.2} % twice", 100.0 * twice);
        assert!(took < before + 1.0, "{cores} cores: {took} s, {before} s before");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// No unit is lost and none is counted twice as long as one core lives.
    #[test]
    fn every_unit_is_counted_once(
        seed: u64,
        loss_percent in 0_u64..40,
        duplicate_percent in 0_u64..30,
        jitter_ms in 0_u64..60,
        door_ms in 0_u64..500,
        units in 1_u32..400,
        cores in 1_u16..6,
        deaths in proptest::collection::vec((1_u16..6, 0_u64..3_000, any::<bool>()), 0..4),
    ) {
        let faults = Faults { loss_percent, duplicate_percent, jitter_ms, door_ms };
        let deaths: Vec<(u16, Duration, bool)> = deaths
            .into_iter()
            .filter(|&(core, ..)| core < cores)
            .map(|(core, time, noticed)| (core, ms(time), noticed))
            .collect();
        simulate(seed, faults, units, cores, &deaths);
    }
}
