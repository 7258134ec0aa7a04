//! What a decoder must refuse, and with which error.

use wire::boot::{self, PixelOrder, Termination};
use wire::{
    Boot, Command, DecodeError, FaultInfo, FromCore, MAX_PAYLOAD, Message, Name, PixelSums, Pixels,
    SumsError, ToCore,
};

fn pixels_packet() -> Vec<u8> {
    let sums = PixelSums::new(&[[1, 2, 3]; 16]).unwrap();
    let message = Message::Pixels(Pixels {
        unit: 1,
        epoch: 0,
        samples: 4096,
        scene: 7,
        ticks: 1,
        rays: 1,
        sums,
    });
    let mut out = [0; MAX_PAYLOAD];
    let len = FromCore {
        core: 3,
        seq: 0,
        session: 9,
        message,
    }
    .encode(&mut out);
    out[..len].to_vec()
}

/// The packet with `bytes` put at `offset`.
fn patched(packet: &[u8], offset: usize, bytes: &[u8]) -> Vec<u8> {
    let mut packet = packet.to_vec();
    packet[offset..offset + bytes.len()].copy_from_slice(bytes);
    packet
}

#[test]
fn a_full_packet_is_not_longer_than_allowed() {
    assert_eq!(pixels_packet().len(), 38 + 16 * 15);
    assert!(pixels_packet().len() <= MAX_PAYLOAD);
}

#[test]
fn every_cut_of_a_packet_is_refused() {
    let packet = pixels_packet();
    // But where a whole number of pixels is left: a datagram is not cut, and its checksum would tell.
    let whole = |len: usize| len > 38 && (len - 38).is_multiple_of(15);
    for len in (0..packet.len()).filter(|&len| !whole(len)) {
        assert_eq!(
            FromCore::decode(&packet[..len]),
            Err(DecodeError::Truncated),
            "{len} bytes"
        );
    }
    let longer = [packet.as_slice(), &[0]].concat();
    assert_eq!(FromCore::decode(&longer), Err(DecodeError::TooLong));
}

#[test]
fn headers_are_checked() {
    let packet = pixels_packet();
    let refused = |offset, bytes: &[u8], error| {
        assert_eq!(
            FromCore::decode(&patched(&packet, offset, bytes)),
            Err(error),
            "offset {offset}: {bytes:?}"
        );
    };
    refused(1, &[1], DecodeError::Padding);
    refused(4, &[0x21], DecodeError::Address); // not for the host
    refused(6, &[1], DecodeError::Address); // not for the host's chip
    refused(5, &[0x20], DecodeError::Address); // from a monitor processor
    refused(5, &[0x32], DecodeError::Address); // from processor 18
    refused(5, &[0x41], DecodeError::Address); // from port 2
    refused(8, &[0x0F, 0x0F], DecodeError::Address); // core 65552 does not exist
    refused(10, &[0x01, 0x02], DecodeError::Command(0x0201)); // a lease goes the other way
    refused(10, &[0, 0], DecodeError::Command(0));
}

#[test]
fn flags_and_tag_are_the_routers_business() {
    let packet = pixels_packet();
    assert_eq!(
        FromCore::decode(&patched(&packet, 2, &[0x87, 0x05])),
        FromCore::decode(&packet)
    );
}

#[test]
fn pixel_and_sample_counts_are_checked() {
    let packet = pixels_packet();
    let refused = |offset, bytes: &[u8], error| {
        assert_eq!(
            FromCore::decode(&patched(&packet, offset, bytes)),
            Err(error),
            "offset {offset}: {bytes:?}"
        );
    };
    refused(24, &[0, 0], DecodeError::Range); // no samples
    refused(24, &[6, 0], DecodeError::Range); // not a multiple of the 2x2 sub-pixels
    refused(24, &[0x04, 0x10], DecodeError::Range); // 4100: the sums could overflow
    let of_pixels = |pixels: usize| FromCore::decode(&packet[..38 + 15 * pixels]).map(|_| ());
    assert_eq!(of_pixels(0), Err(DecodeError::Truncated));
    assert_eq!(of_pixels(1), Ok(()));
    assert_eq!(
        FromCore::decode(&packet[..38 + 14]),
        Err(DecodeError::Truncated),
        "half a pixel"
    );
    let one_more = [&packet[..], &[0; 15]].concat();
    assert_eq!(FromCore::decode(&one_more), Err(DecodeError::TooLong));
}

