//! The figures for people.

use std::fmt::Write as _;

use super::energy::{Energy, Row};
use super::million::Million;
use super::published::{Assumption, CORE_RATE, CORES};
use super::{Derivation, Outcome, Run, Scaling, Series};

/// What is run and what is modelled.
pub(super) const METHOD: [&str; 6] = [
    "run: every unit, by as many emulated cores as `runs` says; its instructions by its core's clock, its picture to the bit",
    "run: cycles of an instruction and of a packet, recorded by QEMU's plugin; priced by a model of the ARM9E-S (docs/cycles.md)",
    "run: leases, by the collector's own table, in virtual time",
    "modelled: the way out of the machine, one server that takes 1/1,500 s a packet, first come first served, and keeps what waits",
    "modelled: the collector's answer time, a constant; all cores start at once; no packet is lost; HELLOs take the wire's time, too",
    "points that are not `run` simulate other numbers of cores on the units' measured costs",
];

/// A figure to four digits, or whole with its thousands apart.
pub(super) fn figure(value: f64) -> String {
    if value.abs() >= 1000.0 {
        return apart(value.round() as u64);
    }
    if value.fract() == 0.0 {
        return format!("{value}");
    }
    let digits = (3 - value.abs().log10().floor() as i32).clamp(0, 12);
    format!("{value:.*}", digits as usize)
}

/// With a comma between thousands.
fn apart(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Everything, for people.
pub fn table(outcome: &Outcome) -> String {
    let mut text = String::new();
    scaling(&mut text, &outcome.scaling);
    for one in &outcome.million {
        million(&mut text, one);
    }
    if let Some(one) = outcome.million.first() {
        assumed(&mut text, &one.assumptions);
    }
    if let Some(measured) = &outcome.energy {
        energy(&mut text, measured);
    }
    text.trim_end().to_owned()
}

/// Adds a line. Writing to a text does not fail.
fn line(text: &mut String, words: impl std::fmt::Display) {
    let _never_fails = writeln!(text, "{words}");
}

fn heading(text: &mut String, words: impl std::fmt::Display) {
    line(text, format_args!("\n{words}"));
}

fn assumed(text: &mut String, assumptions: &[Assumption]) {
    for one in assumptions {
        let value = figure(one.value);
        line(
            text,
            format_args!("  {:40} {value:>10} {:9} {}", one.what, one.unit, one.source),
        );
    }
}

fn scaling(text: &mut String, scaling: &Scaling) {
    let [width, height] = scaling.size;
    line(
        text,
        format_args!(
            "{} {width}x{height}, {} on {}, cores of 200 MHz in virtual time",
            scaling.scene, scaling.profile, scaling.board
        ),
    );
    scaling
        .method
        .iter()
        .for_each(|words| line(text, format_args!("  {words}")));
    assumed(text, &scaling.assumptions);
    line(
        text,
        format_args!(
            "  the collector's answer takes {} s, a packet {} cycles of its core",
            scaling.answer_seconds,
            figure(scaling.packet_cycles)
        ),
    );
    heading(text, "what was run");
    line(text, Run::HEAD);
    scaling.runs.iter().for_each(|run| line(text, run));
    for series in &scaling.series {
        curve(text, series);
    }
    for derivation in &scaling.derivations {
        derived(text, derivation);
    }
    line(
        text,
        format_args!(
            "\nthe published system: {} samples/s a core, {} on {CORES}",
            figure(CORE_RATE.value),
            figure(f64::from(CORES) * CORE_RATE.value)
        ),
    );
}

impl Run {
    const HEAD: &str = "paths     samples/packet  cores  at work   units  instructions/sample  ticks apart  cycles/instruction   picture       \
                        host seconds";
}

impl std::fmt::Display for Run {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let price = self.cycles_per_instruction;
        let price = price.map_or_else(
            || "-".to_owned(),
            |[least, most]| format!("{least:.4} to {most:.4}"),
        );
        let [start, work] = self.host_seconds;
        write!(
            f,
            "{:9} {:>14} {:>6} {:>8} {:>7} {:>20} {:>12} {:>19}   {:12}  {start:.1} + {work:.1}",
            self.termination,
            self.samples_per_packet,
            self.cores,
            self.cores_at_work,
            self.units,
            figure(self.instructions_per_sample),
            self.most_ticks_apart,
            price,
            self.image_sha256.get(..12).unwrap_or_default(),
        )
    }
}

