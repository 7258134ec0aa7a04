//! Error against time: how good a picture is after so many cycles of a core.

mod systems;

use maud::{Markup, html};

use systems::{SYSTEMS, System, plan};

use super::super::part::{Error, Part, SCENE, Workshop};
use super::super::picture::Image;
use super::super::plot::{Along, Axis, Clock, Line, Plot, Point, Rule, Series, number};
use super::super::section::{Figure, Section};
use super::super::table::Table;
use crate::bench::samples::Row;
use crate::bench::scaling::published::CLOCK;
use crate::firmware::board::Board;
use crate::image::picture::{Estimate, Picture};
use crate::oracle::compare::compare;
use crate::oracle::reference;
use crate::oracle::reference::{Rendered, cache};
use crate::platform::workspace;
use crate::scene::{CompiledScene, Integrator, Scene, compile};
use crate::stability::{Effort, error_beside, figure};

/// The part.
pub(super) const PART: Part = Part {
    name: "error-against-time",
    about: "error and bias against cycles of a core, and where arithmetic stops them",
    make,
};

/// The name of the plot that is written as a file of its own, too.
pub(in crate::report) const TELLING: &str = "error-against-time-rmse";

/// Pixels of the picture that the time's scale is for: the default size of `cargo xtask render`.
const PIXELS: f64 = 256.0 * 192.0;
/// Pixels of the pictures that are compared. Of smaller ones many rays of the top row start above the ceiling, and `paper` does not see it then.
const SIZE: [u16; 2] = [48, 32];
/// Samples a pixel by which the floor is found.
const PAIRED: u32 = 4096;
/// Floors that are so many times below the best picture are not drawn.
const FAR_BELOW: f64 = 30.0;
/// Standard errors below which a bias is not told from none.
const SURE: f64 = 2.0;

/// What is rendered.
struct Job {
    scene: Scene,
    size: [u16; 2],
    /// Samples a pixel at most, a power of 4.
    most: u32,
}

fn make(workshop: &Workshop<'_>, effort: &Effort) -> Result<Section, Error> {
    let rows = workshop.samples()?;
    let (size, most) = workshop.either((SIZE, 1 << 16), ([8, 6], 64));
    let job = Job {
        scene: Scene::load(&workspace::file(SCENE)?)?,
        size,
        most,
    };
    let compared = agreed(workshop, rows)?;
    let reference = job.reference();
    effort.expect(job.work());
    let courses: Vec<Course> = SYSTEMS
        .iter()
        .map(|system| Course::of(system, &job, rows, &reference, effort))
        .collect::<Result<_, _>>()?;
    let pictures = equal_time(workshop, &job.scene, &courses)?;
    Ok(Section {
        name: PART.name,
        title: "Error against time",
        prose: prose(&courses, &job, &compared),
        commands: &[
            "cargo xtask bench trace --soft-float",
            "cargo xtask verify stability convergence",
        ],
        figures: vec![
            Figure::Plot(errors(&courses, &job)),
            Figure::Plot(biases(&courses, &job)),
            Figure::Table(floors(&courses)),
            pictures,
        ],
    })
}

/// The row of a system on the ARMv5TE with roulette.
fn row<'a>(rows: &'a [Row], system: &System) -> Result<&'a Row, Error> {
    let [profile, integrator, sampler] = system.row;
    let found = rows.iter().find(|row| {
        row.board == Board::Versatilepb
            && row.termination == "roulette"
            && [
                row.profile.as_str(),
                &row.integrator.to_string(),
                row.sampler.name(),
            ] == [profile, integrator, sampler]
    });
    Ok(found.ok_or_else(|| format!("`cargo xtask bench trace` has no row for {}", system.name))?)
}

fn cycles(rows: &[Row], system: &System) -> Result<f64, Error> {
    let cycles = row(rows, system)?.cycles_per_sample;
    Ok(cycles.ok_or_else(|| {
        format!(
            "nobody counted the cycles of {}: run the report again",
            system.name
        )
    })?)
}

/// Whether the host draws what the cores drew whose cycles were counted: then errors that are found here are theirs. Says of what.
fn agreed(workshop: &Workshop<'_>, rows: &[Row]) -> Result<String, Error> {
    let series = workshop.series()?;
    let scene = Scene::load(&series.scene)?;
    let size = [series.size.width, series.size.height];
    for system in &SYSTEMS {
        let compiled = compile(&scene, size[0], size[1], system.integrator);
        let (_, here) = (system.film)(&compiled, &plan(system.arithmetic, &scene, size, series.spp, 1));
        if here != row(rows, system)?.image_sha256 {
            return Err(format!(
                "{}: the host draws another picture than the cores do, so its errors are not theirs; `cargo test --release -p whole-system \
                 --test system soft_float` may say why",
                system.name
            )
            .into());
        }
    }
    Ok(format!(
        "{}x{} pixels of {} samples",
        size[0], size[1], series.spp
    ))
}

