//! Figures 2 and 3 of the paper once more: fixed point beside double precision, and what epsilon does.

use fixedmath::I16F16;
use tracer::profile::{Paper, Precise, Profile};
use tracer::unit::Plan;

use super::part::plan;
use super::sheet::Panel;
use super::table::{figure, share};
use super::{Effort, Error, Findings, Part, Plot, Sheet, Table};
use crate::firmware::arithmetic::Arithmetic;
use crate::image::picture::displayed;
use crate::oracle::compare::compare;
use crate::oracle::lockstep::{self, Paired};
use crate::platform::workspace;
use crate::scene::{CompiledScene, Integrator, Scene, compile};

/// The part.
pub(super) const PART: Part = Part {
    name: "figures",
    about: "the paper's figures 2 and 3: fixed point beside double precision, and what epsilon does",
    measure,
};

const SCENE: &str = "scenes/cornell.toml";
const SIZE: [u16; 2] = [64, 48];
/// Samples a pixel of figure 2, as published, and of each of figure 3's pictures.
const FIGURE_2: u64 = 20_000;
const FIGURE_3: u64 = 2048;
/// In the scene's unit of length.
const EPSILONS: [f64; 6] = [0.001, 0.003, 0.01, 0.03, 0.1, 0.3];
/// Differences of radiance that are shown in full colour.
const RANGE: f64 = 0.1;
/// An artefact is a pixel that is off by a level of an 8-bit display and by so many standard errors: noise makes one in a million.
const SURE: f64 = 5.0;

const UNITS: &str = "Beside the same samples in double precision, whose epsilon is 2^-16 of a core's unit of length. Bias in per cent of the mean, with its standard error. \
    Error: root of the mean squared difference, in radiance, what is noise in it taken off. Artefacts: pixels that are off by a level of an 8-bit display and by \
    five standard errors.";
const HEAD: [&str; 6] = [
    "arithmetic",
    "epsilon",
    "bias, %",
    "standard error, %",
    "error",
    "artefacts",
];

fn measure(effort: &Effort) -> Result<Findings, Error> {
    measure_apart(effort, effort)
}

/// The same, with another effort for figure 3.
pub(crate) fn measure_apart(effort: &Effort, of_three: &Effort) -> Result<Findings, Error> {
    let [two, three] = [effort.of(FIGURE_2), of_three.of(FIGURE_3)].map(|spp| spp.next_multiple_of(4) as u32);
    let pixels = u64::from(SIZE[0]) * u64::from(SIZE[1]);
    effort.expect(2 * pixels * (u64::from(two) + EPSILONS.len() as u64 * u64::from(three)));
    let scene = Scene::load(&workspace::file(SCENE)?)?;
    let compiled = compile(&scene, SIZE[0], SIZE[1], Integrator::Path);
    let mut findings = Findings::default();
    figure_2(&mut findings, effort, &compiled, two)?;
    figure_3(&mut findings, effort, &compiled, three)?;
    Ok(findings)
}

fn beside_double(arithmetic: Arithmetic, compiled: &CompiledScene, plan: &Plan, effort: &Effort) -> Paired {
    fn beside<P: Profile<Random: Clone>>(compiled: &CompiledScene, plan: &Plan, effort: &Effort) -> Paired {
        lockstep::render_beside::<P>(compiled, plan, I16F16::DELTA, |samples| effort.done(samples))
    }
    match arithmetic {
        Arithmetic::Precise => beside::<Precise>(compiled, plan, effort),
        Arithmetic::Paper => beside::<Paper>(compiled, plan, effort),
    }
}

fn figure_2(
    findings: &mut Findings,
    effort: &Effort,
    compiled: &CompiledScene,
    spp: u32,
) -> Result<(), Error> {
    let title = format!("`{SCENE}` at {spp} samples a pixel");
    let mut table = Table::new(&title, UNITS, &HEAD);
    let mut rows = Vec::new();
    for arithmetic in [Arithmetic::Precise, Arithmetic::Paper] {
        let plan = plan(arithmetic, compiled, SIZE, spp);
        let paired = beside_double(arithmetic, compiled, &plan, effort);
        let epsilon = f64::from(plan.epsilon) * 2f64.powi(-compiled.scale.exponent);
        table.push(Figures::of(&paired)?.row(arithmetic, epsilon));
        let [picture, double] = [&paired.picture.picture, &paired.double.picture];
        rows.push(vec![
            Panel::picture(format!("{arithmetic}, epsilon {}", figure(epsilon)), picture),
            Panel::picture("in double precision", double),
            Panel::difference(format!("difference, up to {RANGE}"), picture, double, RANGE),
        ]);
    }
    findings.tables.push(table);
    findings.sheets.push(Sheet {
        name: "figure-2",
        title: format!("The Cornell box at {spp} samples a pixel"),
        rows,
    });
    Ok(())
}

