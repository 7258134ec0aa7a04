//! The lease table alone, by hand and against a simulated fleet.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap, VecDeque};

use proptest::prelude::*;
use rand_xoshiro::Xoshiro256StarStar;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

use super::*;

fn ms(milliseconds: u64) -> Duration {
    Duration::from_millis(milliseconds)
}

/// All units granted to `core` at `now`.
fn granted(leases: &mut Leases, core: u16, now: Duration) -> Vec<u32> {
    let mut units = Vec::new();
    while let Some(grant) = leases.grant(core, now) {
        units.extend(grant.first..grant.first + grant.count);
    }
    units
}

#[test]
fn a_core_gets_nothing_before_it_is_heard_and_no_more_than_three_leases_then() {
    let mut leases = Leases::new(100);
    assert_eq!(leases.grant(0, ms(0)), None);
    leases.idle(0, ms(0), ms(0));
    assert_eq!(granted(&mut leases, 0, ms(0)), [0, 1, 2]);
    assert_eq!(leases.grant(0, ms(0)), None);
    assert_eq!(leases.arrived(0, 0, ms(10)), Arrival::First);
    assert_eq!(granted(&mut leases, 0, ms(10)), [3]);
}

#[test]
fn leases_grow_with_the_pace_of_the_core() {
    let mut leases = Leases::new(100_000);
    leases.idle(0, ms(0), ms(0));
    granted(&mut leases, 0, ms(0));
    for unit in 0..3 {
        leases.arrived(0, unit, ms(u64::from(unit)));
    }
    let grant = leases.grant(0, ms(3)).expect("there is room");
    assert_eq!(grant.count, 60, "a unit a millisecond, and a lease is to last 60");
}

#[test]
fn a_unit_counts_once() {
    let mut leases = Leases::new(2);
    leases.idle(0, ms(0), ms(0));
    granted(&mut leases, 0, ms(0));
    assert_eq!(leases.arrived(0, 0, ms(1)), Arrival::First);
    assert_eq!(leases.arrived(0, 0, ms(1)), Arrival::Duplicate);
    assert_eq!(leases.arrived(7, 0, ms(1)), Arrival::Duplicate);
    assert!(!leases.is_complete());
    assert_eq!(leases.arrived(0, 1, ms(2)), Arrival::First);
    assert!(leases.is_complete());
}

#[test]
fn what_was_skipped_goes_back_at_once() {
    let mut leases = Leases::new(3);
    leases.idle(0, ms(0), ms(0));
    assert_eq!(granted(&mut leases, 0, ms(0)), [0, 1, 2]);
    leases.arrived(0, 2, ms(30));
    assert_eq!(granted(&mut leases, 0, ms(30)), [0, 1]);
}

#[test]
fn when_only_the_last_packet_is_lost_an_idle_core_gets_its_unit_again() {
    let mut leases = Leases::new(1);
    leases.idle(0, ms(0), ms(0));
    assert_eq!(granted(&mut leases, 0, ms(0)), [0]);
    leases.idle(0, ms(50), ms(50));
    assert_eq!(
        granted(&mut leases, 0, ms(50)),
        [0_u32; 0],
        "the lease may still be on its way"
    );
    leases.idle(0, ms(100), ms(100));
    assert_eq!(granted(&mut leases, 0, ms(100)), [0]);
}

#[test]
fn a_silent_core_loses_its_leases_after_two_seconds_and_a_dead_one_at_once() {
    let mut leases = Leases::new(6);
    for core in [0, 1] {
        leases.idle(core, ms(0), ms(0));
    }
    assert_eq!(granted(&mut leases, 0, ms(0)), [0, 1, 2]);
    assert_eq!(granted(&mut leases, 1, ms(0)), [3, 4, 5]);
    leases.arrived(1, 3, ms(600));
    assert_eq!(leases.late(ms(2_000)), [0_u16; 0]);
    assert_eq!(leases.late(ms(2_001)), [0]);
    assert!(leases.any_speaks());
    assert_eq!(leases.grant(0, ms(2_001)), None, "it has not said anything since");
    assert_eq!(leases.grant(1, ms(2_001)).map(|grant| grant.first), Some(0));
    leases.ended(1);
    leases.idle(0, ms(2_050), ms(2_050));
    let mut again = granted(&mut leases, 0, ms(2_050));
    again.sort_unstable();
    assert_eq!(again.len(), 3);
    leases.idle(1, ms(2_060), ms(2_060));
    assert_eq!(
        leases.grant(1, ms(2_060)),
        None,
        "a core that ended is not asked again"
    );
    leases.started_again(1);
    assert_eq!(leases.grant(1, ms(2_070)), None, "nobody knows where it is");
    leases.idle(1, ms(2_070), ms(2_070));
    assert!(leases.grant(1, ms(2_070)).is_some());
}

