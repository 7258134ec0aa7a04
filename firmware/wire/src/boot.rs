//! The boot block: all that a core has to know, put in its memory before it starts.
//!
//! | offset | bytes | field                                                        |
//! | ------ | ----- | ------------------------------------------------------------ |
//! | 0      | 4     | magic: the characters `PTBB`                                 |
//! | 4      | 2     | version, [`VERSION`]                                         |
//! | 6      | 2     | length of this header: 80                                    |
//! | 8      | 2     | core number                                                  |
//! | 10     | 2     | cores in the fleet                                           |
//! | 12     | 4     | session                                                      |
//! | 16     | 4     | scene id: CRC-32 of the scene blob                           |
//! | 20     | 2     | camera epoch                                                 |
//! | 22     | 2     | width in pixels                                              |
//! | 24     | 2     | height in pixels                                             |
//! | 26     | 2     | samples per pixel in one unit, a multiple of 4, at most 4096 |
//! | 28     | 4     | samples per pixel in all, a multiple of 4                    |
//! | 32     | 8     | seed                                                         |
//! | 40     | 4     | self-intersection epsilon, signed 16:16                      |
//! | 44     | 1     | termination: 0 for roulette, else the depth                  |
//! | 45     | 1     | pixel order: 0 leased, 1 sequential, 2 stochastic            |
//! | 46     | 2     | reserved, zero                                               |
//! | 48     | 12    | name of the arithmetic profile, see [`Name`]                 |
//! | 60     | 4     | the collector's IPv4 address                                 |
//! | 64     | 4     | the core's own IPv4 address                                  |
//! | 68     | 2     | the collector's UDP port; the core sends from the same       |
//! | 70     | 2     | reserved, zero                                               |
//! | 72     | 4     | length of the scene blob                                     |
//! | 76     | 4     | CRC-32 of the 76 bytes before                                |
//! | 80     | n     | the scene blob                                               |
//!
//! The bytes after the blob do not matter: a memory is longer than what was loaded into it.

use crate::bytes::Writer;
use crate::{DecodeError, MAX_PIXELS, MAX_SAMPLES, Name, VERSION, crc32};

const MAGIC: [u8; 4] = *b"PTBB";

/// Bytes before the scene blob.
pub const HEADER_LEN: usize = 80;

/// Where the header's own checksum is.
const CHECKSUM_AT: usize = 76;

/// Bytes of a board's memory kept for the boot block, and so its greatest length.
pub const MAX_LEN: usize = 0x1600;

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
    /// 0 for Russian roulette, else the depth at which every path ends.
    pub termination: u8,
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
    /// The scene's id: the CRC-32 of its blob.
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
        HEADER_LEN + self.scene.len()
    }

    /// Writes the block and returns its length. The rest of `out` stays as it is.
    pub fn encode(&self, out: &mut [u8]) -> Result<usize, TooLong> {
        let len = self.encoded_len();
        if len > MAX_LEN || len > out.len() {
            return Err(TooLong);
        }
        let mut writer = Writer::new(out);
        writer.bytes(&MAGIC);
        writer.u16(VERSION);
        writer.u16(HEADER_LEN as u16);
        writer.u16(self.core);
        writer.u16(self.cores);
        writer.u32(self.session);
        writer.u32(self.scene_id());
        writer.u16(self.epoch);
        writer.u16(self.width);
        writer.u16(self.height);
        writer.u16(self.samples_per_unit);
        writer.u32(self.spp);
        writer.u64(self.seed);
        writer.bytes(&self.epsilon.to_le_bytes());
        writer.bytes(&[self.termination, self.order as u8, 0, 0]);
        writer.bytes(&self.profile.to_bytes());
        writer.bytes(&self.collector);
        writer.bytes(&self.address);
        writer.u16(self.port);
        writer.u16(0);
        writer.u32(self.scene.len() as u32);
        let checksum = crc32(writer.written());
        writer.u32(checksum);
        writer.bytes(self.scene);
        Ok(writer.len())
    }

    /// Reads a block from the start of `memory`. Total: see the crate's contract of decoding.
    pub fn decode(memory: &'a [u8]) -> Result<Self, DecodeError> {
        let (header, rest) = memory.split_first_chunk().ok_or(DecodeError::Truncated)?;
        let header = Header(header);
        if header.at(0) != MAGIC {
            return Err(DecodeError::Magic);
        }
        let version = header.u16_at(4);
        if version != VERSION {
            return Err(DecodeError::Version(version));
        }
        if usize::from(header.u16_at(6)) != HEADER_LEN {
            return Err(DecodeError::Range);
        }
        if crc32(&header.0[..CHECKSUM_AT]) != header.u32_at(CHECKSUM_AT) {
            return Err(DecodeError::Checksum);
        }
        let len = usize::try_from(header.u32_at(72)).map_err(|_| DecodeError::Range)?;
        let scene = rest.get(..len).ok_or(DecodeError::Truncated)?;
        if crc32(scene) != header.u32_at(16) {
            return Err(DecodeError::Checksum);
        }
        let boot = header.fields(scene)?;
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

/// A header, whose fields lie at the offsets of the table above. All of them are constants, so that none can be out of bounds and
/// a core needs no code to see that.
struct Header<'a>(&'a [u8; HEADER_LEN]);

impl Header<'_> {
    #[inline(always)]
    fn at<const N: usize>(&self, offset: usize) -> [u8; N] {
        core::array::from_fn(|index| self.0[offset + index])
    }

    #[inline(always)]
    fn u16_at(&self, offset: usize) -> u16 {
        u16::from_le_bytes(self.at(offset))
    }

    #[inline(always)]
    fn u32_at(&self, offset: usize) -> u32 {
        u32::from_le_bytes(self.at(offset))
    }

    fn fields<'a>(&self, scene: &'a [u8]) -> Result<Boot<'a>, DecodeError> {
        let [termination, order] = self.at(44);
        // Reserved fields are zero until a later version gives them a meaning.
        if self.u16_at(46) != 0 || self.u16_at(70) != 0 {
            return Err(DecodeError::Range);
        }
        Ok(Boot {
            core: self.u16_at(8),
            cores: self.u16_at(10),
            session: self.u32_at(12),
            epoch: self.u16_at(20),
            width: self.u16_at(22),
            height: self.u16_at(24),
            samples_per_unit: self.u16_at(26),
            spp: self.u32_at(28),
            seed: u64::from_le_bytes(self.at(32)),
            epsilon: i32::from_le_bytes(self.at(40)),
            termination,
            order: PixelOrder::from_code(order)?,
            profile: Name::from_bytes(self.at(48))?,
            collector: self.at(60),
            address: self.at(64),
            port: self.u16_at(68),
            scene,
        })
    }
}
