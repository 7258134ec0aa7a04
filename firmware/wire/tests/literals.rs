//! Every packet, byte for byte. Buffers are filled with 0xa5 first, so a byte that an encoder forgets shows.

use std::num::NonZeroU8;

use wire::boot::{self, PixelOrder, Termination};
use wire::{
    Boot, Command, Farewell, FaultInfo, FromCore, Hello, MAX_PAYLOAD, Message, Name, PixelSums, Pixels,
    ToCore,
};

const SESSION: u32 = 0x5E55_1041;

/// Encodes, compares, checks that nothing behind was touched, and decodes again.
fn from_core(packet: FromCore<'_>, expected: &[u8]) {
    let mut out = [0xa5; MAX_PAYLOAD];
    let len = packet.encode(&mut out);
    assert_eq!(out[..len], *expected);
    assert!(out[len..].iter().all(|&byte| byte == 0xa5));
    assert_eq!(FromCore::decode(expected), Ok(packet));
}

fn to_core(packet: ToCore, expected: &[u8]) {
    let mut out = [0xa5; MAX_PAYLOAD];
    let len = packet.encode(&mut out);
    assert_eq!(out[..len], *expected);
    assert!(out[len..].iter().all(|&byte| byte == 0xa5));
    assert_eq!(ToCore::decode(expected), Ok(packet));
}

#[test]
fn hello() {
    let message = Message::Hello(Hello {
        version: 1,
        scene: 0xDEAD_BEEF,
        board: Name::new("versatilepb"),
        profile: Name::new("precise"),
    });
    #[rustfmt::skip]
    let expected = [
        0, 0,
        0x07, 0x01, 0xFF, 0x21, 0, 0, 0, 0,
        0x01, 0x01, 0x34, 0x12,
        0x41, 0x10, 0x55, 0x5E, 1, 0, 0, 0, 0xEF, 0xBE, 0xAD, 0xDE,
        b'v', b'e', b'r', b's', b'a', b't', b'i', b'l', b'e', b'p', b'b', 0,
        b'p', b'r', b'e', b'c', b'i', b's', b'e', 0, 0, 0, 0, 0,
    ];
    from_core(
        FromCore {
            core: 0,
            seq: 0x1234,
            session: SESSION,
            message,
        },
        &expected,
    );
}

#[test]
fn pixels() {
    let message = Message::Pixels(Pixels {
        unit: 0x0102_0304,
        epoch: 9,
        samples: 64,
        scene: 0xDEAD_BEEF,
        ticks: 0x0A0B_0C0D,
        rays: 6789,
        sums: PixelSums::new(&[[0x01_0203_0405, 0, wire::SUM_MAX], [1, 2, 3]]).unwrap(),
    });
    // Core 17 * 256 + 4 lives in row 1, column 0, on processor 5.
    #[rustfmt::skip]
    let expected = [
        0, 0,
        0x07, 0x01, 0xFF, 0x25, 0, 0, 1, 0,
        0x02, 0x01, 0xFF, 0xFF,
        0x41, 0x10, 0x55, 0x5E, 0x04, 0x03, 0x02, 0x01, 9, 0, 64, 0,
        0xEF, 0xBE, 0xAD, 0xDE, 0x0D, 0x0C, 0x0B, 0x0A, 0x85, 0x1A, 0, 0,
        0x05, 0x04, 0x03, 0x02, 0x01, 0, 0, 0, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF,
        1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0, 0, 0, 0,
    ];
    from_core(
        FromCore {
            core: 17 * 256 + 4,
            seq: 0xFFFF,
            session: SESSION,
            message,
        },
        &expected,
    );
}

#[test]
fn farewell() {
    let message = Message::Farewell(Farewell {
        rejected: 3,
        stack_used: 0x0AF0,
        stack_size: 0x4000,
    });
    #[rustfmt::skip]
    let expected = [
        0, 0,
        0x07, 0x01, 0xFF, 0x31, 0, 0, 0, 0,
        0x03, 0x01, 0xF4, 0x01,
        0x41, 0x10, 0x55, 0x5E, 3, 0, 0, 0,
        0xF0, 0x0A, 0, 0, 0, 0x40, 0, 0,
    ];
    from_core(
        FromCore {
            core: 16,
            seq: 500,
            session: SESSION,
            message,
        },
        &expected,
    );
}

#[test]
fn fault() {
    #[rustfmt::skip]
    let expected = [
        0, 0,
        0x07, 0x01, 0xFF, 0x21, 0, 0, 0, 1,
        0x04, 0x01, 0, 0,
        0x41, 0x10, 0x55, 0x5E, 0, 0, 0, 0, 0, 0, 0, 0,
        b'b', b'a', b'd', b' ', 0xC3, 0xA9,
    ];
    from_core(
        FromCore {
            core: 17,
            seq: 0,
            session: SESSION,
            message: Message::Fault(FaultInfo {
                address: None,
                reason: "bad é",
            }),
        },
        &expected,
    );
}

