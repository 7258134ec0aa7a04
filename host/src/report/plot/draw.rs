//! A plot as SVG.

use maud::{Markup, PreEscaped, html};

use super::axis::{Ruler, Tick};
use super::labels::{self, places};
use super::marks::{LOOKS, outline};
use super::{Along, Clock, Line, Plot, Point, Room, Scale, Series};

/// Widths of plots, in the drawing's units: pixels, where there is room for them.
const WHOLE: f64 = 780.0;
const PART: f64 = 372.0;
/// Heights of the space between the axes.
const HEIGHT: f64 = 380.0;
const PART_HEIGHT: f64 = 210.0;
/// A named row's.
const ROW: f64 = 23.0;
/// The radius of a mark, and of what the pointer finds it by.
const MARK: f64 = 4.5;
const REACH: f64 = 10.0;
/// A line of the legend, or of a scale's labels.
const LINE: f64 = 20.0;

/// The style of plots: of those on a page, and of files of their own.
pub(in crate::report) const STYLE: &str = include_str!("plot.css");

/// The plot as an element of a page, which has [`STYLE`].
pub(in crate::report) fn drawing(plot: &Plot) -> Markup {
    let frame = Frame::of(plot);
    let view = format!("0 0 {:.0} {:.0}", frame.size[0], frame.size[1]);
    let (title, about) = (format!("{}-title", plot.name), format!("{}-about", plot.name));
    html! {
        svg class="plot" viewBox=(view) role="img" aria-labelledby={ (title) " " (about) } {
            title id=(title) { (plot.title) }
            desc id=(about) { (plot.about) }
            (frame.contents())
        }
    }
}

/// The plot as a file of its own, with its title.
pub(in crate::report) fn standalone(plot: &Plot) -> String {
    let frame = Frame::of(plot);
    let [width, height] = frame.size;
    let above = 34.0;
    let view = format!("0 -{above} {width:.0} {:.0}", height + above);
    let drawn = html! {
        svg xmlns="http://www.w3.org/2000/svg" class="plot" viewBox=(view) width=(width) height=(height + above)
            role="img" aria-labelledby="title about" {
            title id="title" { (plot.title) }
            desc id="about" { (plot.about) }
            style { (PreEscaped(STYLE)) }
            rect class="paper" x="0" y=(-above) width=(width) height=(height + above) {}
            text class="heading" x="12" y="-12" { (plot.title) }
            (frame.contents())
        }
    };
    drawn.into_string() + "\n"
}

/// A plot, laid out.
struct Frame<'a> {
    plot: &'a Plot,
    size: [f64; 2],
    /// Left, top, right, bottom of the space between the axes.
    inner: labels::Box,
    across: Ruler<'a>,
    upwards: Ruler<'a>,
}

impl<'a> Frame<'a> {
    fn of(plot: &'a Plot) -> Self {
        let (width, height) = match (plot.room, &plot.upwards.scale) {
            (Room::Whole, Scale::Names(names)) => (WHOLE, ROW * names.len() as f64 + 8.0),
            (Room::Whole, _) => (WHOLE, HEIGHT),
            (Room::Part, _) => (PART, PART_HEIGHT),
        };
        let left = match &plot.upwards.scale {
            Scale::Names(names) => names.iter().map(|name| labels::width(name)).fold(0.0, f64::max) + 16.0,
            _ => 66.0,
        };
        let right = 18.0;
        let top = 10.0
            + LINE * legend_lines(plot, width).len() as f64
            + if plot.clock.is_some() { 2.0 * LINE } else { 0.0 }
            + if plot.rules.iter().any(|rule| rule.along == Along::Across) {
                LINE
            } else {
                0.0
            };
        let inner = [left, top, width - right, top + height];
        let points = || plot.series.iter().flat_map(|series| &series.points);
        let marked = |along| {
            plot.rules
                .iter()
                .filter(move |rule| rule.along == along)
                .map(|rule| rule.value)
        };
        let xs = points().map(|point| point.at[0]).chain(marked(Along::Across));
        let ys = points().flat_map(|point| {
            point
                .bounds
                .unwrap_or([point.at[1]; 2])
                .into_iter()
                .chain([point.at[1]])
        });
        let ys = ys.chain(marked(Along::Upwards));
        // Names go downwards, values upwards.
        let heights = match plot.upwards.scale {
            Scale::Names(_) => [inner[1], inner[3]],
            _ => [inner[3], inner[1]],
        };
        Self {
            plot,
            size: [width, inner[3] + 2.0 * LINE + 4.0],
            inner,
            across: Ruler::over(&plot.across.scale, xs, [inner[0], inner[2]]),
            upwards: Ruler::over(&plot.upwards.scale, ys, heights),
        }
    }

