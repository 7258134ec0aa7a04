//! Vast spheres, by the formula of curvature.

use fixedmath::I16F16;
use tracer::arithmetic::{Formats, Mixed};
use tracer::geometry::Ray;
use tracer::profile::{Paper, Precise, Profile};

use super::cases::Truth;
use super::formulas::{Answer, ray_of};
use super::tally::Tally;
use crate::oracle::lockstep::Lockstep;
use crate::stability::draw::Draw;
use crate::stability::exact::Line;
use crate::stability::reintersection::{Body, DIFFUSE, Drawn, Told, line_of, vast_ball, vast_wall};
use crate::stability::vast::Bent;

/// A class of cases: its name, and how one is drawn.
pub(super) type Class = (&'static str, fn(&mut Draw) -> Drawn);

pub(super) const CLASSES: [Class; 2] = [
    ("vast wall of up to 1e5, from 1 ulp to 3000 away", |draw| {
        vast_wall(draw, &DIFFUSE)
    }),
    ("vast ball of up to 1e5, from 1 ulp to 3000 away", |draw| {
        vast_ball(draw, &DIFFUSE)
    }),
];

/// What formulas there are, in the order of [`judge`].
pub(super) const FORMULAS: [&str; 3] = ["`precise`", "`paper`", "`precise` in double precision"];

/// Draws a case, and counts what each formula makes of it.
pub(super) fn judge(class: &Class, draw: &mut Draw, tallies: &mut [Tally]) {
    let (body, ray) = (class.1)(draw);
    let Some(sphere) = body.bent() else {
        return;
    };
    let line = line_of(&ray);
    let coarsely = Line {
        direction: line.direction.map(|c| c >> 14 << 14),
        ..line
    };
    let answers = [
        (line, meet::<Precise>(&body, &ray)),
        (coarsely, meet::<Paper>(&body, &ray)),
        (line, meet::<Lockstep<Precise>>(&body, &ray)),
    ];
    for ((line, answer), tally) in answers.into_iter().zip(tallies) {
        let bent = Bent::of(sphere, &line);
        let far = f64::from(Mixed::FAR) * 65_536.0;
        let distance = bent.goes_under();
        if distance.is_some_and(|distance| distance >= far) {
            continue;
        }
        let truth = distance.map(|distance| {
            let upward = bent.normal_at(distance);
            Truth {
                distance,
                other: f64::INFINITY,
                point: bent.point_at(&line, distance),
                normal: if sphere.is_hollow() {
                    upward.map(|c| -c)
                } else {
                    upward
                },
            }
        });
        tally.add(bent.radius() as i64, truth, answer);
    }
}

fn meet<P: Profile<Numbers: Told>>(body: &Body, ray: &Ray<Mixed>) -> Option<Answer> {
    let ray = ray_of::<P>(ray);
    let t = body.closest::<P>(&ray, false, I16F16::ZERO)?;
    let surface = body.interaction::<P>(&ray, false, t);
    Some(Answer {
        distance: t.into() * 65_536.0,
        point: surface.point.map(|c| c.into() * 65_536.0),
        normal: surface.normal.map(Into::into),
    })
}
