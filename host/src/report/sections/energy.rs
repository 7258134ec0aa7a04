//! Samples and pictures a joule.

use maud::{Markup, html};

use super::super::part::{Error, Part, Workshop};
use super::super::plot::{Axis, Line, Plot, Point, Series, number};
use super::super::section::{Figure, Section};
use super::super::table::Table;
use super::scaling::assumed;
use crate::bench::scaling::Energy;
use crate::bench::scaling::energy::Row;
use crate::stability::Effort;

/// The part.
pub(super) const PART: Part = Part {
    name: "energy",
    about: "samples, and pictures of a given error, a joule: the published machine and processor, ours, a Cortex-M3, this host",
    make,
};

fn make(workshop: &Workshop<'_>, _effort: &Effort) -> Result<Section, Error> {
    let measured = workshop.scaling()?.energy.as_ref();
    let energy = measured.ok_or("energy was not measured")?;
    Ok(Section {
        name: PART.name,
        title: "Energy",
        prose: prose(energy),
        commands: &["cargo xtask bench scaling"],
        figures: vec![
            Figure::Plot(by_machine(
                energy,
                "pictures-a-joule",
                "Pictures of a given error",
                "pictures a kilojoule",
                |row| 1e3 * row.pictures_per_joule,
            )),
            Figure::Plot(by_machine(
                energy,
                "samples-a-joule",
                "Samples",
                "samples a joule",
                |row| row.samples_per_joule,
            )),
            Figure::Table(estimators(energy)),
            Figure::Folded {
                title: "All machines, and what is assumed of them".to_owned(),
                tables: vec![machines(energy), assumed(&energy.assumptions)],
            },
        ],
    })
}

fn prose(energy: &Energy) -> Markup {
    let [width, height] = energy.picture;
    html! {
        p { "A picture is " (width) "x" (height) " pixels, the typical one (the geometric mean) with a standard error of " (number(energy.error))
            " in linear radiance. How many samples that takes depends on the estimator alone; what they cost, on the machine alone. Cycles, noise and \
             this host's rate are measured. " strong { "Power is assumed" } ", by the sources below: chips at their makers' figure, processors at their \
             thermal design power, without memory beside the chip, power supplies and fans." }
        p { "This host: " (energy.processor) ", " (energy.threads) " threads." }
    }
}

fn by_machine(energy: &Energy, name: &str, title: &str, quantity: &str, value: impl Fn(&Row) -> f64) -> Plot {
    let mut machines: Vec<&str> = energy.rows.iter().map(|row| row.machine).collect();
    machines.dedup();
    let of_estimator = |(look, estimator): (usize, &String)| {
        let rows = energy.rows.iter().filter(|row| row.estimator == *estimator);
        let points = rows.filter_map(|row| {
            let place = machines.iter().position(|machine| *machine == row.machine)?;
            Some(Point::new("", [value(row), place as f64]))
        });
        Series {
            name: estimator.clone(),
            points: points.collect(),
            line: Line::None,
            look,
            named: false,
        }
    };
    let estimators = energy.estimators.iter().map(|cost| &cost.estimator);
    Plot {
        about: "Further right is better.".to_owned(),
        series: estimators.enumerate().map(of_estimator).collect(),
        ..Plot::new(
            name,
            title,
            Axis::log(quantity),
            Axis::names(machines.iter().map(|&machine| machine.to_owned()).collect()),
        )
    }
}

fn estimators(energy: &Energy) -> Table {
    let head = [
        "estimator",
        "cycles a sample, ARM9E-S",
        "Cortex-M3",
        "variance of a sample",
        "samples a pixel",
    ];
    let mut table = Table::new("What a picture takes", head);
    for cost in &energy.estimators {
        table.push(vec![
            cost.estimator.clone(),
            number(cost.arm9_cycles),
            number(cost.cortex_m3_cycles),
            number(cost.variance),
            number(cost.samples_of_a_pixel),
        ]);
    }
    table
}

fn machines(energy: &Energy) -> Table {
    let head = [
        "machine",
        "estimator",
        "samples/s",
        "W",
        "samples/J",
        "pictures/kJ",
    ];
    let mut table = Table::new("Machines", head);
    for row in &energy.rows {
        table.push(vec![
            row.machine.to_owned(),
            row.estimator.clone(),
            number(row.samples_per_second),
            number(row.watts),
            number(row.samples_per_joule),
            number(1e3 * row.pictures_per_joule),
        ]);
    }
    table
}
