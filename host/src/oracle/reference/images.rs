//! Images: directions in which a ball shows an emitter, as a mirror or through its glass.
//!
//! Light that comes to a diffuse surface by way of a ball is too rare for paths that set out in any direction, and no emitter can be
//! aimed at through a ball. But where in a ball an emitter appears is soon told: all is symmetrical around the line from the place to the
//! ball's centre. A path stays in one plane with that line, passes the centre after the ball as far away as before it, at `b` of the
//! radius, and is turned by an angle that depends on `b` alone.
//!
//! An image is taken for a piece of a ring around that line: between those `b` that lead to the emitter in the plane of all three, which
//! are found beforehand for all places and kept in a [table](super::rings); and as far out of that plane as the emitter reaches. What is found
//! there counts by the balance heuristic, as in [`super::lights`]: nothing here can make a picture wrong, only noisy.

use std::f64::consts::TAU;

use super::ball::{Balls, Ray};
use super::caustics::Caustic;
use super::lights::{Emitter, Place};
use super::rings::{Bend, Rings};
use super::sampling::{height_of_cone, sine_and_cosine};
use super::vector::Vector;
use crate::scene::{Material, Scene, Sphere};

/// Images at most, those that are likely to be brightest: each takes time and memory.
const MOST: usize = 8;

/// How one ball shows one emitter.
pub(super) struct Image {
    /// The ball's number in the scene.
    pub(super) ball: usize,
    centre: Vector,
    radius: f64,
    /// From the ball's centre to the emitter's middle, a unit vector.
    to_emitter: Vector,
    /// How far the emitter reaches around its middle, of its distance.
    reach: f64,
    rings: Rings,
    /// Where its light is gathered, if it is.
    pub(super) caustic: Option<Caustic>,
}

/// All of a scene that are worth a path.
pub(super) fn all(scene: &Scene, emitters: &[Emitter], balls: &Balls) -> Vec<Image> {
    let mut candidates = Vec::new();
    for (number, sphere) in scene.spheres.iter().enumerate() {
        let bends = match sphere.material {
            Material::Diffuse(_) => continue,
            Material::Mirror(_) => vec![Bend::Reflected],
            Material::Glass { index, .. } => vec![Bend::Refracted { index }, Bend::Reflected],
        };
        // A hollow ball is seen from within.
        let others = emitters
            .iter()
            .filter(|emitter| emitter.number != number && !sphere.hollow);
        for emitter in others {
            candidates.extend(
                bends
                    .iter()
                    .filter_map(|&bend| Candidate::new(number, sphere, emitter, bend)),
            );
        }
    }
    candidates.sort_by(|one, other| other.brightness.total_cmp(&one.brightness));
    candidates.truncate(MOST);
    candidates
        .into_iter()
        .map(|candidate| candidate.image(balls))
        .collect()
}

/// An image without its table.
struct Candidate {
    number: usize,
    centre: Vector,
    radius: f64,
    to_emitter: Vector,
    distance: f64,
    reach: f64,
    bend: Bend,
    brightness: f64,
}

impl Candidate {
    /// `None` for an emitter that touches the ball.
    fn new(number: usize, sphere: &Sphere, emitter: &Emitter, bend: Bend) -> Option<Self> {
        let centre = Vector::of(sphere.centre);
        let (middle, reach) = emitter.extent();
        let to_emitter = middle - centre;
        let distance = to_emitter.length();
        let reach_share = reach / distance;
        (distance > sphere.radius + reach).then(|| Self {
            number,
            centre,
            radius: sphere.radius,
            to_emitter: to_emitter * (1.0 / distance),
            distance,
            reach: reach_share,
            bend,
            brightness: emitter.brightness * (reach_share * sphere.radius).powi(2),
        })
    }