fn figure_3(
    findings: &mut Findings,
    effort: &Effort,
    compiled: &CompiledScene,
    spp: u32,
) -> Result<(), Error> {
    let title = format!("`{SCENE}` at {spp} samples a pixel, by epsilon");
    let mut table = Table::new(&title, UNITS, &HEAD);
    let (mut rows, mut biases, mut artefacts) = (Vec::new(), Vec::new(), Vec::new());
    for arithmetic in [Arithmetic::Precise, Arithmetic::Paper] {
        let (mut pictures, mut differences) = (Vec::new(), Vec::new());
        let (mut bias, mut artefact) = (Vec::new(), Vec::new());
        for epsilon in EPSILONS {
            let plan = Plan {
                epsilon: I16F16::from_num(epsilon * 2f64.powi(compiled.scale.exponent)),
                ..plan(arithmetic, compiled, SIZE, spp)
            };
            let paired = beside_double(arithmetic, compiled, &plan, effort);
            let found = Figures::of(&paired)?;
            table.push(found.row(arithmetic, epsilon));
            bias.push((epsilon, 100.0 * found.bias.abs()));
            artefact.push((epsilon, 100.0 * found.artefacts as f64 / found.pixels as f64));
            let [picture, double] = [&paired.picture.picture, &paired.double.picture];
            pictures.push(Panel::picture(
                format!("{arithmetic}, epsilon {epsilon}"),
                picture,
            ));
            differences.push(Panel::difference(
                "difference from double",
                picture,
                double,
                RANGE,
            ));
        }
        rows.extend([pictures, differences]);
        biases.push((format!("{arithmetic}, bias"), bias));
        artefacts.push((format!("{arithmetic}, artefacts"), artefact));
    }
    findings.tables.push(table);
    findings.plots.push(Plot {
        name: "figure-3-by-epsilon",
        title: "Epsilon, bias and artefacts".to_owned(),
        across: "epsilon, units of length",
        upwards: "per cent, of the mean or of all pixels",
        curves: biases.into_iter().chain(artefacts).collect(),
    });
    findings.sheets.push(Sheet {
        name: "figure-3",
        title: format!("Epsilon, at {spp} samples a pixel; differences of radiance up to {RANGE}"),
        rows,
    });
    Ok(())
}

/// What arithmetic has done to a picture.
struct Figures {
    bias: f64,
    bias_noise: f64,
    error: f64,
    artefacts: u64,
    pixels: u64,
}

impl Figures {
    fn of(paired: &Paired) -> Result<Self, Error> {
        let (picture, double) = paired.difference();
        let found = compare(&picture, &double)?;
        let pixels = picture.picture.pixels().iter().flatten();
        let pixels = pixels.zip(double.picture.pixels().iter().flatten());
        let off = pixels.zip(&paired.variance).filter(|((one, other), variance)| {
            (0..3).any(|c| {
                (displayed(one[c]) - displayed(other[c])).abs() > 1.0 / 255.0
                    && (one[c] - other[c]).abs() > SURE * variance[c].sqrt()
            })
        });
        Ok(Self {
            bias: found.bias.unwrap_or_default(),
            bias_noise: found.bias_standard_error.unwrap_or_default(),
            error: found.rmse,
            artefacts: off.count() as u64,
            pixels: found.compared as u64,
        })
    }

    fn row(&self, arithmetic: Arithmetic, epsilon: f64) -> Vec<String> {
        vec![
            format!("`{arithmetic}`"),
            figure(epsilon),
            figure(100.0 * self.bias),
            figure(100.0 * self.bias_noise),
            figure(self.error),
            share(self.artefacts, self.pixels),
        ]
    }
}
