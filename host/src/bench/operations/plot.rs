//! The price list as a picture: cost against worst error, a panel an operation.

use std::io::Write as _;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::register_font;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::Row;
use super::anchors::{self, ANCHORS, Anchor};
use super::table::{grouped, is_on_front};
use crate::firmware::board::Board;
use crate::image::raster::Raster;
use crate::platform::file::{WriteError, write_whole};

/// The built-in font, under the name that a browser replaces by its own.
const FONT: &str = "sans-serif";
const TITLE: u32 = 14;
const LABEL: u32 = 10;
/// Average width of a letter of a label.
const LETTER: i32 = 6;
const COLUMNS: usize = 3;
const PANEL: (i32, i32) = (400, 270);
const HEADER: i32 = 48;
/// Room around a panel's axes: left, top, right, bottom.
const ROOM: [i32; 4] = [52, 30, 14, 36];

const GRID: RGBColor = RGBColor(225, 225, 225);
const FRONT: RGBColor = RGBColor(150, 150, 150);
const INK: RGBColor = RGBColor(40, 40, 40);

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum PlotError {
    /// The file's name does not say what it is to be.
    #[error("{}: a plot is an .svg or a .png", .0.display())]
    Extension(PathBuf),
    /// It cannot be drawn or written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// What the drawing library says.
pub type DrawingError = Box<dyn std::error::Error + Send + Sync>;

type Canvas<Backend> = DrawingArea<Backend, Shift>;
type Drawn = Result<(), DrawingError>;

/// Draws the list into a file, by the extension of its name.
pub fn write(path: &Path, rows: &[Row]) -> Result<(), PlotError> {
    let is_vector = match path.extension().and_then(|extension| extension.to_str()) {
        Some("svg") => true,
        Some("png") => false,
        _ => return Err(PlotError::Extension(path.to_owned())),
    };
    write_whole(path, |writer| -> Drawn {
        let bytes = if is_vector { svg(rows)? } else { png(rows)? };
        Ok(writer.write_all(&bytes)?)
    })?;
    Ok(())
}

/// The picture for a page.
pub fn svg(rows: &[Row]) -> Result<Vec<u8>, DrawingError> {
    let panels = panels(rows);
    let mut text = String::new();
    draw(
        &SVGBackend::with_string(&mut text, size(&panels)).into_drawing_area(),
        &panels,
        board_of(rows),
    )?;
    Ok(text.into_bytes())
}

fn png(rows: &[Row]) -> Result<Vec<u8>, DrawingError> {
    let panels = panels(rows);
    let (width, height) = size(&panels);
    let mut rgb = vec![0; (width * height * 3) as usize];
    draw(
        &BitMapBackend::with_buffer(&mut rgb, (width, height)).into_drawing_area(),
        &panels,
        board_of(rows),
    )?;
    let mut bytes = Vec::new();
    Raster { width, height, rgb }.write_png(&mut bytes)?;
    Ok(bytes)
}

fn size(panels: &[Panel]) -> (u32, u32) {
    let lines = panels.len().div_ceil(COLUMNS) as i32;
    (
        (PANEL.0 * COLUMNS as i32) as u32,
        (HEADER + PANEL.1 * lines) as u32,
    )
}

/// Whose a mark is, which decides its colour and its shape.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Ours,
    Published,
    Rival,
    Quoted,
}

