//! What each arithmetic operation costs and how wrong it is, ours and others'.

use maud::html;

use super::super::part::{Error, Part, Workshop};
use super::super::plot::{Axis, Line, Plot, Point, Room, Series, number};
use super::super::section::{Figure, Section};
use super::super::table::Table;
use crate::bench::operations::anchors::ANCHORS;
use crate::bench::operations::table::{coverage, figure, grouped};
use crate::bench::operations::{Row, bench, with_errors};
use crate::firmware::board::Board;
use crate::platform::setup::{self, Wanted};
use crate::stability::Effort;
use ::operations::Group;

/// The part.
pub(super) const PART: Part = Part {
    name: "operations",
    about: "cycles against worst error of each arithmetic operation, ours and others'",
    make,
};

fn make(workshop: &Workshop<'_>, _effort: &Effort) -> Result<Section, Error> {
    let wanted = Wanted {
        qemu: true,
        firmware: true,
        ..Wanted::default()
    };
    let tools = setup::ensure(wanted, workshop.install)?;
    let toolchain = tools.firmware.ok_or("set-up gave no compiler")?;
    let qemu = tools.qemu.ok_or("set-up gave no QEMU")?;
    let groups = workshop.either(&Group::ALL[..], &[Group::Roots]);
    let rows = with_errors(&bench::measure(&toolchain, &qemu, Board::default(), groups)?)?;
    let plots: Vec<Plot> = grouped(&rows).iter().filter_map(|group| plot(group)).collect();
    Ok(Section {
        name: PART.name,
        title: "Operations",
        prose: html! {
            p { "Each operation is timed in a loop on one emulated core, less the same loop without it, and compared with the truth: over all \
                 inputs where these are 2" sup { "32" } " at most, else over a sample. The line joins what nothing else beats in both. What is \
                 exact has no place on a logarithmic axis and stands in the table only." }
            p { (beaten(&rows)) }
        },
        commands: &["cargo xtask bench ops", "cargo xtask verify --exhaustive"],
        figures: vec![
            Figure::Plots(plots),
            Figure::Folded {
                title: "All operations".to_owned(),
                tables: vec![table(&rows)],
            },
            Figure::Folded {
                title: "Libraries in C, quoted".to_owned(),
                tables: vec![quoted()],
            },
        ],
    })
}

/// How often ours stand on the line of what nothing beats.
fn beaten(rows: &[Row]) -> String {
    let groups = grouped(rows);
    let contested: Vec<&Vec<&Row>> = groups
        .iter()
        .filter(|group| group.iter().any(|row| row.maker != "ours"))
        .collect();
    let leads = contested.iter().filter(|group| {
        let best = front(group);
        !best.is_empty() && best.iter().all(|row| row.maker == "ours")
    });
    format!(
        "Of {} operations that others have, too, {} have a line of ours alone.",
        contested.len(),
        leads.count()
    )
}

/// The rows that no other one of the group beats in cycles and worst error, the quickest first.
fn front<'a>(group: &[&'a Row]) -> Vec<&'a Row> {
    let mut rows: Vec<&Row> = group
        .iter()
        .copied()
        .filter(|row| row.max_error_ulp.is_some())
        .collect();
    rows.sort_by(|one, other| {
        one.cycles.total_cmp(&other.cycles).then(
            one.max_error_ulp
                .partial_cmp(&other.max_error_ulp)
                .unwrap_or(std::cmp::Ordering::Equal),
        )
    });
    let mut least = f64::INFINITY;
    rows.retain(|row| {
        let error = row.max_error_ulp.unwrap_or(f64::INFINITY);
        let is_better = error < least;
        least = least.min(error);
        is_better
    });
    rows
}

/// A plot of an operation of which there is a choice.
fn plot(group: &[&Row]) -> Option<Plot> {
    let points = |belongs: &dyn Fn(&Row) -> bool| -> Vec<Point> {
        let rows = group.iter().filter(|row| belongs(row));
        rows.filter_map(|row| {
            let error = row.max_error_ulp.filter(|&error| error > 0.0)?;
            Some(Point::new(&row.name, [row.cycles, error]))
        })
        .collect()
    };
    let makers = [
        Series::of_named("ours", 0, points(&|row| row.maker == "ours")),
        Series::of_named("published", 1, points(&|row| row.maker == "published")),
        Series::of_named(
            "others' crates, soft float",
            2,
            points(&|row| !matches!(row.maker, "ours" | "published")),
        ),
    ];
    let mut shown: Vec<Series> = makers
        .into_iter()
        .filter(|series| !series.points.is_empty())
        .collect();
    if shown.iter().map(|series| series.points.len()).sum::<usize>() < 2 {
        return None;
    }
    let best: Vec<Point> = front(group)
        .iter()
        .filter_map(|row| {
            Some(Point::new(
                &row.name,
                [row.cycles, row.max_error_ulp.filter(|&error| error > 0.0)?],
            ))
        })
        .collect();
    let names: Vec<&str> = best.iter().map(|point| point.name.as_str()).collect();
    let about = format!("Not beaten: {}.", names.join(", "));
    if best.len() > 1 {
        shown.insert(
            0,
            Series {
                line: Line::Front,
                named: false,
                ..Series::of_named("not beaten", 5, best)
            },
        );
    }
    let name: String = group[0]
        .op
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '-' })
        .collect();
    Some(Plot {
        about,
        series: shown,
        room: Room::Part,
        ..Plot::new(
            format!("operation-{name}"),
            group[0].op,
            Axis::log("cycles"),
            Axis::log(format!("worst error, {}", ulp(&group[0].ulp))),
        )
    })
}

/// What errors are counted in.
fn ulp(ulp: &str) -> String {
    match ulp {
        "2^-16" => "ulp".to_owned(),
        "2^-0" => "whole numbers".to_owned(),
        ulp => format!("ulp of {ulp}"),
    }
}

fn table(rows: &[Row]) -> Table {
    let head = [
        "function",
        "operation",
        "by",
        "instructions",
        "cycles",
        "worst error",
        "mean error",
        "ulp",
        "inputs",
    ];
    let mut table = Table::new("All operations", head)
        .with_notes("In line, on the ARMv5TE. Errors are in ulp, which are what the column says.");
    for row in grouped(rows).into_iter().flatten() {
        table.push(vec![
            format!("`{}`", row.variant),
            row.op.to_owned(),
            row.maker.to_owned(),
            number(row.instructions),
            number(row.cycles),
            figure(row.max_error_ulp),
            figure(row.mean_error_ulp),
            row.ulp.clone(),
            coverage(row),
        ]);
    }
    table
}

fn quoted() -> Table {
    let head = ["operation", "library", "instructions", "worst error, ulp"];
    let mut table = Table::new("Libraries in C", head).with_notes(
        "Measured once beforehand on the same emulated core (gcc 12, `-O3 -mcpu=arm968e-s -marm`), in instructions and not by a command \
         of this repository; constants of `host::bench::operations::anchors`.",
    );
    for anchor in ANCHORS {
        table.push(vec![
            anchor.op.to_owned(),
            anchor.library.to_owned(),
            number(anchor.instructions),
            figure(anchor.max_error_ulp),
        ]);
    }
    table
}
