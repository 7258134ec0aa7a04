//! The leased order: HELLO, LEASE, PIXELS, STOP, FAREWELL; and what goes wrong on the way.

mod support;

use node::{Fault, Outcome, TICKS_PER_SECOND};
use support::{RENDER_TICKS, SESSION, STACK, World, boot, packet, run};
use wire::boot::PixelOrder;
use wire::{Command, Farewell, Hello, MAX_PAYLOAD, Message, Name};

/// A host that leases units `first..last` on the first HELLO and says STOP on the next.
fn lease_once(first: u32, count: u32) -> impl FnMut(&mut World, support::Said) {
    let mut leased = false;
    move |world, said| {
        if said.is_hello() {
            if leased {
                world.post(Command::Stop)
            } else {
                world.lease(1, first, count)
            }
            leased = true;
        }
    }
}

#[test]
fn a_lease_is_worked_through_and_stop_is_answered() {
    let (outcome, world) = run(&boot(PixelOrder::Leased), World::default(), lease_once(10, 3));
    assert_eq!(
        outcome,
        Ok(Outcome {
            units: 3,
            rejected: 0,
            stack: STACK
        })
    );
    assert_eq!(world.units(), [10, 11, 12]);

    let hello = Hello {
        version: wire::VERSION,
        scene: wire::crc32(b"scene"),
        board: Name::new("fake"),
        profile: Name::new("precise"),
    };
    assert_eq!(world.said[0].message, Message::Hello(hello));
    let farewell = Message::Farewell(Farewell {
        rejected: 0,
        stack_used: 321,
        stack_size: 4096,
    });
    let last: Vec<_> = world
        .said
        .iter()
        .rev()
        .take_while(|said| said.message == farewell)
        .collect();
    assert_eq!(last.len(), 3, "FAREWELL is said three times");
    assert_eq!(last[0].seq, 3);
}

#[test]
fn pixels_say_what_they_are() {
    let (_, world) = run(&boot(PixelOrder::Leased), World::default(), lease_once(11, 2));
    let pixels: Vec<_> = world
        .said
        .iter()
        .filter_map(|said| Some((said.seq, said.pixels()?)))
        .collect();
    let (seq, last_run) = pixels[0];
    assert_eq!(
        (seq, last_run.unit, last_run.epoch, last_run.samples),
        (0, 11, 5, 16)
    );
    assert_eq!(
        (last_run.scene, last_run.ticks, last_run.rays),
        (wire::crc32(b"scene"), RENDER_TICKS, 7)
    );
    assert_eq!(
        last_run.sums.pixels(),
        4,
        "20 x 9 pixels leave 4 for the last run"
    );
    assert_eq!(last_run.sums.iter().next(), Some([11, 0, wire::SUM_MAX]));

    let (seq, second_pass) = pixels[1];
    assert_eq!(
        (seq, second_pass.unit, second_pass.samples),
        (1, 12, 8),
        "24 samples are 16 and 8"
    );
    assert_eq!(second_pass.sums.pixels(), 16);
}

#[test]
fn ticks_survive_the_clocks_wrap() {
    let world = World {
        now: u32::MAX - RENDER_TICKS / 2,
        ..World::default()
    };
    let (_, world) = run(&boot(PixelOrder::Leased), world, lease_once(0, 2));
    assert!(
        world
            .said
            .iter()
            .filter_map(|said| said.pixels())
            .all(|pixels| pixels.ticks == RENDER_TICKS)
    );
}

/// LEASEs are lost: the core says HELLO again, at first after 50 ms, then after twice the time each, but every 800 ms at least. Once it
/// has worked, it begins anew.
#[test]
fn an_idle_core_asks_again() {
    let (mut hellos, mut times) = (0, vec![]);
    let (outcome, world) = run(&boot(PixelOrder::Leased), World::default(), |world, said| {
        if said.is_hello() {
            hellos += 1;
            times.push(world.now);
            match hellos {
                1..=7 | 9 => (),
                8 => world.lease(9, 0, 1),
                _ => world.post(Command::Stop),
            }
        }
    });
    assert_eq!(outcome.unwrap().units, 1);
    assert_eq!(world.units(), [0]);
    let pauses: Vec<u32> = times
        .windows(2)
        .map(|pair| (pair[1] - pair[0]) / (TICKS_PER_SECOND / 1000))
        .collect();
    assert_eq!(pauses, [50, 100, 200, 400, 800, 800, 800, 50, 100]);
}

