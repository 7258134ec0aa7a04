//! The lease table alone, by hand.

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

/// `core` has nothing to do, and all that it has rendered is in.
fn hello(leases: &mut Leases, core: u16, now: Duration) -> Vec<u16> {
    leases.idle(core, 0, now);
    let again = leases.again(core, now, now);
    again.into_iter().map(|grant| grant.number).collect()
}

#[test]
fn a_core_gets_nothing_before_it_is_heard_and_no_more_than_three_leases_then() {
    let mut leases = Leases::new(100);
    assert_eq!(leases.grant(0, ms(0)), None);
    hello(&mut leases, 0, ms(0));
    assert_eq!(granted(&mut leases, 0, ms(0)), [0, 1, 2]);
    assert_eq!(leases.grant(0, ms(0)), None);
    assert_eq!(leases.arrived(0, 0, Some(0), ms(10)), Arrival::First);
    assert_eq!(granted(&mut leases, 0, ms(10)), [3]);
}

#[test]
fn leases_grow_with_the_pace_of_the_core() {
    let mut leases = Leases::new(100_000);
    hello(&mut leases, 0, ms(0));
    granted(&mut leases, 0, ms(0));
    for unit in 0..3 {
        leases.arrived(0, unit, Some(0), ms(u64::from(unit)));
    }
    let grant = leases.grant(0, ms(3)).expect("there is room");
    assert_eq!(grant.count, 60, "a unit a millisecond, and a lease is to last 60");
}

#[test]
fn a_unit_counts_once() {
    let mut leases = Leases::new(2);
    hello(&mut leases, 0, ms(0));
    granted(&mut leases, 0, ms(0));
    assert_eq!(leases.arrived(0, 0, Some(0), ms(1)), Arrival::First);
    assert_eq!(leases.arrived(0, 0, Some(0), ms(1)), Arrival::Duplicate);
    assert_eq!(leases.arrived(7, 0, Some(0), ms(1)), Arrival::Duplicate);
    assert_eq!(leases.done(), 1);
    assert_eq!(leases.arrived(0, 1, Some(0), ms(2)), Arrival::First);
    assert_eq!(leases.done(), 2);
}

#[test]
fn what_was_overtaken_has_a_moment_and_then_goes_to_others() {
    let mut leases = Leases::new(3);
    hello(&mut leases, 0, ms(0));
    assert_eq!(granted(&mut leases, 0, ms(0)), [0, 1, 2]);
    leases.arrived(0, 2, Some(2), ms(30));
    leases.settle(ms(89));
    assert_eq!(granted(&mut leases, 0, ms(89)), [0_u32; 0]);
    assert_eq!(leases.arrived(0, 1, Some(0), ms(89)), Arrival::First);
    leases.settle(ms(90));
    assert_eq!(granted(&mut leases, 0, ms(90)), [0]);
}

/// Its leases overtook each other on the way: the first are still to come.
#[test]
fn a_lease_that_a_core_passes_over_without_a_loss_is_its_own_still_and_sent_again() {
    let mut leases = Leases::new(3);
    hello(&mut leases, 0, ms(0));
    assert_eq!(granted(&mut leases, 0, ms(0)), [0, 1, 2]);
    leases.arrived(0, 1, Some(0), ms(99));
    assert_eq!(leases.again(0, ms(99), ms(99)), []);
    let numbers = |again: Vec<Grant>| -> Vec<u16> { again.into_iter().map(|grant| grant.number).collect() };
    assert_eq!(
        numbers(leases.again(0, ms(100), ms(100))),
        [0],
        "2 is not passed over"
    );
    leases.settle(ms(10_000));
    assert_eq!(granted(&mut leases, 0, ms(10_000)), [0_u32; 0]);
}

#[test]
fn when_the_last_packet_is_lost_its_number_shows_it_and_the_unit_is_leased_again() {
    let mut leases = Leases::new(2);
    hello(&mut leases, 0, ms(0));
    assert_eq!(granted(&mut leases, 0, ms(0)), [0, 1]);
    leases.arrived(0, 0, Some(0), ms(40));
    leases.idle(0, 1, ms(50));
    leases.settle(ms(109));
    assert_eq!(granted(&mut leases, 0, ms(109)), [0_u32; 0], "it may still come");
    leases.settle(ms(110));
    assert_eq!(granted(&mut leases, 0, ms(110)), [1]);
}

#[test]
fn of_two_leases_that_may_have_been_lost_both_are_leased_again() {
    let mut leases = Leases::new(2);
    hello(&mut leases, 0, ms(0));
    assert_eq!(granted(&mut leases, 0, ms(0)), [0, 1]);
    leases.idle(0, 1, ms(50));
    leases.settle(ms(110));
    assert_eq!(granted(&mut leases, 0, ms(110)), [0, 1]);
}

