//! What each choice of `precise` buys: one at a time is the published system's.

use maud::html;
use tracer::kronecker::Stratified;
use tracer::profile::{Paper, Precise};
use tracer::unit::{Plan, Termination};

use super::super::part::{Error, Part, SCENE, Workshop};
use super::super::plot::{Axis, Plot, Point, Series, number};
use super::super::section::{Figure, Section};
use super::super::table::Table;
use crate::firmware::Choice;
use crate::firmware::arithmetic::{Arithmetic, Sampler};
use crate::firmware::board::Board;
use crate::image::picture::Estimate;
use crate::oracle::compare::{Comparison, compare};
use crate::oracle::direct;
use crate::oracle::lockstep::{self, Paired};
use crate::oracle::noise::{self, Noise};
use crate::oracle::reference::{self, Rendered, cache};
use crate::platform::setup::Install;
use crate::platform::workspace;
use crate::render::options::{Backend, End, Epsilon, PictureOptions, Pixels, Reference, RenderOptions, Size};
use crate::render::render;
use crate::scene::{CompiledScene, Integrator, Scene, compile, samples_per_unit};
use crate::stability::{Effort, figure};
use fixedmath::I16F16;

/// The part.
pub(super) const PART: Part = Part {
    name: "choices",
    about: "each choice switched alone: cycles against bias and error",
    make,
};

/// The published epsilon, in the scene's unit of length.
const EPSILON: f64 = 0.1;
/// Surfaces after which the published system's paths end.
const DEPTH: u8 = 5;
/// Standard errors below which a bias is not told from none.
const SURE: f64 = 2.0;

/// What is switched, and from what.
#[derive(Clone, Copy)]
struct Variant {
    name: &'static str,
    profile: Arithmetic,
    choice: Option<Choice>,
    epsilon: bool,
    end: Termination,
    integrator: Integrator,
    sampler: Sampler,
}

/// The default.
const DEFAULT: Variant = Variant {
    name: "precise, the default",
    profile: Arithmetic::Precise,
    choice: None,
    epsilon: false,
    end: Termination::Roulette,
    integrator: Arithmetic::Precise.integrator(),
    sampler: Arithmetic::Precise.sampler(),
};

const fn single(name: &'static str, choice: Choice) -> Variant {
    Variant {
        name,
        choice: Some(choice),
        ..DEFAULT
    }
}

const VARIANTS: [Variant; 14] = [
    DEFAULT,
    single("roots bit by bit", Choice::Root),
    single("division bit by bit", Choice::Division),
    single("directions in 16:16", Choice::Directions),
    single("low bits of a generator", Choice::Generator),
    single("textbook's intersection", Choice::Intersection),
    Variant {
        epsilon: true,
        ..single("textbook and epsilon 0.1", Choice::Intersection)
    },
    single("Malley's disc", Choice::Hemisphere),
    single("Malley's disc, parabolic sine", Choice::Sine),
    Variant {
        name: "epsilon 0.1",
        epsilon: true,
        ..DEFAULT
    },
    Variant {
        name: "depth 5",
        end: Termination::Depth(DEPTH),
        ..DEFAULT
    },
    Variant {
        name: "paths that do not look for light",
        integrator: Integrator::Path,
        ..DEFAULT
    },
    Variant {
        name: "independent samples",
        sampler: Sampler::Independent,
        ..DEFAULT
    },
    Variant {
        name: "paper: all of the published",
        profile: Arithmetic::Paper,
        integrator: Arithmetic::Paper.integrator(),
        sampler: Arithmetic::Paper.sampler(),
        ..DEFAULT
    },
];
/// Those of a quick run: one image of each kind.
const QUICK: [usize; 3] = [0, 1, 13];

/// How large, and by how many samples.
struct Job<'a> {
    scene: Scene,
    reference: Rendered,
    size: [u16; 2],
    spp: u32,
    workshop: &'a Workshop<'a>,
}

