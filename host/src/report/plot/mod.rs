//! Plots: marks and lines over two axes, as SVG within a page or as a file of its own.

mod axis;
mod draw;
mod labels;
mod marks;

pub(super) use axis::number;
pub use axis::{Axis, Scale};
pub(super) use draw::{STYLE, drawing, standalone};

use super::table::Table;

/// Marks and lines over two axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// What links and labels call it: unique on a page, of letters, digits and hyphens.
    pub name: String,
    /// What it shows, in a line.
    pub title: String,
    /// What there is to see, for those who do not see it.
    pub about: String,
    /// The quantity across.
    pub across: Axis,
    /// The quantity upwards.
    pub upwards: Axis,
    /// What is drawn.
    pub series: Vec<Series>,
    /// Values that are marked by a line.
    pub rules: Vec<Rule>,
    /// A second scale across.
    pub clock: Option<Clock>,
    /// How much room it takes.
    pub room: Room,
}

/// How much room a plot takes on a page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Room {
    /// The width of the text.
    Whole,
    /// A part of it, beside others.
    Part,
}

/// Points that belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// What the legend calls it.
    pub name: String,
    /// The points.
    pub points: Vec<Point>,
    /// How the points are joined.
    pub line: Line,
    /// Which of the colours it has, and which of the shapes.
    pub look: usize,
    /// Whether points have their names beside them.
    pub named: bool,
}

impl Series {
    /// Points that are not joined, each with its name.
    pub fn of_named(name: impl Into<String>, look: usize, points: Vec<Point>) -> Self {
        Self {
            name: name.into(),
            points,
            line: Line::None,
            look,
            named: true,
        }
    }

    /// Points that a line joins.
    pub fn joined(name: impl Into<String>, look: usize, points: Vec<Point>) -> Self {
        Self {
            line: Line::Solid,
            named: false,
            ..Self::of_named(name, look, points)
        }
    }
}

/// How points are joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Line {
    /// They are not.
    None,
    /// By a line.
    Solid,
    /// By a thin line, and nothing marks them: they are marked in other series.
    Front,
}

/// A value of both axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Across and upwards.
    pub at: [f64; 2],
    /// What it is, where the series alone does not say it.
    pub name: String,
    /// Between what bounds it is, upwards.
    pub bounds: Option<[f64; 2]>,
    /// Whether the value is a bound from above, because noise hides what is below.
    pub at_most: bool,
}

impl Point {
    /// A value without bounds.
    pub fn new(name: impl Into<String>, at: [f64; 2]) -> Self {
        Self {
            at,
            name: name.into(),
            bounds: None,
            at_most: false,
        }
    }
}

/// A value that a line marks.
#[derive(Clone, Debug, PartialEq)]
pub struct Rule {
    /// Along which axis.
    pub along: Along,
    /// Where.
    pub value: f64,
    /// What stands beside it.
    pub name: String,
}

/// One of the two axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// Across.
    Across,
    /// Upwards.
    Upwards,
}

/// A second scale across: a time in seconds that is a multiple of the value.
#[derive(Clone, Debug, PartialEq)]
pub struct Clock {
    /// What takes this time.
    pub name: String,
    /// Seconds by unit of the value.
    pub seconds: f64,
}

/// Why a plot is not drawn.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlotError {
    /// There is nothing to draw.
    #[error(
        "the plot `{plot}` has nothing to show{of}: what should measure it gave no row; run its own command, which the section names, to see why"
    )]
    Empty {
        /// The plot.
        plot: String,
        /// The series, in words.
        of: String,
    },
    /// A value has no place.
    #[error(
        "the plot `{plot}` has no place for {value} of `{series}`, {point}: a value that its axis cannot have was measured"
    )]
    Value {
        /// The plot.
        plot: String,
        /// The series.
        series: String,
        /// The point.
        point: String,
        /// The value.
        value: String,
    },
}

impl Plot {
    /// A plot without series.
    pub fn new(name: impl Into<String>, title: impl Into<String>, across: Axis, upwards: Axis) -> Self {
        Self {
            name: name.into(),
            title: title.into(),
            about: String::new(),
            across,
            upwards,
            series: Vec::new(),
            rules: Vec::new(),
            clock: None,
            room: Room::Whole,
        }
    }

    /// Whether every series has points, and every point a place.
    pub fn check(&self) -> Result<(), PlotError> {
        let empty = |of: String| PlotError::Empty {
            plot: self.name.clone(),
            of,
        };
        if self.series.is_empty() {
            return Err(empty(String::new()));
        }
        for series in &self.series {
            if series.points.is_empty() {
                return Err(empty(format!(" of `{}`", series.name)));
            }
            for point in &series.points {
                self.check_point(series, point)?;
            }
        }
        for rule in &self.rules {
            let axis = match rule.along {
                Along::Across => &self.across,
                Along::Upwards => &self.upwards,
            };
            if !has_place(axis, rule.value) {
                return Err(self.no_place("a marked value", &rule.name, rule.value));
            }
        }
        Ok(())
    }

