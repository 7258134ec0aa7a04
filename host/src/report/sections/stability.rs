//! The tables of hard cases.

use maud::html;

use super::super::part::{Error, Part, Workshop};
use super::super::section::Section;
use super::figures::{faults, part, shown};
use crate::platform::console::note;
use crate::stability::{Effort, Findings, Plot};

/// The part.
pub(super) const PART: Part = Part {
    name: "stability",
    about: "hard cases for the arithmetic, counted",
    make,
};

/// Of `cargo xtask verify stability`: all but the figures above, the boards, which take eighty images, and light, which takes hours.
const MEASURED: [&str; 5] = [
    "intersection",
    "reintersection",
    "divergence",
    "convergence",
    "hard",
];
/// One of so many parts of the full work, and in a quick run of that.
const SHARE: u64 = 100;
const QUICK_SHARE: u64 = 2;

fn make(workshop: &Workshop<'_>, effort: &Effort) -> Result<Section, Error> {
    let share = workshop.either(SHARE, QUICK_SHARE);
    let effort = effort.one_of(share);
    let mut found = Findings::default();
    for name in MEASURED {
        note(format!("{}: {name}", PART.name));
        let more = (part(name)?.measure)(&effort)?;
        found.tables.extend(more.tables);
        found.plots.extend(more.plots);
        found.sheets.extend(more.sheets);
        found
            .faults
            .extend(more.faults.iter().map(|fault| format!("{name}: {fault}")));
    }
    let bare = bare(&mut found);
    Ok(Section {
        name: PART.name,
        title: "Stability",
        prose: html! {
            p { "Where rays meet spheres that are vast, small, far or grazed, where paths part from double precision, and scenes that are hard: \
                 a part in " (effort.parts()) " of the full run, whose tables are in " code { "docs/stability.md" } "." }
            @if !bare.is_empty() { p class="quiet" { "So few cases leave nothing to draw of: " (bare.join("; ")) "." } }
            @if !workshop.quick { (faults(&found)) }
        },
        commands: &["cargo xtask verify stability"],
        figures: shown(&found),
    })
}

/// Takes the plots out that have nothing to show, because what they count is too rare for a part of the full run, and gives their titles.
fn bare(found: &mut Findings) -> Vec<String> {
    let shows = |plot: &Plot| {
        let points = plot.curves.iter().flat_map(|(_, points)| points);
        points
            .into_iter()
            .any(|(across, upwards)| *across > 0.0 && *upwards > 0.0)
    };
    let bare = found.plots.extract_if(.., |plot| !shows(plot));
    bare.map(|plot| plot.title).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plots_of_what_never_happened_are_named_and_left_out() {
        let plot = |title: &str, upwards| Plot {
            name: "plot",
            title: title.to_owned(),
            across: "x",
            upwards: "y",
            curves: vec![("curve".to_owned(), vec![(1.0, upwards)])],
        };
        let mut found = Findings {
            plots: vec![plot("often", 0.5), plot("never", 0.0)],
            ..Findings::default()
        };
        assert_eq!(bare(&mut found), ["never"]);
        assert_eq!(found.plots.len(), 1);
    }
}
