//! The price list for people.

use std::fmt::Write as _;

use super::Row;

/// The list in lines of fixed width, grouped by operation, the cheapest first. A star marks the rows that no other of the
/// operation beats in cost and in worst error: the Pareto front.
pub fn table(rows: &[Row]) -> String {
    let mut text = format!(
        "  {:42} {:10} {:>12} {:>9} {:>8} {:>8} {:>6} {:>6} {:>12} {:>11}  {}\n",
        "",
        "",
        "instructions",
        "called",
        "cycles",
        "called",
        "code",
        "tables",
        "worst error",
        "mean error",
        "over"
    );
    for group in grouped(rows) {
        let _ = writeln!(text, "{}, ulp = {}", group[0].op, group[0].ulp);
        for row in &group {
            let star = if is_on_front(row, &group) { '*' } else { ' ' };
            let _ = writeln!(
                text,
                "{star} {:42} {:10} {:>12.2} {:>9.2} {:>8.2} {:>8.2} {:>6} {:>6} {:>12} {:>11}  {}",
                row.variant,
                row.maker,
                row.instructions,
                row.called_instructions,
                row.cycles,
                row.called_cycles,
                row.code_bytes,
                row.table_bytes.map_or("-".to_owned(), |bytes| bytes.to_string()),
                figure(row.max_error_ulp),
                figure(row.mean_error_ulp),
                coverage(row),
            );
        }
    }
    text
}

/// Which inputs the errors are for, and whether it was all of them.
pub fn coverage(row: &Row) -> String {
    match row.verified {
        "exhaustive" => format!("all inputs: {}", row.domain),
        sampled => format!("{sampled}: {}", row.domain),
    }
}

/// The rows by operation, in the order in which operations first appear, the cheapest first.
pub fn grouped(rows: &[Row]) -> Vec<Vec<&Row>> {
    let mut groups: Vec<Vec<&Row>> = Vec::new();
    for row in rows {
        match groups.iter_mut().find(|group| group[0].op == row.op) {
            Some(group) => group.push(row),
            None => groups.push(vec![row]),
        }
    }
    for group in &mut groups {
        group.sort_by(|a, b| a.instructions.total_cmp(&b.instructions));
    }
    groups
}

/// Whether no row of the group is better in one of cost and worst error and at least as good in the other.
pub fn is_on_front(row: &Row, group: &[&Row]) -> bool {
    let Some(error) = row.max_error_ulp else {
        return false;
    };
    !group.iter().any(|other| {
        other.max_error_ulp.is_some_and(|others| {
            (other.instructions <= row.instructions && others < error)
                || (other.instructions < row.instructions && others <= error)
        })
    })
}

/// Four significant digits at most, and no more than four decimals.
pub fn figure(value: Option<f64>) -> String {
    let Some(value) = value else {
        return "-".to_owned();
    };
    match value.abs() {
        0.0 => "0".to_owned(),
        size if size < 0.01 => format!("{value:.1e}"),
        size if size < 10.0 => format!("{value:.3}"),
        size if size < 1000.0 => format!("{value:.1}"),
        size if size < 1e6 => format!("{value:.0}"),
        _ => format!("{value:.2e}"),
    }
}
