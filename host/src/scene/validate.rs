//! How the parts of a scene fit together: names, light, extent, and free space in front of the camera.

use super::light::Light;
use super::parse::{Draft, Source};
use super::start::StartPatch;
use super::vector::{cross, length, sub};
use super::{Camera, Material, REACH, Sphere};

/// Notes every fault of `draft`.
pub(super) fn validate(draft: &Draft, source: &mut Source<'_>) {
    names_are_unique(draft, source);
    something_shines(draft, source);
    light_fits(draft, source);
    distances_fit(draft, source);
    directions_differ(draft, source);
    if source.is_clean() {
        camera_is_in_free_space(draft, source);
    }
}

fn names_are_unique(draft: &Draft, source: &mut Source<'_>) {
    for (index, placed) in draft.spheres.iter().enumerate() {
        let name = &placed.sphere.name;
        if let Some(first) = draft.spheres[..index]
            .iter()
            .find(|earlier| earlier.sphere.name == *name)
        {
            let line = source.line(first.at);
            let message =
                format!("a second sphere \"{name}\" (the first is at line {line}); rename one of them");
            source.fault(placed.at, message);
        }
    }
}

fn something_shines(draft: &Draft, source: &mut Source<'_>) {
    if let Some(first) = draft.spheres.first()
        && draft
            .spheres
            .iter()
            .all(|placed| placed.sphere.emission == [0.0; 3])
    {
        source.fault(
            first.at,
            "nothing shines, the picture would be black; give one sphere `emission = [r, g, b]`",
        );
    }
}

fn light_fits(draft: &Draft, source: &mut Source<'_>) {
    let light = Light::of(draft.spheres.iter().map(|placed| &placed.sphere));
    if let Some(faint) = light.too_faint() {
        let placed = &draft.spheres[faint.sphere];
        source.fault(
            placed.at,
            format!("sphere \"{}\": {}", placed.sphere.name, faint.cause),
        );
    }
}

/// From wherever a ray can start, every centre must be within the tracer's reach. (`camera_is_in_free_space` looks after
/// the first ray.)
fn distances_fit(draft: &Draft, source: &mut Source<'_>) {
    let spheres: Vec<&Sphere> = draft.spheres.iter().map(|placed| &placed.sphere).collect();
    for placed in &draft.spheres {
        let (sphere, limit) = (&placed.sphere, reach(&placed.sphere));
        let farthest = farthest_start(&spheres, sphere.centre);
        if farthest >= limit {
            let name = &sphere.name;
            let cause = format!("a ray may start {farthest:.0} from the centre of \"{name}\"");
            let message = format!("{cause}, beyond the tracer's reach ({limit}); make the scene smaller");
            source.fault(placed.at, message);
        }
        // Within glass a ray goes from one side to the other.
        if matches!(sphere.material, Material::Glass { .. }) && sphere.radius >= REACH {
            let message =
                format!("glass of this radius is beyond the tracer's reach ({REACH}); make it smaller");
            source.fault(placed.at, message);
        }
    }
}

/// How far from its centre a ray may start.
fn reach(sphere: &Sphere) -> f64 {
    if sphere.hollow { REACH } else { 2.0 * REACH }
}

/// The greatest distance from `point` to where a ray can start, or a bound on it. In a room, what all hollow spheres have
/// in common, that is its furthest point, and elsewhere the far side of some sphere.
pub(super) fn farthest_start(spheres: &[&Sphere], point: [f64; 3]) -> f64 {
    let far_side = |sphere: &&Sphere| length(sub(point, sphere.centre)) + sphere.radius;
    let mut rooms = spheres.iter().copied().filter(|sphere| sphere.hollow).peekable();
    if rooms.peek().is_none() {
        return spheres.iter().map(far_side).fold(0.0, f64::max);
    }
    // Two bounds: each room's far side, and the corners of the box that all of them have in common.
    let (mut nearest, mut low, mut high) = (f64::INFINITY, [f64::NEG_INFINITY; 3], [f64::INFINITY; 3]);
    for room in rooms {
        nearest = nearest.min(far_side(&room));
        low = [0, 1, 2].map(|i| low[i].max(room.centre[i] - room.radius));
        high = [0, 1, 2].map(|i| high[i].min(room.centre[i] + room.radius));
    }
    let corner = [0, 1, 2].map(|i| (point[i] - low[i]).abs().max((point[i] - high[i]).abs()));
    nearest.min(length(corner))
}

