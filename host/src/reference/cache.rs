//! Finished references on disk, so that nobody waits for the same truth twice.
//!
//! A file's name is a digest of everything the result depends on; its end is a checksum of what is before it. A file
//! that was cut short or altered does not pass and is made anew.

use std::io::Write;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::{Job, render};
use crate::file::{WriteError, write_whole};
use crate::picture::{Estimate, Picture};
use crate::scene::Scene;

/// To be raised when the reference's method changes: old files are then no longer found.
const METHOD: u32 = 1;
const MAGIC: &[u8; 8] = b"reffilm1";
const CHECKSUM: usize = 32;
/// Mean and variance of three channels.
const PIXEL: usize = 6 * size_of::<f64>();

/// Where a reference came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// Found in the cache.
    Cached,
    /// Rendered now; there was none.
    Rendered,
    /// Rendered now; the cached one was damaged.
    Replaced,
}

/// The reference for `job`: from the folder `cache` if it is there and whole, else rendered and put there.
pub fn reference(
    cache: &Path,
    scene: &Scene,
    job: &Job,
    progress: impl Fn(u64) + Sync,
) -> Result<(Estimate, Origin), WriteError> {
    let path = place(cache, scene, job);
    let origin = match std::fs::read(&path) {
        Ok(bytes) => match decode(&bytes, job) {
            Some(estimate) => return Ok((estimate, Origin::Cached)),
            None => Origin::Replaced,
        },
        // Whatever keeps it from being read will keep it from being written, and is reported then.
        Err(_) => Origin::Rendered,
    };
    std::fs::create_dir_all(cache).map_err(|source| WriteError {
        path: cache.to_owned(),
        cause: source.to_string(),
    })?;
    let estimate = render(scene, job, progress);
    let bytes = encode(&estimate);
    write_whole(&path, |writer| writer.write_all(&bytes))?;
    Ok((estimate, origin))
}

/// The file for `job`.
fn place(cache: &Path, scene: &Scene, job: &Job) -> PathBuf {
    // Debug output has every field, and every float to the last bit.
    let everything = format!("{METHOD} {scene:?} {job:?}");
    let digest = Sha256::digest(everything.as_bytes());
    let name: String = digest.iter().take(12).map(|byte| format!("{byte:02x}")).collect();
    cache.join(format!("{}-{name}.reference", scene.name))
}

fn encode(estimate: &Estimate) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    let pixels = estimate.picture.pixels().iter().flatten();
    for (mean, variance) in pixels.zip(estimate.variance.iter().flatten()) {
        for value in mean.iter().chain(variance) {
            bytes.extend(value.to_le_bytes());
        }
    }
    let checksum = Sha256::digest(&bytes);
    bytes.extend(checksum);
    bytes
}

/// `None` for anything but a whole file of this job's size.
fn decode(bytes: &[u8], job: &Job) -> Option<Estimate> {
    let (body, checksum) = bytes.split_last_chunk::<CHECKSUM>()?;
    if Sha256::digest(body)[..] != checksum[..] {
        return None;
    }
    let values = body.strip_prefix(MAGIC)?;
    if values.len() != PIXEL * usize::from(job.width) * usize::from(job.height) {
        return None;
    }
    let (values, _) = values.as_chunks::<8>();
    let values: Vec<f64> = values.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
    let (triples, _) = values.as_chunks::<3>();
    let (pixels, _) = triples.as_chunks::<2>();
    let (means, variances) = pixels
        .iter()
        .map(|[mean, variance]| (Some(*mean), *variance))
        .unzip();
    Some(Estimate {
        picture: Picture::new(job.width, job.height, means),
        variance: Some(variances),
        spp: Some(job.spp),
    })
}

#[cfg(test)]
mod tests {
    use super::super::Termination;
    use super::*;

    fn scene() -> Scene {
        Scene::parse("cornell.toml", include_str!("../../../scenes/cornell.toml")).unwrap()
    }

    const JOB: Job = Job {
        width: 8,
        height: 6,
        spp: 8,
        termination: Termination::Roulette,
        seed: 1,
    };

    #[test]
    fn the_second_time_it_is_cached_and_the_same() {
        let folder = tempfile::tempdir().unwrap();
        let cache = folder.path().join("not").join("there").join("yet");
        let (first, origin) = reference(&cache, &scene(), &JOB, |_| {}).unwrap();
        assert_eq!(origin, Origin::Rendered);
        let (second, origin) = reference(&cache, &scene(), &JOB, |_| panic!("rendered again")).unwrap();
        assert_eq!(origin, Origin::Cached);
        assert_eq!(first, second);
    }

    #[test]
    fn damage_of_any_byte_is_noticed_and_mended() {
        let folder = tempfile::tempdir().unwrap();
        let (whole, _) = reference(folder.path(), &scene(), &JOB, |_| {}).unwrap();
        let path = place(folder.path(), &scene(), &JOB);
        let bytes = std::fs::read(&path).unwrap();
        let mut damaged: Vec<Vec<u8>> = vec![
            vec![],
            bytes[..bytes.len() / 2].to_vec(),
            [&bytes[..], b"x"].concat(),
        ];
        for position in [0, MAGIC.len(), bytes.len() / 2, bytes.len() - 1] {
            let mut copy = bytes.clone();
            copy[position] ^= 1;
            damaged.push(copy);
        }
        for copy in damaged {
            std::fs::write(&path, copy).unwrap();
            let (again, origin) = reference(folder.path(), &scene(), &JOB, |_| {}).unwrap();
            assert_eq!(origin, Origin::Replaced);
            assert_eq!(again, whole);
            assert_eq!(std::fs::read(&path).unwrap(), bytes);
        }
    }

    #[test]
    fn whatever_changes_the_picture_changes_the_name() {
        let mut brighter = scene();
        brighter.spheres[8].emission[2] += 1e-9;
        let folder = Path::new("cache");
        let mut names: Vec<_> = [
            JOB,
            Job { width: 9, ..JOB },
            Job { height: 7, ..JOB },
            Job { spp: 12, ..JOB },
            Job { seed: 2, ..JOB },
            Job {
                termination: Termination::Depth(5),
                ..JOB
            },
            Job {
                termination: Termination::Depth(6),
                ..JOB
            },
        ]
        .iter()
        .map(|job| place(folder, &scene(), job))
        .collect();
        names.push(place(folder, &brighter, &JOB));
        let all = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), all);
    }

    #[test]
    fn a_cache_that_cannot_be_written_is_an_error_not_a_slow_success() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a-file");
        std::fs::write(&file, b"").unwrap();
        let error = reference(&file, &scene(), &JOB, |_| panic!("rendered in vain")).unwrap_err();
        assert!(error.to_string().contains("a-file"), "{error}");
    }
}