impl Job {
    /// 4, 16, ... samples a pixel.
    fn counts(&self) -> impl Iterator<Item = u32> {
        (1..=self.most.ilog(4)).map(|power| 4u32.pow(power))
    }

    fn pixels(&self) -> u64 {
        u64::from(self.size[0]) * u64::from(self.size[1])
    }

    fn compiled(&self, system: &System) -> CompiledScene {
        compile(&self.scene, self.size[0], self.size[1], system.integrator)
    }

    /// Samples a pixel of the pictures beside their doubles.
    fn paired(&self) -> u32 {
        self.most.min(PAIRED)
    }

    /// What is to be done but for the reference.
    fn work(&self) -> u64 {
        let samples = self.counts().sum::<u32>() + 2 * self.paired();
        self.pixels() * SYSTEMS.len() as u64 * u64::from(samples)
    }

    /// The independent reference of as many samples as the best picture has, kept among the user's caches.
    fn reference(&self) -> Rendered {
        let job = reference::Job {
            width: self.size[0],
            height: self.size[1],
            spp: self.most,
            termination: reference::Termination::Roulette,
            seed: 1,
        };
        cache::reference(cache::folder(None).as_deref(), &self.scene, &job, |_| ()).0
    }
}

/// A picture with the noise that so many of its samples have by the reference's word.
fn with_noise(picture: Picture, system: &System, spp: u32, reference: &Rendered) -> Estimate {
    let of_a_sample = match system.integrator {
        Integrator::Path => &reference.plain_variance,
        Integrator::NextEvent => &reference.looking_variance,
    };
    let variance = of_a_sample
        .iter()
        .map(|variance| variance.map(|v| v / f64::from(spp)));
    Estimate {
        picture,
        variance: Some(variance.collect()),
        spp: Some(spp),
    }
}

/// How a system's pictures get better.
struct Course {
    system: &'static System,
    cycles: f64,
    /// Samples a pixel, and what comes of them.
    steps: Vec<(u32, Step)>,
    /// The root of the mean squared difference from double precision, noise taken off, and the most that it may be.
    floor: [f64; 2],
    /// The bias from double precision, and its standard error.
    arithmetic: [f64; 2],
}

/// How good a picture is.
struct Step {
    error: f64,
    /// From the reference, and its standard error.
    bias: [f64; 2],
}

impl Course {
    fn of(
        system: &'static System,
        job: &Job,
        rows: &[Row],
        reference: &Rendered,
        effort: &Effort,
    ) -> Result<Self, Error> {
        let compiled = job.compiled(system);
        let plan = |spp| plan(system.arithmetic, &job.scene, job.size, spp, 1);
        let mut steps = Vec::new();
        for spp in job.counts() {
            let (picture, _) = (system.film)(&compiled, &plan(spp));
            effort.done(job.pixels() * u64::from(spp));
            let picture = with_noise(picture, system, spp, reference);
            let found = compare(&picture, &reference.estimate)?;
            let bias = [found.bias, found.bias_standard_error].map(Option::unwrap_or_default);
            let error = error_beside(&picture.picture, &reference.estimate);
            steps.push((spp, Step { error, bias }));
        }
        let paired = (system.paired)(&compiled, &plan(job.paired()), effort);
        let (picture, double) = paired.difference();
        let lockstep = compare(&picture, &double)?;
        Ok(Self {
            system,
            cycles: cycles(rows, system)?,
            steps,
            floor: [lockstep.rmse, lockstep.squared_error.rmse_at_most()],
            arithmetic: [lockstep.bias, lockstep.bias_standard_error].map(Option::unwrap_or_default),
        })
    }

    fn series(&self, look: usize, point: impl Fn(&Step) -> (f64, bool)) -> Series {
        let points = self.steps.iter().map(|(spp, step)| {
            let (value, at_most) = point(step);
            Point {
                at_most,
                ..Point::new(
                    format!("{} samples a pixel", number(f64::from(*spp))),
                    [self.cycles * f64::from(*spp), value],
                )
            }
        });
        Series {
            name: self.system.name.to_owned(),
            points: points.collect(),
            line: Line::Solid,
            look,
            named: false,
        }
    }
}

fn over_time(
    name: &str,
    title: &str,
    upwards: &str,
    courses: &[Course],
    point: impl Fn(&Step) -> (f64, bool),
) -> Plot {
    let series = courses
        .iter()
        .enumerate()
        .map(|(look, course)| course.series(look, &point));
    Plot {
        series: series.collect(),
        clock: Some(Clock {
            name: format!(
                "a picture of 256x192 on one core of {} MHz",
                number(CLOCK.value / 1e6)
            ),
            seconds: PIXELS / CLOCK.value,
        }),
        ..Plot::new(name, title, Axis::log("cycles a pixel"), Axis::log(upwards))
    }
}

