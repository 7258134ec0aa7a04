//! Which of two surfaces is met first, where they are close.

use fixedmath::I2F30;
use tracer::arithmetic::Mixed;
use tracer::geometry::{PrimitiveId, Ray};

use super::cases::{Case, Surface, record};
use super::formulas::Formula;
use crate::stability::draw::{Draw, combine, dot, length, unit};

/// Two surfaces and a ray.
pub(super) struct Pair {
    /// What a column is called.
    pub(super) name: &'static str,
    draw: fn(&mut Draw) -> [Case; 2],
}

/// All that are looked at.
pub(super) const PAIRS: [Pair; 4] = [
    Pair {
        name: "light cap and ceiling",
        draw: cap_and_ceiling,
    },
    Pair {
        name: "walls at their edge",
        draw: edge,
    },
    Pair {
        name: "concentric, 1 to 16 ulp apart",
        draw: concentric,
    },
    Pair {
        name: "touching balls",
        draw: touching,
    },
];

/// How often the wrong surface came first.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Order {
    pub(super) all: u64,
    pub(super) wrong: u64,
    /// How far the right one was before the other, at most, in ulp.
    pub(super) furthest: f64,
}

impl Order {
    /// Adds another's counts.
    pub(super) fn merge(&mut self, other: &Self) {
        self.all += other.all;
        self.wrong += other.wrong;
        self.furthest = self.furthest.max(other.furthest);
    }
}

/// Draws a case and counts what each formula makes of it.
pub(super) fn judge(pair: &Pair, formulas: &[&Formula], draw: &mut Draw, orders: &mut [Order]) {
    let cases = (pair.draw)(draw);
    for (formula, order) in formulas.iter().zip(orders) {
        let line = (formula.line)(&cases[0]);
        let truths = cases.each_ref().map(|case| {
            let truth = case.truth(&line);
            truth.map_or(f64::INFINITY, |truth| truth.distance)
        });
        let met = cases.each_ref().map(|case| {
            let answer = (formula.meet)(case);
            answer.map_or(f64::INFINITY, |answer| answer.distance)
        });
        let apart = (truths[0] - truths[1]).abs();
        if truths == [f64::INFINITY; 2] || apart == 0.0 {
            continue;
        }
        order.all += 1;
        // Of two at the same distance, the one that is asked first is kept.
        if (met[1] < met[0]) != (truths[1] < truths[0]) {
            order.wrong += 1;
            // What is past the one's silhouette alone, the other's end is as far as anything.
            order.furthest = order.furthest.max(if apart.is_finite() { apart } else { 0.0 });
        }
    }
}

fn cases(shapes: [(Surface, [f64; 3], f64); 2], start: [f64; 3], target: [f64; 3]) -> [Case; 2] {
    let along = combine(1.0, target, -1.0, start);
    let distance = dot(along, along).sqrt();
    let ray = Ray::<Mixed> {
        origin: start.map(length),
        direction: unit(along.map(|c| c / distance)),
        departed: PrimitiveId::NONE,
        normal: [I2F30::ZERO; 3],
    };
    shapes.map(|(surface, centre, radius)| Case {
        surface,
        record: record(surface, centre.map(length), length(radius)),
        ray,
        departs: false,
    })
}

/// Somewhere in the Cornell box.
fn start(draw: &mut Draw) -> [f64; 3] {
    [
        draw.number(2.0, 98.0),
        draw.number(1.0, 75.0),
        draw.number(1.0, 165.0),
    ]
}

const CEILING: (Surface, [f64; 3], f64) = (Surface::Wall, [50.0, -9918.4, 81.6], 1e4);
const BACK: (Surface, [f64; 3], f64) = (Surface::Wall, [50.0, 40.8, 1e4], 1e4);

/// The light of the Cornell box, which dips 0.27 below its ceiling, and the ceiling around it.
fn cap_and_ceiling(draw: &mut Draw) -> [Case; 2] {
    let light = (Surface::Solid, [50.0, 681.33, 81.6], 600.0);
    let target = [draw.number(30.0, 70.0), 81.5, draw.number(61.6, 101.6)];
    let start = start(draw);
    cases([CEILING, light], start, target)
}

/// The edge of its ceiling and its back.
fn edge(draw: &mut Draw) -> [Case; 2] {
    let x = draw.number(1.0, 99.0);
    let target = [x, 81.45 + draw.number(-0.1, 0.1), 0.15 + draw.number(-0.1, 0.1)];
    let start = start(draw);
    cases([CEILING, BACK], start, target)
}

/// A ball around a ball.
fn concentric(draw: &mut Draw) -> [Case; 2] {
    let radius = draw.magnitude(0.01, 1e3);
    let gap = draw.number(1.0, 17.0).floor() / 65_536.0;
    let inner = (Surface::Solid, [0.0; 3], radius);
    let outer = (Surface::Solid, [0.0; 3], f64::from(length(radius)) + gap);
    let towards = draw.direction();
    let across = draw.across(towards);
    let from = radius + draw.magnitude(0.01, 10.0 * radius.sqrt().min(radius) + 0.1);
    let aside = radius * draw.number(0.0, 1.0).sqrt();
    cases(
        [inner, outer],
        towards.map(|c| c * from),
        across.map(|c| c * aside),
    )
}

/// Two balls that touch, and a ray to next to where they do.
fn touching(draw: &mut Draw) -> [Case; 2] {
    let [one, other] = [(); 2].map(|()| draw.magnitude(0.01, 1e3));
    let axis = draw.direction();
    let across = draw.across(axis);
    let smaller = one.min(other);
    let from = draw.magnitude(smaller / 4.0, 8.0 * smaller);
    let target = across.map(|c| c * smaller * draw.magnitude(1e-4, 1e-1));
    cases(
        [
            (Surface::Solid, axis.map(|c| c * one), one),
            (Surface::Solid, axis.map(|c| c * -other), other),
        ],
        across.map(|c| c * from),
        target,
    )
}
