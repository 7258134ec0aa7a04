//! The fleet with a script in QEMU's place.

use super::*;

/// A program that takes QEMU's place.
pub(crate) fn fake_qemu(folder: &Path, script: &str) -> PathBuf {
    let path = folder.join("fake-qemu");
    crate::platform::script::script(&path, script);
    path
}

/// Cores from number 0 on, with boot blocks of a byte each.
pub(crate) fn cores<const N: usize>(boot_blocks: [u8; N]) -> [Core; N] {
    let (mut numbers, elf) = (0.., Path::new("x.elf"));
    boot_blocks.map(|byte| {
        let number = numbers.next().expect("they do not end");
        Core::new(number, Board::Versatilepb, elf, vec![byte])
    })
}

fn all_ended(fleet: &mut QemuFleet, cores: usize) -> Vec<u16> {
    let (start, mut ended) = (Instant::now(), Vec::new());
    while ended.len() < cores && start.elapsed() < Duration::from_secs(10) {
        ended.extend(fleet.newly_ended());
        std::thread::sleep(Duration::from_millis(5));
    }
    ended
}

#[test]
fn the_end_of_a_core_is_noticed_once_and_told_with_its_last_lines() {
    let folder = tempfile::tempdir().expect("a folder");
    let qemu = fake_qemu(
        folder.path(),
        "for i in 1 2 3 4 5 6 7; do echo line $i; done; echo oh no >&2; exit 3",
    );
    let mut fleet = QemuFleet::start(&qemu, &cores([1, 2]), folder.path()).expect("it starts");
    let mut ended = all_ended(&mut fleet, 2);
    ended.sort_unstable();
    assert_eq!(ended, [0, 1]);
    assert_eq!(fleet.newly_ended(), [0_u16; 0]);
    assert_eq!(fleet.how_ended(1), "its QEMU ended with code 3");
    assert_eq!(
        fleet.last_output(1),
        ["line 4", "line 5", "line 6", "line 7", "oh no"]
    );
    assert_eq!(
        fs::read(folder.path().join("core-1.boot")).expect("a boot block"),
        [2]
    );
}

/// Starts a core that ends at once until it has done so `times` times, then starts it again as often as the fleet does.
fn lives(end: &str, times: u32) -> (QemuFleet, tempfile::TempDir, u32) {
    let folder = tempfile::tempdir().expect("a folder");
    let lives = folder.path().join("lives");
    let script = format!(
        "echo life; echo x >> {0}; [ $(wc -l < {0}) -gt {times} ] && exec sleep 60; {end}",
        lives.display()
    );
    let qemu = fake_qemu(folder.path(), &script);
    let mut fleet = QemuFleet::start(&qemu, &cores([1]), folder.path()).expect("it starts");
    let mut restarts = 0;
    while restarts < times && all_ended(&mut fleet, 1) == [0] && fleet.start_again(0).expect("it starts") {
        restarts += 1;
    }
    (fleet, folder, restarts)
}

#[test]
fn a_core_that_failed_is_started_again_with_its_files() {
    for end in ["exit 3", "exit 4"] {
        let (mut fleet, folder, restarts) = lives(end, 1);
        assert_eq!(restarts, 1, "{end}");
        assert_eq!(fleet.newly_ended(), [0_u16; 0]);
        assert_eq!(fleet.how_ended(0), RUNNING);
        let read = |name| fs::read_to_string(folder.path().join(name)).expect("a file");
        assert_eq!(read("core-0.pid"), format!("{}\n", fleet.process_ids()[0]));
        assert_eq!(read("core-0.boot"), "\u{1}");
        let start = Instant::now();
        while read("core-0.log") != "life\nlife\n" {
            assert!(
                start.elapsed() < Duration::from_secs(10),
                "{}",
                read("core-0.log")
            );
        }
    }
}

#[test]
fn a_core_is_known_by_its_number_and_every_life_of_it_is_recorded() {
    let folder = tempfile::tempdir().expect("a folder");
    let qemu = fake_qemu(folder.path(), "echo $*; exit 3");
    let [mut core] = cores([1]);
    (core.number, core.capture) = (7, Some(folder.path().join("core-7.pcap")));
    core.debugger = Some(1234);
    let mut fleet = QemuFleet::start(&qemu, &[core], folder.path()).expect("it starts");
    assert_eq!(all_ended(&mut fleet, 1), [7]);
    assert!(fleet.start_again(7).expect("it starts"));
    assert_eq!(all_ended(&mut fleet, 1), [7]);
    let lives = fleet.last_output(7);
    assert!(
        lives[0].contains("core-7.pcap") && lives[1].contains("core-7.2.pcap"),
        "{lives:?}"
    );
    assert!(
        lives
            .iter()
            .all(|line| line.ends_with("-S -gdb tcp:127.0.0.1:1234")),
        "{lives:?}"
    );
}

#[test]
fn a_core_has_four_lives_at_most() {
    let (fleet, _folder, restarts) = lives("exit 4", 10);
    assert_eq!((restarts, fleet.guests[0].restarts), (3, RESTARTS));
    assert_eq!(fleet.how_ended(0), "its QEMU ended with code 4");
}

#[test]
fn a_core_that_was_killed_or_gave_up_is_not_started_again() {
    for end in ["exit 0", "exit 1", "exit 2", "exit 127", "kill -KILL $$"] {
        let (fleet, _folder, restarts) = lives(end, 10);
        assert_eq!(restarts, 0, "{end}");
        assert_ne!(fleet.how_ended(0), RUNNING);
    }
}

#[test]
fn dropping_the_fleet_ends_its_processes_and_no_others() {
    let folder = tempfile::tempdir().expect("a folder");
    let qemu = fake_qemu(folder.path(), "exec sleep 60");
    let start =
        |name: &str| QemuFleet::start(&qemu, &cores([1]), &folder.path().join(name)).expect("it starts");
    let (dropped, mut kept) = (start("dropped"), start("kept"));
    let gone = dropped.process_ids()[0];
    drop(dropped);
    assert!(!Path::new(&format!("/proc/{gone}")).exists());
    assert_eq!(kept.newly_ended(), [0_u16; 0]);
}

#[test]
fn a_missing_emulator_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let missing = folder.path().join("no-such-qemu");
    match QemuFleet::start(&missing, &cores([1]), folder.path()) {
        Err(error) => assert!(error.to_string().contains("no-such-qemu"), "{error}"),
        // `setpriv` starts and finds nothing to run.
        Ok(mut fleet) => {
            assert_eq!(all_ended(&mut fleet, 1), [0]);
            assert!(fleet.last_output(0).join(" ").contains("no-such-qemu"));
        }
    }
}