fn directions_differ(draft: &Draft, source: &mut Source<'_>) {
    if length(cross(draft.camera.direction, draft.camera.up)) < 1e-3 {
        source.fault(
            draft.camera_at,
            "the camera's `up` is parallel to its `direction`; choose another `up`",
        );
    }
}

fn camera_is_in_free_space(draft: &Draft, source: &mut Source<'_>) {
    // What else a scene is seen at, `check_frame` checks: here it is the default picture.
    let spheres = draft.spheres.iter().map(|placed| (&placed.sphere, placed.at));
    let trouble = first_blocked_ray(&draft.camera, spheres, 256, 192);
    if let Some((rays, blocked)) = trouble {
        let message = match blocked {
            Blocked::Inside(sphere, at) => format!(
                "{rays} starts inside the solid of sphere \"{}\" (line {}); move the camera or change `near`",
                sphere.name,
                source.line(at)
            ),
            Blocked::TooFar(sphere, at) => format!(
                "{rays} starts too far from the centre of sphere \"{}\" (line {}), beyond the tracer's reach ({}); move the camera nearer",
                sphere.name,
                source.line(at),
                reach(sphere)
            ),
        };
        source.fault(draft.camera_at, message);
    }
}

/// Why rays cannot start where they do, with the sphere in question and whatever its caller knows it by.
pub(super) enum Blocked<'s, T> {
    Inside(&'s Sphere, T),
    TooFar(&'s Sphere, T),
}

/// The first sphere that rays of a picture of this shape cannot start where they do for, and which rays these are.
///
/// What the tent filter adds to a picture, a quarter of a pixel, is left out: the few rays that start there in a wall are too
/// few to be measured.
pub(super) fn first_blocked_ray<'s, T>(
    camera: &Camera,
    mut spheres: impl Iterator<Item = (&'s Sphere, T)>,
    width: u16,
    height: u16,
) -> Option<(String, Blocked<'s, T>)> {
    let patch = StartPatch::new(camera, width, height, 0.0);
    spheres.find_map(|(sphere, tag)| {
        let [(nearest, near_place), (furthest, far_place)] = patch.nearest_and_furthest(sphere.centre);
        let the = |place| format!("the {place} ray");
        if furthest >= reach(sphere) {
            return Some((the(far_place), Blocked::TooFar(sphere, tag)));
        }
        let inside = match sphere {
            Sphere { hollow: true, .. } => (furthest >= sphere.radius).then(|| the(far_place)),
            _ if !is_opaque(sphere) => None,
            // Where rays start in a part of it, it is cut open; but nobody wants to see nothing but its inside.
            _ if furthest < sphere.radius => Some("every ray".to_owned()),
            // Cut open, it is crossed from side to side.
            _ => (nearest < sphere.radius && sphere.radius >= REACH).then(|| the(near_place)),
        };
        inside.map(|rays| (rays, Blocked::Inside(sphere, tag)))
    })
}

/// Whether camera rays start within an opaque solid, or so near that rounding may put them there.
pub(super) fn is_cut_open(sphere: &Sphere, patch: &StartPatch) -> bool {
    /// Some units of the last place of 16:16.
    const ROUNDING: f64 = 1.0 / 8192.0;
    let [(nearest, _), _] = patch.nearest_and_furthest(sphere.centre);
    !sphere.hollow && is_opaque(sphere) && nearest < sphere.radius + ROUNDING
}

fn is_opaque(sphere: &Sphere) -> bool {
    !matches!(sphere.material, Material::Glass { .. })
}