    fn check_point(&self, series: &Series, point: &Point) -> Result<(), PlotError> {
        let [across, upwards] = point.at;
        let bounds = point
            .bounds
            .into_iter()
            .flatten()
            .map(|bound| (&self.upwards, bound));
        let values = [(&self.across, across), (&self.upwards, upwards)]
            .into_iter()
            .chain(bounds);
        for (axis, value) in values {
            if !has_place(axis, value) {
                return Err(self.no_place(&series.name, &point.name, value));
            }
        }
        Ok(())
    }

    fn no_place(&self, series: &str, point: &str, value: f64) -> PlotError {
        PlotError::Value {
            plot: self.name.clone(),
            series: series.to_owned(),
            point: point.to_owned(),
            value: value.to_string(),
        }
    }

    /// Its data.
    pub fn table(&self) -> Table {
        let named = self
            .series
            .iter()
            .flat_map(|series| &series.points)
            .any(|point| !point.name.is_empty());
        let bounded = self
            .series
            .iter()
            .flat_map(|series| &series.points)
            .any(|point| point.bounds.is_some());
        let mut head = vec!["series".to_owned()];
        head.extend(named.then(|| "point".to_owned()));
        let title = |axis: &Axis| {
            if axis.name.is_empty() {
                "row".to_owned()
            } else {
                axis.name.clone()
            }
        };
        head.extend([title(&self.across), title(&self.upwards)]);
        head.extend(bounded.then(|| "between".to_owned()));
        let mut table = Table::new(&self.title, head);
        for series in self.series.iter().filter(|series| series.line != Line::Front) {
            for point in &series.points {
                let mut row = vec![series.name.clone()];
                row.extend(named.then(|| point.name.clone()));
                row.extend([written(&self.across, point.at[0]), self.upwards_of(point)]);
                let bounds = point
                    .bounds
                    .map(|bounds| bounds.map(|bound| written(&self.upwards, bound)));
                let bounds = bounds.map(|[low, high]| format!("{low} and {high}"));
                row.extend(bounded.then(|| bounds.unwrap_or_default()));
                table.push(row);
            }
        }
        table
    }

    /// A point's value upwards, in words.
    fn upwards_of(&self, point: &Point) -> String {
        let most = if point.at_most { "at most " } else { "" };
        format!("{most}{}", written(&self.upwards, point.at[1]))
    }
}

/// A value as a table has it.
fn written(axis: &Axis, value: f64) -> String {
    match &axis.scale {
        Scale::Names(names) => names.get(value as usize).cloned().unwrap_or_default(),
        Scale::Log | Scale::Linear => number(value),
    }
}

fn has_place(axis: &Axis, value: f64) -> bool {
    match &axis.scale {
        Scale::Log => value.is_finite() && value > 0.0,
        Scale::Linear => value.is_finite(),
        Scale::Names(names) => (0..names.len()).any(|row| row as f64 == value),
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A plot of one series.
    pub(in crate::report) fn plot(points: &[[f64; 2]]) -> Plot {
        Plot {
            about: "Two things.".to_owned(),
            series: vec![Series {
                name: "ours & theirs".to_owned(),
                points: points.iter().map(|&at| Point::new("a < b", at)).collect(),
                line: Line::Solid,
                look: 0,
                named: true,
            }],
            ..Plot::new("plot", "A <plot>", Axis::log("cycles"), Axis::log("error"))
        }
    }

    #[test]
    fn a_plot_without_data_is_refused() {
        assert_eq!(plot(&[[1.0, 2.0]]).check(), Ok(()));
        let empty = plot(&[]).check().unwrap_err().to_string();
        assert!(
            empty.contains("`plot` has nothing to show of `ours & theirs`"),
            "{empty}"
        );
        let none = Plot {
            series: Vec::new(),
            ..plot(&[])
        };
        assert!(none.check().is_err());
    }

    #[test]
    fn a_value_without_a_place_is_refused() {
        for bad in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
            for at in [[bad, 1.0], [1.0, bad]] {
                let fault = plot(&[[1.0, 1.0], at]).check().unwrap_err().to_string();
                assert!(fault.contains("`ours & theirs`, a < b"), "{fault}");
            }
        }
        let mut bounded = plot(&[[1.0, 1.0]]);
        bounded.series[0].points[0].bounds = Some([0.0, 2.0]);
        assert!(
            bounded.check().is_err(),
            "its lower bound has no place on a logarithmic axis"
        );
        let mut ruled = plot(&[[1.0, 1.0]]);
        ruled.rules.push(Rule {
            along: Along::Across,
            value: -3.0,
            name: "wanted".to_owned(),
        });
        assert!(ruled.check().is_err());
        let names = Axis::names(vec!["row".to_owned()]);
        let row = Plot {
            upwards: names,
            ..plot(&[[1.0, 1.0]])
        };
        assert!(row.check().is_err(), "there is no second row");
    }

    #[test]
    fn the_table_says_what_the_plot_shows() {
        let mut plot = plot(&[[10.0, 0.25]]);
        plot.series[0].points[0].at_most = true;
        let table = plot.table();
        assert_eq!(table.head(), ["series", "point", "cycles", "error"]);
        assert_eq!(table.rows(), [["ours & theirs", "a < b", "10", "at most 0.25"]]);
    }
}