#[test]
fn sums_that_do_not_fit_are_the_greatest_there_is_and_say_so() {
    assert!(PixelSums::new(&[[wire::SUM_MAX; 3]; 16]).is_ok());
    // Not what is left of them in 40 bits.
    for sum in [
        wire::SUM_MAX - 1,
        wire::SUM_MAX,
        wire::SUM_MAX + 1,
        1 << 48,
        u64::MAX,
    ] {
        let sent = PixelSums::new(&[[0, sum, 0]]).expect("a pixel");
        assert_eq!(sent.iter().next(), Some([0, sum.min(wire::SUM_MAX), 0]));
    }
    assert_eq!(PixelSums::new(&[[0; 3]; 17]), Err(SumsError::Pixels));
    assert_eq!(PixelSums::new(&[]), Err(SumsError::Pixels));
}

/// The brightest picture the issue asks for, and the brightest the scene format allows.
#[test]
fn the_brightest_picture_fits() {
    for radiance in [12, 4095] {
        let sum = (radiance * u64::from(wire::MAX_SAMPLES)) << 16;
        let sums = PixelSums::new(&[[sum; 3]; 16]).unwrap();
        assert!(sums.iter().all(|pixel| pixel == [sum; 3]));
    }
}

#[test]
fn leases_are_checked() {
    let mut out = [0; MAX_PAYLOAD];
    let encoded = |command, out: &mut [u8; MAX_PAYLOAD]| {
        ToCore {
            core: 0,
            session: 1,
            command,
        }
        .encode(out)
    };
    let lease = |first, count| Command::Lease {
        number: 1,
        first,
        count,
    };

    let len = encoded(lease(5, 0), &mut out);
    assert_eq!(ToCore::decode(&out[..len]), Err(DecodeError::Range));
    let len = encoded(lease(u32::MAX, 2), &mut out);
    assert_eq!(ToCore::decode(&out[..len]), Err(DecodeError::Range));
    let len = encoded(lease(u32::MAX, 1), &mut out);
    assert!(ToCore::decode(&out[..len]).is_ok());
    assert_eq!(ToCore::decode(&out[..len + 1]), Err(DecodeError::TooLong));
    assert_eq!(FromCore::decode(&out[..len]), Err(DecodeError::Address));
}

fn fault_packet(address: Option<u32>, words: &str) -> Vec<u8> {
    let mut out = [0; MAX_PAYLOAD];
    let len = FromCore {
        core: 0,
        seq: 0,
        session: 0,
        message: Message::Fault(FaultInfo {
            address,
            reason: words,
        }),
    }
    .encode(&mut out);
    out[..len].to_vec()
}

#[test]
fn last_words_are_cut_between_characters() {
    let words = "é".repeat(200);
    let words = format!("x{words}");
    let packet = fault_packet(Some(0x1A34), &words);
    let Message::Fault(kept) = FromCore::decode(&packet).unwrap().message else {
        panic!("not a fault")
    };
    assert_eq!(kept.address, Some(0x1A34));
    assert_eq!(kept.reason.len(), 255);
    assert!(words.starts_with(kept.reason));
}

#[test]
fn the_address_of_a_fault_is_there_or_is_not() {
    let packet = fault_packet(Some(0), "!");
    assert!(
        FromCore::decode(&packet).is_ok(),
        "0 is an address like any other"
    );
    let refused = |packet: &[u8], offset, bytes: &[u8]| {
        assert_eq!(
            FromCore::decode(&patched(packet, offset, bytes)),
            Err(DecodeError::Range),
            "offset {offset}: {bytes:?}"
        );
    };
    refused(&packet, 22, &[2]); // neither known nor unknown
    refused(&packet, 25, &[1]);
    refused(&fault_packet(None, "!"), 18, &[1]); // an address that nobody knows
    refused(&fault_packet(None, "!"), 21, &[1]);
    let unreadable = patched(&packet, 26, &[0xFF]);
    assert_eq!(FromCore::decode(&unreadable), Err(DecodeError::Text));
}

#[test]
fn names_are_cut_and_kept_printable() {
    assert_eq!(Name::new("versatilepb").as_str(), "versatilepb");
    assert_eq!(Name::new("exactly-12-c").as_str(), "exactly-12-c");
    assert_eq!(Name::new("a name that is too long").as_str(), "a?name?that?");
    assert_eq!(Name::new("").as_str(), "");
}

