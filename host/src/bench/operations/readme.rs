//! The price list in the arithmetic's README.

use std::io::Write as _;
use std::path::PathBuf;
use std::{fs, io};

use super::Row;
use super::plot::{self, PlotError};
use super::table::{coverage, figure, grouped, is_on_front};
use crate::platform::file::{WriteError, write_whole};
use crate::platform::workspace::{self, NoWorkspace};

const START: &str = "<!-- prices -->\n";
const END: &str = "<!-- /prices -->";
const COMPILED_BY: &str = "Compiled by rustc ";

/// Why the README is as it was.
#[derive(Debug, thiserror::Error)]
pub enum ReadmeError {
    /// There is no README around here.
    #[error(transparent)]
    NoWorkspace(#[from] NoWorkspace),
    /// It cannot be read.
    #[error("cannot read {}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        #[source]
        cause: io::Error,
    },
    /// It has no place for the list.
    #[error("{}: there is no place for the list; put the lines `{}` and `{END}` where it belongs", .0.display(), START.trim_end())]
    NoPlace(PathBuf),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The list cannot be drawn.
    #[error(transparent)]
    Plot(#[from] PlotError),
}

/// Writes the table into the README and the plots beside it.
pub fn bless(rows: &[Row]) -> Result<(), ReadmeError> {
    for name in ["fixedmath/prices.svg", "fixedmath/prices.png"] {
        plot::write(&workspace::file(name)?, rows)?;
    }
    let path = path()?;
    let (text, place) = place()?;
    let text = [&text[..place.start], &markdown(rows), &text[place.end..]].concat();
    Ok(write_whole(&path, |writer| writer.write_all(text.as_bytes()))?)
}

/// The table that the README has now.
pub fn printed() -> Result<String, ReadmeError> {
    let (text, place) = place()?;
    Ok(text[place].to_owned())
}

fn path() -> Result<PathBuf, NoWorkspace> {
    workspace::file("fixedmath/README.md")
}

/// The README, and where in it the list belongs.
fn place() -> Result<(String, std::ops::Range<usize>), ReadmeError> {
    let path = path()?;
    let text = fs::read_to_string(&path).map_err(|cause| ReadmeError::Read {
        path: path.clone(),
        cause,
    })?;
    let start = text.find(START).map(|start| start + START.len());
    let found = start.and_then(|start| Some(start..start + text[start..].find(END)?));
    match found {
        Some(place) => Ok((text, place)),
        None => Err(ReadmeError::NoPlace(path)),
    }
}

/// The list as a table of Markdown.
pub fn markdown(rows: &[Row]) -> String {
    let mut text =
        "| operation | function | by | instructions | called | cycles | worst error, ulp | mean | inputs |\n\
                    | --- | --- | --- | ---: | ---: | ---: | ---: | ---: | --- |\n"
            .to_owned();
    for group in grouped(rows) {
        for (place, row) in group.iter().enumerate() {
            let operation = match place {
                0 => format!("{}, {}", row.op, row.ulp),
                _ => String::new(),
            };
            let star = if is_on_front(row, &group) { "**" } else { "" };
            text += &format!(
                "| {operation} | {star}`{}`{star} | {} | {:.2} | {:.2} | {:.2} | {} | {} | {} |\n",
                row.variant,
                row.maker,
                row.instructions,
                row.called_instructions,
                row.cycles,
                figure(row.max_error_ulp),
                figure(row.mean_error_ulp),
                coverage(row).replace('|', "\\|"),
            );
        }
    }
    if let Some(row) = rows.first() {
        text += &format!("\n{COMPILED_BY}{}.\n", row.compiler);
    }
    text
}

/// The version of the compiler that a table's costs are of.
pub fn compiler(table: &str) -> Option<&str> {
    table
        .lines()
        .find_map(|line| line.strip_prefix(COMPILED_BY)?.strip_suffix('.'))
}