fn errors(courses: &[Course], job: &Job) -> Plot {
    let plot = over_time(
        TELLING,
        "Error against time",
        "root mean squared error, radiance",
        courses,
        |step| (step.error, false),
    );
    let best = courses
        .iter()
        .flat_map(|course| &course.steps)
        .map(|(_, step)| step.error)
        .fold(f64::INFINITY, f64::min);
    let has_floor = |course: &&Course| {
        !course.system.is_exact
            && course.system.integrator == Integrator::Path
            && course.floor[0] > best / FAR_BELOW
    };
    let rules = courses.iter().filter(has_floor).map(|course| Rule {
        along: Along::Upwards,
        value: course.floor[0],
        name: format!("floor of {}: {}", course.system.name, figure(course.floor[0])),
    });
    Plot {
        about: format!(
            "The Cornell box from 4 to {} samples a pixel, beside an independent picture in double precision. Noise alone falls by half with each \
             fourfold time; a floor is what the arithmetic leaves however long it takes; floors far below the best picture are in the table.",
            number(f64::from(job.most))
        ),
        rules: rules.collect(),
        ..plot
    }
}

fn biases(courses: &[Course], job: &Job) -> Plot {
    // A bias that its standard error does not tell from none could be as large as that leaves room for.
    let plot = over_time(
        "error-against-time-bias",
        "Bias against time",
        "bias of the mean, %",
        courses,
        |step| {
            let [bias, error] = step.bias.map(|share| 100.0 * share);
            if bias.abs() > SURE * error {
                (bias.abs(), false)
            } else {
                (SURE * error, true)
            }
        },
    );
    Plot {
        about: format!(
            "The picture's mean beside the reference's, at {}x{} pixels. Hollow marks are bounds: two standard errors, where the bias is not told from none.",
            job.size[0], job.size[1]
        ),
        ..plot
    }
}

fn floors(courses: &[Course]) -> Table {
    let head = [
        "arithmetic",
        "cycles a sample",
        "floor, radiance",
        "at most",
        "bias, %",
        "standard error, %",
    ];
    let mut table = Table::new("What arithmetic leaves", head).with_notes(
        "Beside the same samples in double precision, whose own floor is not known: the root of the mean squared difference with the noise \
         of paths that parted taken off, and what it may be at most.",
    );
    for course in courses.iter().filter(|course| !course.system.is_exact) {
        table.push(vec![
            course.system.name.to_owned(),
            number(course.cycles),
            figure(course.floor[0]),
            figure(course.floor[1]),
            figure(100.0 * course.arithmetic[0]),
            figure(100.0 * course.arithmetic[1]),
        ]);
    }
    table
}

/// Pictures that each took as many cycles as the dearest.
fn equal_time(workshop: &Workshop<'_>, scene: &Scene, courses: &[Course]) -> Result<Figure, Error> {
    let (size, samples) = workshop.either(([128, 96], 16.0), ([8, 6], 4.0));
    let dearest = courses.iter().map(|course| course.cycles).fold(0.0, f64::max);
    let budget = samples * dearest;
    let mut images = Vec::new();
    for course in courses {
        let spp = ((budget / course.cycles / 4.0).round() as u32).max(1) * 4;
        let system = course.system;
        let compiled = compile(scene, size[0], size[1], system.integrator);
        let (picture, _) = (system.film)(&compiled, &plan(system.arithmetic, scene, size, spp, 1));
        images.push(Image::of(
            format!("{}: {spp} samples a pixel", system.name),
            &picture,
        ));
    }
    let seconds = budget * PIXELS / CLOCK.value;
    Ok(Figure::Pictures {
        title: format!(
            "Equal time: {} cycles a pixel each, {} s for 256x192 on one core",
            figure(budget),
            number(seconds.round())
        ),
        images,
    })
}

fn prose(courses: &[Course], job: &Job, compared: &str) -> Markup {
    let find = |name: &str| courses.iter().find(|course| course.system.name == name);
    let times = |name: &str| Some(find(name)?.cycles / find("precise")?.cycles);
    html! {
        p { "How good a picture is after so many cycles of one core: cycles a sample, counted on the emulated core, times samples. Errors are those of \
             pictures on the host, " (job.size[0]) "x" (job.size[1]) " pixels, which gives cores' pictures to the bit: that was checked at " (compared)
            " for each line, soft float's too, before this was drawn." }
        @if let (Some(paper), Some(single), Some(double)) = (times("paper"), times("soft float, single"), times("soft float, double")) {
            p { "A sample by " code { "paper" } " takes " (number(paper)) " times the cycles of one by " code { "precise" }
                "; the same tracer in soft float, single precision, " (number(single)) " times, and in double " (number(double)) " times. To look for light and \
                 keep samples apart takes more cycles a sample, and far fewer samples." }
        }
    }
}
