//! What a profile found, and how it is kept in a file.

use std::path::{Path, PathBuf};
use std::{fs, io};

use serde::{Deserialize, Serialize};

use super::cost::Cost;
use crate::firmware::arithmetic::Sampler;
use crate::render::report::BlindSpot;
use crate::scene::Integrator;

/// The version of the file's form. Another is not compared.
pub const FORMAT: u32 = 1;

/// What was rendered, on what.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Subject {
    /// The board.
    pub board: String,
    /// The arithmetic.
    pub profile: String,
    /// The scene.
    pub scene: String,
    /// Width and height in pixels.
    pub size: [u16; 2],
    /// Samples a pixel.
    pub spp: u32,
    /// `path` or `next-event`; before there was a choice it was `path`.
    #[serde(default = "only_integrator")]
    pub integrator: String,
    /// `independent` or `kronecker`, likewise.
    #[serde(default = "only_sampler")]
    pub sampler: String,
    /// `roulette` or `depth:N`.
    pub termination: String,
    /// How far from a surface a new ray starts at least, in 16:16.
    pub epsilon_bits: i32,
    /// Of the random numbers.
    pub seed: u64,
    /// Cycles that an access to instruction memory is taken to last longer.
    pub code_access: u32,
}

fn only_integrator() -> String {
    Integrator::Path.to_string()
}

fn only_sampler() -> String {
    Sampler::Independent.to_string()
}

/// A profile.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// [`FORMAT`].
    pub format: u32,
    /// What was rendered.
    #[serde(flatten)]
    pub subject: Subject,
    /// Samples.
    pub samples: u64,
    /// Rays.
    pub rays: u64,
    /// All of it.
    pub total: Cost,
    /// Between what bounds `total.cycles` lies as far as the model of the processor knows.
    pub cycles_at_least: u64,
    /// The upper one.
    pub cycles_at_most: u64,
    /// What the model does not see, and the worst that each can do; a run of before there was such a list has none.
    #[serde(default)]
    pub blind_spots: Vec<BlindSpot>,
    /// Cycles a sample.
    pub cycles_per_sample: f64,
    /// Instructions a sample.
    pub instructions_per_sample: f64,
    /// Cycles a ray.
    pub cycles_per_ray: f64,
    /// Instructions a ray.
    pub instructions_per_ray: f64,
    /// By function, the dearest by itself first.
    pub functions: Vec<Function>,
    /// By class of instruction, the dearest first.
    pub classes: Vec<Named>,
    /// By line of the source, the dearest first.
    pub lines: Vec<Named>,
    /// The hottest blocks that were asked for, the hottest first.
    pub blocks: Vec<Block>,
}

/// What a function costs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Function {
    /// Its name, without the arguments of generic functions.
    pub name: String,
    /// By itself, wherever it was inlined.
    #[serde(rename = "self")]
    pub own: Cost,
    /// With all that it calls and all that is inlined into it.
    pub inclusive_cycles: u64,
    /// Instructions, likewise.
    pub inclusive_instructions: u64,
}

/// What something costs that has a name.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Named {
    /// The name.
    pub name: String,
    /// The cost.
    #[serde(flatten)]
    pub cost: Cost,
}

/// A basic block: it is entered at its first instruction and left after its last.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Block {
    /// Times it was entered.
    pub executions: u64,
    /// The function it is part of.
    pub function: String,
    /// All of it.
    pub cost: Cost,
    /// Its instructions.
    pub instructions: Vec<Instruction>,
}

/// An instruction of a block.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Instruction {
    /// Its address.
    pub address: u32,
    /// In words of the assembler.
    pub text: String,
    /// File and line of its source.
    pub line: String,
    /// What it cost.
    pub cost: Cost,
}

/// A file that is of no use for a comparison.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// It cannot be read.
    #[error("cannot read {}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        #[source]
        cause: io::Error,
    },
    /// It holds something else.
    #[error("{} is no run that `cargo xtask profile --json` has written", path.display())]
    Form {
        /// The file.
        path: PathBuf,
        /// Where it differs.
        #[source]
        cause: serde_json::Error,
    },
    /// It is of another version.
    #[error(
        "{} is a run in format {found}, and this version compares runs in format {FORMAT}: profile the sources to compare with \
         anew, by this version's `cargo xtask profile --json`",
        path.display()
    )]
    Version {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: u32,
    },
    /// It is of something else.
    #[error("{} is of {}: only runs of the same are compared", path.display(), differences.join(", of "))]
    Subject {
        /// The file.
        path: PathBuf,
        /// What differs, as in `board mps2-an385 and not versatilepb`.
        differences: Vec<String>,
    },
}

impl Run {
    /// Reads a run that was saved.
    pub fn read(path: &Path) -> Result<Self, RunError> {
        /// What all versions have in common.
        #[derive(Deserialize)]
        struct Versioned {
            format: u32,
        }
        let bytes = fs::read(path).map_err(|cause| RunError::Read {
            path: path.to_owned(),
            cause,
        })?;
        let form = |cause| RunError::Form {
            path: path.to_owned(),
            cause,
        };
        let Versioned { format: found } = serde_json::from_slice(&bytes).map_err(form)?;
        if found != FORMAT {
            return Err(RunError::Version {
                path: path.to_owned(),
                found,
            });
        }
        serde_json::from_slice(&bytes).map_err(form)
    }

