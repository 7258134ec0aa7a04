//! Tests that run on the cores themselves, on every board: their console says how each of them ended.

#[path = "../../../firmware/images/shared/wire_cases.rs"]
mod wire_cases;

use std::io;
use std::net::UdpSocket;
use std::process::Output;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use host::bench::operations::bench::measure;
use host::firmware::board::Board;
use host::fleet::{run_to_end, run_with_peer};
use operations::Group;
use whole_system::{qemu, test_image, toolchain};

/// The tests that a core has passed, with what they have found.
fn passed(board: Board, output: &Output) -> Vec<(String, Option<u64>)> {
    let said = String::from_utf8_lossy(&output.stdout);
    println!("{board}:\n{said}");
    let tests: Vec<&str> = said
        .lines()
        .filter_map(|line| line.strip_prefix("test "))
        .collect();
    let passed: Vec<_> = tests
        .iter()
        .filter_map(|line| line.trim_end().split_once(" ok"))
        .map(|(name, found)| (name.to_owned(), u64::from_str_radix(found.trim(), 16).ok()))
        .collect();
    assert!(
        output.status.success() && passed.len() == tests.len() && !tests.is_empty(),
        "{board}: {}\n{said}{}",
        output.status,
        String::from_utf8_lossy(&output.stderr)
    );
    passed
}

#[test]
fn the_wire_and_the_stack_mark_are_right_on_every_core() {
    for board in Board::ALL {
        let elf = test_image(board, "core_tests", None);
        let output = run_to_end(&qemu(), board, &elf).expect("QEMU starts");
        let found: Vec<u64> = passed(board, &output)
            .into_iter()
            .filter_map(|(_, found)| found)
            .collect();
        assert_eq!(
            found,
            [wire_cases::transcript().expect("the same on the host")],
            "{board}"
        );
    }
}

#[test]
fn every_controller_s_driver_holds_out_against_its_peer() {
    for board in Board::ALL {
        let elf = test_image(board, "controller_tests", None);
        let peer = UdpSocket::bind("127.0.0.1:0").expect("a free port");
        let core = free_port();
        peer.connect(("127.0.0.1", core)).expect("an address");
        let (port, over) = (
            peer.local_addr().expect("it is bound").port(),
            AtomicBool::new(false),
        );
        let output = thread::scope(|scope| {
            scope.spawn(|| be_a_peer(&peer, &over).expect("the peer's socket works"));
            let output = run_with_peer(&qemu(), board, &elf, core, port);
            over.store(true, Ordering::Relaxed);
            output.expect("QEMU starts")
        });
        assert!(passed(board, &output).len() >= 6);
    }
}

#[test]
fn every_operation_of_ours_answers_alike_on_the_second_board() {
    let board = Board::Mps2An385;
    let groups: Vec<Group> = Group::ALL
        .into_iter()
        .filter(|group| !group.is_rivals())
        .collect();
    // The first board's answers are compared with the price list.
    let rows = measure(&toolchain(), &qemu(), board, &groups).unwrap_or_else(|error| panic!("{error}"));
    for row in &rows {
        let (operation, variant) = (row.entry.operation, row.entry.variant);
        println!(
            "{board}: test {operation}, {variant} ok, {} instructions",
            row.instructions
        );
        let panics = row.reach.symbols.iter().any(|symbol| symbol.contains("panic"));
        assert!(!panics, "{variant} reaches {:?}", row.reach.symbols);
    }
    let reciprocal = |variant: &str| {
        let row = rows.iter().find(|row| row.entry.variant == variant);
        row.map(|row| row.instructions).expect("the list has it")
    };
    // This core divides: a reciprocal needs no table.
    assert!(2.0 * reciprocal("division::reciprocal") < reciprocal("division::nearest"));
}

/// A port that was free a moment ago.
fn free_port() -> u16 {
    let socket = UdpSocket::bind("127.0.0.1:0").expect("a free port");
    socket.local_addr().expect("it is bound").port()
}

/// Where a frame says what it is; see `firmware/images/controller_tests.rs`.
const LETTER: usize = 14;
const NUMBER: usize = 15;
const LENGTH: usize = 17;
const HEAD: usize = 19;

/// The byte at `place` of frame `number`, as the core has it.
fn pattern(number: u16, place: usize) -> u8 {
    (u32::from(number).wrapping_mul(31).wrapping_add(place as u32 * 7) >> 1) as u8
}

fn fill(frame: &mut [u8], number: u16) {
    let len = frame.len() as u16;
    for (place, byte) in frame.iter_mut().enumerate().skip(HEAD) {
        *byte = pattern(number, place);
    }
    frame[NUMBER..LENGTH].copy_from_slice(&number.to_le_bytes());
    frame[LENGTH..HEAD].copy_from_slice(&len.to_le_bytes());
}

fn is_whole(frame: &[u8], number: u16) -> bool {
    let len = usize::from(u16::from_le_bytes([frame[LENGTH], frame[LENGTH + 1]]));
    let mut expected = frame[..len].to_vec();
    fill(&mut expected, number);
    expected == frame[..len]
}

/// Echoes, floods and counts as the core asks for it.
fn be_a_peer(socket: &UdpSocket, over: &AtomicBool) -> io::Result<()> {
    socket.set_read_timeout(Some(Duration::from_millis(50)))?;
    let (mut buffer, mut counted) = ([0; 2048], 0u16);
    while !over.load(Ordering::Relaxed) {
        let len = match socket.recv(&mut buffer) {
            Ok(len) => len,
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => continue,
            // QEMU is not there yet, or not any more.
            Err(error) if error.kind() == io::ErrorKind::ConnectionRefused => continue,
            Err(error) => return Err(error),
        };
        let frame = &mut buffer[..len];
        let number = u16::from_le_bytes([frame[NUMBER], frame[NUMBER + 1]]);
        assert!(
            is_whole(frame, number),
            "frame {} {number} is damaged",
            frame[LETTER] as char
        );
        match frame[LETTER] {
            b'E' => socket.send(frame).map(drop)?,
            b'F' => flood(socket, frame, number)?,
            b'C' => counted += 1,
            b'T' => {
                fill(&mut frame[..HEAD], counted);
                socket.send(&frame[..HEAD])?;
            }
            other => panic!("a frame of the unknown kind {other:#x}"),
        }
    }
    Ok(())
}

fn flood(socket: &UdpSocket, frame: &[u8], frames: u16) -> io::Result<()> {
    for number in 0..frames {
        let mut drop = vec![0; HEAD + usize::from(number) * 23];
        drop[..HEAD].copy_from_slice(&frame[..HEAD]);
        drop[LETTER] = b'd';
        fill(&mut drop, number);
        socket.send(&drop)?;
    }
    Ok(())
}
