//! Tests of the Ethernet controller's driver on a core, against a peer on the host that echoes and floods.
//!
//! Frames of the peer's and of ours are alike: Ethernet's 14 bytes with a type for experiments, a letter that says what the frame
//! is, a number, the frame's own length (padding may follow it), and bytes that follow from number and place.
#![no_std]
#![no_main]

mod harness;

use board::Core;
use harness::Verdict;
use node::ethernet::Device;
use node::{Clock as _, TICKS_PER_SECOND};
use runtime::clock::Clock;
use runtime::{Board, ExitCode};

type Controller = <Core as Board>::Controller;

/// The frame's head: addresses, type, letter, number, length.
const HEAD: usize = 19;
/// The longest frame of Ethernet, without its checksum.
const LONGEST: usize = 1514;
/// Sent by us: to be sent back; so many frames of this length are wanted; one of many to be counted; how many were counted?
const ECHO: u8 = b'E';
const FLOOD: u8 = b'F';
const COUNT: u8 = b'C';
const TALLY: u8 = b'T';
/// Sent by the peer: one of a flood.
const DROP: u8 = b'd';

/// Frames in a flood, each of a different length, and together more than any controller's memory.
const FLOODED: u32 = 64;

struct Bench {
    controller: Controller,
    clock: Clock<Core>,
    mac: [u8; 6],
}

#[board::entry]
fn start() -> ! {
    let mac = [2, 0, 0, 0, 0, 7];
    let Some(controller) = Core::controller(mac) else {
        Core::println(Core::NO_CONTROLLER);
        Core::exit(ExitCode::Fault)
    };
    let bench = Bench {
        controller,
        clock: Clock::start(),
        mac,
    };
    harness::run(
        bench,
        &[
            ("frames of every kind of length come back whole", lengths),
            ("a frame longer than Ethernet's is refused", too_long_to_send),
            (
                "a frame longer than the buffer is dropped, and only that",
                too_long_to_receive,
            ),
            ("what survives an overrun is whole and in order", overrun),
            ("frames are sent while others are received", both_at_once),
            ("the controller starts anew in the middle of it", started_anew),
        ],
    )
}

impl Bench {
    /// Sends a frame, taking in nothing meanwhile.
    fn send(&mut self, letter: u8, number: u32, len: usize) -> Result<(), &'static str> {
        let mut frame = [0; LONGEST];
        let frame = &mut frame[..len];
        fill(frame, self.mac, letter, number);
        let sent = self.controller.transmit(frame);
        sent.map_err(|_| "the controller takes no frame")
    }

    /// The next frame within a second: its letter, its number, its length.
    fn next(&mut self, buffer: &mut [u8]) -> Result<(u8, u32, usize), &'static str> {
        let start = self.clock.ticks();
        while self.clock.ticks().wrapping_sub(start) < TICKS_PER_SECOND {
            match self.controller.receive(buffer) {
                Some(len) => return check(&buffer[..len]),
                None => self.controller.wait(TICKS_PER_SECOND / 100),
            }
        }
        Err("no frame comes")
    }

    fn echo(&mut self, number: u32, len: usize) -> Result<(), &'static str> {
        self.send(ECHO, number, len)?;
        match self.next(&mut [0; LONGEST])? {
            (ECHO, same, whole) if same == number && whole == len => Ok(()),
            _ => Err("another frame comes back"),
        }
    }
}

/// The byte at `place` of frame `number`.
fn pattern(number: u32, place: usize) -> u8 {
    (number.wrapping_mul(31).wrapping_add(place as u32 * 7) >> 1) as u8
}

fn fill(frame: &mut [u8], mac: [u8; 6], letter: u8, number: u32) {
    let len = frame.len() as u16;
    for (place, byte) in frame.iter_mut().enumerate() {
        *byte = pattern(number, place);
    }
    frame[..6].fill(0xff);
    frame[6..12].copy_from_slice(&mac);
    // Local experiments, by IEEE 802.
    frame[12..14].copy_from_slice(&[0x88, 0xb5]);
    frame[14] = letter;
    frame[15..17].copy_from_slice(&(number as u16).to_le_bytes());
    frame[17..19].copy_from_slice(&len.to_le_bytes());
}

