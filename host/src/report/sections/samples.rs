//! What a whole sample costs, and what a picture of a given noise does.

use maud::{Markup, html};

use super::super::part::{Error, Part, Workshop};
use super::super::plot::{Along, Axis, Line, Plot, Point, Rule, Series, number};
use super::super::section::{Figure, Section};
use super::super::table::Table;
use crate::bench::samples::Row;
use crate::bench::scaling::published::{CLOCK, CORE_RATE};
use crate::firmware::arithmetic::Sampler;
use crate::firmware::board::Board;
use crate::scene::Integrator;
use crate::stability::{Effort, figure as digits};

/// The part.
pub(super) const PART: Part = Part {
    name: "samples",
    about: "cycles a sample, and how many times fewer a picture of the same noise takes",
    make,
};

/// Efficiencies that this project set out for: of paths as published, and of the best there is.
const WANTED: [f64; 2] = [12.0, 130.0];
/// Cycles that the published machine spent on a sample, communication and all.
const PUBLISHED_CYCLES: f64 = CLOCK.value / CORE_RATE.value;

fn make(workshop: &Workshop<'_>, _effort: &Effort) -> Result<Section, Error> {
    let rows = workshop.samples()?;
    let series = workshop.series()?;
    let about = format!(
        "{}x{} pixels of the Cornell box, {} samples a pixel.",
        series.size.width, series.size.height, series.spp
    );
    let efficiency = by_kind(
        rows,
        "Efficiency",
        "times fewer cycles for the same noise than `paper` with roulette",
        |row| row.efficiency,
    );
    let cycles = by_kind(rows, "Cycles a sample", "cycles a sample", |row| {
        row.cycles_per_sample
    });
    let rule = |value, name: String| Rule {
        along: Along::Across,
        value,
        name,
    };
    let figures = vec![
        Figure::Plot(Plot {
            about: format!("Geometric mean over pixels of cycles times variance of `paper` with roulette on the same board, over the row's. {about}").replace('`', ""),
            rules: WANTED.map(|wanted| rule(wanted, format!("{wanted} wanted"))).to_vec(),
            ..efficiency
        }),
        Figure::Plot(Plot {
            about: format!("The line is what the published machine spent. {about}"),
            rules: vec![rule(PUBLISHED_CYCLES, format!("published machine: {}", number(PUBLISHED_CYCLES.round())))],
            ..cycles
        }),
        Figure::Table(factors(rows)),
    ];
    Ok(Section {
        name: PART.name,
        title: "Samples",
        prose: prose(rows),
        commands: &["cargo xtask bench trace --soft-float"],
        figures,
    })
}

fn prose(rows: &[Row]) -> Markup {
    let best = |board: Board| {
        let rows = rows.iter().filter(move |row| row.board == board);
        let known = rows.filter_map(|row| row.efficiency.map(|efficiency| (row, efficiency)));
        known.max_by(|one, other| one.1.total_cmp(&other.1))
    };
    html! {
        p { "The same picture by every profile, integrator, sampler and way to end a path. A sample that is twice as noisy must be \
             taken twice as often, so " em { "efficiency" } " counts cycles times variance. Paths of fixed depth leave out what \
             comes after: they are quicker, and darker." }
        @for board in Board::ALL {
            @if let Some((row, efficiency)) = best(board) {
                p { "On " (board.processor()) " the most efficient is " strong { (kind(row)) } ": " (number(efficiency))
                    " times fewer cycles than " code { "paper" } " for a picture of the same noise." }
            }
        }
    }
}

/// What tells a row from others of its board.
fn kind(row: &Row) -> String {
    let ways = [
        (row.integrator == Integrator::NextEvent).then_some("next event"),
        (row.sampler == Sampler::Kronecker).then_some("Kronecker"),
    ];
    let mut ways: Vec<String> = ways.into_iter().flatten().map(str::to_owned).collect();
    ways.extend(
        row.termination
            .strip_prefix("depth:")
            .map(|depth| format!("depth {depth}")),
    );
    if ways.is_empty() {
        row.profile.clone()
    } else {
        format!("{}, {}", row.profile, ways.join(", "))
    }
}

/// A value of each kind, by board.
fn by_kind(rows: &[Row], title: &str, name: &str, value: impl Fn(&Row) -> Option<f64>) -> Plot {
    let mut kinds: Vec<String> = Vec::new();
    for row in rows.iter().filter(|row| value(row).is_some()) {
        let kind = kind(row);
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
    }
    let of_board = |(look, board): (usize, Board)| {
        let rows = rows.iter().filter(|row| row.board == board);
        let points = rows.filter_map(|row| {
            let place = kinds.iter().position(|known| *known == kind(row))?;
            Some(Point::new("", [value(row)?, place as f64]))
        });
        let points: Vec<Point> = points.collect();
        let name = format!("{board}, {}", board.processor());
        (!points.is_empty()).then_some(Series {
            name,
            points,
            line: Line::None,
            look,
            named: false,
        })
    };
    let series = Board::ALL.into_iter().enumerate().filter_map(of_board).collect();
    let id = title.to_lowercase().replace(' ', "-");
    Plot {
        series,
        ..Plot::new(id, title, Axis::log(name.replace('`', "")), Axis::names(kinds))
    }
}

/// How many times fewer cycles than the published machine each kind takes on the first board.
fn factors(rows: &[Row]) -> Table {
    let head = [
        "kind",
        "cycles a sample",
        "published machine, times",
        "variance, mean",
        "bias, %",
        "arithmetic bias, %",
        "rmse, at most",
        "efficiency",
    ];
    let mut table = Table::new("Beside the published machine", head).with_notes(format!(
        "On the ARMv5TE. The published machine spent {} cycles on a sample: a core of {} MHz made {} a second ({}). Ours are of a core alone, without its network. Bias and rmse are beside the \
         independent reference of the same way to end a path, ± one standard error.",
        number(PUBLISHED_CYCLES.round()),
        number(CLOCK.value / 1e6),
        number(CORE_RATE.value),
        CORE_RATE.source
    ));
    let figure = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), number);
    let share = |share: Option<f64>, error: Option<f64>| match (share, error) {
        (Some(share), Some(error)) => format!("{} ± {}", digits(100.0 * share), digits(100.0 * error)),
        _ => "-".to_owned(),
    };
    for row in rows.iter().filter(|row| row.board == Board::Versatilepb) {
        table.push(vec![
            kind(row),
            figure(row.cycles_per_sample),
            figure(row.cycles_per_sample.map(|cycles| PUBLISHED_CYCLES / cycles)),
            figure(row.variance_mean),
            share(row.bias, row.bias_standard_error),
            share(row.lockstep_bias, row.lockstep_bias_standard_error),
            figure(row.rmse_at_most),
            figure(row.efficiency),
        ]);
    }
    table
}