#[test]
fn a_duplicate_lease_is_worked_through_once() {
    let mut hellos = 0;
    let (outcome, world) = run(&boot(PixelOrder::Leased), World::default(), |world, said| {
        if said.is_hello() {
            hellos += 1;
            match hellos {
                1 => (0..3).for_each(|_| world.lease(1, 4, 2)),
                2 => world.lease(1, 4, 2),
                3 => world.lease(2, 4, 1), // the same unit under a new number: a lost packet's second try
                _ => world.post(Command::Stop),
            }
        }
    });
    assert_eq!(world.units(), [4, 5, 4]);
    assert_eq!(outcome.unwrap().rejected, 0, "a duplicate is no fault");
}

#[test]
fn four_leases_are_held_and_a_fifth_is_rejected() {
    let mut first = true;
    let (outcome, world) = run(&boot(PixelOrder::Leased), World::default(), |world, said| {
        if said.is_hello() {
            match std::mem::replace(&mut first, false) {
                true => (0..5).for_each(|n| world.lease(n, u32::from(n), 1)),
                false => world.post(Command::Stop),
            }
        }
    });
    assert_eq!(world.units(), [0, 1, 2, 3]);
    assert_eq!(outcome.unwrap().rejected, 1);
}

/// STOP is looked for between units: a core does not work off its leases first.
#[test]
fn stop_cuts_a_lease_short() {
    let (outcome, world) = run(&boot(PixelOrder::Leased), World::default(), |world, said| {
        if said.is_hello() {
            world.lease(1, 0, 20);
        }
        if said.pixels().is_some_and(|pixels| pixels.unit == 2) {
            world.post(Command::Stop);
        }
    });
    assert_eq!(world.units(), [0, 1, 2]);
    assert_eq!(outcome.unwrap().units, 3);
}

#[test]
fn what_is_not_for_this_core_now_is_rejected_and_counted() {
    let lease = |first, count| Command::Lease {
        number: 8,
        first,
        count,
    };
    let valid = packet(1, SESSION, lease(0, 1));
    let too_long = [valid.as_slice(), &[0; MAX_PAYLOAD]].concat();
    let foreign = [
        packet(1, SESSION ^ 1, lease(0, 1)), // an earlier run's
        packet(1, SESSION ^ 1, Command::Stop),
        packet(2, SESSION, lease(0, 1)),  // the neighbour's
        packet(1, SESSION, lease(24, 1)), // past the last unit
        packet(1, SESSION, lease(23, 2)), // over the end
        packet(1, SESSION, lease(0, u32::MAX)),
        valid[..25].to_vec(),
        vec![],
        vec![0xFF; MAX_PAYLOAD],
        too_long,
    ];
    let (count, mut first) = (foreign.len() as u32, true);
    let (outcome, world) = run(&boot(PixelOrder::Leased), World::default(), |world, said| {
        if said.is_hello() {
            match std::mem::replace(&mut first, false) {
                true => world.inbox.extend(foreign.clone()),
                false => world.post(Command::Stop),
            }
        }
    });
    assert_eq!(world.units(), [0; 0]);
    assert_eq!(
        outcome,
        Ok(Outcome {
            units: 0,
            rejected: count,
            stack: STACK
        })
    );
}

#[test]
fn a_busy_network_is_tried_again() {
    let world = World {
        refuse_sends: 15,
        ..World::default()
    };
    let (outcome, world) = run(&boot(PixelOrder::Leased), world, lease_once(0, 1));
    assert_eq!(outcome.unwrap().units, 1);
    assert_eq!(world.units(), [0]);
}

#[test]
fn a_dead_network_ends_the_core() {
    let world = World {
        refuse_sends: u32::MAX,
        ..World::default()
    };
    let (outcome, _) = run(&boot(PixelOrder::Leased), world, |_, _| ());
    assert_eq!(outcome, Err(Fault::Network));
}

/// A flood of rubbish must not keep a core from its work.
#[test]
fn a_flood_does_not_starve_the_work() {
    let (_, world) = run(&boot(PixelOrder::Leased), World::default(), |world, said| {
        if said.is_hello() {
            world.lease(1, 0, 3);
        }
        world.inbox.extend(std::iter::repeat_n(vec![0; 40], 50));
        if world.units().len() == 3 {
            world.inbox.clear();
            world.post(Command::Stop);
        }
    });
    assert_eq!(world.units(), [0, 1, 2]);
}