    fn image(self, balls: &Balls) -> Image {
        let caustic = match self.bend {
            Bend::Reflected => None,
            // Glass gathers light where a ray from the emitter's middle leaves the ball.
            Bend::Refracted { .. } => {
                let ray = Ray {
                    origin: self.centre - self.to_emitter * self.radius,
                    direction: self.to_emitter * -1.0,
                    departed: Some(self.number),
                };
                Caustic::behind(&ray, self.radius, balls)
            }
        };
        Image {
            ball: self.number,
            centre: self.centre,
            radius: self.radius,
            to_emitter: self.to_emitter,
            reach: self.reach,
            rings: Rings::new(self.bend, self.radius / self.distance, self.reach),
            caustic,
        }
    }
}

impl Image {
    /// Where it is seen from one place, if it is.
    pub(super) fn piece(&self, place: &Place) -> Option<Piece> {
        let to_centre = self.centre - place.point;
        let distance = to_centre.length();
        let near = self.radius / distance;
        if place.ball == self.ball || near >= 1.0 || to_centre.dot(place.normal) < -self.radius {
            return None;
        }
        let axis = to_centre * (1.0 / distance);
        let cosine = axis.dot(self.to_emitter);
        let aside = self.to_emitter - axis * cosine;
        let sine = aside.length();
        let [low, high] = self.rings.at(near, cosine, sine)?;
        let sines = if low < 0.0 && high > 0.0 {
            [0.0, high.max(-low)]
        } else {
            [low.abs().min(high.abs()), low.abs().max(high.abs())]
        };
        let sine_squares = sines.map(|sine| (sine * near).powi(2));
        let heights = sine_squares.map(height_of_cone);
        let out_of_plane = self.reach / sine;
        // Around the line the emitter is seen on all sides.
        let (turn, turn_cosine) = if sines[0] == 0.0 || out_of_plane >= 1.0 {
            (0.5, -1.0)
        } else {
            let cosine = (1.0 - out_of_plane * out_of_plane).sqrt();
            (out_of_plane.atan2(cosine) / TAU, cosine)
        };
        let aside = aside * (1.0f64.copysign(low + high) / sine);
        let solid_angle = 2.0 * TAU * turn * (heights[1] - heights[0]);
        (sine > 0.0 && solid_angle > 0.0).then(|| Piece {
            axis,
            aside,
            across: axis.cross(aside),
            sine_squares,
            heights,
            turn,
            turn_cosine,
            density: 1.0 / solid_angle,
        })
    }
}

/// Directions in a piece of a ring.
pub(super) struct Piece {
    /// To the ball's centre; away from that, to the middle of the image; and across both.
    axis: Vector,
    aside: Vector,
    across: Vector,
    /// Of the angles to `axis`, least and largest.
    sine_squares: [f64; 2],
    /// One minus the cosines of those.
    heights: [f64; 2],
    /// How far it goes around `axis` to either side of `aside`, in full turns; and the cosine of that.
    turn: f64,
    turn_cosine: f64,
    /// By solid angle.
    density: f64,
}

impl Piece {
    /// A direction in it, uniform by solid angle.
    pub(super) fn direction(&self, [share, around]: [f64; 2]) -> Vector {
        let height = self.heights[0] + (self.heights[1] - self.heights[0]) * share;
        let sine = (height * (2.0 - height)).sqrt();
        let (out, along) = sine_and_cosine(self.turn * (2.0 * around - 1.0));
        (self.axis * (1.0 - height) + self.aside * (sine * along) + self.across * (sine * out)).normalised()
    }

