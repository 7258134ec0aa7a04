//! Figure 4 of the paper: samples a second against cores; and a machine of a million of them, on paper.

use maud::{Markup, html};

use super::super::part::{Error, Part, Workshop};
use super::super::plot::{Along, Axis, Plot, Point, Rule, Series, number};
use super::super::prose::prose;
use super::super::section::{Figure, Section};
use super::super::table::Table;
use crate::bench::scaling::published::{Assumption, CORE_RATE, CORES, WIRE};
use crate::bench::scaling::{self, Derivation, Million, Outcome, Run, Scaling};
use crate::stability::Effort;

/// The part.
pub(super) const PART: Part = Part {
    name: "scaling",
    about: "the paper's figure 4, samples a second against cores, and a machine of a million cores on paper",
    make,
};

/// The share of linear that is wanted of all cores together.
const WANTED: f64 = 0.98;

fn make(workshop: &Workshop<'_>, _effort: &Effort) -> Result<Section, Error> {
    let outcome = workshop.scaling()?;
    let scaling = &outcome.scaling;
    let mut figures = vec![
        Figure::Plot(rates(scaling)),
        Figure::Plot(shares(scaling)),
        Figure::Plot(packets(scaling)),
        Figure::Table(derivations(&scaling.derivations)),
        Figure::Folded {
            title: "What was run, and what is assumed".to_owned(),
            tables: vec![runs(&scaling.runs), assumed(&scaling.assumptions)],
        },
    ];
    figures.extend(
        outcome
            .million
            .iter()
            .map(|million| Figure::Table(boards(million))),
    );
    if let Some(million) = outcome.million.first() {
        figures.push(Figure::Folded {
            title: "What is assumed of a machine of a million cores".to_owned(),
            tables: vec![assumed(&million.assumptions)],
        });
    }
    Ok(Section {
        name: PART.name,
        title: "The paper's figure 4, and a million cores",
        prose: about(outcome),
        commands: &["cargo xtask bench scaling"],
        figures,
    })
}

fn about(outcome: &Outcome) -> Markup {
    let scaling = &outcome.scaling;
    let [width, height] = scaling.size;
    let million = outcome.million.first();
    html! {
        p { "The Cornell box, " (width) "x" (height) " pixels, by " code { (scaling.profile) } " with paths, as many emulated cores as the plot says, and the time that \
             as many real ones of 200 MHz would take. Of this:" }
        ul { @for line in &scaling.method { li { (prose(line)) } } }
        p { "A packet takes its core " (number(scaling.packet_cycles)) " cycles. Where the wire carries 1,500 packets a second, packets must be few and full: the \
             samples that they need follow from the rate of the quickest stretch of the picture, and a sweep says how many more keep " (WANTED) " of linear, with \
             the start, when all cores say HELLO at once." }
        @if let Some(million) = million {
            p { "A machine of " (number(million.cores)) " cores, which the publication looks forward to, has " (number(million.boards)) " boards with a wire each, and "
                (number(million.rendering_cores)) " cores that render. It is on paper here: the rate of a core is measured, all else is arithmetic." }
        }
    }
}

/// How a series was found, in a word.
fn origin(series: &scaling::Series) -> &'static str {
    let run = series.points.iter().filter(|point| point.run).count();
    match run {
        0 => "modelled",
        _ if run == series.points.len() => "run",
        _ => "partly run",
    }
}

fn name(series: &scaling::Series) -> String {
    let limit = match series.packets_per_second {
        Some(limit) => format!("{} packets/s", number(limit.into())),
        None => "no limit".to_owned(),
    };
    format!(
        "{}, {} samples a packet, {limit} ({})",
        series.termination,
        number(series.samples_per_packet.into()),
        origin(series)
    )
}

fn drawn(scaling: &Scaling, value: impl Fn(&scaling::Point) -> f64) -> Vec<Series> {
    let series = scaling.series.iter().enumerate();
    series
        .map(|(look, series)| {
            let points = series.points.iter().map(|point| {
                let name = if point.run { "run" } else { "modelled" };
                Point::new(name, [point.cores.into(), value(point)])
            });
            Series::joined(name(series), look, points.collect())
        })
        .collect()
}

fn rates(scaling: &Scaling) -> Plot {
    let mut series = drawn(scaling, |point| point.samples_per_second);
    let cores = scaling.series.iter().flat_map(|series| &series.points);
    let most = cores.map(|point| point.cores).max().unwrap_or(CORES);
    let published = [1.0, f64::from(most)]
        .map(|cores| Point::new("published", [cores, cores * CORE_RATE.value]))
        .to_vec();
    series.push(Series::joined(
        "published, a core's rate times cores",
        series.len(),
        published,
    ));
    Plot {
        about: "With 1,500 packets a second, small packets bend the curve; the number of samples that is derived straightens it.".to_owned(),
        series,
        ..Plot::new("figure-4", "Figure 4: samples a second", Axis::log("cores"), Axis::log("samples a second"))
    }
}