fn make(workshop: &Workshop<'_>, effort: &Effort) -> Result<Section, Error> {
    let (size, spp) = workshop.either(([64, 48], 1024), ([8, 6], 64));
    let wanted: Vec<Variant> = match workshop.quick {
        true => QUICK.map(|index| VARIANTS[index]).to_vec(),
        false => VARIANTS.to_vec(),
    };
    let costs: Vec<f64> = wanted
        .iter()
        .map(|variant| variant.cycles(workshop))
        .collect::<Result<_, _>>()?;
    let scene = Scene::load(&workspace::file(SCENE)?)?;
    let reference = the_reference(&scene, size, spp);
    let job = Job {
        scene,
        reference,
        size,
        spp,
        workshop,
    };
    let samples = u64::from(size[0]) * u64::from(size[1]) * u64::from(spp);
    effort.expect(2 * samples * wanted.len() as u64);
    let mut found = Vec::new();
    for (variant, cycles) in wanted.into_iter().zip(costs) {
        found.push(Found::of(variant, cycles, &job, effort)?);
    }
    let figures = vec![
        Figure::Plot(biases(&found)),
        Figure::Plot(errors(&found)),
        Figure::Table(table(&found)),
    ];
    Ok(Section {
        name: PART.name,
        title: "Choices",
        prose: html! {
            p { "Everything as " code { "precise" } " has it but for one thing. Each has an image of its own, in which the emulated core's cycles are counted; the \
                 host draws the same picture to the bit, which is checked, and compares it. Bias and error are from the same samples in double precision, \
                 where noise is next to none. Only what double precision has as well, where paths end and what the generator does to them, is compared \
                 with the independent reference; there noise hides more." }
            p { code { "precise" } " draws no sine: that choice is beside Malley's disc, which needs one. The low bits alone are 16, so two draws make a number. \
                 Directions in 16:16 are cut by an instruction a component, which formats of 16:16 would not need. To look for light, and to keep samples apart, is \
                 not for the arithmetic but against noise: what it costs to do without is in the last column. The published system does neither." }
        },
        commands: &[
            "cargo xtask render --size 64x48 --cycles --choice root",
            "cargo xtask render --size 64x48 --cycles --epsilon 0.1",
        ],
        figures,
    })
}

fn the_reference(scene: &Scene, [width, height]: [u16; 2], spp: u32) -> Rendered {
    let job = reference::Job {
        width,
        height,
        spp,
        termination: reference::Termination::Roulette,
        seed: 1,
    };
    cache::reference(cache::folder(None).as_deref(), scene, &job, |_| ()).0
}

impl Variant {
    /// Cycles a sample on the ARMv5TE, after a look at whether the host draws the same picture.
    fn cycles(&self, workshop: &Workshop<'_>) -> Result<f64, Error> {
        let folder = tempfile::tempdir()?;
        let size = workshop.either(
            Size {
                width: 64,
                height: 48,
            },
            Size { width: 8, height: 6 },
        );
        let options = RenderOptions {
            picture: PictureOptions {
                scene: Some(workspace::file(SCENE)?),
                size,
                spp: workshop.either(64, 16),
                cores: 2,
                profile: self.profile,
                integrator: Some(self.integrator),
                sampler: Some(self.sampler),
                epsilon: self
                    .epsilon
                    .then(|| EPSILON.to_string().parse::<Epsilon>())
                    .transpose()?,
                termination: End(self.end),
                pixels: Pixels::Leased,
                seed: 1,
                reference: Some(Reference::None),
                reference_spp: None,
                patience: None,
                reference_cache: None,
                out: Some(folder.path().to_owned()),
            },
            boards: vec![Board::Versatilepb],
            backend: Backend::Qemu,
            log: None,
            cycles: true,
            code_access: 0,
            soft_float: None,
            choice: self.choice,
            port: None,
            no_install: workshop.install == Install::Forbidden,
        };
        let report = render(&options, workshop.interrupted)?.report;
        let scene = Scene::load(&workspace::file(SCENE)?)?;
        let compiled = compile(&scene, size.width, size.height, self.integrator);
        let plan = self.plan(
            &scene,
            &compiled,
            [size.width, size.height],
            workshop.either(64, 16),
        );
        if self.film_sha256(&compiled, &plan) != report.image_sha256 {
            return Err(format!(
                "{}: the host draws another picture than the core does, so its errors are not the core's",
                self.name
            )
            .into());
        }
        let cycles = report.cost.cycles_per_sample;
        Ok(cycles.ok_or_else(|| {
            format!(
                "nobody counted the cycles of `{}`: run the report again",
                self.name
            )
        })?)
    }

