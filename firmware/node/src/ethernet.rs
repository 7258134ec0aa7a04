//! Ethernet, ARP, IPv4 and UDP, done once for every board with an Ethernet controller.
//!
//! There is one peer, the collector, so there is no routing and no table: frames to the collector go to the address it was last
//! heard from, and to everybody until it has been heard. `announce` makes the network know this core, and ARP requests for its
//! address are answered.
//!
//! Formats are `smoltcp::wire`'s. Every length that came from outside is checked (`new_checked`, `get`) before a byte behind it is
//! touched; a frame that fails a check is dropped, and counted if it claimed to be UDP for this core.

use core::num::NonZeroU16;

use smoltcp::phy::ChecksumCapabilities;
use smoltcp::wire::{
    ArpOperation, ArpPacket, ArpRepr, EthernetAddress, EthernetFrame, EthernetProtocol, EthernetRepr,
    IpProtocol, Ipv4Address, Ipv4Packet, Ipv4Repr, UdpPacket,
};
use wire::{Boot, MAX_PAYLOAD};

use crate::network::{Network, SendError};
use crate::{checksum, log};

const ETHERNET_LEN: usize = 14;
const ARP_LEN: usize = 28;
const IPV4_LEN: usize = 20;
const UDP_LEN: usize = 8;

/// The longest frame that means anything to a core, without its checksum; with some room for IPv4 options.
pub const MAX_FRAME: usize = ETHERNET_LEN + IPV4_LEN + UDP_LEN + MAX_PAYLOAD + 44;

/// Frames looked at in one call of `receive`: the network's own chatter must not keep a core from its work.
const FRAMES_AT_ONCE: usize = 8;

const HOP_LIMIT: u8 = 64;

/// An Ethernet controller.
pub trait Device {
    /// Sends one frame, given without its checksum. The controller pads short ones.
    fn transmit(&mut self, frame: &[u8]) -> Result<(), SendError>;

    /// Takes the next frame and returns its length; without the checksum, possibly with padding. Frames longer than the buffer
    /// are dropped.
    fn receive(&mut self, buffer: &mut [u8]) -> Option<usize>;

    /// As [`Network::wait`].
    fn wait(&mut self, ticks: u32);
}

/// UDP to and from the collector over an Ethernet controller.
pub struct Interface<'a> {
    device: &'a mut dyn Device,
    mac: EthernetAddress,
    address: Ipv4Address,
    collector: Ipv4Address,
    collector_mac: EthernetAddress,
    port: u16,
    malformed: u32,
}

impl<'a> Interface<'a> {
    /// The network of the core that `boot` describes.
    #[inline(never)]
    pub fn new(boot: &Boot<'_>, device: &'a mut dyn Device) -> Self {
        Self {
            device,
            mac: EthernetAddress(boot.mac()),
            address: Ipv4Address::from(boot.address),
            collector: Ipv4Address::from(boot.collector),
            collector_mac: EthernetAddress::BROADCAST,
            port: boot.port,
            malformed: 0,
        }
    }

    /// Tells the network who has this address: a gratuitous ARP request.
    pub fn announce(&mut self) -> Result<(), SendError> {
        self.send_arp(
            ArpOperation::Request,
            EthernetAddress([0; 6]),
            self.address,
            EthernetAddress::BROADCAST,
        )
    }

    fn send_arp(
        &mut self,
        operation: ArpOperation,
        target_hardware_addr: EthernetAddress,
        target_protocol_addr: Ipv4Address,
        to: EthernetAddress,
    ) -> Result<(), SendError> {
        let repr = ArpRepr::EthernetIpv4 {
            operation,
            source_hardware_addr: self.mac,
            source_protocol_addr: self.address,
            target_hardware_addr,
            target_protocol_addr,
        };
        let mut frame = [0; ETHERNET_LEN + ARP_LEN];
        self.emit_ethernet(&mut frame, EthernetProtocol::Arp, to);
        repr.emit(&mut ArpPacket::new_unchecked(&mut frame[ETHERNET_LEN..]));
        self.device.transmit(&frame)
    }

    fn emit_ethernet(&self, frame: &mut [u8], ethertype: EthernetProtocol, dst_addr: EthernetAddress) {
        let repr = EthernetRepr {
            src_addr: self.mac,
            dst_addr,
            ethertype,
        };
        repr.emit(&mut EthernetFrame::new_unchecked(frame));
    }

