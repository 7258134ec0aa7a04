//! Error against time: how good a picture is after so many cycles of a core.

use floating::Lockstep;
use maud::{Markup, html};
use tracer::kronecker::Stratified;
use tracer::profile::{Paper, Precise, Profile};
use tracer::unit::{Plan, Termination};

use super::super::part::{Error, Part, SCENE, Workshop};
use super::super::picture::Image;
use super::super::plot::{Along, Axis, Clock, Line, Plot, Point, Rule, Series, number};
use super::super::section::{Figure, Section};
use super::super::table::Table;
use super::CLOCK;
use crate::bench::samples::Row;
use crate::firmware::arithmetic::Arithmetic;
use crate::firmware::board::Board;
use crate::image::picture::{Estimate, Picture};
use crate::oracle::compare::compare;
use crate::oracle::reference::cache;
use crate::oracle::{direct, lockstep, reference};
use crate::platform::workspace;
use crate::scene::{CompiledScene, Integrator, Scene, compile, samples_per_unit};
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
/// Standard errors below which a bias is not told from none.
const SURE: f64 = 2.0;

/// A way to compute the picture.
struct System {
    name: &'static str,
    /// As the rows of samples call it.
    row: RowName,
    integrator: Integrator,
    arithmetic: Arithmetic,
    /// A picture, beside the same samples in double precision.
    render: fn(&CompiledScene, &Plan, &Effort) -> lockstep::Paired,
    /// The picture alone, and what its film's sums hash to.
    film: fn(&CompiledScene, &Plan) -> (Picture, String),
    /// Whether there is an arithmetic to tell from double precision.
    is_exact: bool,
}

/// Profile, integrator and sampler.
type RowName = [&'static str; 3];

fn paired<P: Profile<Random: Clone>>(
    compiled: &CompiledScene,
    plan: &Plan,
    effort: &Effort,
) -> lockstep::Paired {
    lockstep::render::<P>(compiled, plan, |samples| effort.done(2 * samples))
}

fn film<P: Profile>(compiled: &CompiledScene, plan: &Plan) -> (Picture, String) {
    let film = direct::film::<P>(compiled, plan);
    (film.picture(), film.sha256())
}

const SYSTEMS: [System; 5] = [
    System {
        name: "precise, next event, Kronecker",
        row: ["precise", "next-event", "kronecker"],
        integrator: Integrator::NextEvent,
        arithmetic: Arithmetic::Precise,
        render: paired::<Stratified<Precise>>,
        film: film::<Stratified<Precise>>,
        is_exact: false,
    },
    System {
        name: "precise",
        row: ["precise", "path", "independent"],
        integrator: Integrator::Path,
        arithmetic: Arithmetic::Precise,
        render: paired::<Precise>,
        film: film::<Precise>,
        is_exact: false,
    },
    System {
        name: "paper",
        row: ["paper", "path", "independent"],
        integrator: Integrator::Path,
        arithmetic: Arithmetic::Paper,
        render: paired::<Paper>,
        film: film::<Paper>,
        is_exact: false,
    },
    System {
        name: "soft float, single",
        row: ["precise in f32", "path", "independent"],
        integrator: Integrator::Path,
        arithmetic: Arithmetic::Precise,
        render: paired::<Lockstep<Precise, f32>>,
        film: film::<Lockstep<Precise, f32>>,
        is_exact: false,
    },
    System {
        name: "soft float, double",
        row: ["precise in f64", "path", "independent"],
        integrator: Integrator::Path,
        arithmetic: Arithmetic::Precise,
        render: paired::<Lockstep<Precise, f64>>,
        film: film::<Lockstep<Precise, f64>>,
        is_exact: true,
    },
];

/// What is rendered.
struct Job {
    scene: Scene,
    size: [u16; 2],
    /// Samples a pixel at most, a power of 4.
    most: u32,
}

fn make(workshop: &Workshop<'_>, effort: &Effort) -> Result<Section, Error> {
    let rows = workshop.samples()?;
    let (size, most) = workshop.either(([32, 24], 1 << 16), ([8, 6], 64));
    let job = Job {
        scene: Scene::load(&workspace::file(SCENE)?)?,
        size,
        most,
    };
    let compared = agreed(workshop, rows)?;
    let reference = job.reference(effort);
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

/// The plan of a picture as cores have it.
fn plan(arithmetic: Arithmetic, scene: &Scene, [width, height]: [u16; 2], spp: u32, seed: u64) -> Plan {
    Plan {
        width,
        height,
        spp,
        samples_per_unit: samples_per_unit(scene, spp, Termination::Roulette),
        seed,
        termination: Termination::Roulette,
        epsilon: arithmetic.epsilon(scene.scale().magnification),
    }
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

    /// The independent reference of as many samples as the best picture has, kept among the user's caches.
    fn reference(&self, effort: &Effort) -> Estimate {
        let samples = self.counts().sum::<u32>();
        effort.expect(self.pixels() * (u64::from(self.most) + 2 * SYSTEMS.len() as u64 * u64::from(samples)));
        let job = reference::Job {
            width: self.size[0],
            height: self.size[1],
            spp: self.most,
            termination: reference::Termination::Roulette,
            seed: 1,
        };
        let (rendered, _origin) = cache::reference(cache::folder(None).as_deref(), &self.scene, &job, |_| ());
        effort.done(self.pixels() * u64::from(self.most));
        rendered.estimate
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
        reference: &Estimate,
        effort: &Effort,
    ) -> Result<Self, Error> {
        let compiled = job.compiled(system);
        let (mut steps, mut last) = (Vec::new(), None);
        for spp in job.counts() {
            let paired = (system.render)(
                &compiled,
                &plan(system.arithmetic, &job.scene, job.size, spp, 1),
                effort,
            );
            let found = compare(&paired.picture, reference)?;
            let bias = [found.bias, found.bias_standard_error].map(Option::unwrap_or_default);
            let error = error_beside(&paired.picture.picture, reference);
            steps.push((spp, Step { error, bias }));
            last = Some(paired);
        }
        let last = last.ok_or("no picture was rendered")?;
        let (picture, double) = last.difference();
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
            name: format!("a picture of 256x192 on one core of {} MHz", CLOCK / 1e6),
            seconds: PIXELS / CLOCK,
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
    let has_floor = |course: &&Course| {
        !course.system.is_exact && course.system.integrator == Integrator::Path && course.floor[0] > 0.0
    };
    let rules = courses.iter().filter(has_floor).map(|course| Rule {
        along: Along::Upwards,
        value: course.floor[0],
        name: format!("floor of {}: {}", course.system.name, figure(course.floor[0])),
    });
    Plot {
        about: format!(
            "The Cornell box from 4 to {} samples a pixel, beside an independent picture in double precision. Noise alone falls by half with each \
             fourfold time; a floor is what the arithmetic leaves however long it takes.",
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
    let mut table = Table::new("What arithmetic leaves", head.map(str::to_owned).to_vec()).with_notes(
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
    let seconds = budget * PIXELS / CLOCK;
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
