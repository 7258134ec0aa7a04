//! The speed-against-error report: one page that needs no other, with plots, pictures and tables of all that is measured.
//!
//! A section is a file in `sections`, a line in [`PARTS`] and a few figures ([`Figure`]). It measures nothing itself but calls what the
//! other rooms have. A plot without data, or with a value that has no place on its axes, is an error, and the old page stays.

mod page;
mod part;
mod picture;
mod plot;
mod prose;
mod section;
mod sections;
mod table;

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

pub use page::Origin;
pub use part::{Error, Part, Workshop};
pub use picture::Image;
pub use plot::{Along, Axis, Clock, Line, Plot, PlotError, Point, Room, Rule, Scale, Series};
pub use section::{Figure, Section, SectionError};
pub use sections::PARTS;
pub use table::Table;

use crate::platform::file::write_whole;

/// The page's file.
pub const PAGE: &str = "index.html";
/// The file of the plot that tells most.
pub const TELLING: &str = "error-against-time.svg";

/// Writes the page of these sections into a folder, and the plot that tells most beside it. What is there stays unless all of it can be
/// written. Says which files there are.
pub fn write(folder: &Path, sections: &[Section], origin: &Origin) -> Result<Vec<PathBuf>, Error> {
    let page = page::page(sections, origin)?;
    let telling = sections
        .iter()
        .flat_map(|section| &section.figures)
        .find_map(|figure| match figure {
            Figure::Plot(plot) if plot.name == sections::TELLING => Some(plot::standalone(plot)),
            _ => None,
        });
    let telling = telling.ok_or("no section has the plot of error against time")?;
    fs::create_dir_all(folder).map_err(|cause| format!("cannot make {}: {cause}", folder.display()))?;
    let files = [(folder.join(TELLING), telling), (folder.join(PAGE), page)];
    for (path, text) in &files {
        write_whole(path, |file| file.write_all(text.as_bytes()))?;
    }
    Ok(files.into_iter().map(|(path, _)| path).collect())
}