#[test]
fn fault_at_an_address() {
    #[rustfmt::skip]
    let expected = [
        0, 0,
        0x07, 0x01, 0xFF, 0x21, 0, 0, 0, 0,
        0x04, 0x01, 0, 0,
        0x41, 0x10, 0x55, 0x5E, 0x34, 0x1A, 0, 0, 1, 0, 0, 0,
        b'n', b'o',
    ];
    from_core(
        FromCore {
            core: 0,
            seq: 0,
            session: SESSION,
            message: Message::Fault(FaultInfo {
                address: Some(0x1A34),
                reason: "no",
            }),
        },
        &expected,
    );
}

#[test]
fn lease() {
    #[rustfmt::skip]
    let expected = [
        0, 0,
        0x07, 0xFF, 0x22, 0xFF, 0, 2, 0, 0,
        0x01, 0x02, 0x07, 0x00,
        0x41, 0x10, 0x55, 0x5E, 0x00, 0x10, 0, 0, 8, 0, 0, 0,
    ];
    let command = Command::Lease {
        number: 7,
        first: 4096,
        count: 8,
    };
    to_core(
        ToCore {
            core: 35,
            session: SESSION,
            command,
        },
        &expected,
    );
}

#[test]
fn stop() {
    #[rustfmt::skip]
    let expected = [
        0, 0,
        0x07, 0xFF, 0x2F, 0xFF, 0x0F, 0x0E, 0, 0,
        0x02, 0x02, 0, 0,
        0x41, 0x10, 0x55, 0x5E, 0, 0, 0, 0, 0, 0, 0, 0,
    ];
    // The last core that a u16 can number: chip 3854.
    to_core(
        ToCore {
            core: 3854 * 17 + 14,
            session: SESSION,
            command: Command::Stop,
        },
        &expected,
    );
}

#[test]
fn boot_block() {
    let block = Boot {
        core: 2,
        cores: 4,
        session: SESSION,
        epoch: 1,
        width: 256,
        height: 192,
        samples_per_unit: 64,
        spp: 1024,
        seed: 0x0123_4567_89AB_CDEF,
        epsilon: 16,
        termination: Termination::Depth(NonZeroU8::new(5).unwrap()),
        order: PixelOrder::Stochastic,
        profile: Name::new("precise"),
        collector: [10, 0, 2, 2],
        port: wire::DEFAULT_PORT,
        address: [10, 0, 2, 15],
        camera: b"camera",
        scene: b"123456789",
    };
    #[rustfmt::skip]
    let expected = [
        b'P', b'T', b'B', b'B', 3, 0, 80, 0,
        2, 0, 4, 0,
        0x41, 0x10, 0x55, 0x5E,
        0x26, 0x39, 0xF4, 0xCB,
        1, 0, 0x00, 0x01, 0xC0, 0x00, 64, 0,
        0x00, 0x04, 0, 0,
        0xEF, 0xCD, 0xAB, 0x89, 0x67, 0x45, 0x23, 0x01,
        16, 0, 0, 0,
        5, 2, 0xE5, 0x45,
        b'p', b'r', b'e', b'c', b'i', b's', b'e', 0, 0, 0, 0, 0,
        10, 0, 2, 2,
        10, 0, 2, 15,
        // CRC-32 of the camera, computed with Python's zlib as the one below.
        0x05, 0xEE, 0x1C, 0x3B,
        6, 0, 9, 0,
        // CRC-32 of the 76 bytes before.
        0xA0, 0xD1, 0x98, 0xC6,
        b'c', b'a', b'm', b'e', b'r', b'a', 0, 0,
        b'1', b'2', b'3', b'4', b'5', b'6', b'7', b'8', b'9',
    ];
    let mut out = [0xa5; boot::MAX_LEN];
    let len = block.encode(&mut out).unwrap();
    assert_eq!(out[..len], expected);
    assert!(out[len..].iter().all(|&byte| byte == 0xa5));
    // A memory is longer than what was loaded into it.
    assert_eq!(Boot::decode(&out), Ok(block));
    assert_eq!(block.mac(), [2, 0, 0, 0, 0, 2]);
}

/// The check value that every catalogue of CRCs gives.
#[test]
fn crc32_check_value() {
    assert_eq!(wire::crc32(b"123456789"), 0xCBF4_3926);
    assert_eq!(wire::crc32(b""), 0);
}
