//! Tables on the page.

use maud::{Markup, html};

use super::prose::prose;
use crate::stability;

/// Rows under a head.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Table {
    caption: String,
    notes: String,
    head: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table without rows.
    pub fn new(caption: impl Into<String>, head: impl IntoIterator<Item = impl Into<String>>) -> Self {
        Self {
            caption: caption.into(),
            notes: String::new(),
            head: head.into_iter().map(Into::into).collect(),
            rows: Vec::new(),
        }
    }

    /// With a sentence on what its columns are.
    #[must_use]
    pub fn with_notes(self, notes: impl Into<String>) -> Self {
        let notes = notes.into();
        Self { notes, ..self }
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
            self.caption
        );
        self.rows.push(row);
    }

    /// What it is of.
    pub fn caption(&self) -> &str {
        &self.caption
    }

    /// The names of its columns.
    pub fn head(&self) -> &[String] {
        &self.head
    }

    /// Its rows.
    pub fn rows(&self) -> &[Vec<String>] {
        &self.rows
    }

    /// The table as an element of a page.
    pub fn markup(&self) -> Markup {
        html! {
            div class="table" {
                table {
                    caption { (prose(&self.caption)) @if !self.notes.is_empty() { span class="notes" { (prose(&self.notes)) } } }
                    thead { tr { @for word in &self.head { th scope="col" { (prose(word)) } } } }
                    tbody {
                        @for row in &self.rows {
                            tr {
                                @for (column, cell) in row.iter().enumerate() {
                                    @if column == 0 { th scope="row" { (prose(cell)) } } @else { td { (prose(cell)) } }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

impl From<&stability::Table> for Table {
    fn from(table: &stability::Table) -> Self {
        Self {
            caption: table.title().to_owned(),
            notes: table.units().to_owned(),
            head: table.head().to_vec(),
            rows: table.rows().to_vec(),
        }
    }
}
