//! The rival: a plain path tracer in C++, `plain.cpp` beside this file, compiled on the spot for this machine.

use std::fmt::Write as _;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Output};

use crate::image::picture::{Estimate, Picture};
use crate::oracle::reference::Job;
use crate::platform::interrupt::{self, LastAct};
use crate::scene::{Material, Scene};

/// The program's text.
const SOURCE: &str = include_str!("plain.cpp");
/// All speed that the compiler can give it.
const FLAGS: [&str; 4] = ["-std=c++17", "-O3", "-march=native", "-ffast-math"];
/// Below this share of the mean square a variance is what rounding leaves of the difference of two sums.
const ROUNDING: f64 = 1e-12;

/// Why the rival gave no picture.
#[derive(Debug, thiserror::Error)]
pub enum PlainError {
    /// There is no room for it.
    #[error("cannot write the C++ program or its scene (set TMPDIR to a folder with room)")]
    Folder(#[source] io::Error),
    /// A program could not be started.
    #[error("cannot start {} (if it is the compiler, is it a working g++? if not, may programs run in TMPDIR?)", program.display())]
    NotStarted {
        /// The program.
        program: PathBuf,
        /// Why.
        #[source]
        cause: io::Error,
    },
    /// The compiler refused it.
    #[error("{} does not compile the C++ program ({status}; take another g++):\n{said}", compiler.display())]
    Refused {
        /// The compiler.
        compiler: PathBuf,
        /// How it ended.
        status: ExitStatus,
        /// What it said.
        said: String,
    },
    /// It did not come to an end.
    #[error(
        "the C++ program failed ({status}; a fault of it or of what it was given, to be looked for in bench/reference): {said}"
    )]
    Failed {
        /// How it ended.
        status: ExitStatus,
        /// What it said.
        said: String,
    },
    /// What it wrote is not the picture.
    #[error(
        "the C++ program's answer makes no sense at line {0} (its text and its reader in bench/reference have parted)"
    )]
    Answer(usize),
}

/// The compiled program, and the scene as it reads it.
pub struct Plain {
    folder: tempfile::TempDir,
    _removes: LastAct,
}

/// A picture by it.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendered {
    /// The picture, and how uncertain it is.
    pub estimate: Estimate,
    /// How long rendering took, without what is before and after it.
    pub seconds: f64,
}

impl Plain {
    /// Compiles it.
    pub fn build(compiler: &Path) -> Result<Self, PlainError> {
        let folder = tempfile::tempdir().map_err(PlainError::Folder)?;
        let place = folder.path().to_owned();
        // Whatever of it stays, it is in a folder for what may go away.
        let removes = LastAct::new(move || drop(fs::remove_dir_all(&place)));
        let source = folder.path().join("plain.cpp");
        fs::write(&source, SOURCE).map_err(PlainError::Folder)?;
        let mut command = Command::new(compiler);
        command.args(FLAGS).arg(&source);
        command.arg("-o").arg(folder.path().join("plain"));
        let output = output(&mut command)?;
        if !output.status.success() {
            return Err(PlainError::Refused {
                compiler: compiler.to_owned(),
                status: output.status,
                said: String::from_utf8_lossy(&output.stderr).into_owned(),
            });
        }
        Ok(Self {
            folder,
            _removes: removes,
        })
    }

    /// Renders `scene`; paths end by roulette, whatever `job` says.
    pub fn render(&self, scene: &Scene, job: &Job) -> Result<Rendered, PlainError> {
        let file = self.folder.path().join("scene");
        fs::write(&file, described(scene, job)).map_err(PlainError::Folder)?;
        let mut command = Command::new(self.folder.path().join("plain"));
        command.arg(&file);
        command.args([job.width, job.height].map(|side| side.to_string()));
        command.args([(job.spp / 4).to_string(), job.seed.to_string()]);
        let output = output(&mut command)?;
        if !output.status.success() {
            return Err(PlainError::Failed {
                status: output.status,
                said: String::from_utf8_lossy(&output.stderr).into_owned(),
            });
        }
        read(&String::from_utf8_lossy(&output.stdout), job)
    }
}

