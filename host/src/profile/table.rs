//! A profile for people.

use super::brief::brief;
use super::cost::Cost;
use super::run::{Block, Function, Named, Run};
use crate::render::report::BlindSpot;

/// How much is shown of a profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::Args)]
pub struct Shown {
    /// Functions that are shown, the dearest by themselves
    #[arg(long, value_name = "N", default_value = "20")]
    pub functions: usize,
    /// Lines of the source that are shown, the dearest
    #[arg(long, value_name = "N", default_value = "0")]
    pub lines: usize,
    /// Basic blocks that are shown with their instructions, the hottest
    #[arg(long, value_name = "N", default_value = "0")]
    pub blocks: usize,
}

/// The whole table.
pub fn table(run: &Run, shown: Shown) -> String {
    let mut parts = vec![head(run)];
    parts.extend(unseen(run));
    parts.extend([functions(run, shown.functions), classes(run)]);
    if shown.lines > 0 {
        parts.push(lines(run, shown.lines));
    }
    parts.extend(
        run.blocks
            .iter()
            .take(shown.blocks)
            .map(|block| self::block(run, block)),
    );
    parts.join("\n\n")
}

fn head(run: &Run) -> String {
    let (of, total) = (&run.subject, run.total);
    let row = |name: &str, count: u64| {
        format!(
            "{name:22} {count:>14} {:>12.1} {:>12.1} {:>7.1} %",
            a_sample(run, count),
            count as f64 / run.rays as f64,
            share(run, count)
        )
    };
    [
        format!(
            "{} on {} with {}, {}, {}: {}x{}, {} samples a pixel, {:.2} rays a sample",
            of.scene,
            of.board,
            of.profile,
            of.integrator,
            of.termination,
            of.size[0],
            of.size[1],
            of.spp,
            run.rays as f64 / run.samples as f64
        ),
        String::new(),
        format!(
            "{:22} {:>14} {:>12} {:>12} {:>9}",
            "", "in all", "a sample", "a ray", "of cycles"
        ),
        row("cycles", total.cycles),
        row("  at least", run.cycles_at_least),
        row("  at most", run.cycles_at_most),
        row("  waiting for loads", total.load_stalls),
        row("  waiting for products", total.multiply_stalls),
        row("instructions", total.instructions),
    ]
    .join("\n")
}

/// What may make the cycles more or fewer, if that shows in a hundred thousandth of them.
fn unseen(run: &Run) -> Option<String> {
    let worth_a_line = |spot: &&BlindSpot| spot.less + spot.more > 1e-5;
    let mut lines = vec!["what the model does not see, at worst:".to_owned()];
    lines.extend(run.blind_spots.iter().filter(worth_a_line).map(|spot| {
        let (less, more) = (100.0 * spot.less, 100.0 * spot.more);
        format!(
            "{:>12} {:>12}  {}",
            format!("-{less:.3} %"),
            format!("+{more:.3} %"),
            spot.what
        )
    }));
    (lines.len() > 1).then(|| lines.join("\n"))
}

fn functions(run: &Run, count: usize) -> String {
    let row = |function: &Function| {
        format!(
            "{} {:>12.1} {:>7.1} %  {}",
            columns(run, function.own),
            a_sample(run, function.inclusive_cycles),
            share(run, function.inclusive_cycles),
            brief(&function.name)
        )
    };
    let head = format!("{} {:>12} {:>9}  function", COLUMNS, "with callees", "");
    titled(
        "by function, a sample:",
        head,
        run.functions.iter().map(row),
        count,
    )
}

fn classes(run: &Run) -> String {
    let row = |class: &Named| format!("{}  {}", columns(run, class.cost), class.name);
    let head = format!("{COLUMNS}  class");
    titled(
        "by class of instruction, a sample:",
        head,
        run.classes.iter().map(row),
        usize::MAX,
    )
}