impl Kind {
    const ALL: [(Self, &'static str); 4] = [
        (Self::Ours, "ours"),
        (Self::Published, "published"),
        (Self::Rival, "crates and soft float"),
        (Self::Quoted, "quoted: C libraries, measured beforehand"),
    ];

    fn colour(self) -> RGBColor {
        match self {
            Self::Ours => RGBColor(0, 90, 181),
            Self::Published => RGBColor(220, 50, 32),
            Self::Rival => RGBColor(90, 90, 90),
            Self::Quoted => RGBColor(120, 60, 160),
        }
    }

    fn mark<Backend: DrawingBackend>(self, canvas: &Canvas<Backend>, (x, y): (i32, i32)) -> Drawn
    where
        Backend::ErrorType: 'static,
    {
        let (colour, filled) = (self.colour(), self.colour().filled());
        match self {
            Self::Ours => canvas.draw(&Circle::new((x, y), 5, filled)),
            Self::Published => canvas.draw(&Rectangle::new([(x - 4, y - 4), (x + 4, y + 4)], filled)),
            Self::Rival => canvas.draw(&Polygon::new(
                [(x, y - 5), (x + 5, y + 4), (x - 5, y + 4)],
                filled,
            )),
            Self::Quoted => {
                let corners = [(x, y - 5), (x + 5, y), (x, y + 5), (x - 5, y), (x, y - 5)];
                canvas.draw(&PathElement::new(corners, colour.stroke_width(1)))
            }
        }
        .map_err(|error| error.to_string().into())
    }
}

struct Point {
    cost: f64,
    error: f64,
    kind: Kind,
    label: String,
    on_front: bool,
}

struct Panel {
    title: String,
    points: Vec<Point>,
}

/// A panel for each operation of which there is a choice, and something to lose by it.
fn panels(rows: &[Row]) -> Vec<Panel> {
    let panel = |group: Vec<&Row>| {
        let points: Vec<Point> = group.iter().filter_map(|row| point(row, &group)).collect();
        let quotes = |anchor: &&Anchor| anchor.op == group[0].op && anchors::BOARD == group[0].board;
        let quoted = ANCHORS.iter().filter(quotes);
        // Whose library it is makes no difference to single precision's results, or hardly.
        let single = group.iter().find(|row| matches!(row.maker, "f32" | "libm"));
        let single = single.and_then(|row| row.max_error_ulp);
        let quoted = quoted.filter_map(|anchor| {
            Some(Point {
                cost: anchor.instructions,
                error: anchor.max_error_ulp.or(single)?,
                kind: Kind::Quoted,
                label: anchor.library.to_owned(),
                on_front: false,
            })
        });
        (points.len() > 1).then(|| Panel {
            title: format!("{}, ulp = {}", group[0].op, group[0].ulp),
            points: points.into_iter().chain(quoted).collect(),
        })
    };
    grouped(rows).into_iter().filter_map(panel).collect()
}

/// A row's mark, if it has an error: what is exact has no place on a logarithmic axis.
fn point(row: &Row, group: &[&Row]) -> Option<Point> {
    let error = row.max_error_ulp.filter(|&error| error > 0.0)?;
    let kind = match row.maker {
        "ours" => Kind::Ours,
        "published" => Kind::Published,
        _ => Kind::Rival,
    };
    Some(Point {
        cost: row.instructions,
        error,
        kind,
        label: row.name.clone(),
        on_front: is_on_front(row, group),
    })
}

/// The board that a list is of.
fn board_of(rows: &[Row]) -> Board {
    rows.first().map(|row| row.board).unwrap_or_default()
}

fn draw<Backend: DrawingBackend>(canvas: &Canvas<Backend>, panels: &[Panel], board: Board) -> Drawn
where
    Backend::ErrorType: 'static,
{
    register_font(FONT, FontStyle::Normal, dejavu::sans::regular())
        .map_err(|_| "the built-in font is damaged")?;
    canvas.fill(&WHITE).map_err(|error| error.to_string())?;
    legend(canvas, board)?;
    for (place, panel) in panels.iter().enumerate() {
        let (column, line) = ((place % COLUMNS) as i32, (place / COLUMNS) as i32);
        draw_panel(canvas, (column * PANEL.0, HEADER + line * PANEL.1), panel)?;
    }
    canvas.present().map_err(|error| error.to_string().into())
}

fn legend<Backend: DrawingBackend>(canvas: &Canvas<Backend>, board: Board) -> Drawn
where
    Backend::ErrorType: 'static,
{
    let title = format!(
        "Worst error (ulp) against instructions on {}; the line joins what nothing else beats",
        board.processor()
    );
    text(canvas, &title, TITLE, (16, 8), HPos::Left, &INK)?;
    let mut x = 24;
    for (kind, name) in Kind::ALL {
        kind.mark(canvas, (x, 36))?;
        text(canvas, name, LABEL, (x + 10, 31), HPos::Left, &kind.colour())?;
        x += 40 + LETTER * name.len() as i32;
    }
    Ok(())
}

/// A logarithmic axis.
struct Axis {
    start: f64,
    end: f64,
    pixels: RangeInclusive<i32>,
}

impl Axis {
    /// Holds all values, with room for marks at its ends.
    fn over(values: impl Iterator<Item = f64>, room: (f64, f64), pixels: RangeInclusive<i32>) -> Self {
        let (least, most) = values.fold((f64::INFINITY, 0f64), |(least, most), value| {
            (least.min(value), most.max(value))
        });
        Self {
            start: (least / room.0).log10(),
            end: (most * room.1).log10(),
            pixels,
        }
    }

    fn pixel(&self, value: f64) -> i32 {
        let share = (value.log10() - self.start) / (self.end - self.start);
        let (first, last) = (f64::from(*self.pixels.start()), f64::from(*self.pixels.end()));
        (first + share * (last - first)).round() as i32
    }