    fn plan(&self, scene: &Scene, compiled: &CompiledScene, [width, height]: [u16; 2], spp: u32) -> Plan {
        Plan {
            width,
            height,
            spp,
            samples_per_unit: samples_per_unit(scene, spp, self.end),
            seed: 1,
            termination: self.end,
            epsilon: if self.epsilon {
                I16F16::from_num(EPSILON * 2f64.powi(compiled.scale.exponent))
            } else {
                self.profile.epsilon(compiled.scale.magnification)
            },
        }
    }

    fn film_sha256(&self, compiled: &CompiledScene, plan: &Plan) -> String {
        let film = match self.choice {
            Some(choice) => direct::film_of_choice(choice, compiled, plan),
            None => direct::film_as(self.profile, self.sampler, compiled, plan),
        };
        film.sha256()
    }

    /// Its picture, beside doubles that have no epsilon to speak of.
    fn paired(&self, compiled: &CompiledScene, plan: &Plan, effort: &Effort) -> Paired {
        let done = |samples| effort.done(2 * samples);
        match (self.choice, self.profile, self.epsilon) {
            (Some(choice), _, _) => {
                lockstep::render_choice_beside(choice, compiled, plan, I16F16::DELTA, done)
            }
            (None, Arithmetic::Precise, true) => {
                lockstep::render_beside::<Stratified<Precise>>(compiled, plan, I16F16::DELTA, done)
            }
            (None, Arithmetic::Paper, _) => {
                lockstep::render_beside::<Paper>(compiled, plan, I16F16::DELTA, done)
            }
            (None, Arithmetic::Precise, false) => {
                lockstep::render_as(self.profile, self.sampler, compiled, plan, done)
            }
        }
    }

    /// Whether double precision has the fault, too, so that only the independent reference shows it.
    fn is_shared_by_doubles(&self) -> bool {
        self.choice == Some(Choice::Generator) || self.end != Termination::Roulette
    }
}

/// What a choice costs and does.
struct Found {
    name: &'static str,
    cycles: f64,
    /// Against what it was compared.
    against: &'static str,
    comparison: Comparison,
    noise: Noise,
    is_default: bool,
}

impl Found {
    fn of(variant: Variant, cycles: f64, job: &Job<'_>, effort: &Effort) -> Result<Self, Error> {
        let compiled = compile(&job.scene, job.size[0], job.size[1], variant.integrator);
        let plan = variant.plan(&job.scene, &compiled, job.size, job.spp);
        let paired = variant.paired(&compiled, &plan, effort);
        let noise = match variant.choice {
            Some(choice) => noise::noise_of_choice(choice, &compiled, &plan),
            None => noise::noise(variant.profile, variant.sampler, &compiled, &plan, |_| ()),
        };
        let noise = noise.or_else(|| job.workshop.quick.then(|| noise_of(&paired.picture))?);
        let (against, comparison) = if variant.is_shared_by_doubles() {
            let picture = job.reference.pooled_noise(paired.picture, variant.integrator);
            ("the reference", compare(&picture, &job.reference.estimate)?)
        } else {
            let (picture, double) = paired.difference();
            ("double precision", compare(&picture, &double)?)
        };
        Ok(Self {
            name: variant.name,
            cycles,
            against,
            comparison,
            noise: noise.ok_or("the noise of a choice is not known")?,
            is_default: variant.name == DEFAULT.name,
        })
    }

