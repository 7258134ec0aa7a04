//! Two profiles of the same: what a change did to the cost of a sample.

use std::collections::BTreeSet;

use super::brief::brief;
use super::cost::Cost;
use super::run::{Named, Run};

/// Rows that are shown at most.
const ROWS: usize = 20;

/// For people: in all, by class, and by function, those first that changed most.
pub fn table(before: &Run, after: &Run) -> String {
    let mut lines = vec![
        "changes, a sample:".to_owned(),
        format!("{:>12} {:>12} {:>12} {:>9}", "before", "cycles", "change", ""),
        row("all cycles", [before, after].map(|run| (run, run.total.cycles))),
        row(
            "all instructions",
            [before, after].map(|run| (run, run.total.instructions)),
        ),
    ];
    lines.extend(changed([before, after], |run| run.classes.clone()));
    let functions = |run: &Run| {
        let own = run.functions.iter().map(|function| Named {
            name: brief(&function.name),
            cost: function.own,
        });
        own.collect()
    };
    lines.extend(changed([before, after], functions));
    lines.join("\n")
}

/// The names whose cycles changed, the most first.
fn changed(runs: [&Run; 2], of: impl Fn(&Run) -> Vec<Named>) -> Vec<String> {
    let named = runs.map(of);
    let names: BTreeSet<&str> = named.iter().flatten().map(|named| named.name.as_str()).collect();
    let cycles = |list: &[Named], name: &str| {
        let found = list.iter().find(|named| named.name == name);
        found.map_or(Cost::default(), |named| named.cost).cycles
    };
    let mut rows: Vec<(f64, &str, [u64; 2])> = names
        .into_iter()
        .map(|name| {
            let cycles = [cycles(&named[0], name), cycles(&named[1], name)];
            (difference(runs, cycles), name, cycles)
        })
        .filter(|(_, _, cycles)| cycles[0] != cycles[1])
        .collect();
    rows.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
    let mut lines = vec![String::new()];
    lines.extend(
        rows.iter()
            .take(ROWS)
            .map(|&(_, name, cycles)| row(name, [(runs[0], cycles[0]), (runs[1], cycles[1])])),
    );
    if rows.len() > ROWS {
        lines.push(format!("and {} smaller changes", rows.len() - ROWS));
    }
    if rows.is_empty() { Vec::new() } else { lines }
}

fn difference(runs: [&Run; 2], counts: [u64; 2]) -> f64 {
    a_sample(runs[1], counts[1]) - a_sample(runs[0], counts[0])
}

fn row(name: &str, sides: [(&Run, u64); 2]) -> String {
    let [before, after] = sides.map(|(run, count)| a_sample(run, count));
    let change = after - before;
    let percent = if before > 0.0 {
        format!("{:+.2} %", 100.0 * change / before)
    } else {
        "new".to_owned()
    };
    format!("{before:>12.1} {after:>12.1} {change:>+12.1} {percent:>9}  {name}")
}

fn a_sample(run: &Run, count: u64) -> f64 {
    count as f64 / run.samples as f64
}

#[cfg(test)]
mod tests {
    use super::super::run::tests::run;
    use super::*;

    #[test]
    fn what_changed_most_is_told_first_and_what_did_not_is_not_told() {
        let before = run(&[("same", 40), ("less", 400), ("gone", 8)]);
        let after = run(&[("same", 40), ("less", 200), ("new", 20)]);
        let said = table(&before, &after);
        let rows: Vec<Vec<&str>> = said
            .lines()
            .skip(2)
            .map(|line| line.split_whitespace().collect())
            .collect();
        assert_eq!(
            rows[0],
            ["112.0", "65.0", "-47.0", "-41.96", "%", "all", "cycles"]
        );
        let by_function = rows.rsplit(|row| row.is_empty()).next().expect("functions");
        assert_eq!(
            by_function,
            [
                vec!["100.0", "50.0", "-50.0", "-50.00", "%", "less"],
                vec!["0.0", "5.0", "+5.0", "new", "new"],
                vec!["2.0", "0.0", "-2.0", "-100.00", "%", "gone"],
            ]
        );
    }

    #[test]
    fn small_changes_are_counted() {
        let names: Vec<String> = (0..30).map(|n| format!("f{n}")).collect();
        let of = |cycles| -> Vec<(&str, u64)> { names.iter().map(|name| (name.as_str(), cycles)).collect() };
        let said = table(&run(&of(8)), &run(&of(4)));
        assert_eq!(said.matches("and 10 smaller changes").count(), 2, "{said}");
        assert_eq!(table(&run(&of(8)), &run(&of(8))).lines().count(), 4);
    }
}