/// Not a multiple of 8 bytes: zeros follow it.
const CAMERA: &[u8; 13] = b"not a picture";
const SCENE_AT: usize = boot::HEADER_LEN + 16;

fn block(scene: &[u8]) -> Boot<'_> {
    Boot {
        core: 0,
        cores: 1,
        session: 1,
        epoch: 0,
        width: 64,
        height: 48,
        samples_per_unit: 64,
        spp: 64,
        seed: 1,
        epsilon: 16,
        termination: Termination::Roulette,
        order: PixelOrder::Leased,
        profile: Name::new("paper"),
        collector: [10, 0, 2, 2],
        port: 17893,
        address: [10, 0, 2, 15],
        camera: CAMERA,
        scene,
    }
}

#[test]
fn boot_blocks_out_of_range_are_refused() {
    let refused = |what: &str, change: fn(&mut Boot<'_>)| {
        let mut boot = block(b"scene");
        change(&mut boot);
        let mut out = [0; boot::MAX_LEN];
        boot.encode(&mut out).unwrap();
        assert_eq!(Boot::decode(&out), Err(DecodeError::Range), "{what}");
    };
    refused("a core outside the fleet", |boot| boot.core = 1);
    refused("no columns", |boot| boot.width = 0);
    refused("no rows", |boot| boot.height = 0);
    refused("no samples", |boot| boot.spp = 0);
    refused("half a 2x2 sub-pixel", |boot| boot.spp = 6);
    refused("no samples in a unit", |boot| boot.samples_per_unit = 0);
    refused("sums that could overflow", |boot| boot.samples_per_unit = 4100);
    refused("more units than ids", |boot| {
        (boot.width, boot.height, boot.spp, boot.samples_per_unit) = (65535, 65535, 68, 4);
    });
    refused("a negative epsilon", |boot| boot.epsilon = -1);
    refused("no port", |boot| boot.port = 0);
}

#[test]
fn damaged_boot_blocks_are_refused() {
    let mut out = [0; boot::MAX_LEN];
    let len = block(b"scene").encode(&mut out).unwrap();
    let out = &out[..len];

    assert_eq!(
        Boot::decode(&[0; 4096]),
        Err(DecodeError::Magic),
        "memory that nothing was loaded into"
    );
    assert_eq!(Boot::decode(&patched(out, 4, &[1])), Err(DecodeError::Version(1)));
    assert_eq!(Boot::decode(&patched(out, 6, &[84])), Err(DecodeError::Range));
    for at in 8..len {
        let damaged = patched(out, at, &[out[at] ^ 0x10]);
        let padding = boot::HEADER_LEN + CAMERA.len()..SCENE_AT;
        let expected = match padding.contains(&at) {
            true => DecodeError::Padding,
            false => DecodeError::Checksum,
        };
        assert_eq!(
            Boot::decode(&damaged),
            Err(expected),
            "a flipped bit in byte {at}"
        );
    }
    for cut in 0..len {
        assert_eq!(
            Boot::decode(&out[..cut]),
            Err(DecodeError::Truncated),
            "{cut} bytes"
        );
    }
}

#[test]
fn a_block_that_does_not_fit_is_not_written() {
    let scene = [0; boot::MAX_LEN - SCENE_AT];
    let mut out = [0; boot::MAX_LEN + 1];
    assert_eq!(block(&scene).encode(&mut out), Ok(boot::MAX_LEN));
    assert_eq!(
        block(&scene).encode(&mut out[..boot::MAX_LEN - 1]),
        Err(boot::TooLong)
    );
    assert_eq!(
        block(&[0; boot::MAX_LEN - SCENE_AT + 1]).encode(&mut out),
        Err(boot::TooLong)
    );
}

#[test]
fn camera_and_scene_are_aligned_as_the_block_is_and_apart() {
    let mut out = [0xa5; 200];
    for len in 0..=CAMERA.len() {
        let boot = Boot {
            camera: &CAMERA[..len],
            ..block(b"scene")
        };
        let end = boot.encode(&mut out).unwrap();
        let scene_at = boot::HEADER_LEN + len.next_multiple_of(boot::ALIGNMENT);
        assert_eq!(&out[scene_at..end], b"scene");
        assert_eq!(&out[boot::HEADER_LEN..][..len], boot.camera);
        assert_eq!(Boot::decode(&out), Ok(boot));
        assert_eq!(
            boot.scene_id(),
            block(b"scene").scene_id(),
            "a moved camera is the same scene"
        );
    }
}