/// Letter, number and length of a frame whose every byte is as it should be.
fn check(frame: &[u8]) -> Result<(u8, u32, usize), &'static str> {
    let head: &[u8; HEAD] = frame.first_chunk().ok_or("a frame is shorter than its head")?;
    let (letter, number) = (head[14], u32::from(u16::from_le_bytes([head[15], head[16]])));
    let len = usize::from(u16::from_le_bytes([head[17], head[18]]));
    let body = frame.get(HEAD..len).ok_or("a frame comes cut short")?;
    let whole = (HEAD..)
        .zip(body)
        .all(|(place, &byte)| byte == pattern(number, place));
    if whole {
        Ok((letter, number, len))
    } else {
        Err("a frame comes with other bytes")
    }
}

fn lengths(bench: &mut Bench) -> Verdict {
    for len in [
        HEAD, 20, 21, 22, 23, 41, 42, 43, 59, 60, 61, 62, 63, 64, 65, 127, 255, 326, 511, 512, 1023, 1512,
        1513, LONGEST,
    ] {
        bench.echo(len as u32, len)?;
    }
    Ok(None)
}

fn too_long_to_send(bench: &mut Bench) -> Verdict {
    match bench.controller.transmit(&[0; LONGEST + 1]) {
        Err(_) => bench.echo(1, 100).map(|()| None),
        Ok(()) => Err("it is taken"),
    }
}

fn too_long_to_receive(bench: &mut Bench) -> Verdict {
    bench.send(ECHO, 1, 300)?;
    bench.send(ECHO, 2, 99)?;
    match bench.next(&mut [0; 128])? {
        (ECHO, 2, 99) => Ok(None),
        _ => Err("the long one comes"),
    }
}

/// Says nothing for a while, in which more comes than there is memory for.
fn overrun(bench: &mut Bench) -> Verdict {
    bench.send(FLOOD, FLOODED, HEAD)?;
    let start = bench.clock.ticks();
    while bench.clock.ticks().wrapping_sub(start) < TICKS_PER_SECOND / 4 {
        core::hint::spin_loop();
    }
    let (mut received, mut last) = (0u64, None);
    let mut buffer = [0; LONGEST];
    while let Ok((letter, number, _)) = bench.next(&mut buffer) {
        if letter != DROP || last.is_some_and(|last| number <= last) {
            return Err("what comes is not what was sent");
        }
        (received, last) = (received + 1, Some(number));
    }
    if received == 0 {
        return Err("nothing survives");
    }
    bench.echo(3, 200)?;
    Ok(Some(received))
}

fn both_at_once(bench: &mut Bench) -> Verdict {
    bench.send(FLOOD, FLOODED, HEAD)?;
    let mut buffer = [0; LONGEST];
    let (mut sent, mut received) = (0, 0u32);
    while sent < FLOODED {
        match bench.send(COUNT, sent, HEAD + sent as usize * 20) {
            Ok(()) => sent += 1,
            // Memory is full of what has come.
            Err(_) if received < FLOODED => {
                bench.next(&mut buffer)?;
                received += 1;
            }
            Err(why) => return Err(why),
        }
        if let Some(len) = bench.controller.receive(&mut buffer) {
            check(&buffer[..len])?;
            received += 1;
        }
    }
    // A controller may have dropped some of the flood: it must say so by silence, not by damage.
    while received < FLOODED && bench.next(&mut buffer).is_ok() {
        received += 1;
    }
    if received == 0 {
        return Err("nothing was received meanwhile");
    }
    bench.send(TALLY, 0, HEAD)?;
    match bench.next(&mut buffer)? {
        (TALLY, FLOODED, _) => Ok(Some(received.into())),
        _ => Err("not every frame that was sent has arrived"),
    }
}

/// As after a fault, whatever the controller was doing.
fn started_anew(bench: &mut Bench) -> Verdict {
    bench.send(FLOOD, FLOODED, HEAD)?;
    bench.next(&mut [0; LONGEST])?;
    bench.controller = Core::controller(bench.mac).ok_or("it does not start again")?;
    while bench.next(&mut [0; LONGEST]).is_ok() {}
    bench.echo(4, 333).map(|()| None)
}
