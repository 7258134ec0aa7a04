//! The published figures 2 and 3 once more.

use maud::{Markup, html};

use super::super::part::{Error, Part, Workshop};
use super::super::picture::Image;
use super::super::section::{Figure, Section};
use super::super::table::Table;
use super::curves;
use crate::stability::figures::measure_apart;
use crate::stability::{Effort, Findings, PARTS, Sheet};

/// The part.
pub(super) const PART: Part = Part {
    name: "figures",
    about: "the paper's figures 2 and 3: fixed point beside double precision, and what epsilon does",
    make,
};

/// Of figure 3's samples, a report has one of so many: what epsilon does is seen in fewer.
const SHARE_OF_FIGURE_3: u64 = 4;

fn make(_workshop: &Workshop<'_>, effort: &Effort) -> Result<Section, Error> {
    let found = measure_apart(effort, &effort.one_of(SHARE_OF_FIGURE_3))?;
    Ok(Section {
        name: PART.name,
        title: "The paper's figures 2 and 3",
        prose: html! {
            p { "Figure 2: the picture in fixed point, the same samples in double precision, and the difference: blue is darker, red brighter. \
                 Figure 3: how far from a surface a new ray starts. " code { "precise" } " needs no epsilon; " code { "paper" }
                " needs 0.1, and loses for it what is nearer, as the light's reflection on the glass ball. Figure 3 has one of "
                (SHARE_OF_FIGURE_3) " of the samples that the command takes." }
            (faults(&found))
        },
        commands: &["cargo xtask verify stability figures"],
        figures: shown(&found),
    })
}

/// A part of the room for stability, by its name.
pub(super) fn part(name: &str) -> Result<&'static crate::stability::Part, Error> {
    let found = PARTS.iter().find(|part| part.name == name);
    Ok(found.ok_or_else(|| format!("there is no part `{name}` of `cargo xtask verify stability`"))?)
}

/// What should have held and did not.
pub(super) fn faults(found: &Findings) -> Markup {
    html! {
        @if !found.faults.is_empty() {
            div class="warning" { "What should hold does not:" ul { @for fault in &found.faults { li { (fault) } } } }
        }
    }
}

/// All that a part has found, the tables folded where there is something else to see.
pub(super) fn shown(found: &Findings) -> Vec<Figure> {
    let mut figures: Vec<Figure> = found.sheets.iter().map(pictures).collect();
    figures.extend(found.plots.iter().map(|plot| Figure::Plot(curves(plot))));
    figures.extend(found.tables.iter().map(|table| Figure::Folded {
        title: table.title().replace('`', ""),
        tables: vec![Table::from(table)],
    }));
    figures
}

fn pictures(sheet: &Sheet) -> Figure {
    Figure::Pictures {
        title: sheet.title.clone(),
        images: sheet.rows.iter().flatten().map(Image::from).collect(),
    }
}
