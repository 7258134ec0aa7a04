//! How the parts of a scene fit together: names, light, lengths, and free space in front of the camera.

use super::light::{Light, rounded_up};
use super::parse::{Draft, Source};
use super::reach::REACH;
use super::scale::Scale;
use super::start::StartPatch;
use super::vector::{cross, length};
use super::{Camera, Integrator, Material, Sphere};

/// Notes every fault of `draft`.
pub(super) fn validate(draft: &Draft, source: &mut Source<'_>) {
    names_are_unique(draft, source);
    something_shines(draft, source);
    light_fits(draft, source);
    lengths_fit(draft, source);
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
    let light = Light::of(
        draft.spheres.iter().map(|placed| &placed.sphere),
        Integrator::Path,
    );
    if let Some(faint) = light.too_faint() {
        let placed = &draft.spheres[faint.sphere];
        source.fault(
            placed.at,
            format!("sphere \"{}\": {}", placed.sphere.name, faint.cause),
        );
    }
}

/// One scale must do for the largest sphere and for the smallest.
fn lengths_fit(draft: &Draft, source: &mut Source<'_>) {
    let spheres: Vec<&Sphere> = draft.spheres.iter().map(|placed| &placed.sphere).collect();
    let Err(found) = Scale::of(&spheres, &draft.camera) else {
        return;
    };
    let small = &draft.spheres[found.small];
    let (name, radius) = (&small.sphere.name, small.sphere.radius);
    let beside = match found.large {
        Some(large) => format!("\"{}\"", spheres[large].name),
        None => "the camera's `near`".to_owned(),
    };
    let least = rounded_up(found.least);
    let message = format!(
        "sphere \"{name}\": a radius of {radius} is lost beside {beside}; make it at least {least:.1e}, or {beside} smaller"
    );
    source.fault(small.at, message);
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
    let spheres: Vec<&Sphere> = draft.spheres.iter().map(|placed| &placed.sphere).collect();
    if let Some(Blocked { rays, sphere }) = first_blocked_ray(&draft.camera, &spheres, 256, 192) {
        let message = format!(
            "{rays} starts inside the solid of sphere \"{}\" (line {}); move the camera or change `near`",
            spheres[sphere].name,
            source.line(draft.spheres[sphere].at)
        );
        source.fault(draft.camera_at, message);
    }
}

/// Which rays of a picture start inside a solid, and the sphere's place in the list.
pub(super) struct Blocked {
    pub(super) rays: String,
    pub(super) sphere: usize,
}

/// The first sphere inside whose solid rays of a picture of this shape start.
///
/// What the tent filter adds to a picture, a quarter of a pixel, is left out: rays that start there in a wall see it at once.
pub(super) fn first_blocked_ray(
    camera: &Camera,
    spheres: &[&Sphere],
    width: u16,
    height: u16,
) -> Option<Blocked> {
    let patch = StartPatch::new(camera, width, height, 0.0);
    let scale = Scale::of(spheres, camera).ok()?;
    (0..).zip(spheres).find_map(|(index, sphere)| {
        let [(nearest, near_place), (furthest, far_place)] = patch.nearest_and_furthest(sphere.centre);
        let the = |place| format!("the {place} ray");
        let inside = match sphere {
            Sphere { hollow: true, .. } => (furthest >= sphere.radius).then(|| the(far_place)),
            _ if !is_opaque(sphere) => None,
            // Where rays start in a part of it, it is cut open; but nobody wants to see nothing but its inside.
            _ if furthest < sphere.radius => Some("every ray".to_owned()),
            // Cut open, it is crossed from side to side.
            _ => (nearest < sphere.radius && scale.core_length(sphere.radius) >= REACH)
                .then(|| the(near_place)),
        };
        inside.map(|rays| Blocked { rays, sphere: index })
    })
}

/// Whether camera rays start within an opaque solid, or so near that rounding may put them there: all in a core's unit.
pub(super) fn is_cut_open(sphere: &Sphere, patch: &StartPatch) -> bool {
    /// Some units of the last place of 16:16.
    const ROUNDING: f64 = 1.0 / 8192.0;
    let [(nearest, _), _] = patch.nearest_and_furthest(sphere.centre);
    !sphere.hollow && is_opaque(sphere) && nearest < sphere.radius + ROUNDING
}

fn is_opaque(sphere: &Sphere) -> bool {
    !matches!(sphere.material, Material::Glass { .. })
}