    fn place(&self, point: &Point) -> [f64; 2] {
        [self.across.place(point.at[0]), self.upwards.place(point.at[1])]
    }

    fn contents(&self) -> Markup {
        html! {
            (self.grid())
            (self.scales())
            @if let Some(clock) = &self.plot.clock { (self.clock(clock)) }
            (self.rules())
            (self.legend())
            @for series in &self.plot.series { (self.joins(series)) }
            @for series in &self.plot.series { (self.marks(series)) }
            (self.names())
            @for series in &self.plot.series { (self.hits(series)) }
        }
    }

    fn grid(&self) -> Markup {
        let [left, top, right, bottom] = self.inner;
        let class = |tick: &Tick| {
            if tick.label.is_some() {
                "grid"
            } else {
                "grid faint"
            }
        };
        html! {
            @for tick in self.across.ticks() {
                @let x = self.across.place(tick.value);
                (segment(class(&tick), [x, top], [x, bottom]))
            }
            @for tick in self.upwards.ticks() {
                @let y = self.upwards.place(tick.value);
                (segment(class(&tick), [left, y], [right, y]))
            }
            (segment("axis", [left, bottom], [right, bottom]))
            (segment("axis", [left, top], [left, bottom]))
        }
    }

    fn scales(&self) -> Markup {
        let [left, top, right, bottom] = self.inner;
        let middle = f64::midpoint(top, bottom);
        html! {
            @for tick in self.across.ticks() {
                @if let Some(label) = &tick.label {
                    (text("tick middle", [self.across.place(tick.value), bottom + 16.0], label))
                }
            }
            @for tick in self.upwards.ticks() {
                @if let Some(label) = &tick.label {
                    (text("tick end", [left - 7.0, self.upwards.place(tick.value) + 4.0], label))
                }
            }
            (text("axis-name middle", [f64::midpoint(left, right), bottom + 36.0], &self.plot.across.name))
            @if !self.plot.upwards.name.is_empty() {
                text class="axis-name middle" transform=(format!("translate(14 {middle:.1}) rotate(-90)")) {
                    (self.plot.upwards.name)
                }
            }
        }
    }

    /// Times that people have names for, on the upper edge.
    fn clock(&self, clock: &Clock) -> Markup {
        const NAMED: [(f64, &str); 14] = [
            (1e-3, "1 ms"),
            (1e-2, "10 ms"),
            (0.1, "0.1 s"),
            (1.0, "1 s"),
            (10.0, "10 s"),
            (60.0, "1 min"),
            (600.0, "10 min"),
            (3600.0, "1 h"),
            (36_000.0, "10 h"),
            (86_400.0, "1 day"),
            (864_000.0, "10 days"),
            (3.156e7, "1 year"),
            (3.156e8, "10 years"),
            (3.156e9, "100 years"),
        ];
        let [left, top, right, _] = self.inner;
        html! {
            (segment("axis", [left, top], [right, top]))
            @for (seconds, name) in NAMED {
                @let value = seconds / clock.seconds;
                @if self.across.holds(value) {
                    @let x = self.across.place(value);
                    (segment("axis", [x, top - 5.0], [x, top]))
                    (text("tick middle", [x, top - 9.0], name))
                }
            }
            (text("axis-name middle", [f64::midpoint(left, right), top - 27.0], &clock.name))
        }
    }

    fn rules(&self) -> Markup {
        let [left, top, right, bottom] = self.inner;
        html! {
            @for rule in &self.plot.rules {
                @match rule.along {
                    Along::Across => {
                        @let x = self.across.place(rule.value);
                        (segment("rule", [x, top], [x, bottom]))
                        (text("rule-name middle", [self.middle_of(x, &rule.name), top - 6.0], &rule.name))
                    }
                    Along::Upwards => {
                        @let y = self.upwards.place(rule.value);
                        (segment("rule", [left, y], [right, y]))
                        (text("rule-name end", [right - 4.0, y - 4.0], &rule.name))
                    }
                }
            }
        }
    }

