use std::time::Duration;

use proptest::prelude::*;
use tracer::unit::Termination;

use super::curve::Work;
use super::machine::{Course, Machine, simulate};
use super::*;

fn ms(milliseconds: u64) -> Duration {
    Duration::from_millis(milliseconds)
}

fn machine(cores: u16, packets_per_second: Option<u32>) -> Machine {
    Machine {
        cores,
        packets_per_second,
        answer: ms(1),
        quiet: false,
    }
}

fn course(cores: u16, packets_per_second: Option<u32>, costs: &[Duration]) -> Course {
    simulate(machine(cores, packets_per_second), costs)
}

fn work(samples_of_a_pixel: u16, costs: Vec<Duration>) -> Work {
    Work {
        termination: Termination::Roulette,
        samples_of_a_pixel,
        samples: u64::from(PACKET_PIXELS) * u64::from(samples_of_a_pixel) * costs.len() as u64,
        costs,
        packet: Duration::ZERO,
    }
}

/// HELLO leaves at once, its answer takes a millisecond, and then there is always a lease: 1 ms and the units one after the other.
#[test]
fn one_core_takes_what_its_units_take() {
    let costs: Vec<Duration> = (1..=50).map(ms).collect();
    let course = course(1, None, &costs);
    assert_eq!(course.first, ms(1 + 1));
    assert_eq!(course.last, ms(1 + 50 * 51 / 2));
    assert_eq!((course.packets, course.longest_wait), (1 + 50, Duration::ZERO));
}

/// A wire of 10 packets a second takes 100 ms each: one for HELLO, and one for the only unit behind it. A core that is not quiet says
/// HELLO again after 50 ms, and that is before the unit, too.
#[test]
fn a_packet_takes_its_time_on_the_wire() {
    let quiet = Machine {
        quiet: true,
        ..machine(1, Some(10))
    };
    let alone = simulate(quiet, &[ms(7)]);
    assert_eq!((alone.last, alone.longest_wait), (ms(100 + 1 + 7 + 100), ms(100)));
    let behind = course(1, Some(10), &[ms(7)]);
    assert_eq!((behind.last, behind.longest_wait), (ms(300), ms(300 - 108)));
}

/// Equal units, a multiple of the cores: all end at once, but for a unit that one core has more than another.
#[test]
fn equal_units_without_a_limit_are_linear() {
    for cores in [2, 8, 136] {
        let costs = vec![ms(20); 30 * usize::from(cores)];
        let last = course(cores, None, &costs).last;
        assert!((ms(601)..=ms(621)).contains(&last), "{cores} cores: {last:?}");
    }
}

/// 136 cores that make 6,800 packets a second, on a wire of 1,500: from the first unit on, one leaves every 1/1,500 s.
#[test]
fn a_saturated_wire_carries_just_what_it_can() {
    let costs = vec![ms(20); 136 * 40];
    let limited = machine(136, Some(1500));
    let quiet = simulate(
        Machine {
            quiet: true,
            ..limited
        },
        &costs,
    );
    let between = (costs.len() - 1) as f64 / 1500.0;
    let took = (quiet.last - quiet.first).as_secs_f64();
    assert!((took - between).abs() < 1e-6, "{took} for {between}");
    // 64 samples a packet, but for the time until the first is there.
    let series = work(4, costs.clone()).series(&[136], Some(1500), &[]);
    let point = series.points[0];
    let most = 1500.0 * 64.0;
    assert!(point.quiet_samples_per_second <= most && point.quiet_samples_per_second > 0.97 * most);
    // Cores that wait say so, and each time that is a packet.
    let noisy = simulate(limited, &costs);
    let rate = noisy.packets as f64 / noisy.last.as_secs_f64();
    assert!((rate / 1500.0 - 1.0).abs() < 1e-3, "{rate}");
    assert!(point.samples_per_second < 0.6 * most, "{point:?}");
}

