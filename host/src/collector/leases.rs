//! Which core works at what: the lease table.
//!
//! A lease is a run of consecutive units that a core was told to render. The table is a state machine without a clock or
//! a socket of its own: time is passed in, as the time since the collector started, and what must be sent comes out.
//! A unit is in one of four states:
//!
//! ```text
//!  fresh ──grant──> leased ──in──> done
//!                   │    ^           ^
//!              lost │    │ grant     │ in after all
//!                   v    │           │
//!                  returned ─────────┘
//! ```
//!
//! A core works through its leases in the order in which it got them, and through a lease from its first unit to its
//! last. So whatever comes from it says that all that should have come before is either in or lost, and what is lost goes
//! back at once. A core that says it has nothing to do has lost all that it was told a while ago. What remains is a
//! core that says nothing: after some [patience](Leases::late), its leases are on offer, and whoever has nothing to do takes them.
//! It may have been at work all the time; once it is heard again, what nobody has taken is its own again. Where one of
//! these conclusions is wrong (packets overtake each other) a unit is rendered twice, to the same bytes, and counted once.

use std::collections::{BTreeMap, BTreeSet, HashSet, VecDeque};
use std::ops::Range;
use std::time::Duration;

use super::pace::Pace;

/// Leases a core may hold: one to work at, and two so that it never waits for the host.
const LEASES_PER_CORE: usize = 3;
/// How long a lease should last.
const LEASE_TIME: Duration = Duration::from_millis(60);
/// The most units in one lease.
const MAX_UNITS: u32 = 256;
/// What an idle core was told longer ago than this never reached it.
const SETTLED: Duration = Duration::from_millis(100);
/// The least time without a word after which a core's leases are on offer.
const LEAST_PATIENCE: Duration = Duration::from_secs(2);
/// The same in units of the core's usual time for one unit.
const PATIENCE_IN_UNITS: u32 = 20;
/// The same in the longest time that any core took for one: units of one picture differ, and so do hosts.
const PATIENCE_IN_LONGEST: u32 = 3;

/// A lease to be sent to a core.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grant {
    /// The lease's own number.
    pub number: u16,
    /// The first unit.
    pub first: u32,
    /// How many units.
    pub count: u32,
}

/// What a unit's arrival means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrival {
    /// It is new: count it.
    First,
    /// It is in already.
    Duplicate,
}

/// A granted lease, as far as it has been worked off.
#[derive(Clone, Copy, Debug)]
struct Lease {
    /// The next unit expected of it.
    next: u32,
    /// The first unit past it.
    end: u32,
    granted: Duration,
}

/// What the table knows of one core.
#[derive(Debug)]
struct Holder {
    /// In the order in which they were granted.
    leases: VecDeque<Lease>,
    pace: Pace,
    /// When it last said something, or was given work after it had none.
    heard: Duration,
    /// For how long it had said nothing when its leases were put on offer; it gets others once it says something.
    silent: Option<Duration>,
}

impl Holder {
    /// It was at work all the time: what nobody has taken meanwhile is its own again.
    fn reclaim(&mut self, returned: &mut BTreeSet<u32>) {
        for lease in std::mem::take(&mut self.leases) {
            let before = self.leases.len();
            for unit in (lease.next..lease.end).filter(|unit| returned.remove(unit)) {
                match self.leases.range_mut(before..).last() {
                    Some(part) if part.end == unit => part.end += 1,
                    _ => self.leases.push_back(Lease {
                        next: unit,
                        end: unit + 1,
                        granted: lease.granted,
                    }),
                }
            }
        }
    }
}

/// The lease table.
#[derive(Debug)]
pub struct Leases {
    units: u32,
    /// The first unit that was never leased.
    fresh: u32,
    /// Units that were leased, are not in, and are on offer now.
    returned: BTreeSet<u32>,
    done: HashSet<u32>,
    holders: BTreeMap<u16, Holder>,
    /// Cores that are known to have ended.
    dead: BTreeSet<u16>,
    /// The longest that a unit has taken, as far as is known.
    longest: Duration,
    next_number: u16,
}

impl Leases {
    /// A table of `units` units, none of them leased.
    pub fn new(units: u32) -> Self {
        Self {
            units,
            fresh: 0,
            returned: BTreeSet::new(),
            done: HashSet::new(),
            holders: BTreeMap::new(),
            dead: BTreeSet::new(),
            longest: Duration::ZERO,
            next_number: 0,
        }
    }

    /// Whether every unit is in.
    pub fn is_complete(&self) -> bool {
        self.done.len() == self.units as usize
    }

    /// The core says that it has nothing to do, and did not say so before `said`: its word may have waited in the socket.
    pub fn idle(&mut self, core: u16, said: Duration, now: Duration) {
        let Some(holder) = self.holder(core, now) else {
            return;
        };
        holder.pace.pause();
        // Granted in order, so the settled ones are at the front.
        let is_settled = |lease: &Lease| said.saturating_sub(lease.granted) >= SETTLED;
        let settled = holder.leases.iter().take_while(|lease| is_settled(lease)).count();
        let lost: Vec<Lease> = holder.leases.drain(..settled).collect();
        for lease in lost {
            self.take_back(lease.next..lease.end);
        }
    }

