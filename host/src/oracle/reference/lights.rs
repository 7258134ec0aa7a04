//! Looking for light: directions in which emitters are.
//!
//! A diffuse surface finds light in two ways, by a direction drawn here and by the one in which its path goes on. Either may meet any
//! emitter, and what it meets counts by the balance heuristic (Veach, "Robust Monte Carlo Methods for Light Transport Simulation",
//! 1997, section 9.2): with the density of one way over the sum of both. The weights of a direction add up to 1 whatever the
//! density here is, and the path itself may go in every direction that reflects at all. So nothing here can make a
//! picture wrong, only noisy: what follows is free to be a guess of where light comes from.
//!
//! An emitter is aimed at in one of two ways, the one that says it is smaller:
//! - a ball seen from outside, by the cone that it fills, uniform by solid angle (Shirley and Wang 1996);
//! - a ball of which walls leave but a cap to be seen, by that cap, uniform by area.

use std::f64::consts::{PI, TAU};

use super::ball::Ball;
use super::sampling::{Draws, cosine_density, within_cone};
use super::vector::Vector;
use crate::scene::{Material, Scene, Sphere};

/// All emitters that can be aimed at.
pub(super) struct Lights {
    emitters: Vec<Emitter>,
}

struct Emitter {
    /// Its number in the scene.
    number: usize,
    ball: Ball,
    /// Radiance, channels added up.
    brightness: f64,
    exposed: Option<Cap>,
    hollow: bool,
}

/// The part of a ball's surface around `axis` where one minus the cosine is below `height`, which is below 2.
#[derive(Clone, Copy)]
struct Cap {
    /// A unit vector.
    axis: Vector,
    height: f64,
}

/// A point of a surface from where light is looked for.
pub(super) struct Place {
    pub(super) point: Vector,
    /// On the side from which light comes.
    pub(super) normal: Vector,
    /// Whose surface.
    pub(super) ball: usize,
}

impl Lights {
    pub(super) fn new(scene: &Scene) -> Self {
        let emitters = scene.spheres.iter().enumerate().filter_map(|(number, sphere)| {
            let brightness = sphere.emission.iter().sum();
            let exposed = exposed(scene, number)?;
            (brightness > 0.0).then(|| Emitter {
                number,
                ball: ball(sphere),
                brightness,
                exposed: exposed.cap(),
                hollow: sphere.hollow,
            })
        });
        Self {
            // All that is seen of a hollow ball that is not cut is found by any direction.
            emitters: emitters
                .filter(|emitter| !emitter.hollow || emitter.exposed.is_some())
                .collect(),
        }
    }

    /// For paths that find light by themselves.
    #[cfg(test)]
    pub(super) fn none() -> Self {
        Self { emitters: Vec::new() }
    }

    /// A direction to look in from surface `number` of a path, if any emitter can be aimed at from there.
    pub(super) fn direction(&self, place: &Place, number: u32, draws: &mut Draws<'_>) -> Option<Vector> {
        let aims = || {
            let emitters = self.emitters.iter();
            emitters.filter_map(|emitter| Some((emitter.brightness, emitter.aim(place)?)))
        };
        let total: f64 = aims().map(|(brightness, aim)| brightness * aim.solid_angle).sum();
        let mut left = draws.uniform() * total;
        let mut chosen = None;
        for (brightness, aim) in aims() {
            left -= brightness * aim.solid_angle;
            chosen = Some(aim);
            if left < 0.0 {
                break;
            }
        }
        Some(chosen?.direction(place, draws.of_light(number)))
    }

    /// What light from `direction`, at this cosine to the normal, counts at `place`, whichever of the two ways has found it.
    ///
    /// The path's own way is in proportion to the cosine, as what is reflected is. So light `L` that is looked for has the estimate
    /// `(own / (looked + own)) L` times the colour: the weight `looked / (looked + own)` times `L` times what is reflected over
    /// the density `looked`; and light that the path meets has the same.
    pub(super) fn weight(&self, place: &Place, direction: Vector, cosine: f64) -> f64 {
        let own = cosine_density(cosine);
        own / (own + self.density(place, direction))
    }

    /// Density of [`Lights::direction`] by solid angle.
    fn density(&self, place: &Place, direction: Vector) -> f64 {
        let (mut sum, mut total) = (0.0, 0.0);
        for emitter in &self.emitters {
            if let Some(aim) = emitter.aim(place) {
                let share = emitter.brightness * aim.solid_angle;
                total += share;
                sum += share * aim.density(place, direction);
            }
        }
        if total > 0.0 { sum / total } else { 0.0 }
    }
}

/// How an emitter is aimed at from one place.
struct Aim<'a> {
    emitter: &'a Emitter,
    target: Target,
    /// What the emitter fills of the directions; of a cap, about.
    solid_angle: f64,
}

enum Target {
    /// Directions around `axis` where one minus the cosine is below `height`.
    Cone {
        axis: Vector,
        height: f64,
    },
    Cap(Cap),
}

