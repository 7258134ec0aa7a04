//! The sections of the page: a file each.

mod choices;
mod energy;
mod figures;
mod operations;
mod samples;
mod scaling;
mod scenes;
mod spectrum;
mod stability;
mod time;

pub(super) use time::TELLING;

use super::part::Part;
use super::plot::{Axis, Line, Plot, Point, Series};
use crate::stability::Plot as Curves;

/// All sections, in the order of the page. To add one is a module and a line here.
pub const PARTS: &[Part] = &[
    operations::PART,
    samples::PART,
    spectrum::PART,
    choices::PART,
    time::PART,
    figures::PART,
    scaling::PART,
    energy::PART,
    stability::PART,
    scenes::PART,
];

/// Curves that a part of the room for stability has found. Points that have no place on its axes are left out there, too.
fn curves(found: &Curves) -> Plot {
    let series = found
        .curves
        .iter()
        .enumerate()
        .map(|(look, (name, points))| Series {
            name: name.clone(),
            points: points
                .iter()
                .filter(|(across, upwards)| *across > 0.0 && *upwards > 0.0)
                .map(|&(across, upwards)| Point::new("", [across, upwards]))
                .collect(),
            line: Line::Solid,
            look,
            named: false,
        });
    let (across, upwards) = (Axis::log(found.across), Axis::log(found.upwards));
    Plot {
        series: series.filter(|series| !series.points.is_empty()).collect(),
        ..Plot::new(found.name, &found.title, across, upwards)
    }
}
