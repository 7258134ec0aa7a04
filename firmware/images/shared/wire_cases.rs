//! Packets of every kind, there and back: the same text runs on a core and on the host, and must give the same bytes.

use core::num::NonZeroU8;

use fixedmath::random::Lcg64;
use wire::boot::{PixelOrder, Termination};
use wire::{
    Boot, Command, Farewell, FromCore, Hello, MAX_PAYLOAD, MAX_PIXELS, Message, Name, PixelSums, Pixels,
    SUM_MAX, ToCore,
};

/// Drawn packets of each kind.
const CASES: u32 = 2_000;

/// What an encoding is fed to: FNV-1a of 64 bits.
struct Hash(u64);

impl Hash {
    fn feed(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}

/// The hash of all encodings, each of which has been decoded again.
pub(crate) fn transcript() -> Result<u64, &'static str> {
    let mut hash = Hash(0xcbf2_9ce4_8422_2325);
    let mut random = Lcg64::new(5);
    for _ in 0..CASES {
        commands(&mut random, &mut hash)?;
        messages(&mut random, &mut hash)?;
        boot_blocks(&mut random, &mut hash)?;
    }
    Ok(hash.0)
}

fn commands(random: &mut Lcg64, hash: &mut Hash) -> Result<(), &'static str> {
    let mut word = || random.next_fraction();
    let first = word();
    let lease = Command::Lease {
        number: word() as u16,
        first,
        count: (word() >> 8).clamp(1, u32::MAX - first),
    };
    for command in [lease, Command::Stop] {
        let packet = ToCore {
            core: word() as u16,
            session: word(),
            command,
        };
        let mut bytes = [0; MAX_PAYLOAD];
        let len = packet.encode(&mut bytes);
        hash.feed(&bytes[..len]);
        if ToCore::decode(&bytes[..len]) != Ok(packet) {
            return Err("a command comes back as another");
        }
        if ToCore::decode(&bytes[..len - 1]).is_ok() {
            return Err("a command cut short is taken");
        }
    }
    Ok(())
}

fn messages(random: &mut Lcg64, hash: &mut Hash) -> Result<(), &'static str> {
    let mut word = || random.next_fraction();
    let mut sums = [[0; 3]; MAX_PIXELS];
    let pixels = 1 + word() as usize % MAX_PIXELS;
    for sum in sums.iter_mut().flatten() {
        *sum = (u64::from(word()) << 32 | u64::from(word())) & SUM_MAX;
    }
    let pixels = Pixels {
        unit: word(),
        epoch: word() as u16,
        samples: 4 + 4 * (word() % 1024) as u16,
        scene: word(),
        ticks: word(),
        rays: word(),
        sums: PixelSums::new(&sums[..pixels]).map_err(|error| error.as_str())?,
    };
    let hello = Hello {
        version: wire::VERSION,
        scene: word(),
        board: Name::new("some board"),
        profile: Name::new("precise"),
    };
    let farewell = Farewell {
        rejected: word(),
        stack_used: word(),
        stack_size: word(),
    };
    for message in [
        Message::Hello(hello),
        Message::Pixels(pixels),
        Message::Farewell(farewell),
    ] {
        let packet = FromCore {
            core: word() as u16,
            seq: word() as u16,
            session: word(),
            message,
        };
        let mut bytes = [0; MAX_PAYLOAD];
        let len = packet.encode(&mut bytes);
        hash.feed(&bytes[..len]);
        if FromCore::decode(&bytes[..len]) != Ok(packet) {
            return Err("a message comes back as another");
        }
        if FromCore::decode(&bytes[..len - 1]).is_ok() {
            return Err("a message cut short is taken");
        }
    }
    Ok(())
}

fn boot_blocks(random: &mut Lcg64, hash: &mut Hash) -> Result<(), &'static str> {
    let mut word = || random.next_fraction();
    let (mut camera, mut scene) = ([0; 37], [0; 64]);
    camera.fill_with(|| word() as u8);
    scene.fill_with(|| word() as u8);
    let cores = 1 + word() as u16 % 1000;
    let boot = Boot {
        core: word() as u16 % cores,
        cores,
        session: word(),
        epoch: word() as u16,
        width: 1 + word() as u16 % 1000,
        height: 1 + word() as u16 % 1000,
        samples_per_unit: 64,
        spp: 64 * (1 + word() % 64),
        seed: u64::from(word()) << 32 | u64::from(word()),
        epsilon: (word() >> 12) as i32,
        termination: NonZeroU8::new(word() as u8).map_or(Termination::Roulette, Termination::Depth),
        order: PixelOrder::Stochastic,
        profile: Name::new("paper"),
        collector: word().to_be_bytes(),
        port: 17893,
        address: word().to_be_bytes(),
        camera: &camera,
        scene: &scene,
    };
    let mut bytes = [0; 256];
    let len = boot
        .encode(&mut bytes)
        .map_err(|_| "a small boot block does not fit")?;
    hash.feed(&bytes[..len]);
    if Boot::decode(&bytes[..len]) != Ok(boot) {
        return Err("a boot block comes back as another");
    }
    bytes[len - 1] ^= 1;
    if Boot::decode(&bytes[..len]).is_ok() {
        return Err("a damaged boot block is taken");
    }
    Ok(())
}