    /// Powers of ten, fewer where there are too many for labels, and twice and five times them where there are too few.
    fn ticks(&self) -> Vec<f64> {
        let decades = self.start.floor() as i32..=self.end.ceil() as i32;
        let step = (self.end - self.start) as usize / 6 + 1;
        let factors: &[f64] = if self.end - self.start < 1.7 {
            &[1.0, 2.0, 5.0]
        } else {
            &[1.0]
        };
        let ticks = decades
            .step_by(step)
            .flat_map(|power| factors.iter().map(move |factor| factor * 10f64.powi(power)));
        let inside = |tick: &f64| (self.start..=self.end).contains(&tick.log10());
        ticks.filter(inside).collect()
    }
}

fn draw_panel<Backend: DrawingBackend>(canvas: &Canvas<Backend>, at: (i32, i32), panel: &Panel) -> Drawn
where
    Backend::ErrorType: 'static,
{
    let [left, top, right, bottom] = ROOM;
    let (x0, x1) = (at.0 + left, at.0 + PANEL.0 - right);
    let (y0, y1) = (at.1 + PANEL.1 - bottom, at.1 + top);
    let costs = Axis::over(panel.points.iter().map(|point| point.cost), (1.5, 1.5), x0..=x1);
    let height = RangeInclusive::new(y0, y1);
    let errors = Axis::over(panel.points.iter().map(|point| point.error), (4.0, 4.0), height);
    text(canvas, &panel.title, TITLE, (x0, at.1 + 8), HPos::Left, &INK)?;
    for tick in costs.ticks() {
        let x = costs.pixel(tick);
        line(canvas, [(x, y0), (x, y1)], &GRID)?;
        text(canvas, &number(tick), LABEL, (x, y0 + 4), HPos::Center, &INK)?;
    }
    for tick in errors.ticks() {
        let y = errors.pixel(tick);
        line(canvas, [(x0, y), (x1, y)], &GRID)?;
        text(canvas, &number(tick), LABEL, (x0 - 5, y - 6), HPos::Right, &INK)?;
    }
    line(canvas, [(x0, y1), (x0, y0)], &INK)?;
    line(canvas, [(x0, y0), (x1, y0)], &INK)?;
    text(canvas, "instructions", LABEL, (x1, y0 + 18), HPos::Right, &INK)?;
    let place = |point: &Point| (costs.pixel(point.cost), errors.pixel(point.error));
    let front = panel.points.iter().filter(|point| point.on_front).map(place);
    line(canvas, front.collect::<Vec<_>>(), &FRONT)?;
    let marks: Vec<(i32, i32)> = panel.points.iter().map(place).collect();
    for (point, &at) in panel.points.iter().zip(&marks) {
        point.kind.mark(canvas, at)?;
    }
    labels(canvas, &panel.points, &marks, (x0, x1))
}

/// Puts a label beside each mark, on the side with more room, and above or below where it would cover another.
fn labels<Backend: DrawingBackend>(
    canvas: &Canvas<Backend>,
    points: &[Point],
    marks: &[(i32, i32)],
    (start, end): (i32, i32),
) -> Drawn
where
    Backend::ErrorType: 'static,
{
    let half = LABEL as i32 / 2 + 1;
    let mut taken: Vec<[i32; 4]> = marks.iter().map(|&(x, y)| [x - 5, y - 5, x + 5, y + 5]).collect();
    for (point, &(x, y)) in points.iter().zip(marks) {
        let width = LETTER * point.label.chars().count() as i32;
        let boxes = |shift: i32| {
            let (above, below) = (y + shift - half, y + shift + half);
            [
                (HPos::Left, [x + 8, above, x + 8 + width, below]),
                (HPos::Right, [x - 8 - width, above, x - 8, below]),
            ]
        };
        let fits = |&(_, [left, above, right, below]): &(HPos, [i32; 4])| {
            let covers = |other: &[i32; 4]| {
                left < other[2] && other[0] < right && above < other[3] && other[1] < below
            };
            left >= start && right <= end && !taken.iter().any(covers)
        };
        let shifts = [0, -9, 9, -14, 14, -20, 20, -27, 27, -34, 34];
        let found = shifts.into_iter().flat_map(boxes).find(fits);
        let (side, place) = found.unwrap_or(boxes(0)[0]);
        taken.push(place);
        let anchor = if matches!(side, HPos::Left) {
            place[0]
        } else {
            place[2]
        };
        text(
            canvas,
            &point.label,
            LABEL,
            (anchor, place[1]),
            side,
            &point.kind.colour(),
        )?;
    }
    Ok(())
}

fn number(tick: f64) -> String {
    if (0.001..1e5).contains(&tick) {
        // A tick has one digit that is not 0.
        format!("{:.*}", (-tick.log10().floor()).max(0.0) as usize, tick)
    } else {
        format!("{tick:.0e}")
    }
}

fn line<Backend: DrawingBackend>(
    canvas: &Canvas<Backend>,
    through: impl Into<Vec<(i32, i32)>>,
    colour: &RGBColor,
) -> Drawn
where
    Backend::ErrorType: 'static,
{
    let path = PathElement::new(through.into(), colour.stroke_width(1));
    canvas.draw(&path).map_err(|error| error.to_string().into())
}

fn text<Backend: DrawingBackend>(
    canvas: &Canvas<Backend>,
    words: &str,
    size: u32,
    place: (i32, i32),
    horizontal: HPos,
    colour: &RGBColor,
) -> Drawn
where
    Backend::ErrorType: 'static,
{
    let style = TextStyle::from((FONT, size).into_font()).color(colour);
    let style = style.pos(Pos::new(horizontal, VPos::Top));
    let element = Text::new(words.to_owned(), place, style);
    canvas.draw(&element).map_err(|error| error.to_string().into())
}
