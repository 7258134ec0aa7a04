//! Which core works at what: the lease table.
//!
//! A lease is a range of units that a core was told to render. The table is a state machine without a clock or
//! a socket of its own: time is passed in, as the time since the collector started, and what must be sent comes out.
//! A unit is in one of five states:
//!
//! ```text
//!  fresh ──grant──> leased ──────────in──────> done
//!                  │  ^  │                      ^
//!                  │  │  └─missing──> overtaken │ in after all
//!        late, ended  │ grant             │     │
//!                  v  │                   v     │
//!                 returned <──60 ms later─┴─────┘
//! ```
//!
//! A core works through its leases in the order in which they reach it, and through a lease from its first unit to its last, and
//! it numbers what it sends. So the numbers that a packet of it skips say how many units before are either lost or overtaken on the
//! way: what is not in a moment later is leased again.
//!
//! Where no number is missing, a lease that a core passes over, or has while it says that it has nothing to do, may not have reached
//! it, or not yet been read. It is sent again, under the same number: a core takes none twice, so that can do no harm. Told in vain a
//! few times, it gives the lease back.
//!
//! What remains is a core that says nothing: after some [patience](Leases::late), its leases are on offer, and whoever has nothing
//! to do takes them. It may have been at work all the time; once it is heard again, what nobody has taken is its own again.
//! Where one of these conclusions is wrong, a unit is rendered twice, to the same bytes, and counted once.

use std::collections::{BTreeMap, BTreeSet, HashSet, VecDeque};
use std::ops::Range;
use std::time::Duration;

use super::pace::Pace;

/// Leases a core may hold: one to work at, and two so that it never waits for the host.
pub const LEASES_PER_CORE: usize = 3;
/// How long a lease should last.
const LEASE_TIME: Duration = Duration::from_millis(60);
/// The most units in one lease.
const MAX_UNITS: u32 = 256;
/// A lease that was sent longer ago than this may never have reached its core. It is sent again, and then after twice the time before.
const SETTLED: Duration = Duration::from_millis(100);
/// Times that a lease is sent again.
const TRIES: u32 = 5;
/// How much later than its successors a packet may come.
const OVERTAKEN: Duration = Duration::from_millis(60);
/// The same where packets get lost, and a unit that does not come is most likely one of them.
const OVERTAKEN_OR_LOST: Duration = Duration::from_millis(20);
/// A network that has lost a packet is taken for one that loses packets for this long.
const LOSSY: Duration = Duration::from_secs(5);
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
    /// As the core was told.
    grant: Grant,
    /// The next unit expected of it.
    next: u32,
    /// The first unit past it.
    end: u32,
    /// When it was sent last.
    sent: Duration,
    /// Times that it was sent again.
    again: u32,
    /// The core is at a later one.
    passed: bool,
}

/// Units that a core has sent, by what came after them, and that have not come.
#[derive(Clone, Debug)]
struct Missing {
    units: Range<u32>,
    /// Whether the core has sent them for certain.
    certain: bool,
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
    /// It has nothing to do, by its own word.
    idle: bool,
}

impl Holder {
    /// The core was at `unit`, and if it was there last, it has sent `skipped` packets before it that have not come. Returns what is
    /// missing.
    fn advance(&mut self, unit: u32, skipped: Option<u64>) -> Vec<Missing> {
        let is_its = |lease: &Lease| (lease.next..lease.end).contains(&unit);
        let Some(index) = self.leases.iter().position(is_its) else {
            return Vec::new();
        };
        let lease = &mut self.leases[index];
        let units = lease.next..unit;
        lease.next = unit + 1;
        let mut missing = Vec::new();
        if let Some(skipped) = skipped {
            missing = self.finish(index, skipped.saturating_sub(units.len() as u64));
        }
        let certain = skipped.is_some();
        missing.push(Missing { units, certain });
        self.leases.retain(|lease| lease.next < lease.end);
        missing
    }

