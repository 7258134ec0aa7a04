//! The collector against cores in threads of this process, over the loopback: the real worker, on a network that is made to fail,
//! with a renderer that is quick and easy to check.

use std::net::{Ipv4Addr, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use node::{Clock, Fault, Outcome, StackUse, TICKS_PER_SECOND, Worker};
use rand_xoshiro::Xoshiro256StarStar;
use rand_xoshiro::rand_core::SeedableRng;
use tracer::unit::SPAN;
use wire::boot::PixelOrder;
use wire::{Boot, Name};

use super::faulty_network::{Faults, FaultyNetwork};
use super::silence::Silence;
use super::*;
use crate::firmware::arithmetic::{Arithmetic, Sampler};
use crate::fleet::session::tests::small;
use crate::fleet::session::{Route, Session};
use crate::fleet::{self, Elsewhere, Fleet, NativeFleet, QemuFleet};
use crate::image::film::Film;

struct HostClock(Instant);

impl Clock for HostClock {
    fn ticks(&mut self) -> u32 {
        (self.0.elapsed().as_micros() as u64 * u64::from(TICKS_PER_SECOND / 1_000_000)) as u32
    }
}

/// What the quick renderer makes of a unit.
fn rendered(unit: u32) -> [[u64; 3]; SPAN] {
    std::array::from_fn(|pixel| [u64::from(unit) + 1, pixel as u64, u64::from(unit % 1000) << 20])
}

/// Cores in threads of their own, outside of any [`Fleet`].
struct Cores {
    threads: Vec<JoinHandle<Result<Outcome, Fault>>>,
    given_up: Arc<AtomicBool>,
}

impl Cores {
    fn start(session: &Session, port: u16, faults: &[Faults]) -> Self {
        let given_up = Arc::new(AtomicBool::new(false));
        let spawn = |(core, &faults): (usize, &Faults)| {
            let (session, given_up) = (session.clone(), Arc::clone(&given_up));
            thread::spawn(move || work(&session, core as u16, port, faults, given_up))
        };
        Self {
            threads: faults.iter().enumerate().map(spawn).collect(),
            given_up,
        }
    }

    fn join(self) -> Vec<Result<Outcome, Fault>> {
        // Those that were told to stop still say farewell a few times; the others never end by themselves.
        let start = Instant::now();
        while !self.threads.iter().all(JoinHandle::is_finished) && start.elapsed() < Duration::from_secs(1) {
            thread::sleep(Duration::from_millis(1));
        }
        self.given_up.store(true, Ordering::Relaxed);
        self.threads
            .into_iter()
            .map(|thread| thread.join().expect("no panic"))
            .collect()
    }
}

fn work(
    session: &Session,
    core: u16,
    port: u16,
    faults: Faults,
    given_up: Arc<AtomicBool>,
) -> Result<Outcome, Fault> {
    let boot: Boot<'_> = session.boot(core, &Route::loopback(port));
    let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).expect("a socket");
    socket
        .connect((Ipv4Addr::LOCALHOST, port))
        .expect("the collector's address");
    socket.set_nonblocking(true).expect("a socket that does not wait");
    let chance = Xoshiro256StarStar::seed_from_u64(u64::from(core));
    let mut network = FaultyNetwork {
        socket,
        chance,
        faults,
        sent: 0,
        given_up,
    };
    let mut renderer = |unit: u32, sums: &mut tracer::unit::Sums| {
        thread::sleep(Duration::from_millis(2));
        *sums = rendered(unit).map(|pixel| pixel.map(fixedmath::U48F16::from_bits));
        7
    };
    let mut clock = HostClock(Instant::now());
    let worker = Worker::new(
        &boot,
        session.plan,
        Name::new("test"),
        &mut renderer,
        &mut network,
        &mut clock,
    )?;
    worker.run(|| StackUse {
        used: 100,
        size: 1000,
    })
}

/// As long as tests wait for cores that say nothing: longer than for the end of a core whose units others take.
const PATIENCE: Option<Duration> = Some(Duration::from_secs(4));

/// Runs a collection with one core a fault; returns it, the cores' outcomes and how long it took.
fn collected(
    session: &Session,
    faults: &[Faults],
    interrupted: &AtomicBool,
) -> (Collection, Vec<Result<Outcome, Fault>>, Duration) {
    let socket = bind(Ipv4Addr::LOCALHOST, 0).expect("a free port");
    let port = socket.local_addr().expect("it is bound").port();
    let cores = Cores::start(session, port, faults);
    let start = Instant::now();
    let collection = collect(session, &socket, &mut Elsewhere, PATIENCE, interrupted, &mut drop);
    let took = start.elapsed();
    (collection.expect("the socket works"), cores.join(), took)
}

