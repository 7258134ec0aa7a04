//! `cargo xtask trace`: the recorded packets, byte by byte, against the protocol's documents and its decoders.

use std::ffi::{OsStr, OsString};
use std::net::Ipv4Addr;
use std::os::unix::ffi::{OsStrExt, OsStringExt};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::AtomicBool;

use clap::Parser;
use host::firmware::board::Board;
use host::fleet::capture::Tally;
use host::render::{RenderError, TraceOptions, trace};
use serde_json::Value;
use tempfile::TempDir;
use whole_system::{oddly_named_folder, repository};
use wire::{FromCore, Message, ToCore, to_core};

const COLLECTOR: Ipv4Addr = Ipv4Addr::new(10, 0, 2, 2);
const CORE: u16 = 1;

/// As the documents of the crate `wire` number them.
const COMMANDS: [(&str, u16); 6] = [
    ("HELLO", 0x0101),
    ("PIXELS", 0x0102),
    ("FAREWELL", 0x0103),
    ("FAULT", 0x0104),
    ("LEASE", 0x0201),
    ("STOP", 0x0202),
];

fn numbered(name: &str) -> u16 {
    let found = COMMANDS.iter().find(|(command, _)| *command == name);
    found.unwrap().1
}

#[derive(Parser)]
struct Flags {
    #[command(flatten)]
    options: TraceOptions,
}

fn options(out: &Path, flags: &str) -> TraceOptions {
    let scene = repository("scenes/cornell.toml");
    let flags = flags.split_whitespace().map(OsStr::new);
    let words = ["trace", "--reference", "none", "--core", "1"]
        .map(OsStr::new)
        .into_iter()
        .chain(flags);
    let out = OsString::from_vec([b"--out=", out.as_os_str().as_bytes()].concat());
    Flags::parse_from(words.chain([scene.as_os_str(), &out])).options
}

/// A traced render's folder.
fn traced(flags: &str) -> TempDir {
    let out = oddly_named_folder();
    trace(&options(out.path(), flags), &AtomicBool::new(false)).unwrap();
    out
}

fn file(out: &TempDir) -> PathBuf {
    out.path().join("core-1.pcap")
}

/// A UDP datagram of a capture file.
struct Datagram {
    source: Ipv4Addr,
    destination: Ipv4Addr,
    payload: Vec<u8>,
}

impl Datagram {
    fn byte(&self, at: usize) -> u8 {
        self.payload[at]
    }

    fn u16(&self, at: usize) -> u16 {
        u16::from_le_bytes(self.payload[at..at + 2].try_into().unwrap())
    }

    fn u32(&self, at: usize) -> u32 {
        u32::from_le_bytes(self.payload[at..at + 4].try_into().unwrap())
    }
}

/// The UDP datagrams of a capture file in the byte order of the machine that wrote it: this one.
fn datagrams(path: &Path) -> Vec<Datagram> {
    let bytes = std::fs::read(path).unwrap();
    let word = |at: usize| u32::from_ne_bytes(bytes[at..at + 4].try_into().unwrap());
    assert_eq!(
        (word(0), word(20)),
        (0xa1b2_c3d4, 1),
        "a capture file of Ethernet"
    );
    let (mut at, mut found) = (24, Vec::new());
    while at < bytes.len() {
        let (kept, sent) = (word(at + 8) as usize, word(at + 12) as usize);
        assert_eq!(kept, sent, "no frame is cut short");
        found.extend(datagram(&bytes[at + 16..at + 16 + kept]));
        at += 16 + kept;
    }
    found
}

fn datagram(frame: &[u8]) -> Option<Datagram> {
    let (kind, packet) = (&frame[12..14], &frame[14..]);
    if kind != [0x08, 0x00] || packet[9] != 17 {
        return None;
    }
    let address = |at: usize| Ipv4Addr::from(<[u8; 4]>::try_from(&packet[at..at + 4]).unwrap());
    let datagram = &packet[4 * usize::from(packet[0] & 15)..];
    let length = usize::from(u16::from_be_bytes([datagram[4], datagram[5]]));
    Some(Datagram {
        source: address(12),
        destination: address(16),
        payload: datagram[8..length].to_vec(),
    })
}

/// A packet's fields as they lie behind the SDP header, from byte 10: command, sequence number, arguments.
fn fields(datagram: &Datagram) -> (u16, u16, [u32; 3]) {
    let arguments = [14, 18, 22].map(|at| datagram.u32(at));
    (datagram.u16(10), datagram.u16(12), arguments)
}

fn expected_from_core(packet: &FromCore<'_>) -> (u16, u16, [u32; 3]) {
    let (command, arg2, arg3) = match &packet.message {
        Message::Hello(hello) => ("HELLO", hello.version.into(), hello.scene),
        Message::Pixels(pixels) => {
            let samples = u32::from(pixels.samples);
            ("PIXELS", pixels.unit, samples << 16 | u32::from(pixels.epoch))
        }
        Message::Farewell(farewell) => ("FAREWELL", farewell.rejected, farewell.stack_used),
        Message::Fault(fault) => {
            let known = fault.address.is_some();
            ("FAULT", fault.address.unwrap_or(0), known.into())
        }
    };
    (numbered(command), packet.seq, [packet.session, arg2, arg3])
}