/// Where the wire carries just what the cores make, it ceases to bend the curve; with fewer samples a packet the curve is the wire's.
#[test]
fn the_derived_samples_are_where_the_wire_ceases_to_matter() {
    let work = work(64, vec![ms(25); 136 * 80]);
    // A core renders 40,960 samples a second: 136 / 1,500 s of that are 3,713.7, and 16 pixels of 236 samples 3,776.
    let mut derivation = work.derivation(136);
    let [mean, quickest] = derivation.samples_per_packet_needed;
    assert!(
        (mean - 3713.7).abs() < 0.1 && (quickest - mean).abs() < 0.1,
        "{derivation:?}"
    );
    assert_eq!(
        (derivation.samples_per_packet, derivation.samples_of_a_pixel),
        (3776, 236)
    );
    work.sweep(&mut derivation);
    assert_eq!(
        Some(PACKET_PIXELS * u32::from(derivation.chosen())),
        derivation.enough
    );
    assert!(
        derivation.enough >= Some(derivation.samples_per_packet),
        "{derivation:?}"
    );
    for sweep in derivation.sweep {
        if f64::from(sweep.samples_per_packet) < 0.95 * mean {
            let share = sweep.quiet_samples_per_second / sweep.wire;
            assert!(share > 0.97 && share <= 1.0, "{sweep:?}");
            assert!(sweep.share_of_linear < 0.95, "{sweep:?}");
        }
        if sweep.samples_per_packet >= derivation.samples_per_packet {
            assert!(sweep.share_of_linear > 0.97, "{sweep:?}");
        }
    }
}

/// A stretch of quick units fills the wire, though the mean does not.
#[test]
fn quick_units_in_a_row_need_more_samples_a_packet() {
    let costs = [vec![ms(20); 408], vec![ms(30); 136 * 57]].concat();
    let [mean, quickest] = work(64, costs).derivation(136).samples_per_packet_needed;
    assert!(
        (quickest - 136.0 / 1500.0 * 1024.0 / 0.02).abs() < 0.1,
        "{quickest}"
    );
    assert!(mean < quickest / 1.4, "{mean} and {quickest}");
}

/// A picture of uneven units, as many a core as there are in a full run: each core more makes it quicker.
#[test]
fn more_cores_are_quicker_and_never_above_linear() {
    let uneven = (0..136 * 80).map(|unit: u64| Duration::from_micros(20_000 + unit * 7919 % 9000));
    let work = work(64, uneven.collect());
    let cores: Vec<u16> = (1..=136).collect();
    let points = work.series(&cores, None, &[]).points;
    for pair in points.windows(2) {
        assert!(
            pair[1].samples_per_second > pair[0].samples_per_second,
            "{pair:?}"
        );
    }
    for point in points {
        assert!((0.98..=1.0).contains(&point.share_of_linear), "{point:?}");
    }
}

#[test]
fn figures_have_five_digits() {
    assert_eq!(rounded(123_456.7), 123_460.0);
    assert_eq!(rounded(0.000_123_456_7), 0.000_123_46);
    assert_eq!((rounded(0.0), rounded(-1.0)), (0.0, -1.0));
}

#[test]
fn samples_of_a_pixel_are_a_multiple_of_four() {
    assert_eq!([1.0, 64.0, 64.1, 3735.0].map(samples_of_a_pixel), [4, 4, 8, 236]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Never above linear, and never faster than the wire; each unit is in once.
    #[test]
    fn no_machine_is_faster_than_its_cores_and_its_wire(
        costs in proptest::collection::vec(500_u64..40_000, 1..400),
        cores in 1_u16..40,
        limit in proptest::option::of(50_u32..3_000),
    ) {
        let costs: Vec<Duration> = costs.into_iter().map(Duration::from_micros).collect();
        let (one, many) = (course(1, None, &costs), course(cores, limit, &costs));
        prop_assert!(many.last >= one.last / u32::from(cores));
        prop_assert!(many.packets >= costs.len() as u64);
        if let Some(limit) = limit {
            prop_assert!(many.last.as_secs_f64() >= costs.len() as f64 / f64::from(limit));
        }
    }
}
