//! Decoding is total, and what decodes encodes again to the same bytes.

use std::num::NonZeroU8;

use proptest::prelude::*;
use wire::boot::{self, PixelOrder, Termination};
use wire::{
    Boot, Command, Farewell, FaultInfo, FromCore, Hello, MAX_PAYLOAD, MAX_SAMPLES, Message, Name, PixelSums,
    Pixels, SUM_MAX, ToCore,
};

/// Checks one payload against both decoders.
fn total(payload: &[u8]) {
    let mut out = [0xa5; MAX_PAYLOAD];
    if let Ok(packet) = FromCore::decode(payload) {
        let len = packet.encode(&mut out);
        same_but_for_flags_and_tag(&out[..len], payload);
    }
    if let Ok(packet) = ToCore::decode(payload) {
        let len = packet.encode(&mut out);
        same_but_for_flags_and_tag(&out[..len], payload);
    }
}

fn same_but_for_flags_and_tag(ours: &[u8], theirs: &[u8]) {
    assert_eq!(ours.len(), theirs.len());
    assert_eq!((&ours[..2], &ours[4..]), (&theirs[..2], &theirs[4..]));
}

fn name() -> impl Strategy<Value = Name> {
    "[!-~]{0,12}".prop_map(|name| Name::new(&name))
}

fn sums() -> impl Strategy<Value = PixelSums> {
    let sum = prop_oneof![0..=SUM_MAX, Just(0), Just(SUM_MAX)];
    prop::collection::vec(prop::array::uniform3(sum), 1..=16).prop_map(|sums| PixelSums::new(&sums).unwrap())
}

prop_compose! {
    fn pixels()(
        unit: u32, epoch: u16, quads in 1..=MAX_SAMPLES / 4, scene: u32,
        ticks: u32, rays: u32, sums in sums(),
    ) -> Pixels {
        Pixels { unit, epoch, samples: 4 * quads, scene, ticks, rays, sums }
    }
}

prop_compose! {
    fn hello()(version: u16, scene: u32, board in name(), profile in name()) -> Hello {
        Hello { version, scene, board, profile }
    }
}

prop_compose! {
    fn farewell()(rejected: u32, stack_used: u32, stack_size: u32) -> Farewell {
        Farewell { rejected, stack_used, stack_size }
    }
}

prop_compose! {
    fn fault()(
        address: Option<u32>, reason in prop_oneof![Just(""), Just("panicked at unit.rs:7"), Just("µ")],
    ) -> FaultInfo<'static> {
        FaultInfo { address, reason }
    }
}

fn message() -> impl Strategy<Value = Message<'static>> {
    prop_oneof![
        hello().prop_map(Message::Hello),
        pixels().prop_map(Message::Pixels),
        farewell().prop_map(Message::Farewell),
        fault().prop_map(Message::Fault),
    ]
}

fn command() -> impl Strategy<Value = Command> {
    let lease = (any::<u16>(), any::<u32>(), 1u32..).prop_filter_map(
        "the last unit's id must fit",
        |(number, first, count)| {
            first
                .checked_add(count - 1)
                .map(|_| Command::Lease { number, first, count })
        },
    );
    prop_oneof![lease, Just(Command::Stop)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn any_bytes(payload in prop::collection::vec(any::<u8>(), 0..300)) {
        total(&payload);
    }

    /// Noise alone seldom gets past the headers: valid packets with some bytes changed and cut go deeper.
    #[test]
    fn damaged_packets(
        core: u16, seq: u16, session: u32, message in message(), command in command(),
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..4), cut in 0usize..4,
    ) {
        for towards_host in [true, false] {
            let mut out = [0xa5; MAX_PAYLOAD];
            let len = if towards_host {
                FromCore { core, seq, session, message }.encode(&mut out)
            } else {
                ToCore { core, session, command }.encode(&mut out)
            };
            for (at, byte) in &damage {
                out[at.index(len)] = *byte;
            }
            total(&out[..len - cut]);
        }
    }

    #[test]
    fn packets_from_cores_return(core: u16, seq: u16, session: u32, message in message()) {
        let packet = FromCore { core, seq, session, message };
        let mut out = [0xa5; MAX_PAYLOAD];
        let len = packet.encode(&mut out);
        prop_assert!(len <= MAX_PAYLOAD);
        prop_assert_eq!(FromCore::decode(&out[..len]), Ok(packet));
    }

    #[test]
    fn packets_to_cores_return(core: u16, session: u32, command in command()) {
        let packet = ToCore { core, session, command };
        let mut out = [0xa5; MAX_PAYLOAD];
        let len = packet.encode(&mut out);
        prop_assert_eq!(ToCore::decode(&out[..len]), Ok(packet));
    }

    #[test]
    fn sums_return(sums in prop::collection::vec(prop::array::uniform3(0..=SUM_MAX), 1..=16)) {
        let packed = PixelSums::new(&sums).unwrap();
        prop_assert_eq!(packed.iter().collect::<Vec<_>>(), sums);
    }

    #[test]
    fn any_memory(memory in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = Boot::decode(&memory);
    }

    /// With the checksum put right, so that the checks behind it are reached.
    #[test]
    fn any_boot_header(mut header in prop::array::uniform32(any::<u8>()), tail in prop::collection::vec(any::<u8>(), 48)) {
        header[..8].copy_from_slice(b"PTBB\x03\0\x50\0");
        let mut memory = [&header[..], &tail].concat();
        let checksum = wire::crc32(&memory[..76]).to_le_bytes();
        memory[76..].copy_from_slice(&checksum);
        if let Ok(boot) = Boot::decode(&memory) {
            prop_assert!(boot.core < boot.cores);
        }
    }

    #[test]
    fn boot_blocks_return(
        core in 0u16..100, more in 1u16..100, session: u32, epoch: u16, size in (1u16..600, 1u16..600),
        quads in (1..=MAX_SAMPLES / 4, 1u32..10_000), seed: u64, epsilon in 0..=i32::MAX, depth: u8, profile in name(),
        port in 1u16.., camera in prop::collection::vec(any::<u8>(), 0..100), scene in prop::collection::vec(any::<u8>(), 0..600),
    ) {
        let boot = Boot {
            core, cores: core + more, session, epoch, width: size.0, height: size.1, samples_per_unit: 4 * quads.0,
            spp: 4 * quads.1, seed, epsilon, termination: NonZeroU8::new(depth).map_or(Termination::Roulette, Termination::Depth),
            order: PixelOrder::Sequential, profile, collector: [10, 0, 2, 2], port, address: [10, 0, 2, 15],
            camera: &camera, scene: &scene,
        };
        let mut memory = [0xa5; boot::MAX_LEN];
        prop_assert_eq!(boot.encode(&mut memory), Ok(boot.encoded_len()));
        prop_assert_eq!(Boot::decode(&memory), Ok(boot));
    }
}