fn output(command: &mut Command) -> Result<Output, PlainError> {
    interrupt::output(command).map_err(|cause| PlainError::NotStarted {
        program: command.get_program().into(),
        cause,
    })
}

/// The scene in numbers: the camera, how many spheres, each sphere. What is written of a number is read as the same one.
fn described(scene: &Scene, job: &Job) -> String {
    let camera = &scene.camera;
    let mut text = String::new();
    let mut line = |numbers: &[f64]| {
        for number in numbers {
            // A text takes all that is written to it.
            let _never_fails = write!(text, "{number:e} ");
        }
        text.push('\n');
    };
    line(&camera.position);
    line(&camera.direction);
    line(&camera.up);
    line(&[camera.height_for(job.width, job.height), camera.near]);
    line(&[scene.spheres.len() as f64]);
    for sphere in &scene.spheres {
        let (colour, kind, index) = match sphere.material {
            Material::Diffuse(colour) => (colour, 0.0, 1.0),
            Material::Mirror(colour) => (colour, 1.0, 1.0),
            Material::Glass { tint, index } => (tint, 2.0, index),
        };
        line(&sphere.centre);
        line(&[sphere.radius, f64::from(u8::from(sphere.hollow))]);
        line(&sphere.emission);
        line(&colour);
        line(&[kind, index]);
    }
    text
}

/// Reads what the program says: its time, then sums and sums of squares of each sub-pixel.
fn read(text: &str, job: &Job) -> Result<Rendered, PlainError> {
    let mut lines = text.lines().enumerate().map(|(index, line)| (index + 1, line));
    let first = lines.next().and_then(|(_, line)| line.parse::<f64>().ok());
    let seconds = first
        .filter(|seconds| *seconds > 0.0)
        .ok_or(PlainError::Answer(1))?;
    let mut sub_pixels = Vec::new();
    for (number, line) in lines {
        let sums = numbers(line).ok_or(PlainError::Answer(number))?;
        sub_pixels.push(SubPixel::of(sums, f64::from(job.spp / 4)));
    }
    let (pixels, rest) = sub_pixels.as_chunks();
    if !rest.is_empty() || pixels.len() != usize::from(job.width) * usize::from(job.height) {
        return Err(PlainError::Answer(sub_pixels.len() + 1));
    }
    let means = pixels
        .iter()
        .map(|pixel| Some(sum(pixel.map(|part| part.mean)).map(|sum| sum / 4.0)));
    // The sub-pixels are strata of equal weight, as the reference has them.
    let variances = pixels
        .iter()
        .map(|pixel| sum(pixel.map(|part| part.variance)).map(|sum| sum / 16.0));
    Ok(Rendered {
        estimate: Estimate {
            picture: Picture::new(job.width, job.height, means.collect()),
            variance: Some(variances.collect()),
            spp: Some(job.spp),
        },
        seconds,
    })
}

fn numbers(line: &str) -> Option<[f64; 6]> {
    let numbers: Option<Vec<f64>> = line.split(' ').map(|word| word.parse().ok()).collect();
    let finite = |numbers: &[f64; 6]| numbers.iter().all(|number| number.is_finite());
    numbers?.try_into().ok().filter(finite)
}

fn sum(parts: [[f64; 3]; 4]) -> [f64; 3] {
    [0, 1, 2].map(|channel| parts.iter().map(|part| part[channel]).sum())
}

/// A sub-pixel's mean, and the variance of that.
#[derive(Clone, Copy)]
struct SubPixel {
    mean: [f64; 3],
    variance: [f64; 3],
}

