//! `cargo xtask bench generators`

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context;
use host::bench::generators::dieharder::Assessment;
use host::bench::generators::judgement::{self, Judgement, Streams};
use host::bench::generators::low_bits::{Effect, Pictures};
use host::bench::generators::uniformity::{FALSE_ALARM, Power, SURE, Uniformity};
use host::oracle::reference::{self, cache};
use host::platform::console::{note, say};
use host::platform::setup::{self, Wanted};
use host::platform::workspace;
use host::scene::Scene;
use serde::Serialize;

use crate::SetUp;

/// Arguments of `bench generators`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Run Debian's dieharder on the tracer's numbers, too: most of an hour
    #[arg(long)]
    dieharder: bool,
    /// Write the judgement as JSON, too
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Draw what the published low bits do to a picture as a PNG file: minutes
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    #[command(flatten)]
    set_up: SetUp,
}

/// All that was found.
#[derive(Serialize)]
struct Found {
    generators: Vec<Judgement>,
    streams: Streams,
    low_bits: Option<Effect>,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    let mut found = Found {
        generators: judgement::judge().into(),
        streams: judgement::streams(),
        low_bits: None,
    };
    say(lattices(&found))?;
    say(layout(&found.streams))?;
    say(uniformity(&found.generators))?;
    if arguments.dieharder {
        run_dieharder(&mut found.generators, &arguments.set_up)?;
        say(format!("\n{}", batteries(&found.generators)))?;
    }
    if let Some(path) = &arguments.picture {
        found.low_bits = Some(draw(path)?);
    }
    if let Some(path) = &arguments.json {
        let json = serde_json::to_string_pretty(&found)?;
        std::fs::write(path, json + "\n").with_context(|| format!("cannot write {}", path.display()))?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Adds dieharder's results.
fn run_dieharder(generators: &mut [Judgement], set_up: &SetUp) -> anyhow::Result<()> {
    let wanted = Wanted {
        dieharder: true,
        ..Wanted::default()
    };
    let tools = setup::ensure(wanted, set_up.install())?;
    let program = tools.dieharder.context("set-up gave no dieharder")?;
    let rows = judgement::batteries(&program, |row| note(row))?;
    for (judged, rows) in generators.iter_mut().zip(rows) {
        judged.dieharder = rows;
    }
    Ok(())
}

/// Draws the standard scene with either generator.
fn draw(path: &Path) -> anyhow::Result<Effect> {
    let scene = Scene::load(&workspace::scene(None)?)?;
    let job = reference::Job {
        width: 256,
        height: 192,
        spp: 1024,
        termination: reference::Termination::Roulette,
        seed: 0x5eed,
    };
    let (rendered, origin) = cache::reference(cache::folder(None).as_deref(), &scene, &job, |_| ());
    if let Some(warning) = origin.warning() {
        note(warning);
    }
    let pictures = Pictures::render(&scene, 1024, rendered.estimate);
    pictures.write(path)?;
    let effect = pictures.effect()?;
    for (bits, figures) in [
        ("upper 32 of 64", effect.full_state),
        ("lower 16 of 32", effect.low_bits),
    ] {
        say(format!(
            "{bits}: bias {:+.3} % (standard error {:.3} %), rmse {:.5}, {} of {} tile tests fail, errors correlate by \
             up to {:+.4} at {:?}",
            100.0 * figures.bias.unwrap_or(f64::NAN),
            100.0 * figures.bias_standard_error.unwrap_or(f64::NAN),
            figures.rmse,
            figures.tiles_failed,
            figures.tiles,
            figures.correlation,
            figures.correlation_at
        ))?;
    }
    Ok(effect)
}

fn batteries(generators: &[Judgement]) -> String {
    let lines = generators.iter().map(|judged| {
        let count = |assessment| {
            let rows = judged.dieharder.iter();
            rows.filter(|row| row.assessment == assessment).count()
        };
        let failed: Vec<&str> = judged
            .dieharder
            .iter()
            .filter(|row| row.assessment == Assessment::Failed)
            .map(|row| row.test.as_str())
            .collect();
        format!(
            "{:8} dieharder: {} results passed, {} weak, {} failed {}",
            judged.profile,
            count(Assessment::Passed),
            count(Assessment::Weak),
            failed.len(),
            failed.join(" ")
        )
    });
    lines.collect::<Vec<_>>().join("\n")
}

fn merits(merits: &[f64]) -> String {
    let columns: Vec<String> = merits.iter().map(|merit| format!("{merit:.4}")).collect();
    columns.join("  ")
}

fn lattices(found: &Found) -> String {
    let mut lines = vec![format!(
        "{:8} {:16} {:>7}  {:30} {:>6}  {:>6}  {:>6}  {:>6}  {:>6}",
        "profile", "bits used", "period", "spectral test of", "S_2", "S_3", "S_4", "S_5", "S_6"
    )];
    let mut line = |judged: &Judgement, of: &str, figures: &[f64]| {
        lines.push(format!(
            "{:8} {:16} {:>7}  {of:30} {}",
            judged.profile,
            judged.bits_used,
            format!("2^{}", judged.period_log2),
            merits(figures)
        ));
    };
    for judged in &found.generators {
        line(judged, "successive numbers", &judged.merits);
    }
    line(
        &found.generators[0],
        "units' first numbers",
        &found.streams.merits,
    );
    lines.push(String::new());
    lines.join("\n")
}

fn layout(streams: &Streams) -> String {
    format!(
        "streams of precise: {:#x} steps apart; of any n up to 2^32 no two come closer than 2^64 / ({:.2} n) steps,\n\
         and of all 2^32 the closest are {} ids and {} steps apart.\n\
         Side by side, streams up to {} ids apart form pairs with S_2 of {:.4} or more (the least for {} ids).\n\
         {} renders with seeds 0, 1, 2, ... and {} units each have no two streams closer than {} steps.\n",
        streams.stride,
        streams.crowding,
        streams.closest_ids,
        streams.closest_steps,
        streams.pairs_up_to,
        streams.pair_merit,
        streams.pair_ids,
        streams.renders,
        streams.units,
        streams.closest_of_renders
    )
}

fn uniformity(generators: &[Judgement]) -> String {
    let mut lines = vec![format!(
        "{:8} {:22} {:>10} {:>10} {:>10} {:>10}  {}",
        "profile", "numbers", "chi2 1-D", "chi2 2-D", "chi2 3-D", "serial", "largest correlation"
    )];
    for judged in generators {
        lines.push(p_values(judged.profile, "unit after unit", &judged.within_units));
        lines.push(p_values(
            judged.profile,
            "units' first numbers",
            &judged.across_units,
        ));
    }
    let power = Power::of(judgement::NUMBERS);
    let [one, two, three] = power.unevenness.map(|unevenness| 100.0 * unevenness);
    lines.push(format!(
        "p-values; below {FALSE_ALARM:.0e} or above 1 less that is a failure (!). {} numbers each: in {:.0} % of cases cells uneven by\n\
         {one:.2} %, {two:.2} % and {three:.2} % in 1, 2 and 3 dimensions are found, and a correlation of {:.4}.",
        judgement::NUMBERS,
        100.0 * SURE,
        power.correlation
    ));
    lines.join("\n")
}

fn p_values(profile: &str, numbers: &str, found: &Uniformity) -> String {
    let [one, two, three] = found.equidistribution;
    let mut columns = String::new();
    for (p, passed) in [one, two, three, found.correlation]
        .into_iter()
        .zip(found.passed())
    {
        let text = if p > 0.0 && p < 1e-3 {
            format!("{p:.0e}")
        } else {
            format!("{p:.4}")
        };
        columns += &format!(" {text:>9}{}", if passed { " " } else { "!" });
    }
    format!(
        "{profile:8} {numbers:22}{columns}  {:+.1} sigma at lag {}",
        found.correlation_z, found.correlation_lag
    )
}