    /// Refuses to be compared with a run of something else; `path` is where this one was read.
    pub fn check(&self, path: &Path, subject: &Subject) -> Result<(), RunError> {
        let differences = self.subject.differences(subject);
        if differences.is_empty() {
            Ok(())
        } else {
            Err(RunError::Subject {
                path: path.to_owned(),
                differences,
            })
        }
    }
}

impl Subject {
    fn differences(&self, other: &Self) -> Vec<String> {
        let aspects = |of: &Self| {
            [
                ("board", of.board.clone()),
                ("profile", of.profile.clone()),
                ("scene", of.scene.clone()),
                ("size", format!("{}x{}", of.size[0], of.size[1])),
                ("spp", of.spp.to_string()),
                ("integrator", of.integrator.clone()),
                ("sampler", of.sampler.clone()),
                ("termination", of.termination.clone()),
                ("epsilon", (f64::from(of.epsilon_bits) / 65536.0).to_string()),
                ("seed", of.seed.to_string()),
                ("code access", of.code_access.to_string()),
            ]
        };
        let pairs = aspects(self).into_iter().zip(aspects(other));
        pairs
            .filter(|(mine, others)| mine != others)
            .map(|((aspect, mine), (_, others))| format!("{aspect} {mine} and not {others}"))
            .collect()
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A run of four samples, whose functions cost so many cycles by themselves.
    pub(in super::super) fn run(functions: &[(&str, u64)]) -> Run {
        let cost = |cycles| Cost {
            cycles,
            instructions: cycles / 2,
            load_stalls: 1,
            multiply_stalls: 1,
        };
        let all = functions.iter().map(|(_, cycles)| cycles).sum();
        let named = |&(name, cycles): &(&str, u64)| Named {
            name: name.to_owned(),
            cost: cost(cycles),
        };
        Run {
            format: FORMAT,
            subject: Subject {
                board: "versatilepb".to_owned(),
                profile: "precise".to_owned(),
                scene: "cornell".to_owned(),
                size: [1, 1],
                spp: 4,
                integrator: "path".to_owned(),
                sampler: "independent".to_owned(),
                termination: "roulette".to_owned(),
                epsilon_bits: 16,
                seed: 1,
                code_access: 0,
            },
            samples: 4,
            rays: 8,
            total: cost(all),
            cycles_at_least: all,
            cycles_at_most: all + 4,
            blind_spots: vec![
                BlindSpot {
                    what: "a great thing".to_owned(),
                    less: 0.0,
                    more: 0.01,
                },
                BlindSpot {
                    what: "nothing to speak of".to_owned(),
                    less: 1e-7,
                    more: 0.0,
                },
            ],
            cycles_per_sample: all as f64 / 4.0,
            instructions_per_sample: (all / 2) as f64 / 4.0,
            cycles_per_ray: all as f64 / 8.0,
            instructions_per_ray: (all / 2) as f64 / 8.0,
            functions: functions
                .iter()
                .map(|&(name, cycles)| Function {
                    name: name.to_owned(),
                    own: cost(cycles),
                    inclusive_cycles: cycles,
                    inclusive_instructions: cycles / 2,
                })
                .collect(),
            classes: functions.iter().map(named).collect(),
            lines: Vec::new(),
            blocks: Vec::new(),
        }
    }

    #[test]
    fn a_run_is_read_as_it_was_written_and_nothing_else_is() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("run.json");
        let missing = Run::read(&file).expect_err("there is no file").to_string();
        assert!(missing.contains("run.json"), "{missing}");
        let run = run(&[("a::b", 100), ("c", 1)]);
        let json = serde_json::to_string_pretty(&run).expect("JSON");
        fs::write(&file, &json).expect("a file");
        assert_eq!(Run::read(&file).expect("the run"), run);

        let older = json.replace("blind_spots", "unknown_then");
        fs::write(&file, &older).expect("a file");
        assert_eq!(Run::read(&file).expect("the run").blind_spots, []);

        let newer = json.replace("\"format\": 1", "\"format\": 2");
        // Of another version nothing but its number need be understood.
        for other in [&newer, "{\"format\": 2, \"all\": \"new\"}"] {
            fs::write(&file, other).expect("a file");
            let error = Run::read(&file).expect_err(other).to_string();
            assert!(error.contains("in format 2") && error.contains("anew"), "{error}");
        }
        for other in ["[]", "{\"format\": 1}", &json[..json.len() / 2], ""] {
            fs::write(&file, other).expect("a file");
            let error = Run::read(&file).expect_err(other).to_string();
            assert!(
                error.contains("no run that `cargo xtask profile --json`"),
                "{error}"
            );
        }
    }

    #[test]
    fn runs_of_different_things_are_told_apart() {
        let (run, file) = (run(&[("a", 4)]), Path::new("run.json"));
        run.check(file, &run.subject).expect("it is the same");
        let other = Subject {
            board: "mps2-an385".to_owned(),
            epsilon_bits: 1 << 15,
            ..run.subject.clone()
        };
        let error = run.check(file, &other).expect_err("another").to_string();
        assert_eq!(
            error,
            "run.json is of board versatilepb and not mps2-an385, of epsilon 0.000244140625 and not 0.5: only runs of the same \
             are compared"
        );
    }
}