    /// Density of [`Piece::direction`] by solid angle.
    pub(super) fn density(&self, direction: Vector) -> f64 {
        let (along, out) = (direction.dot(self.aside), direction.dot(self.across));
        let square = along * along + out * out;
        let [least, largest] = self.sine_squares;
        let holds = direction.dot(self.axis) > 0.0
            && (least..=largest).contains(&square)
            && along >= self.turn_cosine * square.sqrt();
        if holds { self.density } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use rand_xoshiro::Xoshiro256PlusPlus;
    use rand_xoshiro::rand_core::SeedableRng;

    use super::super::ball::Ball;
    use super::super::lights::Lights;
    use super::super::sampling::{Draws, within_cone};
    use super::*;

    const UP: Vector = Vector::of([0.0, 1.0, 0.0]);

    /// Two balls of radius 1 under a lamp of radius 0.5, and the images in them: in the mirror, through the glass, in the glass.
    fn images() -> (Vec<Image>, Balls) {
        let scene = "format = 1\n[camera]\nposition = [0, 0, 20]\ndirection = [0, 0, -1]\nplane_height = 1
            [[sphere]]\nname = \"lamp\"\ncentre = [1, 6, 0.5]\nradius = 0.5\nemission = [1, 1, 1]\ndiffuse = [0, 0, 0]
            [[sphere]]\nname = \"mirror\"\ncentre = [-2, 2, 0]\nradius = 1\nmirror = [0.9, 0.9, 0.9]
            [[sphere]]\nname = \"glass\"\ncentre = [2, 2, 0]\nradius = 1\nglass = [0.9, 0.9, 0.9]\nindex = 1.5";
        let scene = Scene::parse("images.toml", scene).expect("a scene");
        let balls = scene.spheres.iter().map(|sphere| Ball {
            centre: Vector::of(sphere.centre),
            radius: sphere.radius,
        });
        let balls = Balls::new(balls.collect());
        (all(&scene, Lights::new(&scene).emitters(), &balls), balls)
    }

    fn places() -> impl Iterator<Item = Place> {
        let points = [
            [-6.0, 0.0, 1.0],
            [0.0, 0.0, 0.0],
            [1.5, 0.2, -0.1],
            [30.0, 0.0, 20.0],
        ];
        points.into_iter().map(|point| Place {
            point: Vector::of(point),
            normal: UP,
            ball: usize::MAX,
        })
    }

    /// The balance heuristic's weights are of the right size only if a density says how often its directions come.
    #[test]
    fn a_density_is_that_of_the_directions() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
        let mut draws = Draws::free(&mut random);
        let mut seen = 0;
        for place in places() {
            for image in images().0 {
                let Some(piece) = image.piece(&place) else {
                    continue;
                };
                seen += 1;
                // Around the ball and a tenth more of its cone, uniform.
                let height = (1.1 * piece.heights[1]).min(2.0);
                let count = 1 << 16;
                let densities =
                    (0..count).map(|_| piece.density(within_cone(piece.axis, height, draws.point())));
                let integral = TAU * height * densities.sum::<f64>() / f64::from(count);
                let spread = (TAU * height * piece.density / f64::from(count)).sqrt();
                assert!((integral - 1.0).abs() < 5.0 * spread, "{integral} +- {spread}");
                for _ in 0..1000 {
                    let direction = piece.direction(draws.point());
                    assert!((direction.length() - 1.0).abs() < 1e-12);
                    assert!(piece.density(direction) > 0.0);
                }
            }
        }
        assert!(seen > 6, "{seen}");
    }

    /// Of directions to the mirror's image one in three finds the lamp, whose number is 0: a cell of the table is wider than that.
    #[test]
    fn the_lamp_is_in_its_image() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
        let mut draws = Draws::free(&mut random);
        let (images, balls) = images();
        let mirror = images.iter().find(|image| image.ball == 1).expect("the mirror's");
        let place = places().next().expect("a place");
        let piece = mirror.piece(&place).expect("it is seen");
        let found = (0..1000).filter(|_| {
            let first = Ray {
                origin: place.point,
                direction: piece.direction(draws.point()),
                departed: None,
            };
            let Some(hit) = balls.first_hit(&first).filter(|hit| hit.ball == 1) else {
                return false;
            };
            let second = Ray {
                origin: hit.point,
                direction: first.direction - hit.outward * (2.0 * hit.outward.dot(first.direction)),
                departed: Some(1),
            };
            balls.nearest(&second).is_some_and(|(ball, _)| ball == 0)
        });
        let found = found.count();
        assert!(found > 300, "{found} of 1000");
    }
}