#[test]
fn an_idle_core_of_which_nothing_is_missing_is_told_the_same_again_and_again() {
    let mut leases = Leases::new(2);
    hello(&mut leases, 0, ms(0));
    assert_eq!(granted(&mut leases, 0, ms(0)), [0, 1]);
    let none = [0_u16; 0];
    assert_eq!(hello(&mut leases, 0, ms(99)), none, "it may still be on its way");
    // After 100 ms, 200 ms more, 400, 800, 1600.
    for (early, due) in [(0, 100), (299, 300), (699, 700), (1_499, 1_500), (3_099, 3_100)] {
        assert_eq!(hello(&mut leases, 0, ms(early)), none);
        assert_eq!(hello(&mut leases, 0, ms(due)), [0, 1]);
    }
    assert_eq!(granted(&mut leases, 0, ms(6_299)), [0_u32; 0]);
    assert_eq!(hello(&mut leases, 0, ms(6_300)), none);
    assert_eq!(granted(&mut leases, 0, ms(6_300)), [0, 1], "it was told in vain");
}

#[test]
fn a_silent_core_loses_its_leases_after_two_seconds_and_a_dead_one_at_once() {
    let mut leases = Leases::new(6);
    for core in [0, 1] {
        hello(&mut leases, core, ms(0));
    }
    assert_eq!(granted(&mut leases, 0, ms(0)), [0, 1, 2]);
    assert_eq!(granted(&mut leases, 1, ms(0)), [3, 4, 5]);
    leases.arrived(1, 3, Some(0), ms(600));
    assert_eq!(leases.late(ms(2_000)), [0_u16; 0]);
    assert_eq!(leases.late(ms(2_001)), [0]);
    assert!(leases.any_speaks());
    assert_eq!(leases.grant(0, ms(2_001)), None, "it has not said anything since");
    assert_eq!(leases.grant(1, ms(2_001)).map(|grant| grant.first), Some(0));
    leases.ended(1);
    assert_eq!(hello(&mut leases, 0, ms(2_050)), [0, 1, 2], "its own again");
    leases.arrived(0, 0, Some(0), ms(2_055));
    assert_eq!(granted(&mut leases, 0, ms(2_055)), [4]);
    hello(&mut leases, 1, ms(2_060));
    assert_eq!(
        leases.grant(1, ms(2_060)),
        None,
        "a core that ended is not asked again"
    );
    leases.started_again(1);
    assert_eq!(leases.grant(1, ms(2_070)), None, "nobody knows where it is");
    hello(&mut leases, 1, ms(2_070));
    assert!(leases.grant(1, ms(2_070)).is_some());
}

#[test]
fn a_core_that_takes_long_over_a_unit_is_given_time() {
    let mut leases = Leases::new(100);
    hello(&mut leases, 0, ms(0));
    granted(&mut leases, 0, ms(0));
    leases.arrived(0, 0, Some(0), ms(500));
    leases.arrived(0, 1, Some(0), ms(1_000));
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
    hello(&mut leases, 0, ms(0));
    granted(&mut leases, 0, ms(0));
    assert_eq!(
        leases.late(ms(2_001)),
        [0],
        "nobody knows yet that its units take three seconds"
    );
    leases.arrived(0, 0, Some(0), ms(3_000));
    granted(&mut leases, 0, ms(3_000));
    leases.arrived(0, 1, Some(0), ms(6_000));
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
        hello(&mut leases, core, ms(0));
        granted(&mut leases, core, ms(0));
    }
    leases.arrived(0, 0, Some(0), ms(1_500));
    assert_eq!(leases.late(ms(4_500)), [0_u16; 0], "three units of the other's");
    assert_eq!(leases.late(ms(4_501)), [1]);
}

/// It was at work at a long unit: what nobody has taken meanwhile is not leased again, and next time it has longer.
#[test]
fn a_core_that_is_heard_again_has_its_leases_back() {
    let mut leases = Leases::new(7);
    hello(&mut leases, 0, ms(0));
    assert_eq!(granted(&mut leases, 0, ms(0)), [0, 1, 2]);
    assert_eq!(leases.late(ms(2_100)), [0]);
    assert_eq!(leases.late(ms(2_200)), [0_u16; 0], "once is enough");
    assert!(!leases.any_speaks());
    hello(&mut leases, 1, ms(2_300));
    assert_eq!(leases.grant(1, ms(2_300)).map(|grant| grant.first), Some(0));
    assert_eq!(leases.arrived(0, 0, Some(0), ms(60_000)), Arrival::First);
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
fn an_old_word_is_not_answered_again() {
    let mut leases = Leases::new(3);
    hello(&mut leases, 0, ms(0));
    granted(&mut leases, 0, ms(500));
    leases.idle(0, 0, ms(900));
    assert_eq!(leases.again(0, ms(500), ms(900)), []);
    assert_eq!(leases.again(0, ms(600), ms(900)).len(), 3);
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