    /// Where the middle of a text is that should be at `x` and must not leave the drawing.
    fn middle_of(&self, x: f64, text: &str) -> f64 {
        let half = labels::width(text) / 2.0 + 4.0;
        x.min(self.size[0] - half).max(half)
    }

    fn legend(&self) -> Markup {
        html! {
            @for (line, entries) in (0u32..).zip(legend_lines(self.plot, self.size[0])) {
                @for (x, series) in entries {
                    @let y = 12.0 + LINE * f64::from(line);
                    path class={ "mark " (colour(series)) } d=(outline(series.look, [x + 6.0, y], MARK)) {}
                    (text("entry", [x + 16.0, y + 4.0], &series.name))
                }
            }
        }
    }

    /// The line through a series, and the bounds of its points.
    fn joins(&self, series: &Series) -> Markup {
        let places: Vec<String> = series
            .points
            .iter()
            .map(|point| self.place(point))
            .map(|[x, y]| format!("{x:.1},{y:.1}"))
            .collect();
        html! {
            @if series.line != Line::None {
                polyline class={ (if series.is_marked() { "join " } else { "join front " }) (colour(series)) } points=(places.join(" ")) {}
            }
            @for point in &series.points {
                @if let Some([low, high]) = point.bounds {
                    @let x = self.across.place(point.at[0]);
                    @let ends = [low, high].map(|bound| self.upwards.place(bound));
                    path class={ "bounds " (colour(series)) }
                        d=(format!("M{x:.1} {:.1}V{:.1}M{:.1} {:.1}h6M{:.1} {:.1}h6", ends[0], ends[1], x - 3.0, ends[0], x - 3.0, ends[1])) {}
                }
            }
        }
    }

    fn marks(&self, series: &Series) -> Markup {
        html! {
            @for point in series.marked() {
                @let [x, y] = self.place(point);
                @if point.at_most {
                    path class={ "mark hollow " (colour(series)) } d=(outline(series.look, [x, y], MARK)) {}
                    path class={ "bounds " (colour(series)) } d=(format!("M{x:.1} {:.1}v11m-3 -4l3 4l3 -4", y + MARK)) {}
                } @else {
                    path class={ "mark " (colour(series)) } d=(outline(series.look, [x, y], MARK)) {}
                }
            }
        }
    }

    /// What the pointer finds, above everything that is drawn.
    fn hits(&self, series: &Series) -> Markup {
        html! {
            @for point in series.marked() {
                @let [x, y] = self.place(point);
                g class="hit" {
                    title { (self.said(series, point)) }
                    circle class="reach" cx=(format!("{x:.1}")) cy=(format!("{y:.1}")) r=(REACH) {}
                }
            }
        }
    }

    /// A point in words.
    fn said(&self, series: &Series, point: &Point) -> String {
        let name = match (point.name.as_str(), series.name.as_str()) {
            ("", series) => series.to_owned(),
            (name, "") => name.to_owned(),
            (name, series) => format!("{name}, {series}"),
        };
        let value = |axis: &super::Axis, text: String| match axis.name.as_str() {
            "" => text,
            name => format!("{name}: {text}"),
        };
        let upwards = value(&self.plot.upwards, self.plot.upwards_of(point));
        format!(
            "{name}\n{}\n{upwards}",
            value(&self.plot.across, super::written(&self.plot.across, point.at[0]))
        )
    }

    /// Names of points.
    fn names(&self) -> Markup {
        let points = || {
            self.plot
                .series
                .iter()
                .flat_map(|series| series.marked().iter().map(move |point| (series, point)))
        };
        let marks: Vec<[f64; 2]> = points().map(|(_, point)| self.place(point)).collect();
        let names: Vec<Option<&str>> = points()
            .map(|(series, point)| series.named.then_some(point.name.as_str()))
            .collect();
        let places = places(&marks, &names, self.inner);
        html! {
            @for ((name, place), mark) in names.iter().zip(&places).zip(&marks) {
                @if let (Some(name), Some(place)) = (name, place) {
                    @if place.is_far {
                        @let [left, base] = place.at;
                        @let near = mark[0].clamp(left, left + labels::width(name));
                        (segment("leader", *mark, [near, base - if base < mark[1] { 0.0 } else { 9.0 }]))
                    }
                    (text("name", place.at, name))
                }
            }
        }
    }
}

