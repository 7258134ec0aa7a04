//! The boot block: all that a core has to know, put in its memory before it starts.
//!
//! | offset | bytes | field                                                                         |
//! | ------ | ----- | ----------------------------------------------------------------------------- |
//! | 0      | 4     | magic: the characters `PTBB`                                                  |
//! | 4      | 2     | version: [`VERSION`]                                                          |
//! | 6      | 2     | header length: 80                                                             |
//! | 8      | 2     | core: its number                                                              |
//! | 10     | 2     | cores: how many are in the fleet                                              |
//! | 12     | 4     | session                                                                       |
//! | 16     | 4     | scene id: CRC-32 of the scene                                                 |
//! | 20     | 2     | epoch: the camera's                                                           |
//! | 22     | 2     | width: in pixels                                                              |
//! | 24     | 2     | height: in pixels                                                             |
//! | 26     | 2     | samples per unit: of a pixel, in one unit; a multiple of 4, at most 4096      |
//! | 28     | 4     | spp: samples of a pixel in all, a multiple of 4                               |
//! | 32     | 8     | seed                                                                          |
//! | 40     | 4     | epsilon: of self-intersection, signed 16:16                                   |
//! | 44     | 1     | termination: 0 for roulette, else the depth                                   |
//! | 45     | 1     | order: of pixels; 0 leased, 1 sequential, 2 stochastic                        |
//! | 46     | 2     | port: the collector's, of UDP; the core sends from the same                   |
//! | 48     | 12    | profile: name of the arithmetic profile, see [`Name`]                         |
//! | 60     | 4     | collector: its IPv4 address                                                   |
//! | 64     | 4     | address: the core's own IPv4 address                                          |
//! | 68     | 4     | camera check: CRC-32 of the camera                                            |
//! | 72     | 2     | camera length: c                                                              |
//! | 74     | 2     | scene length: s                                                               |
//! | 76     | 4     | checksum: CRC-32 of the 76 bytes before                                       |
//! | 80     | c     | the camera                                                                    |
//! |        | 0-7   | zeros, so that the scene, too, begins at a multiple of 8                      |
//! |        | s     | the scene                                                                     |
//!
//! A core reads camera and scene where they lie. What they mean is the tracer's affair. The bytes after the scene do not matter: a
//! memory is longer than what was loaded into it.

use core::num::NonZeroU8;

use crate::layout::{Layout, layout};
use crate::{DecodeError, MAX_PIXELS, MAX_SAMPLES, Name, VERSION, crc32};

layout! {
    struct Header[0..80] {
        0 => magic: [u8; 4],
        4 => version: u16,
        6 => header_length: u16,
        8 => core: u16,
        10 => cores: u16,
        12 => session: u32,
        16 => scene_id: u32,
        20 => epoch: u16,
        22 => width: u16,
        24 => height: u16,
        26 => samples_per_unit: u16,
        28 => spp: u32,
        32 => seed: u64,
        40 => epsilon: i32,
        44 => termination: u8,
        45 => order: u8,
        46 => port: u16,
        48 => profile: [u8; Name::LEN],
        60 => collector: [u8; 4],
        64 => address: [u8; 4],
        68 => camera_check: u32,
        72 => camera_length: u16,
        74 => scene_length: u16,
        76 => checksum: u32,
    }
}

const MAGIC: [u8; 4] = *b"PTBB";

/// Bytes before the camera.
pub const HEADER_LEN: usize = Header::END;

/// Bytes that the header's checksum covers: all before it.
const CHECKED: usize = HEADER_LEN - size_of::<u32>();

/// What the camera and the scene are aligned to, as long as the block is: as much as the widest number in them.
pub const ALIGNMENT: usize = 8;

// The camera's place, and the lengths' fields.
const _: () = assert!(HEADER_LEN.is_multiple_of(ALIGNMENT) && MAX_LEN <= u16::MAX as usize);

/// Bytes of a board's memory kept for the boot block, and so its greatest length.
pub const MAX_LEN: usize = 0xA000;