fn lines(run: &Run, count: usize) -> String {
    let row = |line: &Named| format!("{}  {}", columns(run, line.cost), line.name);
    titled(
        "by line, a sample:",
        format!("{COLUMNS}  line"),
        run.lines.iter().map(row),
        count,
    )
}

fn block(run: &Run, block: &Block) -> String {
    let mut lines = vec![
        format!(
            "block of {}: {:.2} times a sample, {:.1} cycles a sample ({:.1} %)",
            brief(&block.function),
            a_sample(run, block.executions),
            a_sample(run, block.cost.cycles),
            share(run, block.cost.cycles)
        ),
        // Of one execution.
        format!(
            "{:>10}  {:40} {:>8} {:>8}  line",
            "address", "instruction", "cycles", "stalls"
        ),
    ];
    lines.extend(block.instructions.iter().map(|instruction| {
        let once = |count: u64| count as f64 / block.executions as f64;
        format!(
            "{:#010x}  {:40} {:>8.2} {:>8.2}  {}",
            instruction.address,
            instruction.text,
            once(instruction.cost.cycles),
            once(instruction.cost.stalls()),
            instruction.line
        )
    }));
    lines.join("\n")
}

/// What stands above [`columns`].
const COLUMNS: &str = "      cycles           instructions       stalls";

fn columns(run: &Run, cost: Cost) -> String {
    format!(
        "{:>12.1} {:>7.1} % {:>12.1} {:>12.1}",
        a_sample(run, cost.cycles),
        share(run, cost.cycles),
        a_sample(run, cost.instructions),
        a_sample(run, cost.stalls())
    )
}

fn titled(title: &str, head: String, rows: impl Iterator<Item = String>, count: usize) -> String {
    let mut lines = vec![title.to_owned(), head];
    lines.extend(rows.take(count));
    lines.join("\n")
}

fn a_sample(run: &Run, count: u64) -> f64 {
    count as f64 / run.samples as f64
}

/// In percent of all cycles.
fn share(run: &Run, cycles: u64) -> f64 {
    100.0 * cycles as f64 / run.total.cycles as f64
}

#[cfg(test)]
mod tests {
    use super::super::run::Instruction;
    use super::super::run::tests::run;
    use super::*;

    #[test]
    fn a_table_shows_what_is_asked_for() {
        let mut run = run(&[("<tracer::A as tracer::B>::c", 300), ("d", 100)]);
        run.lines = run.classes.clone();
        run.blocks = vec![Block {
            executions: 10,
            function: "d".to_owned(),
            cost: run.classes[1].cost,
            instructions: vec![Instruction {
                address: 0x28a4,
                text: "umull r1, r0, r6, r7".to_owned(),
                line: "kernel.rs:72".to_owned(),
                cost: Cost {
                    cycles: 40,
                    multiply_stalls: 10,
                    instructions: 10,
                    load_stalls: 0,
                },
            }],
        }];
        let shown = |functions, lines, blocks| {
            table(
                &run,
                Shown {
                    functions,
                    lines,
                    blocks,
                },
            )
        };
        let all = shown(9, 9, 9);
        for expected in [
            "2.00 rays a sample",
            "    -0.000 %     +1.000 %  a great thing\n\nby function",
            "        75.0    75.0 %         37.5          0.5         75.0    75.0 %  <A as B>::c\n",
            "block of d: 2.50 times a sample, 25.0 cycles a sample (25.0 %)",
            "0x000028a4  umull r1, r0, r6, r7                         4.00     1.00  kernel.rs:72",
        ] {
            assert!(all.contains(expected), "{expected}\n{all}");
        }
        let little = shown(1, 0, 0);
        assert!(
            !little.contains("by line") && !little.contains("block of"),
            "{little}"
        );
        // `d` is left as a class.
        assert_eq!(
            (all.matches("  d\n").count(), little.matches("  d\n").count()),
            (3, 0),
            "{all}"
        );
        assert!(little.ends_with("  d"));
    }
}