/// The film with every unit once.
fn whole_film(session: &Session) -> Film {
    let mut film = Film::new(session.plan.width, session.plan.height);
    for unit in 0..session.plan.units().expect("few units") {
        let extent = session.plan.extent(unit);
        let sums = &rendered(unit)[..usize::from(extent.pixels)];
        film.add(extent.first_pixel, u32::from(extent.samples), sums)
            .expect("it fits");
    }
    film
}

static RUNNING: AtomicBool = AtomicBool::new(false);

#[test]
fn every_unit_is_added_once_and_the_cores_say_farewell() {
    let session = small(3, PixelOrder::Leased);
    let (collection, outcomes, _) = collected(&session, &[Faults::default(); 3], &RUNNING);
    assert_eq!(collection.end, End::Complete);
    assert_eq!(collection.film, whole_film(&session));
    assert_eq!((collection.packets.rejected, collection.packets.lost), (0, 0));
    assert_eq!(collection.rays(), 7 * 40);
    assert!(collection.ticks() >= 40 * 2 * 24_000, "each unit sleeps for 2 ms");
    assert_eq!(collection.stack(), Some((100, 1000)));
    let units: u64 = collection.cores.iter().map(|core| core.units).sum();
    assert_eq!(units, 40);
    assert!(
        collection
            .cores
            .iter()
            .all(|core| core.units > 0 && core.farewell.is_some())
    );
    assert!(outcomes.iter().all(Result::is_ok), "{outcomes:?}");
}

#[test]
fn a_bad_network_gives_the_same_film_and_shows_in_the_accounts() {
    let session = small(3, PixelOrder::Leased);
    let bad = Faults {
        loss_percent: 20,
        duplicate_percent: 20,
        foreign: true,
        dies_after: None,
    };
    let (collection, ..) = collected(&session, &[bad; 3], &RUNNING);
    assert_eq!(collection.end, End::Complete);
    assert_eq!(collection.film, whole_film(&session));
    let packets = collection.packets;
    assert!(
        packets.lost > 0 && packets.duplicate > 0 && packets.rejected > 20,
        "{packets:?}"
    );
}

#[test]
fn the_units_of_a_core_that_dies_go_to_the_other() {
    let session = small(2, PixelOrder::Leased);
    let dying = Faults {
        dies_after: Some(5),
        ..Faults::default()
    };
    let (collection, outcomes, took) = collected(&session, &[Faults::default(), dying], &RUNNING);
    assert_eq!(collection.end, End::Complete);
    assert_eq!(collection.film, whole_film(&session));
    assert_eq!(outcomes[1], Err(Fault::Network));
    assert!(took < Duration::from_secs(7), "{took:?}");
}

#[test]
fn when_all_cores_are_silent_for_as_long_as_the_user_waits_it_ends_and_names_them() {
    let session = small(2, PixelOrder::Leased);
    let dying = Faults {
        dies_after: Some(6),
        ..Faults::default()
    };
    let (collection, _, took) = collected(&session, &[dying; 2], &RUNNING);
    assert!(
        took < Duration::from_secs(7),
        "4 s of silence and 2 s for a last word, not {took:?}"
    );
    let End::Deserted(why) = collection.end else {
        panic!("it cannot be complete: {:?}", collection.end)
    };
    assert!(
        why.contains("core 0") && why.contains("core 1") && why.contains("last heard"),
        "{why}"
    );
    assert!(collection.film.samples() > 0 && collection.film != whole_film(&session));
}

/// A quiet, living core says nothing for what the clock takes for 15 seconds: a tenth of a second between any two looks at the socket.
#[test]
fn a_core_that_lives_is_waited_for() {
    let session = small(1, PixelOrder::Leased);
    let socket = bind(Ipv4Addr::LOCALHOST, 0).expect("a free port");
    let port = socket.local_addr().expect("it is bound").port();
    let folder = tempfile::tempdir().expect("a folder");
    // The process lives; a thread does its work, once it has been quiet for long.
    let mut fleet = scripted(folder.path(), "exec sleep 60");
    let looks = Arc::new(AtomicU32::new(0));
    let (seen, of_core) = (Arc::clone(&looks), session.clone());
    let core = thread::spawn(move || {
        while seen.load(Ordering::Relaxed) < 150 {
            thread::sleep(Duration::from_millis(1));
        }
        work(&of_core, 0, port, Faults::default(), Arc::default())
    });
    let clock = || Duration::from_millis(100) * looks.fetch_add(1, Ordering::Relaxed);
    let collection = collected_by(&clock, &session, &socket, &mut fleet);
    assert_eq!(collection.end, End::Complete);
    assert!(core.join().expect("no panic").is_ok());
}

