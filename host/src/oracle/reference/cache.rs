//! Finished references on disk, so that nobody waits for the same truth twice.
//!
//! A file's name is a digest of everything the result depends on; its end is a checksum of what is before it. A file
//! that was cut short or altered does not pass and is made anew.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use etcetera::base_strategy::{BaseStrategy, Xdg};
use sha2::{Digest, Sha256};

use super::{Job, Pixel, Rendered, of_pixels, render};
use crate::platform::file::{OUR_FOLDER, write_whole};
use crate::scene::Scene;

/// To be raised when the reference's method changes: old files are then no longer found.
const METHOD: u32 = 5;
const MAGIC: &[u8; 8] = b"reffilm3";
const CHECKSUM: usize = 32;
/// Mean, its variance, and the variances of samples by two other methods, of three channels.
const PIXEL: usize = 12 * size_of::<f64>();

/// Where a reference came from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    /// Found in the cache.
    Cached,
    /// Rendered now; there was none.
    Rendered,
    /// Rendered now; the cached one was damaged.
    Replaced,
    /// Rendered now, and again the next time, for this reason.
    NotKept(String),
}

impl Origin {
    /// What users may want to mend.
    pub fn warning(&self) -> Option<String> {
        let Self::NotKept(cause) = self else {
            return None;
        };
        Some(format!(
            "warning: the reference is not kept for the next time: {cause}; name a folder for it with --reference-cache or \
             XDG_CACHE_HOME"
        ))
    }
}

/// The folder for references: the one named, or ours among the user's caches. None where the user has no home.
pub fn folder(named: Option<&Path>) -> Option<PathBuf> {
    let ours = || Some(Xdg::new().ok()?.cache_dir().join(OUR_FOLDER));
    named.map(Path::to_owned).or_else(ours)
}

/// The reference for `job`: from the folder `cache` if it is there and whole, else rendered, and put there if that is possible.
pub fn reference(
    cache: Option<&Path>,
    scene: &Scene,
    job: &Job,
    progress: impl Fn(u64) + Sync,
) -> (Rendered, Origin) {
    let path = cache.map(|cache| place(cache, scene, job));
    // Whatever keeps it from being read will keep it from being written, and is reported then.
    let kept = path.as_deref().and_then(|path| fs::read(path).ok());
    let mut origin = Origin::Rendered;
    if let Some(bytes) = kept {
        match decode(&bytes, job) {
            Some(rendered) => return (rendered, Origin::Cached),
            None => origin = Origin::Replaced,
        }
    }
    let rendered = render(scene, job, progress);
    let home = || "you have no home folder".to_owned();
    let stored = path.ok_or_else(home).and_then(|path| store(&path, &rendered));
    (rendered, stored.map_or_else(Origin::NotKept, |()| origin))
}

/// Puts a reference where the next render looks for it, or says why not.
fn store(path: &Path, rendered: &Rendered) -> Result<(), String> {
    if let Some(folder) = path.parent() {
        let failed = |cause| format!("cannot make the folder {}: {cause}", folder.display());
        fs::create_dir_all(folder).map_err(failed)?;
    }
    let bytes = encode(rendered);
    let written = write_whole(path, |writer| writer.write_all(&bytes));
    written.map_err(|error| format!("cannot write {}: {}", error.path.display(), error.cause))
}

/// The file for `job`.
fn place(cache: &Path, scene: &Scene, job: &Job) -> PathBuf {
    // Debug output has every field, and every float to the last bit.
    let everything = format!("{METHOD} {scene:?} {job:?}");
    let digest = Sha256::digest(everything.as_bytes());
    let name: String = digest.iter().take(12).map(|byte| format!("{byte:02x}")).collect();
    cache.join(format!("{}-{name}.reference", scene.name))
}

fn encode(rendered: &Rendered) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    let Rendered {
        estimate,
        plain_variance,
        looking_variance,
    } = rendered;
    let pixels = estimate.picture.pixels().iter().flatten();
    let variances = estimate.variance.iter().flatten();
    let others = plain_variance.iter().zip(looking_variance);
    for ((mean, variance), (plain, looking)) in pixels.zip(variances).zip(others) {
        for value in [mean, variance, plain, looking].into_iter().flatten() {
            bytes.extend(value.to_le_bytes());
        }
    }
    let checksum = Sha256::digest(&bytes);
    bytes.extend(checksum);
    bytes
}

/// `None` for anything but a whole file of this job's size.
fn decode(bytes: &[u8], job: &Job) -> Option<Rendered> {
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
    let (pixels, _) = triples.as_chunks::<4>();
    let pixels: Vec<Pixel> = pixels
        .iter()
        .map(|&[mean, variance, plain_variance, looking_variance]| Pixel {
            mean,
            variance,
            plain_variance,
            looking_variance,
        })
        .collect();
    Some(of_pixels(&pixels, job))
}

#[cfg(test)]
mod tests {
    use super::super::Termination;
    use super::*;

    fn scene() -> Scene {
        Scene::parse("cornell.toml", include_str!("../../../../scenes/cornell.toml")).unwrap()
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
        let (first, origin) = reference(Some(&cache), &scene(), &JOB, |_| {});
        assert_eq!(origin, Origin::Rendered);
        let (second, origin) = reference(Some(&cache), &scene(), &JOB, |_| panic!("rendered again"));
        assert_eq!(origin, Origin::Cached);
        assert_eq!(first, second);
    }

    #[test]
    fn damage_of_any_byte_is_noticed_and_mended() {
        let folder = tempfile::tempdir().unwrap();
        let (whole, _) = reference(Some(folder.path()), &scene(), &JOB, |_| {});
        let path = place(folder.path(), &scene(), &JOB);
        let bytes = fs::read(&path).unwrap();
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
            fs::write(&path, copy).unwrap();
            let (again, origin) = reference(Some(folder.path()), &scene(), &JOB, |_| {});
            assert_eq!(origin, Origin::Replaced);
            assert_eq!(again, whole);
            assert_eq!(fs::read(&path).unwrap(), bytes);
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
    fn a_cache_that_cannot_be_written_is_a_warning_beside_the_reference() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a-file");
        fs::write(&file, b"").unwrap();
        let (kept, _) = reference(Some(folder.path()), &scene(), &JOB, |_| {});
        for (cache, words) in [(Some(file.as_path()), "a-file"), (None, "home")] {
            let (estimate, origin) = reference(cache, &scene(), &JOB, |_| {});
            assert_eq!(estimate, kept);
            let warning = origin.warning().expect("it was not kept");
            for words in [words, "--reference-cache"] {
                assert!(warning.contains(words), "{warning}");
            }
        }
    }

    #[test]
    fn references_are_kept_among_the_caches_of_the_user_unless_they_say_where() {
        let ours = folder(None).expect("tests have a home");
        assert!(ours.is_absolute() && ours.ends_with("fixed-point-path-tracer"));
        assert_eq!(folder(Some(Path::new("here"))), Some("here".into()));
    }
}
