//! Frames, byte for byte, and frames that lie.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

use node::ethernet::{Device, Interface, MAX_FRAME};
use node::{Network, SendError};
use proptest::prelude::*;
use wire::boot::{PixelOrder, Termination};
use wire::{Boot, Name};

const HOST_MAC: [u8; 6] = [0x52, 0x55, 10, 0, 2, 2];
const BROADCAST: [u8; 6] = [0xFF; 6];

#[derive(Clone, Default)]
struct Cable {
    to_core: Rc<RefCell<VecDeque<Vec<u8>>>>,
    from_core: Rc<RefCell<Vec<Vec<u8>>>>,
}

impl Device for Cable {
    fn transmit(&mut self, frame: &[u8]) -> Result<(), SendError> {
        self.from_core.borrow_mut().push(frame.to_vec());
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8]) -> Option<usize> {
        let frame = self.to_core.borrow_mut().pop_front()?;
        buffer[..frame.len()].copy_from_slice(&frame);
        Some(frame.len())
    }

    fn wait(&mut self, _ticks: u32) {}
}

/// Core 259 at 10.0.2.15, its collector at 10.0.2.2, port 17893 (0x45E5).
fn interface() -> (Interface<'static>, Cable) {
    let boot = Boot {
        core: 259,
        cores: 260,
        session: 1,
        epoch: 0,
        width: 16,
        height: 1,
        samples_per_unit: 4,
        spp: 4,
        seed: 0,
        epsilon: 0,
        termination: Termination::Roulette,
        order: PixelOrder::Leased,
        profile: Name::new("precise"),
        collector: [10, 0, 2, 2],
        port: 17893,
        address: [10, 0, 2, 15],
        camera: b"camera",
        scene: &[],
    };
    let cable = Cable::default();
    (Interface::new(&boot, Box::leak(Box::new(cable.clone()))), cable)
}

/// A datagram from the collector, as slirp sends it; its payload is `hi!`. Checksums by Python.
#[rustfmt::skip]
const DATAGRAM: [u8; 45] = [
    0x02, 0, 0, 0, 1, 3, 0x52, 0x55, 10, 0, 2, 2, 0x08, 0x00,
    0x45, 0, 0, 31, 0, 7, 0, 0, 64, 17, 0x62, 0xB7, 10, 0, 2, 2, 10, 0, 2, 15,
    0x45, 0xE5, 0x45, 0xE5, 0, 11, 0xD2, 0x93, b'h', b'i', b'!',
];

#[rustfmt::skip]
const ARP_REQUEST: [u8; 42] = [
    0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x52, 0x55, 10, 0, 2, 2, 0x08, 0x06,
    0, 1, 0x08, 0x00, 6, 4, 0, 1,
    0x52, 0x55, 10, 0, 2, 2, 10, 0, 2, 2,
    0, 0, 0, 0, 0, 0, 10, 0, 2, 15,
];

fn received(interface: &mut Interface<'static>, cable: &Cable, frame: &[u8]) -> Option<Vec<u8>> {
    cable.to_core.borrow_mut().push_back(frame.to_vec());
    let mut buffer = [0xa5; 300];
    interface.receive(&mut buffer).map(|len| buffer[..len].to_vec())
}

/// The frame with `bytes` put at `offset`.
fn patched(frame: &[u8], offset: usize, bytes: &[u8]) -> Vec<u8> {
    let mut frame = frame.to_vec();
    frame[offset..offset + bytes.len()].copy_from_slice(bytes);
    frame
}

#[test]
fn the_announcement_is_a_gratuitous_arp_request() {
    let (mut interface, cable) = interface();
    interface.announce().unwrap();
    #[rustfmt::skip]
    let expected = [
        0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x02, 0, 0, 0, 1, 3, 0x08, 0x06,
        0, 1, 0x08, 0x00, 6, 4, 0, 1,
        0x02, 0, 0, 0, 1, 3, 10, 0, 2, 15,
        0, 0, 0, 0, 0, 0, 10, 0, 2, 15,
    ];
    assert_eq!(cable.from_core.take(), [expected]);
}

#[test]
fn an_arp_request_is_answered() {
    let (mut interface, cable) = interface();
    assert_eq!(received(&mut interface, &cable, &ARP_REQUEST), None);
    #[rustfmt::skip]
    let expected = [
        0x52, 0x55, 10, 0, 2, 2, 0x02, 0, 0, 0, 1, 3, 0x08, 0x06,
        0, 1, 0x08, 0x00, 6, 4, 0, 2,
        0x02, 0, 0, 0, 1, 3, 10, 0, 2, 15,
        0x52, 0x55, 10, 0, 2, 2, 10, 0, 2, 2,
    ];
    assert_eq!(cable.from_core.take(), [expected]);
}

#[test]
fn an_arp_request_for_another_is_not_answered() {
    let (mut interface, cable) = interface();
    received(&mut interface, &cable, &patched(&ARP_REQUEST, 41, &[16]));
    received(&mut interface, &cable, &patched(&ARP_REQUEST, 18, &[200, 200])); // address lengths that lie
    received(&mut interface, &cable, &ARP_REQUEST[..41]);
    assert!(cable.from_core.take().is_empty());
}

