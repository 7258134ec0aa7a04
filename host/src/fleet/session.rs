//! One run of a fleet: what its cores, its boot blocks and its collector agree on.

use std::hash::{BuildHasher, RandomState};
use std::num::NonZeroU8;

use tracer::unit::{Plan, Termination};
use wire::boot::{self, PixelOrder, TooLong};
use wire::{Boot, Name};

use crate::scene::CompiledScene;

/// What all cores of one run share.
#[derive(Clone, Debug)]
pub struct Session {
    /// Told apart from other runs by this number; packets of others are rejected.
    pub id: u32,
    /// Cores in the fleet, numbered from 0.
    pub cores: u16,
    /// The compiled camera.
    pub camera: Vec<u8>,
    /// The compiled scene.
    pub scene: Vec<u8>,
    /// The scene's id, as cores repeat it.
    pub scene_id: u32,
    /// Cores' radiance is the scene's times 2^exponent.
    pub exponent: i32,
    /// The camera's epoch.
    pub epoch: u16,
    /// The picture and how it is cut into units.
    pub plan: Plan,
    /// In which order cores take their units.
    pub order: PixelOrder,
    /// The arithmetic profile.
    pub profile: Name,
}

/// Where cores reach the collector, and under which address of their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Route {
    /// The collector's IPv4 address as the cores see it.
    pub collector: [u8; 4],
    /// The collector's UDP port.
    pub port: u16,
    /// Every core's own address; with more than one core in the same network, `first + core number`.
    pub first_address: [u8; 4],
    /// Whether the cores share one network.
    pub shared: bool,
}

impl Route {
    /// Each core behind its own QEMU user-mode network, where 10.0.2.2 is the host's loopback.
    pub const fn qemu(port: u16) -> Self {
        Self {
            collector: [10, 0, 2, 2],
            port,
            first_address: [10, 0, 2, 15],
            shared: false,
        }
    }

    /// Cores that are threads of this host.
    pub const fn loopback(port: u16) -> Self {
        Self {
            collector: [127, 0, 0, 1],
            port,
            first_address: [127, 0, 0, 1],
            shared: false,
        }
    }

    fn address(&self, core: u16) -> [u8; 4] {
        let offset = if self.shared { u32::from(core) } else { 0 };
        u32::from_be_bytes(self.first_address)
            .wrapping_add(offset)
            .to_be_bytes()
    }
}

/// Bytes of a core's data memory that the boot block of a scene takes.
pub fn boot_block_len(scene: &CompiledScene) -> usize {
    boot::encoded_len(size_of_val(&scene.camera), scene.blob.bytes().len())
}

impl Session {
    /// A number for a new run that no other run is likely to have.
    pub fn fresh_id() -> u32 {
        RandomState::new().hash_one(std::process::id()) as u32
    }

    /// What core number `core` is told before it starts.
    ///
    /// # Panics
    /// If paths are to end at depth 0.
    pub fn boot(&self, core: u16, route: &Route) -> Boot<'_> {
        Boot {
            core,
            cores: self.cores,
            session: self.id,
            epoch: self.epoch,
            width: self.plan.width,
            height: self.plan.height,
            samples_per_unit: self.plan.samples_per_unit,
            spp: self.plan.spp,
            seed: self.plan.seed,
            epsilon: self.plan.epsilon.to_bits(),
            termination: match self.plan.termination {
                Termination::Roulette => boot::Termination::Roulette,
                Termination::Depth(depth) => {
                    boot::Termination::Depth(NonZeroU8::new(depth).expect("a depth is at least 1"))
                }
            },
            order: self.order,
            profile: self.profile,
            collector: route.collector,
            port: route.port,
            address: route.address(core),
            camera: &self.camera,
            scene: &self.scene,
        }
    }

    /// The encoded boot block of core number `core`.
    pub fn boot_block(&self, core: u16, route: &Route) -> Result<Vec<u8>, TooLong> {
        let boot = self.boot(core, route);
        let mut block = vec![0; boot.encoded_len()];
        boot.encode(&mut block)?;
        Ok(block)
    }

    /// Samples of the whole picture.
    pub fn samples(&self) -> u64 {
        u64::from(self.plan.width) * u64::from(self.plan.height) * u64::from(self.plan.spp)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use fixedmath::I16F16;

    use super::*;

    /// A small session for tests: 32 x 10 pixels are 20 runs, 8 samples in units of 4 make 2 passes.
    pub(crate) fn small(cores: u16, order: PixelOrder) -> Session {
        let scene = b"not a scene, but nobody here looks".to_vec();
        Session {
            id: 0x5eed_0001,
            cores,
            camera: b"a camera".to_vec(),
            scene_id: wire::crc32(&scene),
            scene,
            exponent: 0,
            epoch: 0,
            plan: Plan {
                width: 32,
                height: 10,
                spp: 8,
                samples_per_unit: 4,
                seed: 1,
                termination: Termination::Depth(5),
                epsilon: I16F16::from_bits(16),
            },
            order,
            profile: Name::new("precise"),
        }
    }

    #[test]
    fn the_boot_block_carries_the_session() {
        let session = small(300, PixelOrder::Leased);
        let block = session.boot_block(259, &Route::qemu(17893)).expect("it fits");
        let boot = Boot::decode(&block).expect("it decodes");
        assert_eq!(boot, session.boot(259, &Route::qemu(17893)));
        assert_eq!(
            (boot.core, boot.cores, boot.samples_per_unit, boot.camera),
            (259, 300, 4, &session.camera[..])
        );
        assert_eq!((boot.collector, boot.address), ([10, 0, 2, 2], [10, 0, 2, 15]));
        assert_eq!(boot.scene_id(), session.scene_id);
    }

    #[test]
    fn cores_in_one_network_have_addresses_of_their_own() {
        let route = Route {
            collector: [192, 168, 0, 1],
            port: 1,
            first_address: [192, 168, 0, 250],
            shared: true,
        };
        assert_eq!(route.address(5), [192, 168, 0, 255]);
        assert_eq!(route.address(6), [192, 168, 1, 0]);
    }

    #[test]
    fn a_scene_that_does_not_fit_is_refused() {
        let session = Session {
            scene: vec![0; wire::boot::MAX_LEN],
            ..small(1, PixelOrder::Leased)
        };
        assert_eq!(session.boot_block(0, &Route::qemu(1)), Err(TooLong));
    }
}