    /// The core is past the first few leases, and has sent `skipped` packets for them that have not come. Returns what is missing: a
    /// lease of which something came was worked off to its end; one of which nothing came may have been where as many packets are
    /// missing as it has units, and is else still to be worked at.
    fn finish(&mut self, leases: usize, skipped: u64) -> Vec<Missing> {
        let is_begun = |lease: &Lease| lease.next > lease.grant.first;
        let (mut left, mut missing) = (skipped, Vec::new());
        for certain in [true, false] {
            let first = self.leases.range_mut(..leases);
            for lease in first.filter(|lease| is_begun(lease) == certain) {
                let count = u64::from(lease.end - lease.next);
                if certain {
                    left = left.saturating_sub(count);
                } else if count > left {
                    lease.passed = true;
                    continue;
                }
                let units = lease.next..lease.end;
                missing.push(Missing { units, certain });
                lease.next = lease.end;
            }
        }
        self.leases.retain(|lease| lease.next < lease.end);
        missing
    }

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
                        ..lease
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
    /// What may have been overtaken by other packets, and until when it may still come.
    overtaken: Vec<(Duration, Missing)>,
    /// Until when the network is taken for one that loses packets.
    lossy: Duration,
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
            overtaken: Vec::new(),
            lossy: Duration::ZERO,
            done: HashSet::new(),
            holders: BTreeMap::new(),
            dead: BTreeSet::new(),
            longest: Duration::ZERO,
            next_number: 0,
        }
    }

    /// Units that are in.
    pub fn done(&self) -> usize {
        self.done.len()
    }

    /// Whether this one is.
    pub fn is_done(&self, unit: u32) -> bool {
        self.done.contains(&unit)
    }

    /// The core says that it has nothing to do, and that it has sent `skipped` packets which have not come.
    pub fn idle(&mut self, core: u16, skipped: u64, now: Duration) {
        let Some(holder) = self.holder(core, now) else {
            return;
        };
        holder.pace.pause();
        holder.idle = true;
        let missing = holder.finish(holder.leases.len(), skipped);
        self.overtake(missing, now);
    }

    /// Unit `unit` came in from `core`, which has sent `skipped` packets before it that have not come; nothing, where it is not the
    /// last that the core has sent of those that have come.
    pub fn arrived(&mut self, core: u16, unit: u32, skipped: Option<u64>, now: Duration) -> Arrival {
        if let Some(holder) = self.holders.get(&core) {
            let took = now.saturating_sub(holder.heard);
            // A core that was stopped, not slow, shall not make everybody patient for as long as that.
            self.longest = self
                .longest
                .max(holder.silent.map_or(took, |waited| took.min(waited)));
        }
        // Where packets get lost, a lease that was passed over is one of them, or all that came of it is.
        let skipped = skipped.map(|skipped| if now < self.lossy { u64::MAX } else { skipped });
        let mut missing = Vec::new();
        if let Some(holder) = self.holder(core, now) {
            holder.pace.unit_done(now);
            holder.idle = false;
            missing = holder.advance(unit, skipped);
        }
        let arrival = if self.done.insert(unit) {
            Arrival::First
        } else {
            Arrival::Duplicate
        };
        self.returned.remove(&unit);
        self.overtake(missing, now);
        arrival
    }

    /// This has a moment to come after all.
    fn overtake(&mut self, missing: Vec<Missing>, now: Duration) {
        let wait = if now < self.lossy {
            OVERTAKEN_OR_LOST
        } else {
            OVERTAKEN
        };
        let missing = missing.into_iter().filter(|missing| !missing.units.is_empty());
        self.overtaken
            .extend(missing.map(|missing| (now + wait, missing)));
    }

    /// The leases that `core` should be sent again. It did not say its last word before `said`: that may have waited in the socket.
    pub fn again(&mut self, core: u16, said: Duration, now: Duration) -> Vec<Grant> {
        let (mut again, mut in_vain) = (Vec::new(), Vec::new());
        let tries = if now < self.lossy { 0 } else { TRIES };
        let Some(holder) = self.holders.get_mut(&core) else {
            return again;
        };
        holder.leases.retain_mut(|lease| {
            let open = holder.idle || lease.passed;
            if !open || said.saturating_sub(lease.sent) < SETTLED * 2_u32.pow(lease.again) {
                return true;
            }
            if lease.again >= tries {
                in_vain.push(lease.next..lease.end);
                return false;
            }
            again.push(lease.grant);
            (lease.again, lease.sent) = (lease.again + 1, now);
            true
        });
        for units in in_vain {
            self.take_back(units);
        }
        again
    }

    /// Puts on offer what should have come by now.
    pub fn settle(&mut self, now: Duration) {
        let due: Vec<_> = self
            .overtaken
            .extract_if(.., |(until, _)| *until <= now)
            .collect();
        for (_, Missing { units, certain }) in due {
            if certain && units.clone().any(|unit| !self.done.contains(&unit)) {
                self.lossy = now + LOSSY;
            }
            self.take_back(units);
        }
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
        let number = self.next_number;
        self.next_number = number.wrapping_add(1);
        let grant = Grant { number, first, count };
        holder.leases.push_back(Lease {
            grant,
            next: first,
            end: first + count,
            sent: now,
            again: 0,
            passed: false,
        });
        Some(grant)
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
            idle: false,
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
