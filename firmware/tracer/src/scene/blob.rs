//! The blob's layout: little-endian words, a header and then the spheres, hollow ones first.
//!
//! | words | header |
//! | --- | --- |
//! | 1 | magic "FXS1" |
//! | 1 | spheres (low half), of which hollow (high half) |
//! | 3 | camera position, 16:16 |
//! | 9 | forward, right, up, 2:30 |
//! | 1 | near, 16:16 |
//! | 3 | columns: sub-pixels, 2^45 / sub-pixels (two words) |
//! | 3 | rows, likewise |
//!
//! | words | sphere |
//! | --- | --- |
//! | 3 | centre, 16:16 |
//! | 1 | radius, 16:16 |
//! | 2 | radius squared, 32:32 |
//! | 1 | reciprocal: 2^60 / (radius << shift) |
//! | 1 | shift (low byte), material (second byte), whether two-sided (third byte) |
//! | 3 | emission, 16:16 |
//! | 3 | reflectance, 0:32 (all ones: 1) |
//! | 3 | reflectance / survival, 0:32 |
//! | 1 | survival, 2:30 |
//! | 2 | index of refraction and its inverse, 4:28 |
//! | 1 | reflectance at normal incidence, 2:30 |

const MAGIC: u32 = u32::from_le_bytes(*b"FXS1");
const WORD: usize = 4;

/// Size of an encoded [`Header`].
pub const HEADER_BYTES: usize = 21 * WORD;
/// Size of an encoded [`SphereRecord`].
pub const SPHERE_BYTES: usize = 21 * WORD;

/// Why a blob was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlobError {
    /// It is shorter than its header.
    Truncated,
    /// It does not begin as a scene.
    BadMagic,
    /// It counts more spheres than there can be, or than it holds.
    BadCounts,
    /// A material has no such number, or is neither one- nor two-sided.
    BadMaterial,
    /// It needs a material that this image was built without.
    NotInThisImage,
}

/// What the blob says before its spheres.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header {
    /// Spheres in all.
    pub spheres: u16,
    /// How many of them, the first ones, are hollow.
    pub hollow: u16,
    /// The camera.
    pub camera: CameraRecord,
}

/// The camera as encoded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CameraRecord {
    /// Pinhole, 16:16.
    pub position: [i32; 3],
    /// To the film's centre, 2:30; scaled, with the next two, so that no sum leaves the format.
    pub forward: [i32; 3],
    /// Across the film, 2:30.
    pub right: [i32; 3],
    /// Up the film, 2:30.
    pub up: [i32; 3],
    /// Start of a ray along its unit direction, 16:16.
    pub near: i32,
    /// Sub-pixels across, and 2^45 over them.
    pub columns: (u32, u64),
    /// Sub-pixels up, and 2^45 over them.
    pub rows: (u32, u64),
}

/// A sphere as encoded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SphereRecord {
    /// Centre, 16:16.
    pub centre: [i32; 3],
    /// Radius, 16:16.
    pub radius: i32,
    /// Radius squared, 32:32.
    pub square: i64,
    /// 2^60 / (radius << shift), with the shift that leaves the radius 30 bits.
    pub reciprocal: i32,
    /// See `reciprocal`.
    pub shift: u8,
    /// Whether camera rays may start within this solid.
    pub two_sided: bool,
    /// Emission, 16:16.
    pub emission: [u32; 3],
    /// Reflectance, 0:32 (all ones: 1).
    pub reflectance: [u32; 3],
    /// Reflectance over survival, 0:32.
    pub survivor: [u32; 3],
    /// Largest channel of the reflectance, 2:30.
    pub survival: i32,
    /// Material.
    pub material: MaterialRecord,
}

/// A material as encoded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MaterialRecord {
    /// Number 0.
    #[default]
    Diffuse,
    /// Number 1.
    Mirror,
    /// Number 2.
    Glass {
        /// Index of refraction, 4:28.
        index: i32,
        /// Its inverse, 4:28.
        inverse: i32,
        /// Reflectance at normal incidence, 2:30.
        normal_reflectance: i32,
    },
}

impl Header {
    /// The header's bytes.
    pub fn encode(&self) -> [u8; HEADER_BYTES] {
        let mut words = [0; HEADER_BYTES / WORD];
        let camera = &self.camera;
        words[0] = MAGIC;
        words[1] = u32::from(self.spheres) | u32::from(self.hollow) << 16;
        words[2..5].copy_from_slice(&camera.position.map(|w| w as u32));
        words[5..8].copy_from_slice(&camera.forward.map(|w| w as u32));
        words[8..11].copy_from_slice(&camera.right.map(|w| w as u32));
        words[11..14].copy_from_slice(&camera.up.map(|w| w as u32));
        words[14] = camera.near as u32;
        for (at, (subpixels, reciprocal)) in [(15, camera.columns), (18, camera.rows)] {
            words[at] = subpixels;
            words[at + 1] = reciprocal as u32;
            words[at + 2] = (reciprocal >> 32) as u32;
        }
        bytes(&words)
    }