/// In which order a core takes its units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum PixelOrder {
    /// As the host leases them.
    Leased = 0,
    /// One after the other without a lease, each core from its own share's start, wrapping.
    Sequential = 1,
    /// Drawn at random without a lease.
    Stochastic = 2,
}

/// When a path ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Termination {
    /// By Russian roulette.
    Roulette,
    /// At this depth.
    Depth(NonZeroU8),
}

/// A decoded boot block: every field has been checked as far as it can be without the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Boot<'a> {
    /// This core's number, less than `cores`.
    pub core: u16,
    /// Cores in the fleet.
    pub cores: u16,
    /// The run; a packet of another is rejected.
    pub session: u32,
    /// The camera's epoch.
    pub epoch: u16,
    /// Width in pixels.
    pub width: u16,
    /// Height in pixels.
    pub height: u16,
    /// Samples per pixel in one unit: a multiple of 4, 4 to 4096.
    pub samples_per_unit: u16,
    /// Samples per pixel in all: a multiple of 4.
    pub spp: u32,
    /// Seed of the whole render.
    pub seed: u64,
    /// Self-intersection epsilon in 16:16.
    pub epsilon: i32,
    /// When paths end.
    pub termination: Termination,
    /// In which order this core takes its units.
    pub order: PixelOrder,
    /// The arithmetic profile the image must have been built with.
    pub profile: Name,
    /// The collector's IPv4 address.
    pub collector: [u8; 4],
    /// The collector's UDP port; the core sends from the same.
    pub port: u16,
    /// The core's own IPv4 address.
    pub address: [u8; 4],
    /// The camera as the host compiled it. It is no part of the scene: one that has moved sees the same scene.
    pub camera: &'a [u8],
    /// The scene as the host compiled it.
    pub scene: &'a [u8],
}

/// The block would be longer than [`MAX_LEN`] or than the room given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLong;

impl core::fmt::Display for TooLong {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(
            f,
            "the boot block is longer than {MAX_LEN} bytes: the scene has too many objects for a core"
        )
    }
}

impl core::error::Error for TooLong {}

impl<'a> Boot<'a> {
    /// The scene's id: the CRC-32 of its bytes.
    pub fn scene_id(&self) -> u32 {
        crc32(self.scene)
    }

    /// The core's Ethernet address: locally administered, and its own in the fleet.
    pub fn mac(&self) -> [u8; 6] {
        let [high, low] = self.core.to_be_bytes();
        [0x02, 0, 0, 0, high, low]
    }

    /// Length of the encoded block.
    pub fn encoded_len(&self) -> usize {
        encoded_len(self.camera.len(), self.scene.len())
    }

    /// Writes the block and returns its length. The rest of `out` stays as it is.
    pub fn encode(&self, out: &mut [u8]) -> Result<usize, TooLong> {
        let (scene_at, len) = (scene_at(self.camera.len()), self.encoded_len());
        if len > MAX_LEN {
            return Err(TooLong);
        }
        let block = out.get_mut(..len).ok_or(TooLong)?;
        let (front, scene) = block.split_at_mut(scene_at);
        let (header, camera) = front.split_first_chunk_mut::<HEADER_LEN>().ok_or(TooLong)?;
        self.header(0).write(header);
        let checksum = crc32(&header[..CHECKED]);
        self.header(checksum).write(header);
        let (camera, padding) = camera.split_at_mut(self.camera.len());
        camera.copy_from_slice(self.camera);
        padding.fill(0);
        scene.copy_from_slice(self.scene);
        Ok(len)
    }

    fn header(&self, checksum: u32) -> Header {
        Header {
            magic: MAGIC,
            version: VERSION,
            header_length: HEADER_LEN as u16,
            core: self.core,
            cores: self.cores,
            session: self.session,
            scene_id: self.scene_id(),
            epoch: self.epoch,
            width: self.width,
            height: self.height,
            samples_per_unit: self.samples_per_unit,
            spp: self.spp,
            seed: self.seed,
            epsilon: self.epsilon,
            termination: self.termination.code(),
            order: self.order as u8,
            port: self.port,
            profile: self.profile.to_bytes(),
            collector: self.collector,
            address: self.address,
            camera_check: crc32(self.camera),
            camera_length: self.camera.len() as u16,
            scene_length: self.scene.len() as u16,
            checksum,
        }
    }