fn shares(scaling: &Scaling) -> Plot {
    Plot {
        about: "Samples a second over as many times those of one core without a limit.".to_owned(),
        series: drawn(scaling, |point| point.share_of_linear),
        rules: vec![Rule {
            along: Along::Upwards,
            value: WANTED,
            name: format!("{WANTED} wanted"),
        }],
        ..Plot::new(
            "share-of-linear",
            "Figure 4, of linear",
            Axis::log("cores"),
            Axis::linear("share of linear"),
        )
    }
}

fn packets(scaling: &Scaling) -> Plot {
    let series = scaling.derivations.iter().enumerate().map(|(look, derivation)| {
        let points = derivation.sweep.iter();
        let points =
            points.map(|sweep| Point::new("", [sweep.samples_per_packet.into(), sweep.share_of_linear]));
        let name = format!(
            "{}, {} cores (modelled)",
            derivation.termination, derivation.cores
        );
        Series::joined(name, look, points.collect())
    });
    Plot {
        about: format!(
            "With {} packets a second out of the machine, on the units' measured costs.",
            number(WIRE.value)
        ),
        series: series.collect(),
        rules: vec![Rule {
            along: Along::Upwards,
            value: WANTED,
            name: format!("{WANTED} wanted"),
        }],
        ..Plot::new(
            "samples-a-packet",
            "Samples that a packet must carry",
            Axis::log("samples a packet"),
            Axis::linear("share of linear"),
        )
    }
}

fn derivations(all: &[Derivation]) -> Table {
    let head = [
        "paths end by",
        "cores",
        "samples/s a core, mean",
        "so a packet needs",
        "where it is quickest",
        "so a packet needs",
        "with the start, for 0.98",
    ];
    let mut table = Table::new(
        "Samples a packet, derived",
        head,
    )
    .with_notes(
        "Cores over packets a second, less a packet's own time, is what a core may render for a packet; times its samples a second.",
    );
    for one in all {
        let [mean, quickest] = one.samples_per_second_a_core.map(number);
        let [needed, needed_there] = one.samples_per_packet_needed.map(number);
        let enough = one
            .enough
            .map_or_else(|| "-".to_owned(), |samples| number(samples.into()));
        table.push(vec![
            one.termination.clone(),
            one.cores.to_string(),
            mean,
            needed,
            quickest,
            needed_there,
            enough,
        ]);
    }
    table
}

fn runs(all: &[Run]) -> Table {
    let head = [
        "paths end by",
        "samples/packet",
        "cores",
        "at work",
        "units",
        "instructions/sample",
        "cycles/instruction",
        "picture",
    ];
    let mut table = Table::new("What was run", head);
    for run in all {
        let price = run.cycles_per_instruction.map_or_else(
            || "-".to_owned(),
            |[least, most]| format!("{least:.4} to {most:.4}"),
        );
        table.push(vec![
            run.termination.clone(),
            run.samples_per_packet.to_string(),
            run.cores.to_string(),
            run.cores_at_work.to_string(),
            run.units.to_string(),
            number(run.instructions_per_sample),
            price,
            run.image_sha256.get(..12).unwrap_or_default().to_owned(),
        ]);
    }
    table
}

fn boards(million: &Million) -> Table {
    let head = [
        "samples a packet",
        "seconds a packet",
        "packets/s a board makes",
        "its wire carries them",
        "packets/s in all",
        "Mbit/s",
        "collectors",
        "samples/s that arrive",
    ];
    let title = format!(
        "A machine of {} cores, {}",
        number(million.cores),
        million.termination
    );
    let notes = format!(
        "{} samples/s a core, {} in all, {} a joule. A collector that takes so many packets a second in is one process of this host.",
        number(million.samples_per_second_a_core),
        number(million.samples_per_second),
        number(million.samples_per_joule)
    );
    let mut table = Table::new(title, head).with_notes(notes);
    for flood in &million.packets {
        table.push(vec![
            number(flood.samples_per_packet.into()),
            number(flood.seconds_per_packet),
            number(flood.packets_per_second_a_board),
            if flood.carried { "yes" } else { "no" }.to_owned(),
            number(flood.packets_per_second),
            number(flood.megabits_per_second),
            number(flood.collectors),
            number(flood.samples_per_second),
        ]);
    }
    table
}

/// Figures that results rest on and that nobody here has measured, with their sources.
pub(super) fn assumed(all: &[Assumption]) -> Table {
    let head = ["figure", "value", "unit", "source"];
    let mut table = Table::new("Assumptions", head);
    for one in all {
        table.push(vec![
            one.what.to_owned(),
            number(one.value),
            one.unit.to_owned(),
            one.source.to_owned(),
        ]);
    }
    table
}