    /// The header, and the bytes after it.
    pub fn decode(blob: &[u8]) -> Result<(Self, &[u8]), BlobError> {
        let (head, rest) = blob.split_at_checked(HEADER_BYTES).ok_or(BlobError::Truncated)?;
        let mut words = Words(head);
        if words.next() != MAGIC {
            return Err(BlobError::BadMagic);
        }
        let counts = words.next();
        let camera = CameraRecord {
            position: words.signed(),
            forward: words.signed(),
            right: words.signed(),
            up: words.signed(),
            near: words.next() as i32,
            columns: (words.next(), words.long()),
            rows: (words.next(), words.long()),
        };
        Ok((
            Self {
                spheres: counts as u16,
                hollow: (counts >> 16) as u16,
                camera,
            },
            rest,
        ))
    }
}

impl SphereRecord {
    /// The sphere's bytes.
    pub fn encode(&self) -> [u8; SPHERE_BYTES] {
        let (number, glass) = match self.material {
            MaterialRecord::Diffuse => (0, [0; 3]),
            MaterialRecord::Mirror => (1, [0; 3]),
            MaterialRecord::Glass {
                index,
                inverse,
                normal_reflectance,
            } => (2, [index, inverse, normal_reflectance]),
        };
        let mut words = [0; SPHERE_BYTES / WORD];
        words[..3].copy_from_slice(&self.centre.map(|w| w as u32));
        words[3] = self.radius as u32;
        words[4] = self.square as u32;
        words[5] = (self.square >> 32) as u32;
        words[6] = self.reciprocal as u32;
        words[7] = u32::from(self.shift) | number << 8 | u32::from(self.two_sided) << 16;
        words[8..11].copy_from_slice(&self.emission);
        words[11..14].copy_from_slice(&self.reflectance);
        words[14..17].copy_from_slice(&self.survivor);
        words[17] = self.survival as u32;
        words[18..21].copy_from_slice(&glass.map(|w| w as u32));
        bytes(&words)
    }

    /// The sphere in `SPHERE_BYTES` bytes.
    pub fn decode(blob: &[u8]) -> Result<Self, BlobError> {
        if blob.len() != SPHERE_BYTES {
            return Err(BlobError::Truncated);
        }
        let mut words = Words(blob);
        let centre = words.signed();
        let radius = words.next() as i32;
        let square = words.long() as i64;
        let reciprocal = words.next() as i32;
        let packed = words.next();
        let (emission, reflectance, survivor) = (words.three(), words.three(), words.three());
        let survival = words.next() as i32;
        let [index, inverse, normal_reflectance] = words.signed();
        let material = match packed >> 8 & 0xff {
            0 => MaterialRecord::Diffuse,
            1 => MaterialRecord::Mirror,
            2 => MaterialRecord::Glass {
                index,
                inverse,
                normal_reflectance,
            },
            _ => return Err(BlobError::BadMaterial),
        };
        let two_sided = match packed >> 16 {
            0 => false,
            1 => true,
            _ => return Err(BlobError::BadMaterial),
        };
        let shift = packed as u8 & 31;
        Ok(Self {
            centre,
            radius,
            square,
            reciprocal,
            shift,
            two_sided,
            emission,
            reflectance,
            survivor,
            survival,
            material,
        })
    }
}

fn bytes<const WORDS: usize, const BYTES: usize>(words: &[u32; WORDS]) -> [u8; BYTES] {
    let mut bytes = [0; BYTES];
    for (bytes, word) in bytes.chunks_exact_mut(WORD).zip(words) {
        bytes.copy_from_slice(&word.to_le_bytes());
    }
    bytes
}

/// Reads words from the front; zeros past the end, which callers have ruled out by length.
struct Words<'b>(&'b [u8]);

impl Words<'_> {
    fn next(&mut self) -> u32 {
        match self.0.split_first_chunk() {
            Some((word, rest)) => {
                self.0 = rest;
                u32::from_le_bytes(*word)
            }
            None => 0,
        }
    }

    fn long(&mut self) -> u64 {
        u64::from(self.next()) | u64::from(self.next()) << 32
    }

    fn three(&mut self) -> [u32; 3] {
        [self.next(), self.next(), self.next()]
    }

    fn signed(&mut self) -> [i32; 3] {
        self.three().map(|word| word as i32)
    }
}