impl SubPixel {
    fn of(sums: [f64; 6], samples: f64) -> Self {
        let mean = [0, 1, 2].map(|channel| sums[channel] / samples);
        let variance = [0, 1, 2].map(|channel| {
            let square = sums[3 + channel] / samples;
            let spread = square - mean[channel] * mean[channel];
            if spread > ROUNDING * square {
                spread / (samples - 1.0)
            } else {
                0.0
            }
        });
        Self { mean, variance }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::reference::Termination;
    use crate::platform::script::script;

    const POINT: Job = Job {
        width: 1,
        height: 1,
        spp: 16,
        termination: Termination::Roulette,
        seed: 3,
    };

    fn scene() -> Scene {
        let text = "format = 1\n[camera]\nposition = [0, 0, 3]\ndirection = [0, 0, -1]\nplane_height = 1\nplane_width = 0.5\nnear = 0.1\n\
             [[sphere]]\nname = \"room\"\nhollow = true\ncentre = [0, 0, 0]\nradius = 10\nemission = [1, 0, 0.5]\ndiffuse = [0.5, 0.25, 0]\n\
             [[sphere]]\nname = \"ball\"\ncentre = [0, 0.125, 0]\nradius = 1\nglass = [0.9, 0.8, 0.7]\nindex = 1.5";
        Scene::parse("small.toml", text).expect("a scene")
    }

    #[test]
    fn a_scene_is_written_with_the_height_that_the_camera_has_for_the_picture() {
        let numbers: Vec<f64> = described(&scene(), &POINT)
            .split_whitespace()
            .map(|word| word.parse().expect("a number"))
            .collect();
        let [camera, rest] = [&numbers[..11], &numbers[11..]];
        assert_eq!(camera, [0.0, 0.0, 3.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0, 0.5, 0.1]);
        let room = [0.0, 0.0, 0.0, 10.0, 1.0, 1.0, 0.0, 0.5, 0.5, 0.25, 0.0, 0.0, 1.0];
        let ball = [0.0, 0.125, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.9, 0.8, 0.7, 2.0, 1.5];
        assert_eq!(rest[0], 2.0);
        assert_eq!(rest[1..], [room, ball].concat());
    }

    /// Samples 0, 0, 0, 4 in red, four of 0.1 in green, where nothing but rounding is left, and none in blue.
    #[test]
    fn sums_become_means_and_their_variance_within_sub_pixels() {
        let line = "4 0.4 0 16 0.040000000000000008 0\n";
        let rendered = read(&format!("0.5\n{}", line.repeat(4)), &POINT).expect("a picture");
        assert_eq!(rendered.seconds, 0.5);
        assert_eq!(rendered.estimate.picture.pixels(), [Some([1.0, 0.1, 0.0])]);
        // (16 - 4) / 3 is the variance of a sample, a 16th of that the variance of the mean of 16.
        assert_eq!(rendered.estimate.variance, Some(vec![[0.25, 0.0, 0.0]]));
    }

    #[test]
    fn an_answer_that_makes_no_sense_is_told_by_its_line() {
        let good = "1 1 1 1 1 1\n".repeat(4);
        let line = |text: &str| match read(text, &POINT) {
            Err(PlainError::Answer(line)) => line,
            other => panic!("{other:?}"),
        };
        assert_eq!(line(""), 1);
        assert_eq!(line(&format!("0\n{good}")), 1);
        assert_eq!(line(&format!("1\n{good}1 1 1 1 1\n")), 6);
        assert_eq!(line("1\n1 1 1 1 1 1\n1 1 nan 1 1 1\n"), 3);
        assert_eq!(line("1\n1 1 1 1 1 1\n"), 2);
        assert!(read(&format!("1\n{good}"), &POINT).is_ok());
    }

    #[test]
    fn a_compiler_that_is_missing_or_fails_is_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let program = folder.path().join("g++");
        let said = |program: &Path| {
            Plain::build(program)
                .map(|_| ())
                .expect_err("no program")
                .to_string()
        };
        assert!(said(&program).contains("cannot start"));
        script(&program, "echo 'no memory' >&2\nexit 1");
        assert!(said(&program).ends_with("no memory\n"), "{}", said(&program));
    }
}
