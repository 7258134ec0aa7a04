//! The stacks as a picture: a flame graph that hangs from the top, SVG.
//!
//! Width is cycles. What stands below a function is inlined into it or called by it. The colour says whose code it is.

use std::fmt::{self, Display, Formatter};

use super::brief::brief;
use super::calls::Node;
use super::code::Code;
use super::run::Run;

/// The picture's width and the height of a row, in pixels.
const WIDTH: f64 = 1400.0;
const ROW: f64 = 18.0;
/// Room above the stacks, for the heading.
const TOP: f64 = 56.0;
const MARGIN: f64 = 10.0;
/// What is narrower is not drawn.
const NARROWEST: f64 = 0.4;
/// The width of a character of the font.
const CHARACTER: f64 = 6.7;

/// Whose code it is, by how its names begin, and its colour.
const COLOURS: [(&str, &[&str], &str); 4] = [
    ("tracer", &["tracer::"], "#f4a259"),
    ("arithmetic", &["fixedmath::"], "#e4572e"),
    (
        "frame and the compiler's routines",
        &["node::", "runtime::", "wire::", "board::", "__"],
        "#9fb8d9",
    ),
    ("libraries", &[""], "#8cb369"),
];

/// The picture.
pub(super) fn svg(run: &Run, stacks: &[Node], code: &Code) -> String {
    let mut boxes = Vec::new();
    let mut x = MARGIN;
    let scale = (WIDTH - 2.0 * MARGIN) / run.total.cycles as f64;
    for node in stacks {
        hang(node, x, 0, scale, &mut boxes);
        x += node.cycles * scale;
    }
    let rows = boxes.iter().map(|hung| hung.depth + 1).max().unwrap_or_default();
    let height = TOP + rows as f64 * ROW + MARGIN;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height}\" viewBox=\"0 0 {WIDTH} {height}\" \
         font-family=\"monospace\" font-size=\"11\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
    );
    svg += &heading(run);
    for hung in &boxes {
        svg += &draw(hung, run, code);
    }
    svg + "</svg>\n"
}

/// A function's place in the picture.
struct Hung<'a> {
    node: &'a Node,
    x: f64,
    depth: usize,
    width: f64,
}

fn hang<'a>(node: &'a Node, x: f64, depth: usize, scale: f64, boxes: &mut Vec<Hung<'a>>) {
    let width = node.cycles * scale;
    if width < NARROWEST {
        return;
    }
    boxes.push(Hung {
        node,
        x,
        depth,
        width,
    });
    let mut below: Vec<&Node> = node.below.iter().collect();
    below.sort_by(|a, b| b.cycles.total_cmp(&a.cycles));
    let mut x = x;
    for node in below {
        hang(node, x, depth + 1, scale, boxes);
        x += node.cycles * scale;
    }
}

fn heading(run: &Run) -> String {
    let of = &run.subject;
    let title = format!(
        "{} on {} with {}, {}: {:.0} cycles a sample",
        of.scene, of.board, of.profile, of.termination, run.cycles_per_sample
    );
    let mut text = format!(
        "<text x=\"{MARGIN}\" y=\"22\" font-size=\"15\">{}</text>\n",
        Escaped(&title)
    );
    let mut x = MARGIN;
    for (whose, _, colour) in COLOURS {
        text += &format!(
            "<rect x=\"{x}\" y=\"34\" width=\"11\" height=\"11\" fill=\"{colour}\"/>\
             <text x=\"{}\" y=\"44\">{}</text>\n",
            x + 16.0,
            Escaped(whose)
        );
        x += 40.0 + whose.len() as f64 * CHARACTER;
    }
    text
}

