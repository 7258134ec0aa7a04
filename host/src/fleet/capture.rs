//! Recorded packets: what a capture file of QEMU's tells of a core's talk with its collector.

use std::fmt;
use std::fs::File;
use std::path::{Path, PathBuf};

use pcap_parser::traits::PcapReaderIterator;
use pcap_parser::{LegacyPcapReader, PcapBlockOwned, PcapError};
use smoltcp::wire::{EthernetFrame, EthernetProtocol, IpProtocol, Ipv4Packet, UdpPacket};
use wire::{Command, FromCore, Message, ToCore};

/// Room for the largest record that QEMU writes: 64 KiB and its header.
const BUFFER: usize = 1 << 17;

/// Why a capture file could not be read.
#[derive(Debug, thiserror::Error)]
#[error("the recorded packets in {}: {cause}", path.display())]
pub struct CaptureError {
    path: PathBuf,
    cause: String,
}

/// How many packets of each command went each way.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// From the core to the collector.
    pub from_core: Commands,
    /// From the collector to the core.
    pub to_core: Commands,
    /// Frames that carry neither: the network's own affairs.
    pub others: u64,
    /// The UDP port of the collector, which is the core's own as well.
    pub port: Option<u16>,
}

/// Packets by the names of their commands, in the order of their first appearance.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Commands(Vec<(&'static str, u64)>);

impl Commands {
    /// Packets of the command of this name.
    pub fn of(&self, name: &str) -> u64 {
        let entry = self.0.iter().find(|(command, _)| *command == name);
        entry.map_or(0, |&(_, packets)| packets)
    }

    fn count(&mut self, name: &'static str) {
        match self.0.iter_mut().find(|(command, _)| *command == name) {
            Some((_, packets)) => *packets += 1,
            None => self.0.push((name, 1)),
        }
    }
}

impl fmt::Display for Commands {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words: Vec<String> = self
            .0
            .iter()
            .map(|(command, packets)| format!("{packets} {command}"))
            .collect();
        f.write_str(if words.is_empty() { "nothing" } else { "" })?;
        f.write_str(&words.join(", "))
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "  from the core: {}", self.from_core)?;
        writeln!(f, "  to the core:   {}", self.to_core)?;
        write!(f, "  other frames:  {}", self.others)
    }
}

impl Tally {
    /// Counts the packets in a capture file.
    pub fn of(path: &Path) -> Result<Self, CaptureError> {
        let failed = |cause: String| CaptureError {
            path: path.to_owned(),
            cause,
        };
        let file = File::open(path).map_err(|error| failed(error.to_string()))?;
        let mut reader = LegacyPcapReader::new(BUFFER, file).map_err(|error| failed(error.to_string()))?;
        let mut tally = Self::default();
        loop {
            match reader.next() {
                Ok((length, block)) => {
                    if let PcapBlockOwned::Legacy(record) = block {
                        tally.count(record.data);
                    }
                    reader.consume(length);
                }
                Err(PcapError::Eof) => return Ok(tally),
                Err(PcapError::Incomplete(_)) => {
                    reader.refill().map_err(|error| failed(error.to_string()))?;
                }
                Err(error) => return Err(failed(error.to_string())),
            }
        }
    }

    fn count(&mut self, frame: &[u8]) {
        let Some((port, payload)) = datagram(frame) else {
            self.others += 1;
            return;
        };
        self.port = Some(port);
        match (FromCore::decode(payload), ToCore::decode(payload)) {
            (Ok(packet), _) => self.from_core.count(message_name(&packet.message)),
            (_, Ok(packet)) => self.to_core.count(command_name(packet.command)),
            _ => self.others += 1,
        }
    }
}

/// The destination port and the payload of a frame that carries UDP over IPv4.
fn datagram(frame: &[u8]) -> Option<(u16, &[u8])> {
    let frame = EthernetFrame::new_checked(frame).ok()?;
    let packet = Some(frame.payload()).filter(|_| frame.ethertype() == EthernetProtocol::Ipv4)?;
    let packet = Ipv4Packet::new_checked(packet).ok()?;
    let datagram = Some(packet.payload()).filter(|_| packet.next_header() == IpProtocol::Udp)?;
    let datagram = UdpPacket::new_checked(datagram).ok()?;
    Some((datagram.dst_port(), datagram.payload()))
}

fn message_name(message: &Message<'_>) -> &'static str {
    match message {
        Message::Hello(_) => "HELLO",
        Message::Pixels(_) => "PIXELS",
        Message::Farewell(_) => "FAREWELL",
        Message::Fault(_) => "FAULT",
    }
}

fn command_name(command: Command) -> &'static str {
    match command {
        Command::Lease { .. } => "LEASE",
        Command::Stop => "STOP",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_missing_or_no_capture_is_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("core-0.pcap");
        let error = |path| Tally::of(path).expect_err("no capture").to_string();
        assert!(error(&path).contains("core-0.pcap"));
        std::fs::write(&path, b"something else, and long enough for a header").expect("a file");
        assert!(error(&path).contains("core-0.pcap"));
    }

    #[test]
    fn packets_are_counted_by_command_and_direction_and_the_rest_is_kept_apart() {
        let stop = ToCore {
            core: 0,
            session: 7,
            command: Command::Stop,
        };
        let mut payload = [0; wire::MAX_PAYLOAD];
        let len = stop.encode(&mut payload);
        let mut tally = Tally::default();
        for payload in [&payload[..len], &payload[..len], b"hello"] {
            tally.count(&frame(payload));
        }
        tally.count(b"no frame");
        assert_eq!((tally.to_core.of("STOP"), tally.others), (2, 2));
        assert_eq!(tally.port, Some(9));
        assert_eq!(
            tally.to_string(),
            "  from the core: nothing\n  to the core:   2 STOP\n  other frames:  2"
        );
    }

    /// An Ethernet frame with a UDP datagram from port 8 to port 9.
    fn frame(payload: &[u8]) -> Vec<u8> {
        let udp = 8 + payload.len() as u16;
        let mut bytes = [0; 14].to_vec();
        bytes[12] = 0x08;
        bytes.extend([0x45, 0]);
        bytes.extend((20 + udp).to_be_bytes());
        bytes.extend([0, 0, 0, 0, 64, 17, 0, 0, 10, 0, 2, 2, 10, 0, 2, 15]);
        bytes.extend([0, 8, 0, 9]);
        bytes.extend(udp.to_be_bytes());
        bytes.extend([0, 0]);
        bytes.extend(payload);
        bytes
    }
}