#[test]
fn a_core_that_takes_long_over_a_unit_is_given_time() {
    let mut leases = Leases::new(100);
    leases.idle(0, ms(0), ms(0));
    granted(&mut leases, 0, ms(0));
    leases.arrived(0, 0, ms(500));
    leases.arrived(0, 1, ms(1_000));
    assert_eq!(
        leases.late(ms(10_900)),
        [0_u16; 0],
        "twenty units of half a second"
    );
    assert_eq!(leases.late(ms(11_001)), [0]);
}

#[test]
fn a_core_that_was_taken_for_silent_keeps_its_pace() {
    let mut leases = Leases::new(100);
    leases.idle(0, ms(0), ms(0));
    granted(&mut leases, 0, ms(0));
    assert_eq!(
        leases.late(ms(2_001)),
        [0],
        "nobody knows yet that its units take three seconds"
    );
    leases.arrived(0, 0, ms(3_000));
    granted(&mut leases, 0, ms(3_000));
    leases.arrived(0, 1, ms(6_000));
    assert_eq!(
        leases.late(ms(65_000)),
        [0_u16; 0],
        "twenty units of three seconds"
    );
}

#[test]
fn what_others_took_for_a_unit_is_given_to_every_core() {
    let mut leases = Leases::new(100);
    for core in [0, 1] {
        leases.idle(core, ms(0), ms(0));
        granted(&mut leases, core, ms(0));
    }
    leases.arrived(0, 0, ms(1_500));
    assert_eq!(leases.late(ms(4_500)), [0_u16; 0], "three units of the other's");
    assert_eq!(leases.late(ms(4_501)), [1]);
}

/// It was at work at a long unit: what nobody has taken meanwhile is not leased again, and next time it has longer.
#[test]
fn a_core_that_is_heard_again_has_its_leases_back() {
    let mut leases = Leases::new(7);
    leases.idle(0, ms(0), ms(0));
    assert_eq!(granted(&mut leases, 0, ms(0)), [0, 1, 2]);
    assert_eq!(leases.late(ms(2_100)), [0]);
    assert_eq!(leases.late(ms(2_200)), [0_u16; 0], "once is enough");
    assert!(!leases.any_speaks());
    leases.idle(1, ms(2_300), ms(2_300));
    assert_eq!(leases.grant(1, ms(2_300)).map(|grant| grant.first), Some(0));
    assert_eq!(leases.arrived(0, 0, ms(60_000)), Arrival::First);
    assert_eq!(
        granted(&mut leases, 1, ms(60_000)),
        [3, 4],
        "1 and 2 are its own again"
    );
    assert_eq!(granted(&mut leases, 0, ms(60_000)), [5]);
    assert_eq!(
        leases.late(ms(66_300)),
        [1],
        "thrice what the other was waited for, not thrice the minute that it was stopped"
    );
}

/// A HELLO that has waited in the socket for longer than its answer is out says nothing about that answer.
#[test]
fn an_old_word_takes_no_lease_back() {
    let mut leases = Leases::new(3);
    leases.idle(0, ms(0), ms(0));
    granted(&mut leases, 0, ms(500));
    leases.idle(0, ms(500), ms(900));
    assert_eq!(leases.grant(0, ms(900)), None);
    leases.idle(0, ms(600), ms(900));
    assert_eq!(granted(&mut leases, 0, ms(900)), [0, 1, 2]);
}