fn expected_to_core(packet: &ToCore) -> (u16, u16, [u32; 3]) {
    match packet.command {
        to_core::Command::Lease { number, first, count } => {
            (numbered("LEASE"), number, [packet.session, first, count])
        }
        to_core::Command::Stop => (numbered("STOP"), 0, [packet.session, 0, 0]),
    }
}

/// Checks the bytes of one packet and gives its command.
fn checked(datagram: &Datagram) -> u16 {
    // Core 1 is port 1 of processor 2 of chip (0, 0); the host is 0xFF.
    let (host, core) = (0xff, 0x22);
    let from_core = datagram.destination == COLLECTOR;
    assert!(from_core || datagram.source == COLLECTOR);
    let (tag, destination, source) = if from_core {
        (1, host, core)
    } else {
        (0xff, core, host)
    };
    assert_eq!(
        datagram.payload[..10],
        [0, 0, 7, tag, destination, source, 0, 0, 0, 0]
    );
    let (number, expected) = if from_core {
        let packet = FromCore::decode(&datagram.payload).unwrap();
        (packet.core, expected_from_core(&packet))
    } else {
        let packet = ToCore::decode(&datagram.payload).unwrap();
        (packet.core, expected_to_core(&packet))
    };
    assert_eq!((number, fields(datagram)), (CORE, expected));
    expected.0
}

#[test]
fn the_recorded_packets_are_the_protocol_s_and_all_there_on_every_board() {
    for board in Board::ALL {
        let out = traced(&format!("--size 64x48 --spp 16 --cores 2 --board {board}"));
        let datagrams = datagrams(&file(&out));
        let commands: Vec<u16> = datagrams.iter().map(checked).collect();
        let tally = Tally::of(&file(&out)).unwrap();
        for (name, command) in COMMANDS {
            let recorded = commands.iter().filter(|&&other| other == command).count();
            assert_eq!(recorded > 0, name != "FAULT", "{board}: {name}");
            let counted = tally.from_core.of(name) + tally.to_core.of(name);
            assert_eq!(counted, recorded as u64, "{board}: {name}");
        }

        let report: Value =
            serde_json::from_slice(&std::fs::read(out.path().join("report.json")).unwrap()).unwrap();
        let units = report["per_core"][usize::from(CORE)]["units"].as_u64().unwrap();
        let duplicate = report["packets"]["duplicate"].as_u64().unwrap();
        let pixels = tally.from_core.of("PIXELS");
        // A unit that was leased twice counts for the core whose packet came first.
        assert!(
            (units..=units + duplicate).contains(&pixels),
            "{board}: {pixels} packets, {units} units, {duplicate} duplicates"
        );
    }
}

#[test]
fn what_cannot_be_recorded_is_refused() {
    let out = tempfile::tempdir().unwrap();
    let end = |flags: &str| trace(&options(out.path(), flags), &AtomicBool::new(false));
    assert!(matches!(end("--backend native"), Err(RenderError::NoNetwork)));
    let error = end("--cores 1").unwrap_err();
    assert!(
        matches!(error, RenderError::NoSuchCore { core: 1, cores: 1 }),
        "{error}"
    );
}

/// The dissector for Wireshark numbers them as the packets do.
#[test]
fn the_dissector_knows_every_command() {
    let dissector = std::fs::read_to_string(repository("docs/sdp.lua")).unwrap();
    for (name, number) in COMMANDS {
        let line = format!("[{number:#06x}] = \"{name}\",");
        assert!(dissector.contains(&line), "{line}");
    }
}

#[test]
fn wireshark_sees_every_field_as_the_decoders_do() {
    let out = traced("--size 64x48 --spp 16 --cores 2");
    let names = "padding flags tag dest_port_cpu srce_port_cpu dest_y dest_x srce_y srce_x cmd_rc seq arg1 arg2 arg3 core data";
    let mut tshark = Command::new("tshark");
    tshark
        .arg("-X")
        .arg(format!("lua_script:{}", repository("docs/sdp.lua").display()));
    tshark
        .arg("-r")
        .arg(file(&out))
        .args(["-Y", "udp", "-T", "fields"]);
    for name in names.split(' ') {
        tshark.args(["-e", &format!("spinnaker.{name}")]);
    }
    let output = tshark.output().expect("tshark, of the package tshark");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let datagrams = datagrams(&file(&out));
    assert_eq!(text.lines().count(), datagrams.len());
    for (line, datagram) in text.lines().zip(&datagrams) {
        let command = checked(datagram);
        let (_, seq, [session, arg2, arg3]) = fields(datagram);
        let hex = |bytes: &[u8]| bytes.iter().map(|byte| format!("{byte:02x}")).collect::<String>();
        let byte = |at| datagram.byte(at);
        let expected = [
            "0x0000".to_owned(),
            format!("{:#04x}", byte(2)),
            byte(3).to_string(),
            format!("{:#04x}", byte(4)),
            format!("{:#04x}", byte(5)),
            byte(6).to_string(),
            byte(7).to_string(),
            byte(8).to_string(),
            byte(9).to_string(),
            format!("{command:#06x}"),
            seq.to_string(),
            format!("{session:#010x}"),
            arg2.to_string(),
            arg3.to_string(),
            CORE.to_string(),
            hex(&datagram.payload[26..]),
        ];
        assert_eq!(line.split('\t').collect::<Vec<_>>(), expected);
    }
    println!("{} packets", datagrams.len());
}
