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
use super::sampling::{Draws, height_of_cone, within_cone};
use super::vector::Vector;
use crate::scene::{Material, Scene, Sphere};

/// All emitters that can be aimed at.
pub(super) struct Lights {
    emitters: Vec<Emitter>,
}

/// What can be aimed at.
pub(super) struct Emitter {
    /// Its number in the scene.
    pub(super) number: usize,
    ball: Ball,
    /// Radiance, channels added up.
    pub(super) brightness: f64,
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
#[derive(Clone, Copy)]
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

    pub(super) fn emitters(&self) -> &[Emitter] {
        &self.emitters
    }

    /// A direction to look in from surface `number` of a path, if any emitter can be aimed at from there.
    pub(super) fn direction(&self, place: &Place, number: u32, draws: &mut Draws<'_>) -> Option<Vector> {
        let mut total = 0.0;
        let mut chosen = None;
        let mut left = if self.emitters.len() > 1 {
            draws.uniform()
        } else {
            0.0
        };
        // In one pass: each takes the place of those before it, with the chance of its share of all so far.
        for emitter in &self.emitters {
            let Some(aim) = emitter.aim(place) else {
                continue;
            };
            let share = emitter.brightness * aim.solid_angle;
            total += share;
            let chance = share / total;
            if left < chance {
                left /= chance;
                chosen = Some((emitter, aim));
            } else {
                left = (left - chance) / (1.0 - chance);
            }
        }
        let (emitter, aim) = chosen?;
        Some(emitter.direction(&aim, place, draws.of_light(number)))
    }

    /// Density of [`Lights::direction`] by solid angle.
    pub(super) fn density(&self, place: &Place, direction: Vector) -> f64 {
        let (mut sum, mut total) = (0.0, 0.0);
        for emitter in &self.emitters {
            if let Some(aim) = emitter.aim(place) {
                let share = emitter.brightness * aim.solid_angle;
                total += share;
                sum += share * emitter.density(&aim, place, direction);
            }
        }
        if total > 0.0 { sum / total } else { 0.0 }
    }
}

/// How an emitter is aimed at from one place.
struct Aim {
    target: Target,
    /// What the emitter fills of the directions; of a cap, about.
    solid_angle: f64,
}

enum Target {
    /// The cone that the ball fills: directions where one minus the cosine to its centre is below this.
    Cone(f64),
    Cap(Cap),
}

impl Emitter {
    /// About where what is seen of it is, and how far around that it reaches.
    pub(super) fn extent(&self) -> (Vector, f64) {
        match self.exposed {
            Some(cap) if cap.height < 1.0 => {
                let rim = (cap.height * (2.0 - cap.height)).sqrt();
                (
                    self.ball.centre + cap.axis * self.ball.radius,
                    self.ball.radius * rim,
                )
            }
            _ => (self.ball.centre, self.ball.radius),
        }
    }

    /// How to aim at it, if that is worth while: not at what is below the horizon, or fills half of the directions above it.
    #[inline(always)]
    fn aim(&self, place: &Place) -> Option<Aim> {
        let to_centre = self.ball.centre - place.point;
        if self.number == place.ball || (!self.hollow && to_centre.dot(place.normal) < -self.ball.radius) {
            return None;
        }
        let mut smallest = Aim {
            target: Target::Cone(2.0),
            solid_angle: PI,
        };
        let (square, radius_square) = (to_centre.dot(to_centre), self.ball.radius * self.ball.radius);
        if radius_square < square {
            let height = height_of_cone(radius_square / square);
            if TAU * height < PI {
                smallest = Aim {
                    target: Target::Cone(height),
                    solid_angle: TAU * height,
                };
            }
        }
        if let Some(cap) = self.exposed {
            let middle = to_centre + cap.axis * self.ball.radius;
            let solid_angle = TAU * radius_square * cap.height / middle.dot(middle);
            if solid_angle < smallest.solid_angle {
                smallest = Aim {
                    target: Target::Cap(cap),
                    solid_angle,
                };
            }
        }
        (smallest.solid_angle < PI).then_some(smallest)
    }

    fn direction(&self, aim: &Aim, place: &Place, pair: [f64; 2]) -> Vector {
        match aim.target {
            Target::Cone(height) => within_cone((self.ball.centre - place.point).normalised(), height, pair),
            Target::Cap(cap) => {
                let point = self.ball.centre + within_cone(cap.axis, cap.height, pair) * self.ball.radius;
                (point - place.point).normalised()
            }
        }
    }

    fn density(&self, aim: &Aim, place: &Place, direction: Vector) -> f64 {
        let ball = &self.ball;
        let Some(crossings) = ball.crossings(place.point, direction) else {
            return 0.0;
        };
        match aim.target {
            Target::Cone(_) if crossings[0] > 0.0 => 1.0 / aim.solid_angle,
            Target::Cone(_) => 0.0,
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