/// Again and again the collector stands still for an hour, as by Ctrl-Z and fg, or with the lid closed, first of all while no core
/// says anything. That is no silence.
#[test]
fn time_in_which_the_collector_stood_still_is_no_silence() {
    let session = small(1, PixelOrder::Leased);
    let socket = bind(Ipv4Addr::LOCALHOST, 0).expect("a free port");
    let port = socket.local_addr().expect("it is bound").port();
    let (start, looks) = (Instant::now(), Arc::new(AtomicU32::new(0)));
    let (seen, of_core) = (Arc::clone(&looks), session.clone());
    let core = thread::spawn(move || {
        while seen.load(Ordering::Relaxed) < 20 {
            thread::sleep(Duration::from_millis(1));
        }
        work(&of_core, 0, port, Faults::default(), Arc::default())
    });
    let clock = || start.elapsed() + Duration::from_secs(3600) * (looks.fetch_add(1, Ordering::Relaxed) / 10);
    let collection = collected_by(&clock, &session, &socket, &mut Elsewhere);
    assert_eq!(collection.end, End::Complete);
    assert_eq!(collection.film, whole_film(&session));
    assert!(core.join().expect("no panic").is_ok());
}

/// A collection by another clock than the host's.
fn collected_by(
    clock: &dyn Fn() -> Duration,
    session: &Session,
    socket: &UdpSocket,
    fleet: &mut dyn Fleet,
) -> Collection {
    let silence = Silence::new(PATIENCE.filter(|_| !fleet.policy().sees_ends));
    let collection = run::collect_by(clock, session, socket, fleet, silence, &RUNNING, &mut drop);
    collection.expect("the socket works")
}

#[test]
fn cores_that_failed_to_start_end_it_at_once_with_their_reason() {
    let session = small(2, PixelOrder::Leased);
    let socket = bind(Ipv4Addr::LOCALHOST, 0).expect("a free port");
    let damaged = vec![vec![0; 100]; 2];
    let mut fleet = NativeFleet::start(&damaged, Arithmetic::Precise, Sampler::Independent).expect("threads");
    let start = Instant::now();
    let end = collect(&session, &socket, &mut fleet, None, &RUNNING, &mut drop);
    assert!(start.elapsed() < Duration::from_secs(2));
    let End::Deserted(why) = end.expect("the socket works").end else {
        panic!("no core ever worked")
    };
    assert!(
        why.contains("all cores have ended, with 0 of 40 units in"),
        "{why}"
    );
    assert!(why.contains("core 1: it failed: its boot block"), "{why}");
}

/// What the collector makes of a fleet that it waits for.
fn waited_for(session: &Session, socket: &UdpSocket, fleet: &mut dyn Fleet) -> Collection {
    let collection = collect(session, socket, fleet, None, &RUNNING, &mut drop);
    collection.expect("the socket works")
}

/// A fleet whose QEMU is a script, which finds its own folder in `$0`.
fn scripted(folder: &std::path::Path, script: &str) -> QemuFleet {
    let qemu = fleet::fake_qemu(folder, script);
    QemuFleet::start(&qemu, &fleet::cores([0]), folder).expect("it starts")
}

#[test]
fn a_core_that_fails_every_time_is_given_up_soon() {
    let session = small(1, PixelOrder::Leased);
    let socket = bind(Ipv4Addr::LOCALHOST, 0).expect("a free port");
    let folder = tempfile::tempdir().expect("a folder");
    let mut fleet = scripted(folder.path(), "echo oh no; exit 4");
    let collection = waited_for(&session, &socket, &mut fleet);
    let End::Deserted(why) = collection.end else {
        panic!("no core ever worked")
    };
    for words in ["all cores have ended", "code 4", "started again 3 times", "oh no"] {
        assert!(why.contains(words), "{words} in: {why}");
    }
    let ended = Cause::Ended("its QEMU ended with code 4".to_owned());
    assert_eq!(collection.cores[0].restarts, vec![ended; 3]);
    // Four short lives, and no wait for anything else.
    assert!(
        collection.elapsed < Duration::from_secs(5),
        "{:?}",
        collection.elapsed
    );
}