#[test]
fn the_whole_range_of_unit_ids_can_be_leased() {
    let mut fresh = u32::MAX - 2;
    assert_eq!(
        take(&mut BTreeSet::new(), &mut fresh, u32::MAX, 256),
        Some((u32::MAX - 2, 2))
    );
    assert_eq!(take(&mut BTreeSet::new(), &mut fresh, u32::MAX, 256), None);
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
    Unit { core: u16, unit: u32 },
    /// A HELLO reaches the host.
    Hello { core: u16 },
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
                let delay = ms(1 + self.chance.next_u64() % (self.faults.jitter_ms + 1));
                self.at(now + delay, event);
            }
        }
    }

    fn step(&mut self, now: Duration, core: u16, state: &mut SimulatedCore) {
        let pause = match state.queue.front_mut() {
            Some((next, count)) => {
                self.send(now, Event::Unit { core, unit: *next });
                state.hellos = 0;
                *next += 1;
                *count -= 1;
                if *count == 0 {
                    state.queue.pop_front();
                }
                ms(5 + self.chance.next_u64() % 10)
            }
            None => {
                self.send(now, Event::Hello { core });
                state.hellos += 1;
                ms(50 << (state.hellos - 1).min(4))
            }
        };
        self.at(now + pause, Event::Step { core });
    }

    /// Runs until every unit is in and returns how long that took.
    fn run(mut self, units: u32, cores: u16, deaths: &[(u16, Duration, bool)]) -> Result<Duration, String> {
        let mut leases = Leases::new(units);
        let mut fleet: HashMap<u16, SimulatedCore> =
            (0..cores).map(|core| (core, SimulatedCore::default())).collect();
        let mut counted = vec![0_u32; units as usize];
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
                return Err(format!(
                    "hangs with {:?} of {units} units in",
                    counted.iter().sum::<u32>()
                ));
            }
            self.handle(now, event, &mut leases, &mut fleet, &mut counted);
            if leases.is_complete() {
                let wrong = counted.iter().position(|&times| times != 1);
                return wrong.map_or(Ok(now), |unit| {
                    Err(format!("unit {unit} counted {} times", counted[unit]))
                });
            }
            leases.late(now);
            for core in leases.holders() {
                while let Some(Grant { number, first, count }) = leases.grant(core, now) {
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
            }
        }
        Err("nothing happens any more".to_owned())
    }

    fn handle(
        &mut self,
        now: Duration,
        event: Event,
        leases: &mut Leases,
        fleet: &mut HashMap<u16, SimulatedCore>,
        counted: &mut [u32],
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
            Event::Unit { core, unit } => {
                if leases.arrived(core, unit, now) == Arrival::First {
                    counted[unit as usize] += 1;
                }
            }
            Event::Hello { core } => leases.idle(core, now, now),
            Event::Death { core } => core_of(fleet, core).dead = true,
            Event::Noticed { core } => leases.ended(core),
        }
    }
}

fn core_of(fleet: &mut HashMap<u16, SimulatedCore>, core: u16) -> &mut SimulatedCore {
    fleet.get_mut(&core).expect("a core of the fleet")
}

fn simulate(seed: u64, faults: Faults, units: u32, cores: u16, deaths: &[(u16, Duration, bool)]) -> Duration {
    let chance = Xoshiro256StarStar::seed_from_u64(seed);
    let simulation = Simulation {
        chance,
        faults,
        events: BinaryHeap::new(),
        order: 0,
    };
    match simulation.run(units, cores, deaths) {
        Ok(time) => time,
        Err(what) => panic!("{what}: seed {seed}, {faults:?}, {cores} cores, deaths {deaths:?}"),
    }
}

#[test]
fn a_good_network_and_two_cores_take_half_the_time_of_one() {
    let none = Faults {
        loss_percent: 0,
        duplicate_percent: 0,
        jitter_ms: 0,
    };
    let (one, two) = (simulate(1, none, 1_000, 1, &[]), simulate(1, none, 1_000, 2, &[]));
    assert!(one > ms(9_000) && one < ms(10_500), "{one:?}");
    assert!(two < one.mul_f64(0.55), "{two:?} against {one:?}");
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
        units in 1_u32..400,
        cores in 1_u16..6,
        deaths in proptest::collection::vec((1_u16..6, 0_u64..3_000, any::<bool>()), 0..4),
    ) {
        let faults = Faults { loss_percent, duplicate_percent, jitter_ms };
        let deaths: Vec<(u16, Duration, bool)> = deaths
            .into_iter()
            .filter(|&(core, ..)| core < cores)
            .map(|(core, time, noticed)| (core, ms(time), noticed))
            .collect();
        simulate(seed, faults, units, cores, &deaths);
    }
}