fn curve(text: &mut String, series: &Series) {
    let limit = series.packets_per_second;
    let limit = limit.map_or_else(
        || "no limit".to_owned(),
        |most| format!("at most {} packets/s", apart(most.into())),
    );
    let packet = apart(series.samples_per_packet.into());
    heading(
        text,
        format_args!("{}, {packet} samples a packet, {limit}", series.termination),
    );
    line(
        text,
        "cores        samples/s  of linear  packets/s   without HELLOs   seconds  longest wait, s",
    );
    for point in &series.points {
        line(
            text,
            format_args!(
                "{:>5} {:>16} {:>10.4} {:>10} {:>16} {:>9} {:>16}  {}",
                point.cores,
                figure(point.samples_per_second),
                point.share_of_linear,
                figure(point.packets_per_second),
                figure(point.quiet_samples_per_second),
                figure(point.seconds),
                figure(point.longest_wait),
                if point.run { "run" } else { "" },
            ),
        );
    }
}

fn derived(text: &mut String, derivation: &Derivation) {
    heading(
        text,
        format_args!("{}: samples that a packet needs", derivation.termination),
    );
    let [mean, quickest] = derivation.samples_per_second_a_core;
    let [needed, quickest_needed] = derivation.samples_per_packet_needed;
    line(
        text,
        format_args!(
            "  in the mean: {} cores x {} samples/s / {} packets/s, less the packets' own time: {}",
            derivation.cores,
            figure(mean),
            apart(derivation.packets_per_second.into()),
            figure(needed),
        ),
    );
    line(
        text,
        format_args!(
            "  where the picture is quickest, over all units that the cores hold: {} samples/s, {}",
            figure(quickest),
            figure(quickest_needed)
        ),
    );
    line(
        text,
        format_args!(
            "  so 16 pixels of {} samples, {} a packet; with fewer and more of them:",
            derivation.samples_of_a_pixel,
            apart(derivation.samples_per_packet.into()),
        ),
    );
    line(
        text,
        "  samples/packet   the wire carries        samples/s  of linear   without HELLOs",
    );
    for one in &derivation.sweep {
        line(
            text,
            format_args!(
                "  {:>14} {:>18} {:>16} {:>10.4} {:>16}",
                apart(one.samples_per_packet.into()),
                figure(one.wire),
                figure(one.samples_per_second),
                one.share_of_linear,
                figure(one.quiet_samples_per_second),
            ),
        );
    }
    if let Some(enough) = derivation.enough {
        let enough = apart(enough.into());
        line(
            text,
            format_args!(
                "  the first of these with 0.98 of linear, HELLOs and all: {enough} samples a packet"
            ),
        );
    }
}

fn million(text: &mut String, million: &Million) {
    heading(
        text,
        format_args!(
            "a machine of {} cores, {}, on paper: {} render at {} samples/s each, {} samples/s in all, {} a joule",
            apart(million.cores as u64),
            million.termination,
            apart(million.rendering_cores as u64),
            figure(million.samples_per_second_a_core),
            figure(million.samples_per_second),
            figure(million.samples_per_joule),
        ),
    );
    line(
        text,
        "  samples/packet  s a packet  packets/s a board  carried  packets/s in all      Mbit/s  collectors         samples/s",
    );
    for flood in &million.packets {
        line(
            text,
            format_args!(
                "  {:>14} {:>11} {:>18} {:>8} {:>17} {:>11} {:>11} {:>17}",
                apart(flood.samples_per_packet.into()),
                figure(flood.seconds_per_packet),
                figure(flood.packets_per_second_a_board),
                if flood.carried { "yes" } else { "no" },
                figure(flood.packets_per_second),
                figure(flood.megabits_per_second),
                flood.collectors,
                figure(flood.samples_per_second),
            ),
        );
    }
}

fn energy(text: &mut String, energy: &Energy) {
    let [width, height] = energy.picture;
    heading(
        text,
        format_args!(
            "energy: a picture is {width}x{height} with a standard error of {} in its typical pixel, roulette",
            energy.error
        ),
    );
    assumed(text, &energy.assumptions);
    line(
        text,
        format_args!("  this host: {}, {} threads", energy.processor, energy.threads),
    );
    line(
        text,
        "\nestimator                        ARM9E-S cycles  Cortex-M3 cycles  variance  samples a pixel",
    );
    for cost in &energy.estimators {
        line(
            text,
            format_args!(
                "{:32} {:>14} {:>17} {:>9} {:>16}",
                cost.estimator,
                figure(cost.arm9_cycles),
                figure(cost.cortex_m3_cycles),
                figure(cost.variance),
                figure(cost.samples_of_a_pixel)
            ),
        );
    }
    line(text, Row::HEAD);
    energy.rows.iter().for_each(|row| line(text, row));
}

impl Row {
    const HEAD: &str = "\nmachine                          estimator                           samples/s         W    samples/J  pictures/kJ";
}

impl std::fmt::Display for Row {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{:32} {:30} {:>14} {:>9} {:>12} {:>12}",
            self.machine,
            self.estimator,
            figure(self.samples_per_second),
            figure(self.watts),
            figure(self.samples_per_joule),
            figure(1e3 * self.pictures_per_joule),
        )
    }
}