    /// Reads a block from the start of `memory`. Total: see the crate's contract of decoding.
    pub fn decode(memory: &'a [u8]) -> Result<Self, DecodeError> {
        let (fields, rest) = Header::split_aligned(memory)?;
        if fields.magic != MAGIC {
            return Err(DecodeError::Magic);
        }
        if fields.version != VERSION {
            return Err(DecodeError::Version(fields.version));
        }
        if usize::from(fields.header_length) != HEADER_LEN {
            return Err(DecodeError::Range);
        }
        if crc32(&memory[..CHECKED]) != fields.checksum {
            return Err(DecodeError::Checksum);
        }
        let camera_len = usize::from(fields.camera_length);
        let front = rest.split_at_checked(scene_at(camera_len) - HEADER_LEN);
        let (camera, rest) = front.ok_or(DecodeError::Truncated)?;
        let scene = rest
            .get(..fields.scene_length.into())
            .ok_or(DecodeError::Truncated)?;
        let (camera, padding) = camera
            .split_at_checked(camera_len)
            .ok_or(DecodeError::Truncated)?;
        if padding.iter().any(|&byte| byte != 0) {
            return Err(DecodeError::Padding);
        }
        if crc32(camera) != fields.camera_check || crc32(scene) != fields.scene_id {
            return Err(DecodeError::Checksum);
        }
        let boot = Self {
            core: fields.core,
            cores: fields.cores,
            session: fields.session,
            epoch: fields.epoch,
            width: fields.width,
            height: fields.height,
            samples_per_unit: fields.samples_per_unit,
            spp: fields.spp,
            seed: fields.seed,
            epsilon: fields.epsilon,
            termination: Termination::from_code(fields.termination),
            order: PixelOrder::from_code(fields.order)?,
            profile: Name::from_bytes(fields.profile)?,
            collector: fields.collector,
            address: fields.address,
            port: fields.port,
            camera,
            scene,
        };
        boot.check()?;
        Ok(boot)
    }

    /// Ranges that the rest of the firmware relies on.
    fn check(&self) -> Result<(), DecodeError> {
        let in_fleet = self.core < self.cores;
        let samples = |n: u32| n != 0 && n.is_multiple_of(4);
        let sampled = samples(self.spp) && samples(self.samples_per_unit.into());
        let passes = self.spp.div_ceil(u32::from(self.samples_per_unit).max(1));
        let runs = (u32::from(self.width) * u32::from(self.height)).div_ceil(MAX_PIXELS as u32);
        let numbered = runs != 0 && runs.checked_mul(passes).is_some();
        let sound = self.epsilon >= 0 && self.port != 0;
        if in_fleet && sampled && self.samples_per_unit <= MAX_SAMPLES && numbered && sound {
            Ok(())
        } else {
            Err(DecodeError::Range)
        }
    }
}

/// Length of a block with a camera and a scene of these lengths.
pub const fn encoded_len(camera: usize, scene: usize) -> usize {
    scene_at(camera) + scene
}

/// Where the scene begins behind a camera of this length.
const fn scene_at(camera_len: usize) -> usize {
    (HEADER_LEN + camera_len).next_multiple_of(ALIGNMENT)
}

impl Termination {
    fn code(self) -> u8 {
        match self {
            Self::Roulette => 0,
            Self::Depth(depth) => depth.get(),
        }
    }

    fn from_code(code: u8) -> Self {
        NonZeroU8::new(code).map_or(Self::Roulette, Self::Depth)
    }
}

impl PixelOrder {
    fn from_code(code: u8) -> Result<Self, DecodeError> {
        match code {
            0 => Ok(Self::Leased),
            1 => Ok(Self::Sequential),
            2 => Ok(Self::Stochastic),
            _ => Err(DecodeError::Range),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::tests::assert_documented;

    #[test]
    fn the_header_is_as_documented() {
        assert_documented(include_str!("boot.rs"), "//! The boot block", Header::FIELDS);
    }
}