    /// Looks at one frame; gives the UDP payload if it is one for this core.
    fn process<'f>(&mut self, frame: &'f [u8]) -> Option<&'f [u8]> {
        let frame = EthernetFrame::new_checked(frame).ok()?;
        if frame.dst_addr() != self.mac && !frame.dst_addr().is_broadcast() {
            return None;
        }
        match frame.ethertype() {
            EthernetProtocol::Arp => {
                self.process_arp(frame.payload());
                None
            }
            EthernetProtocol::Ipv4 => self.process_ipv4(frame.src_addr(), frame.payload()),
            _ => None,
        }
    }

    fn process_arp(&mut self, packet: &[u8]) {
        // Lengths that the compiler knows need no code that checks them.
        let Some(packet) = packet.first_chunk::<ARP_LEN>().map(ArpPacket::new_unchecked) else {
            return;
        };
        if packet.hardware_len() != 6 || packet.protocol_len() != 4 {
            return;
        }
        let Ok(ArpRepr::EthernetIpv4 {
            operation,
            source_hardware_addr,
            source_protocol_addr,
            target_protocol_addr,
            ..
        }) = ArpRepr::parse(&packet)
        else {
            return;
        };
        self.learn(source_protocol_addr, source_hardware_addr);
        if operation == ArpOperation::Request && target_protocol_addr == self.address {
            // A lost answer is asked for again.
            let _ = self.send_arp(
                ArpOperation::Reply,
                source_hardware_addr,
                source_protocol_addr,
                source_hardware_addr,
            );
        }
    }

    fn process_ipv4<'f>(&mut self, from: EthernetAddress, bytes: &'f [u8]) -> Option<&'f [u8]> {
        let packet = Ipv4Packet::new_checked(bytes).ok()?;
        if packet.dst_addr() != self.address || packet.next_header() != IpProtocol::Udp {
            return None;
        }
        let Some(payload) = udp_payload(&packet, bytes, self.port) else {
            self.malformed = self.malformed.wrapping_add(1);
            log::warn!("datagram of {=usize} bytes dropped: malformed", bytes.len());
            return None;
        };
        self.learn(packet.src_addr(), from);
        Some(payload)
    }

    /// Remembers where the collector, or the router before it, was heard.
    fn learn(&mut self, address: Ipv4Address, mac: EthernetAddress) {
        if address == self.collector && mac.is_unicast() {
            self.collector_mac = mac;
        }
    }
}

/// The payload of a datagram for `port`, whole and with right checksums, in a packet of these bytes.
fn udp_payload<'f>(packet: &Ipv4Packet<&[u8]>, bytes: &'f [u8], port: u16) -> Option<&'f [u8]> {
    let header = bytes.get(..packet.header_len().into())?;
    let fragmented = packet.more_frags() || packet.frag_offset() != 0;
    if packet.version() != 4 || fragmented || checksum::of(checksum::sum(header)) != 0 {
        return None;
    }
    let datagram = bytes.get(header.len()..packet.total_len().into())?;
    let udp = UdpPacket::new_unchecked(datagram.first_chunk::<UDP_LEN>()?);
    let datagram = datagram.get(..udp.len().into())?;
    let payload = datagram.get(UDP_LEN..)?;
    let sum = pseudo_header(packet.src_addr(), packet.dst_addr(), datagram.len()) + checksum::sum(datagram);
    // A checksum of zero is none.
    let sound = udp.checksum() == 0 || checksum::of(sum) == 0;
    (sound && udp.dst_port() == port).then_some(payload)
}

/// The sum of what UDP's checksum covers besides the datagram.
fn pseudo_header(source: Ipv4Address, destination: Ipv4Address, len: usize) -> u32 {
    let addresses = checksum::sum(&source.octets()) + checksum::sum(&destination.octets());
    addresses + u32::from(u8::from(IpProtocol::Udp)) + len as u32
}

impl Network for Interface<'_> {
    fn send(&mut self, payload: &[u8]) -> Result<(), SendError> {
        let mut frame = [0; MAX_FRAME];
        let len = ETHERNET_LEN + IPV4_LEN + UDP_LEN + payload.len();
        let frame = frame.get_mut(..len).ok_or(SendError)?;
        self.emit_ethernet(frame, EthernetProtocol::Ipv4, self.collector_mac);
        let ip = Ipv4Repr {
            src_addr: self.address,
            dst_addr: self.collector,
            next_header: IpProtocol::Udp,
            payload_len: UDP_LEN + payload.len(),
            hop_limit: HOP_LIMIT,
        };
        let (_, packet) = frame.split_at_mut(ETHERNET_LEN);
        let (header, datagram) = packet.split_at_mut_checked(IPV4_LEN).ok_or(SendError)?;
        ip.emit(
            &mut Ipv4Packet::new_unchecked(&mut *header),
            &ChecksumCapabilities::ignored(),
        );
        Ipv4Packet::new_unchecked(&mut *header).set_checksum(0);
        let sum = checksum::sum(header);
        Ipv4Packet::new_unchecked(header).set_checksum(checksum::of(sum));

        let len = datagram.len();
        datagram
            .get_mut(UDP_LEN..)
            .ok_or(SendError)?
            .copy_from_slice(payload);
        let mut udp = UdpPacket::new_unchecked(&mut *datagram);
        udp.set_src_port(self.port);
        udp.set_dst_port(self.port);
        udp.set_len(len as u16);
        udp.set_checksum(0);
        let sum = pseudo_header(self.address, self.collector, len) + checksum::sum(datagram);
        // Zero would say that there is none; it is one of two spellings of the same number.
        let checksum = NonZeroU16::new(checksum::of(sum)).unwrap_or(NonZeroU16::MAX);
        UdpPacket::new_unchecked(datagram).set_checksum(checksum.get());
        self.device.transmit(frame)
    }

    fn receive(&mut self, buffer: &mut [u8]) -> Option<usize> {
        let mut frame = [0; MAX_FRAME];
        for _ in 0..FRAMES_AT_ONCE {
            let len = self.device.receive(&mut frame)?;
            if let Some(payload) = self.process(frame.get(..len)?) {
                let len = payload.len().min(buffer.len());
                let (room, payload) = (buffer.get_mut(..len)?, payload.get(..len)?);
                room.copy_from_slice(payload);
                return Some(len);
            }
        }
        None
    }

    fn wait(&mut self, ticks: u32) {
        self.device.wait(ticks);
    }

    fn malformed(&self) -> u32 {
        self.malformed
    }
}