#[test]
fn a_datagram_goes_to_everybody_until_the_collector_is_known() {
    let (mut interface, cable) = interface();
    interface.send(b"hi!").unwrap();
    #[rustfmt::skip]
    let expected = [
        0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x02, 0, 0, 0, 1, 3, 0x08, 0x00,
        0x45, 0, 0, 31, 0, 0, 0x40, 0, 64, 17, 0x22, 0xBE, 10, 0, 2, 15, 10, 0, 2, 2,
        0x45, 0xE5, 0x45, 0xE5, 0, 11, 0xD2, 0x93, b'h', b'i', b'!',
    ];
    assert_eq!(cable.from_core.take(), [expected]);

    received(&mut interface, &cable, &ARP_REQUEST);
    cable.from_core.take();
    interface.send(b"hi!").unwrap();
    assert_eq!(cable.from_core.take(), [patched(&expected, 0, &HOST_MAC)]);
}

#[test]
fn the_collector_is_also_learnt_from_its_datagrams() {
    let (mut interface, cable) = interface();
    assert_eq!(
        received(&mut interface, &cable, &DATAGRAM).as_deref(),
        Some(&b"hi!"[..])
    );
    interface.send(b"").unwrap();
    assert_eq!(cable.from_core.take()[0][..6], HOST_MAC);
}

#[test]
fn nobody_else_is_learnt() {
    let (mut interface, cable) = interface();
    received(&mut interface, &cable, &patched(&ARP_REQUEST, 31, &[3]));
    cable.from_core.take();
    interface.send(b"").unwrap();
    assert_eq!(cable.from_core.take()[0][..6], BROADCAST);
}

#[test]
fn padding_of_short_frames_is_not_payload() {
    let (mut interface, cable) = interface();
    let padded = [&DATAGRAM[..], &[0xa5; 15]].concat();
    assert_eq!(
        received(&mut interface, &cable, &padded).as_deref(),
        Some(&b"hi!"[..])
    );
}

#[test]
fn frames_that_lie_about_their_length_are_refused() {
    let (mut interface, cable) = interface();
    let frames = [
        patched(&DATAGRAM, 38, &[0, 200]), // the UDP length is longer than the frame
        patched(&DATAGRAM, 38, &[0, 7]),   // and shorter than its own header
        patched(&DATAGRAM, 44, b"?"),      // the UDP checksum does not match
        patched(&DATAGRAM, 24, &[0xFF]),   // the IPv4 checksum does not match
        patched(&DATAGRAM, 36, &[0x45, 0xE6]), // another port
    ];
    for (malformed, frame) in (1..).zip(frames) {
        assert_eq!(received(&mut interface, &cable, &frame), None);
        assert_eq!(interface.malformed(), malformed);
    }
    // Not even recognisable as UDP for this core: dropped, not counted.
    for frame in [
        patched(&DATAGRAM, 16, &[4, 0]), // the IPv4 length is longer than the frame
        patched(&DATAGRAM, 14, &[0x4F]), // header options beyond the end
        patched(&DATAGRAM, 0, &[0]),     // for another Ethernet address
        patched(&DATAGRAM, 33, &[16]),   // for another IPv4 address
        patched(&DATAGRAM, 23, &[6]),    // TCP
        DATAGRAM[..13].to_vec(),
        vec![],
    ] {
        assert_eq!(received(&mut interface, &cable, &frame), None);
    }
    assert_eq!(interface.malformed(), 5);
}

#[test]
fn the_own_chatter_of_a_network_is_skipped() {
    let (mut interface, cable) = interface();
    cable.to_core.borrow_mut().extend(vec![ARP_REQUEST.to_vec(); 3]);
    assert_eq!(
        received(&mut interface, &cable, &DATAGRAM).as_deref(),
        Some(&b"hi!"[..])
    );
}

#[test]
fn a_payload_that_no_frame_can_hold_is_refused() {
    let (mut interface, cable) = interface();
    assert_eq!(interface.send(&[0; MAX_FRAME]), Err(SendError));
    assert!(cable.from_core.take().is_empty());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(5000))]

    #[test]
    fn any_frame(frame in prop::collection::vec(any::<u8>(), 0..MAX_FRAME)) {
        let (mut interface, cable) = interface();
        received(&mut interface, &cable, &frame);
    }

    #[test]
    fn damaged_frames(
        damage in prop::collection::vec((0usize..42, any::<u8>()), 1..5), cut in 0usize..10, arp: bool,
    ) {
        let mut frame = if arp { ARP_REQUEST.to_vec() } else { DATAGRAM.to_vec() };
        for (at, byte) in damage {
            frame[at] = byte;
        }
        frame.truncate(frame.len() - cut);
        let (mut interface, cable) = interface();
        received(&mut interface, &cable, &frame);
    }
}