impl Series {
    fn is_marked(&self) -> bool {
        self.line != Line::Front
    }

    /// The points that have a mark of this series.
    fn marked(&self) -> &[Point] {
        if self.is_marked() { &self.points } else { &[] }
    }
}

/// The legend's lines: where the entries of each start. One series needs none.
fn legend_lines(plot: &Plot, width: f64) -> Vec<Vec<(f64, &Series)>> {
    let entries: Vec<&Series> = plot.series.iter().filter(|series| series.is_marked()).collect();
    let mut lines: Vec<Vec<(f64, &Series)>> = Vec::new();
    if entries.len() < 2 {
        return lines;
    }
    let mut x = width;
    for series in entries {
        let wide = labels::width(&series.name) + 34.0;
        if x + wide > width {
            lines.push(Vec::new());
            x = 12.0;
        }
        if let Some(line) = lines.last_mut() {
            line.push((x, series));
        }
        x += wide;
    }
    lines
}

fn colour(series: &Series) -> String {
    format!("c{}", series.look % LOOKS)
}

fn segment(class: &str, from: [f64; 2], to: [f64; 2]) -> Markup {
    let [x1, y1, x2, y2] = [from[0], from[1], to[0], to[1]].map(|place| format!("{place:.1}"));
    html! { line class=(class) x1=(x1) y1=(y1) x2=(x2) y2=(y2) {} }
}

fn text(class: &str, at: [f64; 2], words: &str) -> Markup {
    let [x, y] = at.map(|place| format!("{place:.1}"));
    html! { text class=(class) x=(x) y=(y) { (words) } }
}

#[cfg(test)]
mod tests {
    use super::super::tests::plot;
    use super::*;

    #[test]
    fn every_point_is_a_mark_with_its_values() {
        let drawn = drawing(&plot(&[[10.0, 0.5], [2000.0, 0.001]])).into_string();
        let parsed = roxmltree::Document::parse(&drawn).expect("it is well formed");
        let of_class = |class: &str| {
            parsed
                .descendants()
                .filter(|node| {
                    node.attribute("class")
                        .is_some_and(|all| all.split(' ').any(|it| it == class))
                })
                .count()
        };
        assert_eq!((of_class("mark"), of_class("hit"), of_class("join")), (2, 2, 1));
        let said: Vec<&str> = parsed
            .descendants()
            .filter(|node| node.has_tag_name("title"))
            .filter_map(|node| node.text())
            .collect();
        assert_eq!(
            said,
            [
                "A <plot>",
                "a < b, ours & theirs\ncycles: 10\nerror: 0.5",
                "a < b, ours & theirs\ncycles: 2,000\nerror: 0.001"
            ]
        );
        assert_eq!(parsed.root_element().attribute("role"), Some("img"));
    }

    #[test]
    fn marks_lie_between_the_axes() {
        let plot = plot(&[[10.0, 0.5], [2000.0, 0.001]]);
        let frame = Frame::of(&plot);
        for point in &plot.series[0].points {
            let [x, y] = frame.place(point);
            assert!(frame.inner[0] < x && x < frame.inner[2] && frame.inner[1] < y && y < frame.inner[3]);
        }
        let [first, second] = [0, 1].map(|index| frame.place(&plot.series[0].points[index]));
        assert!(
            first[0] < second[0] && first[1] < second[1],
            "smaller errors are below"
        );
    }

    #[test]
    fn a_file_of_its_own_needs_nothing_else() {
        let file = standalone(&plot(&[[10.0, 0.5]]));
        let parsed = roxmltree::Document::parse(&file).expect("it is well formed");
        assert_eq!(
            parsed.root_element().tag_name().namespace(),
            Some("http://www.w3.org/2000/svg")
        );
        assert!(file.contains("prefers-color-scheme") && !file.contains("url("));
    }
}