impl Emitter {
    /// How to aim at it, if that is worth while: not at what is below the horizon, or fills half of the directions above it.
    fn aim(&self, place: &Place) -> Option<Aim<'_>> {
        let to_centre = self.ball.centre - place.point;
        if self.number == place.ball || (!self.hollow && to_centre.dot(place.normal) < -self.ball.radius) {
            return None;
        }
        let cone = self.cone(to_centre);
        let cap = self.exposed.map(|cap| {
            let middle = to_centre + cap.axis * self.ball.radius;
            let area = TAU * self.ball.radius * self.ball.radius * cap.height;
            (Target::Cap(cap), area / middle.dot(middle))
        });
        let smaller = [cone, cap]
            .into_iter()
            .flatten()
            .min_by(|one, other| one.1.total_cmp(&other.1));
        smaller
            .filter(|&(_, solid_angle)| solid_angle < PI)
            .map(|(target, solid_angle)| Aim {
                emitter: self,
                target,
                solid_angle,
            })
    }

    /// The cone that the ball fills, seen from outside.
    fn cone(&self, to_centre: Vector) -> Option<(Target, f64)> {
        let distance = to_centre.length();
        let sine = self.ball.radius / distance;
        (sine < 1.0).then(|| {
            // 1 - cos = sin^2 / (1 + cos)
            let height = sine * sine / (1.0 + ((1.0 - sine) * (1.0 + sine)).sqrt());
            let axis = to_centre * (1.0 / distance);
            (Target::Cone { axis, height }, TAU * height)
        })
    }
}

impl Aim<'_> {
    fn direction(&self, place: &Place, pair: [f64; 2]) -> Vector {
        match self.target {
            Target::Cone { axis, height } => within_cone(axis, height, pair),
            Target::Cap(cap) => {
                let ball = &self.emitter.ball;
                let point = ball.centre + within_cone(cap.axis, cap.height, pair) * ball.radius;
                (point - place.point).normalised()
            }
        }
    }

    fn density(&self, place: &Place, direction: Vector) -> f64 {
        let ball = &self.emitter.ball;
        let Some(crossings) = ball.crossings(place.point, direction) else {
            return 0.0;
        };
        match self.target {
            Target::Cone { .. } if crossings[0] > 0.0 => 1.0 / self.solid_angle,
            Target::Cone { .. } => 0.0,
            Target::Cap(cap) => {
                // The line may go through the cap twice, and either point stands for this direction.
                let distances = crossings.into_iter().filter(|&distance| {
                    let point = place.point + direction * distance;
                    distance > 0.0 && cap.holds(ball, point)
                });
                // By area, 1 / (2 pi r^2 height); a solid angle is distance^2 / cos of an area, and the cosine half a chord over r.
                let squares: f64 = distances.map(|distance| distance * distance).sum();
                let half_chord = (crossings[1] - crossings[0]) / 2.0;
                if squares > 0.0 {
                    squares / (TAU * ball.radius * cap.height * half_chord)
                } else {
                    0.0
                }
            }
        }
    }
}

impl Cap {
    /// Whether a point of the surface is in it.
    fn holds(&self, ball: &Ball, point: Vector) -> bool {
        // By the distance to the cap's middle, which stays exact where the cap is next to nothing of the ball.
        let aside = point - (ball.centre + self.axis * ball.radius);
        aside.dot(aside) <= 2.0 * ball.radius * ball.radius * self.height
    }
}

/// What walls leave to be seen of a surface.
enum Exposed {
    All,
    Only(Cap),
}

impl Exposed {
    fn cap(&self) -> Option<Cap> {
        match self {
            Self::All => None,
            Self::Only(cap) => Some(*cap),
        }
    }
}

/// The smallest cap of a sphere's surface that any one other sphere leaves to be seen: a hollow one of what is outside it, an
/// opaque solid one of what is inside. `None` if one hides all of it.
fn exposed(scene: &Scene, number: usize) -> Option<Exposed> {
    let sphere = &scene.spheres[number];
    let mut smallest = Exposed::All;
    for (other_number, other) in scene.spheres.iter().enumerate() {
        let between = Vector::of(other.centre) - Vector::of(sphere.centre);
        let distance = between.length();
        let sees_through = matches!(other.material, Material::Glass { .. });
        if other_number == number || sees_through || distance == 0.0 {
            continue;
        }
        // The surfaces meet in a circle around the line of centres. By the law of cosines, one minus the cosine of its angle at this
        // centre is (R^2 - (d - r)^2) / 2 r d on the other centre's side, and ((d + r)^2 - R^2) / 2 r d on the far side.
        let across = 2.0 * sphere.radius * distance;
        let (axis, height) = if other.hollow {
            let less = distance - sphere.radius;
            (between, (other.radius - less) * (other.radius + less) / across)
        } else {
            let more = distance + sphere.radius;
            (
                between * -1.0,
                (more - other.radius) * (more + other.radius) / across,
            )
        };
        if height <= 0.0 {
            return None;
        }
        let limit = smallest.cap().map_or(2.0, |cap| cap.height);
        if height < limit {
            let axis = axis * (1.0 / distance);
            smallest = Exposed::Only(Cap { axis, height });
        }
    }
    Some(smallest)
}

fn ball(sphere: &Sphere) -> Ball {
    Ball {
        centre: Vector::of(sphere.centre),
        radius: sphere.radius,
    }
}