    /// Unit `unit` came in from `core`.
    pub fn arrived(&mut self, core: u16, unit: u32, now: Duration) -> Arrival {
        let mut passed = Vec::new();
        if let Some(holder) = self.holders.get(&core) {
            let took = now.saturating_sub(holder.heard);
            // A core that was stopped, not slow, shall not make everybody patient for as long as that.
            self.longest = self
                .longest
                .max(holder.silent.map_or(took, |waited| took.min(waited)));
        }
        if let Some(holder) = self.holder(core, now) {
            holder.pace.unit_done(now);
            let of = holder
                .leases
                .iter()
                .position(|lease| (lease.next..lease.end).contains(&unit));
            if let Some(index) = of {
                passed.extend(holder.leases.drain(..index).map(|lease| lease.next..lease.end));
                let lease = &mut holder.leases[0];
                passed.push(lease.next..unit);
                lease.next = unit + 1;
                if lease.next == lease.end {
                    holder.leases.pop_front();
                }
            }
        }
        let arrival = if self.done.insert(unit) {
            Arrival::First
        } else {
            Arrival::Duplicate
        };
        self.returned.remove(&unit);
        for range in passed {
            self.take_back(range);
        }
        arrival
    }

    /// The core has ended: its leases go elsewhere, and it gets no more, whatever of it still arrives.
    pub fn ended(&mut self, core: u16) {
        self.dead.insert(core);
        // Those of a silent core are on offer already.
        let holder = self
            .holders
            .remove(&core)
            .filter(|holder| holder.silent.is_none());
        for lease in holder.map(|holder| holder.leases).unwrap_or_default() {
            self.take_back(lease.next..lease.end);
        }
    }

    /// A core that had ended was started again: it gets work once it says something.
    pub fn started_again(&mut self, core: u16) {
        self.dead.remove(&core);
    }

    /// Puts on offer the leases of cores that have been silent for more than 2 seconds, 20 of their usual units, and 3 of the longest
    /// that any core has taken. Returns these cores; they get work again once they say something.
    pub fn late(&mut self, now: Duration) -> Vec<u16> {
        let longest = self.longest;
        let patience = |holder: &Holder| {
            let usual = holder.pace.usual().unwrap_or_default();
            LEAST_PATIENCE
                .max(usual * PATIENCE_IN_UNITS)
                .max(longest * PATIENCE_IN_LONGEST)
        };
        let (mut late, mut lost) = (Vec::new(), Vec::new());
        for (&core, holder) in &mut self.holders {
            let waited = now.saturating_sub(holder.heard);
            if holder.silent.is_none() && !holder.leases.is_empty() && waited > patience(holder) {
                late.push(core);
                lost.extend(holder.leases.iter().copied());
                holder.silent = Some(waited);
            }
        }
        for lease in lost {
            self.take_back(lease.next..lease.end);
        }
        late
    }

    /// Whether there is a core that the work of a silent one can go to.
    pub fn any_speaks(&self) -> bool {
        self.holders.values().any(|holder| holder.silent.is_none())
    }

    /// The next lease for `core`, if it has room for one and there is something left to lease.
    pub fn grant(&mut self, core: u16, now: Duration) -> Option<Grant> {
        let cores = self.holders.len() as u32;
        let left = self.returned.len() as u32 + (self.units - self.fresh);
        let holder = self.holders.get_mut(&core)?;
        if holder.silent.is_some() || holder.leases.len() >= LEASES_PER_CORE {
            return None;
        }
        // Towards the end leases get shorter, so that all cores end at about the same time.
        let fair = left.div_ceil(cores * LEASES_PER_CORE as u32);
        let lasting = holder.pace.usual().map_or(1, |unit| {
            u32::try_from(LEASE_TIME.as_nanos() / unit.as_nanos().max(1)).unwrap_or(MAX_UNITS)
        });
        let (first, count) = take(
            &mut self.returned,
            &mut self.fresh,
            self.units,
            lasting.min(fair).clamp(1, MAX_UNITS),
        )?;
        if holder.leases.is_empty() {
            holder.heard = now;
        }
        holder.leases.push_back(Lease {
            next: first,
            end: first + count,
            granted: now,
        });
        let number = self.next_number;
        self.next_number = number.wrapping_add(1);
        Some(Grant { number, first, count })
    }

    /// The cores that have been heard of and have not ended, in order.
    pub fn holders(&self) -> Vec<u16> {
        self.holders.keys().copied().collect()
    }

    /// The entry of a core that has just said something, unless it had ended before.
    fn holder(&mut self, core: u16, now: Duration) -> Option<&mut Holder> {
        if self.dead.contains(&core) {
            return None;
        }
        let new = || Holder {
            leases: VecDeque::new(),
            pace: Pace::default(),
            heard: now,
            silent: None,
        };
        let holder = self.holders.entry(core).or_insert_with(new);
        holder.heard = now;
        if holder.silent.take().is_some() {
            holder.reclaim(&mut self.returned);
        }
        Some(holder)
    }

    /// These units are on offer, but for those that are in.
    fn take_back(&mut self, units: Range<u32>) {
        self.returned
            .extend(units.filter(|unit| !self.done.contains(unit)));
    }
}

/// Takes up to `most` consecutive units: returned ones first, as others may already wait for them.
fn take(returned: &mut BTreeSet<u32>, fresh: &mut u32, units: u32, most: u32) -> Option<(u32, u32)> {
    if let Some(first) = returned.pop_first() {
        let mut count = 1;
        while count < most && returned.remove(&(first + count)) {
            count += 1;
        }
        return Some((first, count));
    }
    let first = *fresh;
    let count = most.min(units - first);
    *fresh += count;
    (count > 0).then_some((first, count))
}

#[cfg(test)]
#[path = "leases_tests.rs"]
mod tests;