    /// The bias in per cent, and its standard error.
    fn bias(&self) -> [f64; 2] {
        [self.comparison.bias, self.comparison.bias_standard_error]
            .map(|share| 100.0 * share.unwrap_or_default())
    }

    /// The size of the bias, or the most that it may be where it is not told from none.
    fn bias_at_most(&self) -> (f64, bool) {
        let [bias, error] = self.bias();
        if bias.abs() > SURE * error {
            (bias.abs(), false)
        } else {
            (SURE * error, true)
        }
    }

    /// The error, or the most that it may be where it is not told from none.
    fn error_at_most(&self) -> (f64, bool) {
        let squared = self.comparison.squared_error;
        if squared.corrected > SURE * squared.standard_error {
            (self.comparison.rmse, false)
        } else {
            (squared.rmse_at_most(), true)
        }
    }
}

/// What a picture's own samples say of its noise, as if they were independent: all that a quick run has.
fn noise_of(picture: &Estimate) -> Option<Noise> {
    let spp = f64::from(picture.spp?);
    let variance = picture.variance.as_ref()?.iter();
    Some(Noise {
        variance: variance
            .map(|channels| spp * channels.iter().sum::<f64>() / 3.0)
            .collect(),
    })
}

fn scatter(
    name: &str,
    title: &str,
    upwards: &str,
    found: &[Found],
    value: impl Fn(&Found) -> (f64, bool),
) -> Plot {
    let points = |belongs: &dyn Fn(&Found) -> bool| -> Vec<Point> {
        let found = found.iter().filter(|found| belongs(found));
        found
            .map(|found| {
                let (value, at_most) = value(found);
                Point {
                    at_most,
                    ..Point::new(found.name, [found.cycles, value])
                }
            })
            .collect()
    };
    let all = [
        Series::of_named("all ours", 0, points(&|found| found.is_default)),
        Series::of_named(
            "one choice switched, beside double precision",
            1,
            points(&|found| !found.is_default && found.against == "double precision"),
        ),
        Series::of_named(
            "beside the reference",
            3,
            points(&|found| found.against == "the reference"),
        ),
    ];
    Plot {
        about: "To the right is dearer, upwards is worse. Hollow marks are bounds, where noise hides what is below them.".to_owned(),
        series: all.into_iter().filter(|series| !series.points.is_empty()).collect(),
        ..Plot::new(name, title, Axis::log("cycles a sample"), Axis::log(upwards))
    }
}

fn biases(found: &[Found]) -> Plot {
    scatter(
        "choices-bias",
        "What a choice costs, and its bias",
        "bias of the mean, %",
        found,
        Found::bias_at_most,
    )
}

fn errors(found: &[Found]) -> Plot {
    scatter(
        "choices-error",
        "What a choice costs, and its error",
        "rms error without noise, radiance",
        found,
        Found::error_at_most,
    )
}

fn table(found: &[Found]) -> Table {
    let head = [
        "switched",
        "cycles a sample",
        "of the default's",
        "bias, %",
        "standard error, %",
        "error",
        "error, at most",
        "beside",
        "efficiency",
    ];
    let mut table = Table::new("Each choice alone", head).with_notes(
        "Efficiency: geometric mean over pixels of the default's cycles times variance over the row's; above 1 a picture of the same noise takes fewer cycles.",
    );
    let default = found.iter().find(|found| found.is_default);
    for row in found {
        let [bias, error] = row.bias();
        let relative = default.map_or_else(String::new, |default| {
            format!("{:.3}", row.cycles / default.cycles)
        });
        let efficiency = default.map_or_else(String::new, |default| {
            number(row.noise.less_than(&default.noise) * default.cycles / row.cycles)
        });
        table.push(vec![
            row.name.to_owned(),
            number(row.cycles),
            relative,
            figure(bias),
            figure(error),
            figure(row.comparison.rmse),
            figure(row.comparison.squared_error.rmse_at_most()),
            row.against.to_owned(),
            efficiency,
        ]);
    }
    table
}
