//! Why paths in fixed point are not those in double precision, scene by scene, and what it costs their pictures.

use tracer::profile::{Paper, Precise};
use tracer::unit::Plan;

use super::part::plan;
use super::table::{figure, share};
use super::{Effort, Error, Findings, Part, Plot, Table};
use crate::firmware::arithmetic::Arithmetic;
use crate::oracle::divergence::{
    BOUNCES, Cause, Divergence, Explicable, Quantity, explain, explain_rounding,
};
use crate::platform::workspace;
use crate::scene::{CompiledScene, Integrator, Scene, compile};

/// The part.
pub(super) const PART: Part = Part {
    name: "divergence",
    about: "where paths in fixed point leave those in double precision, and why",
    measure,
};

const SIZE: [u16; 2] = [64, 48];
/// Samples a pixel; of `paper` a quarter, which parts a thousand times as often.
const SPP: u64 = 4096;

/// Scenes, and what their plots are called by profile: those worth a look.
const SCENES: [(&str, Option<[&str; 2]>); 6] = [
    (
        "scenes/cornell.toml",
        Some(["divergence-cornell-precise", "divergence-cornell-paper"]),
    ),
    ("tests/scenes/open.toml", None),
    ("tests/scenes/tiny.toml", None),
    (
        "tests/scenes/mirrors.toml",
        Some(["divergence-mirrors-precise", "divergence-mirrors-paper"]),
    ),
    ("tests/scenes/cut-open.toml", None),
    ("scenes/hard/overlap.toml", None),
];

const UNITS: &str = "Parted: the share of all paths that part by this decision. Inherited: the share of these that \
    double precision would have sent the same way as fixed point from the same ray, so that earlier bounces' rounding parted them. \
    Bounce: the median one. Offset: how far apart the two rays start there, the power of two of ulp that half stay below. \
    Bias: what it adds to the picture's mean radiance, in per cent of it, with its standard error. \
    Rms: its share of the root of the mean squared difference of a sample, in radiance.";
const HEAD: [&str; 8] = [
    "decision",
    "parted",
    "inherited",
    "bounce",
    "offset, ulp",
    "bias, %",
    "standard error, %",
    "rms",
];

const ROUNDING_UNITS: &str = "Paths in double precision but for one quantity of each ray, which is rounded to the nearest \
    in the format of `precise`, beside paths without any rounding. Shares and biases as above, of all decisions together.";
const ROUNDED: [(&str, Quantity); 3] = [
    ("start, 16:16", Quantity::Start),
    ("direction, 2:30", Quantity::Direction),
    ("normal, 2:30", Quantity::Normal),
];

fn measure(effort: &Effort) -> Result<Findings, Error> {
    let spp = effort.of(SPP / 4).next_multiple_of(4) as u32;
    let pixels = u64::from(SIZE[0]) * u64::from(SIZE[1]);
    effort.expect(SCENES.len() as u64 * 5 * pixels * u64::from(spp) + pixels * 3 * u64::from(4 * spp));
    let mut findings = Findings::default();
    for (file, plots) in SCENES {
        let scene = Scene::load(&workspace::file(file)?)?;
        let compiled = compile(&scene, SIZE[0], SIZE[1], Integrator::Path);
        let [precise, paper] = plots.map_or([None; 2], |names| names.map(Some));
        let plan = |arithmetic, spp| plan(arithmetic, &compiled, SIZE, spp);
        let (ours, published) = (plan(Arithmetic::Precise, 4 * spp), plan(Arithmetic::Paper, spp));
        add::<Precise>(&mut findings, effort, &compiled, file, &ours, precise);
        add::<Paper>(&mut findings, effort, &compiled, file, &published, paper);
    }
    let scene = Scene::load(&workspace::file(SCENES[0].0)?)?;
    findings.tables.push(by_quantity(
        effort,
        &compile(&scene, SIZE[0], SIZE[1], Integrator::Path),
        4 * spp,
    ));
    Ok(findings)
}

fn add<P: Explicable>(
    findings: &mut Findings,
    effort: &Effort,
    compiled: &CompiledScene,
    file: &str,
    plan: &Plan,
    plot_name: Option<&'static str>,
) {
    let found = explain::<P>(compiled, plan, |samples| effort.done(samples));
    let title = format!("`{file}`, `{}`, {} paths", P::NAME, found.samples);
    let units = if findings.tables.is_empty() { UNITS } else { "" };
    let mut table = Table::new(&title, units, &HEAD);
    for cause in Cause::ALL {
        if found.share(cause).paths > 0 {
            table.push(row(&found, cause));
        }
    }
    let total = found.total_bias();
    let mut all = vec!["all".to_owned(), figure(found.parted())];
    all.extend([(); 3].map(|()| "-".to_owned()));
    all.extend([100.0 * total.value, 100.0 * total.standard_error].map(figure));
    all.push(figure(found.total_rms()));
    table.push(all);
    findings.tables.push(table);
    if let Some(name) = plot_name {
        findings.plots.push(plot(name, title.replace('`', ""), &found));
    }
}

fn row(found: &Divergence, cause: Cause) -> Vec<String> {
    let (it, bias) = (found.share(cause), found.bias(cause));
    vec![
        cause.to_string(),
        share(it.paths, found.samples),
        share(it.inherited, it.paths),
        it.median_bounce().to_string(),
        it.median_offset().map_or_else(|| "-".to_owned(), figure),
        figure(100.0 * bias.value),
        figure(100.0 * bias.standard_error),
        figure(found.rms(cause)),
    ]
}

/// How soon paths part, decision by decision.
fn plot(name: &'static str, title: String, found: &Divergence) -> Plot {
    let curve = |cause: Cause| -> Vec<(f64, f64)> {
        let counts = &found.share(cause).bounces[..BOUNCES - 1];
        let share = |count: u64| 1e6 * count as f64 / found.samples as f64;
        (1u32..)
            .zip(counts)
            .map(|(bounce, &count)| (bounce.into(), share(count)))
            .collect()
    };
    let parting = Cause::ALL
        .into_iter()
        .filter(|&cause| cause != Cause::Rounding && found.share(cause).paths > 0);
    Plot {
        name,
        title: format!("Where paths part: {title}"),
        across: "bounce",
        upwards: "paths that part there, of a million",
        curves: parting.map(|cause| (cause.to_string(), curve(cause))).collect(),
    }
}

/// What each of the formats alone does.
fn by_quantity(effort: &Effort, compiled: &CompiledScene, spp: u32) -> Table {
    let head = ["rounded", "parted", "bias, %", "standard error, %", "rms"];
    let mut table = Table::new(
        "`scenes/cornell.toml`, one rounding at a time",
        ROUNDING_UNITS,
        &head,
    );
    for (name, quantity) in ROUNDED {
        let plan = plan(Arithmetic::Precise, compiled, SIZE, spp);
        let found = explain_rounding::<Precise>(compiled, &plan, quantity, |samples| effort.done(samples));
        let bias = found.total_bias();
        table.push(vec![
            name.to_owned(),
            figure(found.parted()),
            figure(100.0 * bias.value),
            figure(100.0 * bias.standard_error),
            figure(found.total_rms()),
        ]);
    }
    table
}
