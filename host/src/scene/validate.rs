//! How the parts of a scene fit together: names, light, extent, and free space in front of the camera.

use super::parse::{Draft, Source};
use super::{Camera, Material, REACH, Sphere};

/// Notes every fault of `draft`.
pub(super) fn validate(draft: &Draft, source: &mut Source<'_>) {
    names_are_unique(draft, source);
    something_shines(draft, source);
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
fn farthest_start(spheres: &[&Sphere], point: [f64; 3]) -> f64 {
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
    if let Some((place, blocked)) = trouble {
        let message = match blocked {
            Blocked::Inside(sphere, at) => format!(
                "the {place} ray starts inside the solid of sphere \"{}\" (line {}); move the camera or change `near`",
                sphere.name,
                source.line(at)
            ),
            Blocked::TooFar(sphere, at) => format!(
                "the {place} ray starts too far from the centre of sphere \"{}\" (line {}), beyond the tracer's reach ({}); move the camera nearer",
                sphere.name,
                source.line(at),
                reach(sphere)
            ),
        };
        source.fault(draft.camera_at, message);
    }
}

/// Why a ray cannot start where it does, with the sphere in question and whatever its caller knows it by.
pub(super) enum Blocked<'s, T> {
    Inside(&'s Sphere, T),
    TooFar(&'s Sphere, T),
}

/// Looks at the middle, the corners and the edges of a picture of this shape.
pub(super) fn first_blocked_ray<'s, T>(
    camera: &Camera,
    spheres: impl Iterator<Item = (&'s Sphere, T)> + Clone,
    width: u16,
    height: u16,
) -> Option<(&'static str, Blocked<'s, T>)> {
    start_points(camera, width, height)
        .into_iter()
        .find_map(|(place, start)| {
            spheres.clone().find_map(|(sphere, tag)| {
                let distance = length(sub(start, sphere.centre));
                if distance >= reach(sphere) {
                    Some((place, Blocked::TooFar(sphere, tag)))
                } else if (distance < sphere.radius) != sphere.hollow {
                    Some((place, Blocked::Inside(sphere, tag)))
                } else {
                    None
                }
            })
        })
}

/// Where the rays in the middle, at the corners and halfway between these start: along an edge, a ray through its middle
/// is least oblique and so starts furthest out. What the tent filter adds, a quarter of a pixel, is left out: the few rays
/// that start there in a wall are too few to be measured.
fn start_points(camera: &Camera, width: u16, height: u16) -> [(&'static str, [f64; 3]); 9] {
    let aspect = f64::from(width) / f64::from(height);
    let right = normalised(cross(camera.direction, camera.up));
    let up = cross(right, camera.direction);
    let plane_height = camera.height_for(width, height);
    let (half_width, half_height) = (plane_height * aspect / 2.0, plane_height / 2.0);
    [
        ("middle", 0.0, 0.0),
        ("top", 0.0, 1.0),
        ("bottom", 0.0, -1.0),
        ("left", -1.0, 0.0),
        ("right", 1.0, 0.0),
        ("top left", -1.0, 1.0),
        ("top right", 1.0, 1.0),
        ("bottom left", -1.0, -1.0),
        ("bottom right", 1.0, -1.0),
    ]
    .map(|(name, x, y)| {
        let (across, upwards) = (x * half_width, y * half_height);
        let ray = normalised([0, 1, 2].map(|i| camera.direction[i] + across * right[i] + upwards * up[i]));
        (name, [0, 1, 2].map(|i| camera.position[i] + camera.near * ray[i]))
    })
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}

fn normalised(v: [f64; 3]) -> [f64; 3] {
    let length = length(v);
    v.map(|c| c / length)
}
