//! Tables as text.

use std::fmt;

/// A table with a title and what its columns' units are. It is shown as Markdown, its columns aligned for those who read the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Table {
    title: String,
    units: String,
    head: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table without rows. `units` is a sentence or two that says what its figures are in; nothing where another table says it.
    pub fn new(title: impl Into<String>, units: impl Into<String>, head: &[&str]) -> Self {
        Self {
            title: title.into(),
            units: units.into(),
            head: head.iter().map(|&word| word.to_owned()).collect(),
            rows: Vec::new(),
        }
    }

    /// What it is of.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// What its figures are in.
    pub fn units(&self) -> &str {
        &self.units
    }

    /// The names of its columns.
    pub fn head(&self) -> &[String] {
        &self.head
    }

    /// Its rows.
    pub fn rows(&self) -> &[Vec<String>] {
        &self.rows
    }

    /// Adds a row, of as many cells as the head has.
    ///
    /// # Panics
    /// If it has more or fewer.
    pub fn push(&mut self, row: Vec<String>) {
        assert_eq!(
            row.len(),
            self.head.len(),
            "a cell for every column of {}",
            self.title
        );
        self.rows.push(row);
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let cells = |column: usize| {
            let rows = self.rows.iter().map(move |row| &row[column]);
            std::iter::once(&self.head[column]).chain(rows)
        };
        let widths: Vec<usize> = (0..self.head.len())
            .map(|column| cells(column).map(|cell| cell.chars().count()).max().unwrap_or(0))
            .collect();
        writeln!(f, "### {}\n", self.title)?;
        if !self.units.is_empty() {
            writeln!(f, "{}\n", self.units)?;
        }
        let line = |f: &mut fmt::Formatter<'_>, row: &[String]| {
            for (column, (cell, &width)) in row.iter().zip(&widths).enumerate() {
                // Names on the left, figures on the right.
                match column {
                    0 => write!(f, "| {cell:width$} ")?,
                    _ => write!(f, "| {cell:>width$} ")?,
                }
            }
            writeln!(f, "|")
        };
        line(f, &self.head)?;
        for (column, &width) in widths.iter().enumerate() {
            let rule = "-".repeat(width);
            write!(f, "| {rule}{}", if column == 0 { " " } else { ":" })?;
        }
        writeln!(f, "|")?;
        self.rows.iter().try_for_each(|row| line(f, row))
    }
}

/// A share of cases: how many of how many, by the figures that a count has. None is `0`; there is no share of no cases.
pub(super) fn share(part: u64, all: u64) -> String {
    match (part, all) {
        (_, 0) => "-".to_owned(),
        (0, _) => "0".to_owned(),
        _ => figure(part as f64 / all as f64),
    }
}

/// Three figures of a number, or all of a whole one that has no more than six.
pub(crate) fn figure(value: f64) -> String {
    let magnitude = value.abs();
    if value == 0.0 {
        "0".to_owned()
    } else if !(1e-3..1e6).contains(&magnitude) {
        format!("{value:.2e}")
    } else {
        let decimals = (2 - magnitude.log10().floor() as i32).max(0);
        format!("{value:.*}", decimals as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_markdown() {
        let mut table = Table::new("Title", "In ulp.", &["name", "worst"]);
        table.push(vec!["a".to_owned(), figure(1234.5)]);
        assert_eq!(
            table.to_string(),
            "### Title\n\nIn ulp.\n\n| name | worst |\n| ---- | -----:|\n| a    |  1234 |\n"
        );
    }

    #[test]
    fn figures_are_three() {
        let figures = [0.0, 0.012_345, 1.0, 999.6, 54_321.0, 1e7, 1e-7].map(figure);
        assert_eq!(
            figures,
            ["0", "0.0123", "1.00", "1000", "54321", "1.00e7", "1.00e-7"]
        );
        assert_eq!([share(0, 9), share(1, 8), share(0, 0)], ["0", "0.125", "-"]);
    }
}
