//! The published orders, without leases.

mod support;

use std::collections::BTreeSet;

use support::{Said, World, boot, run};
use wire::boot::PixelOrder;
use wire::{Boot, Command};

/// The first `count` units that a core renders by itself.
fn units(boot: &Boot<'_>, count: usize) -> Vec<u32> {
    let mut seen = 0;
    let (outcome, world) = run(boot, World::default(), |world: &mut World, said: Said| {
        seen += usize::from(said.pixels().is_some());
        if seen == count {
            world.post(Command::Stop);
        }
    });
    assert_eq!(outcome.unwrap().units as usize, count);
    assert_eq!(
        world.said.iter().filter(|said| said.is_hello()).count(),
        1,
        "a busy core asks for nothing"
    );
    world.units()
}

#[test]
fn sequential_cores_start_in_their_own_share_and_wrap() {
    let boot = boot(PixelOrder::Sequential);
    // Core 1 of 4, 24 units.
    let expected: Vec<u32> = (6..24).chain(0..6).chain([6]).collect();
    assert_eq!(units(&boot, 25), expected);
    assert_eq!(
        units(
            &Boot {
                core: 1,
                cores: 5,
                ..boot
            },
            1
        ),
        [4]
    );
}

#[test]
fn stochastic_cores_differ_from_each_other_and_repeat_themselves() {
    let boot = boot(PixelOrder::Stochastic);
    let first = units(&boot, 200);
    assert_eq!(units(&boot, 200), first);
    assert_ne!(units(&Boot { seed: 2, ..boot }, 200), first);
    // 200 draws from 12 runs miss one with a probability of 3e-7.
    let runs: BTreeSet<u32> = first.iter().map(|unit| unit % 12).collect();
    assert_eq!(runs.len(), 12);
    assert!(
        first.iter().any(|&unit| unit > 24),
        "ids are drawn from all passes"
    );
}

#[test]
fn a_free_running_core_wants_no_lease() {
    let mut seen = 0;
    let (outcome, world) = run(&boot(PixelOrder::Sequential), World::default(), |world, said| {
        if said.is_hello() {
            world.lease(1, 20, 2);
        }
        seen += u32::from(said.pixels().is_some());
        if seen == 3 {
            world.post(Command::Stop);
        }
    });
    assert_eq!(world.units(), [6, 7, 8]);
    assert_eq!(outcome.unwrap().rejected, 1);
}