#[test]
fn a_core_that_is_started_again_works_on() {
    let session = small(1, PixelOrder::Leased);
    let socket = bind(Ipv4Addr::LOCALHOST, 0).expect("a free port");
    let port = socket.local_addr().expect("it is bound").port();
    let folder = tempfile::tempdir().expect("a folder");
    // The script fails in its first life; in the second, a thread does the core's work in its stead.
    let script = "cd $(dirname $0); [ -e first ] || { touch first; exit 3; }; touch second; exec sleep 60";
    let (mut fleet, second) = (scripted(folder.path(), script), folder.path().join("second"));
    let of_core = session.clone();
    let core = thread::spawn(move || {
        while !second.exists() {
            thread::sleep(Duration::from_millis(1));
        }
        work(&of_core, 0, port, Faults::default(), Arc::default())
    });
    let collection = waited_for(&session, &socket, &mut fleet);
    assert_eq!(collection.end, End::Complete);
    assert_eq!(collection.film, whole_film(&session));
    assert_eq!(collection.packets.lost, 0);
    let record = &collection.cores[0];
    let ended = Cause::Ended("its QEMU ended with code 3".to_owned());
    assert_eq!(record.restarts, vec![ended.clone()]);
    assert_eq!((record.trouble(), &record.ended), (Some(ended), &None));
    assert!(core.join().expect("no panic").is_ok());
}

#[test]
fn packets_of_another_run_are_named_when_nothing_else_comes() {
    let session = small(1, PixelOrder::Leased);
    let other = Session {
        id: 77,
        ..session.clone()
    };
    let socket = bind(Ipv4Addr::LOCALHOST, 0).expect("a free port");
    let port = socket.local_addr().expect("it is bound").port();
    let foreign = Cores::start(&other, port, &[Faults::default()]);
    // Its own core exists but never says a word that counts, so that the silence is its own.
    let mut damaged =
        NativeFleet::start(&[vec![]], Arithmetic::Precise, Sampler::Independent).expect("a thread");
    thread::sleep(Duration::from_millis(100));
    let end = collect(&session, &socket, &mut damaged, None, &RUNNING, &mut drop);
    foreign.join();
    let End::Deserted(why) = end.expect("the socket works").end else {
        panic!("no core ever worked")
    };
    assert!(why.contains("of another run (0x0000004d)"), "{why}");
}

#[test]
fn an_interrupted_collection_keeps_what_came_and_stops_the_cores() {
    let session = small(1, PixelOrder::Leased);
    let session = Session {
        plan: tracer::unit::Plan {
            spp: 4_000,
            ..session.plan
        },
        ..session
    };
    let interrupted = Arc::new(AtomicBool::new(false));
    let later = Arc::clone(&interrupted);
    let timer = thread::spawn(move || {
        thread::sleep(Duration::from_millis(200));
        later.store(true, Ordering::Relaxed);
    });
    let (collection, outcomes, took) = collected(&session, &[Faults::default()], &interrupted);
    timer.join().expect("no panic");
    assert_eq!(collection.end, End::Interrupted);
    assert!(collection.film.samples() > 0);
    assert!(
        outcomes[0].is_ok() && took < Duration::from_secs(2),
        "{outcomes:?} {took:?}"
    );
}

#[test]
fn the_sequential_order_ends_when_every_unit_is_in() {
    let session = small(3, PixelOrder::Sequential);
    let (collection, outcomes, _) = collected(&session, &[Faults::default(); 3], &RUNNING);
    assert_eq!(collection.end, End::Complete);
    assert_eq!(collection.film, whole_film(&session));
    assert!(outcomes.iter().all(Result::is_ok), "{outcomes:?}");
}

#[test]
fn the_stochastic_order_ends_when_there_are_as_many_samples_as_were_asked_for() {
    let session = small(2, PixelOrder::Stochastic);
    let (collection, outcomes, _) = collected(&session, &[Faults::default(); 2], &RUNNING);
    assert_eq!(collection.end, End::Complete);
    assert_eq!(collection.film.samples(), session.samples());
    assert!(outcomes.iter().all(Result::is_ok), "{outcomes:?}");
}