fn draw(hung: &Hung<'_>, run: &Run, code: &Code) -> String {
    let Hung {
        node,
        x,
        depth,
        width,
    } = *hung;
    let name = code.word(node.name);
    let y = TOP + depth as f64 * ROW;
    let samples = run.samples as f64;
    let title = format!(
        "{name}: {:.1} cycles a sample ({:.1} %), {:.1} instructions",
        node.cycles / samples,
        100.0 * node.cycles / run.total.cycles as f64,
        node.instructions / samples
    );
    let mut drawn = format!(
        "<g><title>{}</title><rect x=\"{x:.2}\" y=\"{y}\" width=\"{width:.2}\" height=\"{}\" fill=\"{}\" stroke=\"#ffffff\" \
         stroke-width=\"0.5\"/>",
        Escaped(&title),
        ROW - 1.0,
        colour(name)
    );
    if let Some(label) = label(name, width) {
        drawn += &format!(
            "<text x=\"{:.2}\" y=\"{}\">{}</text>",
            x + 3.0,
            y + 12.5,
            Escaped(&label)
        );
    }
    drawn + "</g>\n"
}

fn colour(name: &str) -> &'static str {
    // A method's name begins with its type: `<tracer::T as U>::f`.
    let name = name.trim_start_matches(['<', '&']);
    let begins = |(_, starts, _): &&(_, &[&str], _)| starts.iter().any(|start| name.starts_with(start));
    COLOURS
        .iter()
        .find(begins)
        .map_or("none", |(_, _, colour)| colour)
}

/// As much of a name as fits: all of it, its last parts, its beginning; nothing where not even three letters do.
fn label(name: &str, width: f64) -> Option<String> {
    let room = ((width - 6.0) / CHARACTER) as usize;
    let name = brief(name);
    let mut shown = name.as_str();
    while shown.len() > room {
        match shown.split_once("::") {
            Some((_, last)) => shown = last,
            None => break,
        }
    }
    let shown: String = shown.chars().take(room).collect();
    (shown.len() >= 3).then_some(shown)
}

/// Text of an XML document.
struct Escaped<'a>(&'a str);

impl Display for Escaped<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        self.0.chars().try_for_each(|character| match character {
            '&' => f.write_str("&amp;"),
            '<' => f.write_str("&lt;"),
            '>' => f.write_str("&gt;"),
            other => write!(f, "{other}"),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::code::tests::code;
    use super::super::run::tests::run;
    use super::*;

    /// The numbers of an attribute, in order.
    fn numbers(svg: &str, attribute: &str) -> Vec<f64> {
        let start = format!(" {attribute}=\"");
        let boxes = svg.lines().filter(|line| line.starts_with("<g>"));
        let values = boxes.map(|line| {
            line.split(&start)
                .nth(1)
                .expect("the attribute")
                .split('"')
                .next()
        });
        values
            .map(|value| value.expect("a value").parse().expect("a number"))
            .collect()
    }

    #[test]
    fn boxes_are_as_wide_as_their_cycles_and_hang_side_by_side() {
        let code = code(&[
            (0, "<tracer::Ray<'_> as A&B>::hit"),
            (4, "fixedmath::root"),
            (8, "narrow"),
        ]);
        let node = |address, cycles, below| Node {
            name: code.outermost(address),
            cycles,
            instructions: cycles,
            below,
        };
        let tree = node(
            0,
            1000.0,
            vec![
                node(8, 0.1, vec![]),
                node(4, 500.0, vec![]),
                node(4, 250.0, vec![]),
            ],
        );
        let svg = svg(&run(&[("all", 1000)]), &[tree], &code);
        // What is too narrow to be seen is left out.
        assert_eq!(numbers(&svg, "width"), [1380.0, 690.0, 345.0]);
        assert_eq!(numbers(&svg, "x"), [10.0, 10.0, 700.0]);
        let y = numbers(&svg, "y");
        assert!(y[0] < y[1] && y[1] == y[2], "{y:?}");
        assert!(
            svg.contains("&lt;tracer::Ray&lt;'_&gt; as A&amp;B&gt;::hit: 250.0 cycles a sample (100.0 %)"),
            "{svg}"
        );
        assert!(
            svg.contains("fill=\"#f4a259\"") && svg.contains("fill=\"#e4572e\""),
            "{svg}"
        );
    }

    #[test]
    fn a_label_is_what_fits() {
        for (width, expected) in [
            (200.0, Some("fixedmath::root::nearest")),
            (100.0, Some("root::nearest")),
            (50.0, Some("neares")),
            (20.0, None),
        ] {
            assert_eq!(
                label("fixedmath::root::nearest", width).as_deref(),
                expected,
                "{width}"
            );
        }
    }
}
