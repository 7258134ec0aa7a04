//! `cargo xtask verify`

mod shortcuts;
mod stability;

use std::process::ExitCode;

use anyhow::ensure;
use host::bench::operations::Entry;
use host::bench::operations::record::{Record, sources_sha256};
use host::bench::operations::table::figure;
use host::bench::operations::verify::{Depth, Verdict, verify};
use host::platform::console::{bar, say};

/// Arguments of `verify`.
#[derive(clap::Args)]
#[command(args_conflicts_with_subcommands = true)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    what: Option<Part>,
    /// Try all 2^32 inputs of the operations that have no more, and a thousand million of the others: some minutes
    #[arg(long)]
    exhaustive: bool,
    /// Write what the exhaustive run finds to fixedmath/proof.json, instead of comparing
    #[arg(long, requires = "exhaustive")]
    bless: bool,
    /// Only the operation of this name
    #[arg(long, value_name = "NAME")]
    op: Option<String>,
}

/// What else is verified.
#[derive(clap::Subcommand)]
enum Part {
    /// Compare what cores leave out with the plain loop: rays of the scenes and of random ones must meet the same surfaces
    Shortcuts(shortcuts::Arguments),
    /// Count, in hard cases by the million, how wrong arithmetic is: docs/stability.md has the tables
    Stability(stability::Arguments),
}

/// Compares a sample of every operation, as `cargo xtask test` does.
pub(crate) fn sampled() -> anyhow::Result<ExitCode> {
    run(&Arguments {
        what: None,
        exhaustive: false,
        bless: false,
        op: None,
    })
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    match &arguments.what {
        Some(Part::Shortcuts(arguments)) => return shortcuts::run(arguments),
        Some(Part::Stability(arguments)) => return stability::run(arguments),
        None => {}
    }
    let depth = if arguments.exhaustive {
        Depth::Exhaustive
    } else {
        Depth::Sampled
    };
    let op = arguments.op.as_deref();
    let wanted = |entry: &Entry| depth.covers(entry) && op.is_none_or(|op| op == entry.operation);
    let sources = sources_sha256()?;
    let bar = bar("comparing with the truth");
    let verdicts = verify(depth, &wanted, &bar);
    bar.finish_and_clear();
    ensure!(
        !verdicts.is_empty(),
        "there is no operation `{}`; `cargo xtask bench ops` names them all",
        op.unwrap_or_default()
    );
    let record = Record::load(&Record::path()?)?;
    if arguments.bless {
        ensure!(
            sources == sources_sha256()?,
            "fixedmath's sources have changed meanwhile, and this is about what they were; try again"
        );
        record.updated(&verdicts)?.store(&Record::path()?)?;
        say(table(&verdicts))?;
        return Ok(ExitCode::SUCCESS);
    }
    say(table(&verdicts))?;
    let faults = match depth {
        Depth::Sampled => record.exceeded(&verdicts),
        Depth::Exhaustive => record.differences(&verdicts),
    };
    ensure!(
        faults.is_empty(),
        "not what the record says:\n{}",
        faults.join("\n")
    );
    if !record.is_current()? {
        say(
            "the record is about other sources: `cargo xtask verify --exhaustive --bless` brings it up to date",
        )?;
    }
    Ok(ExitCode::SUCCESS)
}

fn table(verdicts: &[Verdict]) -> String {
    let lines = verdicts.iter().filter_map(|Verdict { entry, figures }| {
        let figures = figures.as_ref()?;
        Some(format!(
            "{:28} {:42} {:>12} {:>12} {:>14}",
            entry.operation,
            entry.name(),
            figure(Some(figures.max_error)),
            figure(Some(figures.mean_error)),
            figures.cases
        ))
    });
    let head = format!(
        "{:28} {:42} {:>12} {:>12} {:>14}",
        "", "", "worst error", "mean error", "cases"
    );
    std::iter::once(head).chain(lines).collect::<Vec<_>>().join("\n")
}
