//! Cores that fail: it is said where in the source, and the fleet goes on.

use std::net::Ipv4Addr;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use clap::Parser;
use host::collector::{self, Collection, End};
use host::firmware::Level;
use host::firmware::board::Board;
use host::firmware::symbols::{Place, explained};
use host::fleet::session::Route;
use host::fleet::{Core, Fleet, QemuFleet, RESTARTS, run_to_end};
use host::render::options::RenderOptions;
use host::render::{Job, boot_blocks};
use tracer::profile::Precise;
use whole_system::{cornell, film, plan, qemu, repository, test_image};
use wire::FaultInfo;

/// One of the images that test a board, and what it says until its end.
fn ended(board: Board, name: &str) -> (PathBuf, String) {
    let elf = test_image(board, name, None);
    let output = run_to_end(&qemu(), board, &elf).unwrap();
    (elf, String::from_utf8_lossy(&output.stdout).into_owned())
}

/// The address that a core's fault report names.
fn address(report: &str) -> u32 {
    let (_, after) = report.split_once(" at 0x").unwrap_or_else(|| panic!("{report}"));
    u32::from_str_radix(&after[..8], 16).unwrap()
}

#[test]
fn the_address_of_a_fault_is_one_of_the_image_s_own_lines() {
    for board in Board::ALL {
        let (elf, said) = ended(board, "undefined_instruction");
        let place = Place::of(&elf, address(&said)).unwrap();
        println!("{board}: {} is {place}", said.trim());
        assert!(
            place
                .line
                .is_some_and(|line| line.contains("undefined_instruction.rs:")),
            "{said}"
        );
        assert_eq!(
            Place::of(&elf, board.dtcm().start.try_into().unwrap()),
            None,
            "there is no code in data memory"
        );
    }
}

#[test]
fn a_panic_is_traced_to_its_function_by_the_line_it_names() {
    for board in Board::ALL {
        let (elf, said) = ended(board, "panicking");
        let words = FaultInfo {
            address: None,
            reason: said.trim(),
        };
        let explained = explained(&elf, &words);
        println!("{board}: {explained}");
        let (panic, place) = explained.split_once(", in ").unwrap();
        assert_eq!(panic, words.reason);
        // The address leads back to the line that the core has named.
        let found = Place::of(&elf, address(place)).unwrap();
        assert!(place.starts_with(&found.function), "{place}");
        assert!(panic.contains(&found.line.unwrap()), "{explained}");
    }
}

#[derive(Parser)]
struct Flags {
    #[command(flatten)]
    options: RenderOptions,
}

/// Collects the Cornell box from cores with a failing image instead of the image that the job would build: what came, and the log.
fn collected(board: Board, name: &str, log: Option<Level>, flags: &str) -> (Collection, String) {
    let elf = test_image(board, name, log);
    let (scene, out) = (repository("scenes/cornell.toml"), tempfile::tempdir().unwrap());
    let words = [
        "render",
        scene.to_str().unwrap(),
        "--out",
        out.path().to_str().unwrap(),
    ];
    let options = Flags::parse_from(words.into_iter().chain(flags.split_whitespace())).options;
    let session = Job::new(&options.picture).unwrap().session();
    let socket = collector::bind(Ipv4Addr::LOCALHOST, 0).unwrap();
    let route = Route::qemu(socket.local_addr().unwrap().port());
    let blocks = (0..).zip(boot_blocks(&session, &route).unwrap());
    let cores: Vec<Core> = blocks
        .map(|(number, block)| Core {
            logs: log.is_some(),
            ..Core::new(number, board, &elf, block)
        })
        .collect();
    let mut fleet = QemuFleet::start(&qemu(), &cores, out.path()).unwrap();
    let running = AtomicBool::new(false);
    let collection = collector::collect(&session, &socket, &mut fleet, None, &running, &mut drop).unwrap();
    fleet.end();
    let log = std::fs::read_to_string(out.path().join("fleet.log"));
    (collection, log.unwrap_or_default())
}

#[test]
fn a_core_that_fails_again_and_again_is_named_and_the_picture_is_complete_without_it() {
    let expected = film::<Precise>(&cornell(), &plan::<Precise>(128, 96, 128)).sha256();
    let quiet = Board::ALL.map(|board| (board, None));
    for (board, log) in quiet.into_iter().chain([(Board::Mps2An385, Some(Level::Error))]) {
        let flags = "--size 128x96 --spp 128 --cores 3 --integrator path --sampler independent";
        let (collection, text) = collected(board, "failing", log, flags);
        assert_eq!(collection.end, End::Complete);
        assert_eq!(collection.film.sha256(), expected);
        assert_eq!(collection.packets.lost, 0, "a new life is no loss");
        let [failed, others @ ..] = &collection.cores[..] else {
            panic!("no cores")
        };
        assert_eq!(failed.restarts.len(), RESTARTS);
        assert!(failed.ended.is_some());
        assert!(failed.units > 0, "what it did before it failed counts");
        let fault = failed.trouble().unwrap().explained();
        let (given_up, end) = (failed.heard.unwrap(), collection.elapsed);
        println!("{board}: given up after {given_up:.1?} of {end:.1?}: {fault}");
        for words in ["undefined instruction at 0x", "failing::fail", "failing.rs:"] {
            assert!(fault.contains(words), "{words} in: {fault}");
        }
        for core in others {
            assert_eq!((core.trouble(), core.restarts.len()), (None, 0));
        }
        // Each of its lives ends with a word in the log, and nothing else went wrong.
        let lives = if log.is_some() { 1 + RESTARTS } else { 0 };
        assert_eq!(text.lines().count(), lives, "{text}");
        for line in text.lines() {
            assert!(
                line.contains("core 0  ERROR  undefined instruction at 0x"),
                "{line}"
            );
        }
    }
}
