//! Rays and paths: hits, warps, units.

mod support;

use fixedmath::{I2F30, I16F16, U0F32, U16F16, U48F16};
use support::{Blob, GLASS, Sphere, blob, camera, sphere};
use tracer::aggregate::{Aggregate, Sight};
use tracer::arithmetic::vector::reflected;
use tracer::arithmetic::{Directions, Formats, Mixed, Published, Sampling};
use tracer::camera::Camera;
use tracer::geometry::sphere::SphereRecord;
use tracer::geometry::{Interaction, PrimitiveId, Ray};
use tracer::integrator::{Integrator, Path};
use tracer::material::{DielectricNumbers, HemisphereSampling, Kind, MalleyDisc, RejectedDisc};
use tracer::profile::{Paper, Precise, Profile, Quadratic};
use tracer::random::{FullState, LowBits, Random};
use tracer::scene::{All, Capabilities, Scene};
use tracer::unit::{Plan, SPAN, Sums, Termination, render};

fn plan(width: u16, height: u16, spp: u32) -> Plan {
    Plan {
        width,
        height,
        spp,
        samples_per_unit: 16,
        seed: 7,
        termination: Termination::Roulette,
        epsilon: Precise::EPSILON,
    }
}

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}

/// Bins of equal probability in cosine squared and in angle, chi-squared against the uniform count.
fn warp_is_cosine_weighted<N: Sampling<Unit: Into<f64>>, D: HemisphereSampling>(
    random: &mut impl Random,
) -> f64 {
    const BINS: usize = 16;
    const DRAWS: u32 = 400_000;
    let n = [0.36, 0.48, 0.8];
    let (u, v) = ([0.8, -0.6, 0.0], [0.48, 0.64, -0.6]);
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let normal = n.map(|c| N::unit(support::q30(c)));
    let mut counts = [[0u32; BINS]; BINS];
    for _ in 0..DRAWS {
        let d: [f64; 3] = D::direction::<N, _>(normal, random).map(Into::into);
        assert!((length(d) - 1.0).abs() < 1e-3 && dot(d, n) > -1e-4);
        let height = dot(d, n).clamp(0.0, 0.999_999);
        let angle = dot(d, v).atan2(dot(d, u)) / std::f64::consts::TAU + 0.5;
        let bin = |x: f64| ((x * BINS as f64) as usize).min(BINS - 1);
        counts[bin(height * height)][bin(angle)] += 1;
    }
    let expected = f64::from(DRAWS) / (BINS * BINS) as f64;
    counts
        .as_flattened()
        .iter()
        .map(|&count| (f64::from(count) - expected).powi(2) / expected)
        .sum()
}

#[test]
fn our_warp_draws_the_cosine_distribution() {
    // 255 degrees of freedom: 350 is exceeded once in 10,000 runs, and the seed is fixed.
    let found = warp_is_cosine_weighted::<Mixed, RejectedDisc>(&mut FullState::for_unit(1, 0));
    assert!(found < 350.0, "{found}");
    let found = warp_is_cosine_weighted::<Mixed, MalleyDisc>(&mut FullState::for_unit(2, 0));
    assert!(found < 350.0, "{found}");
}

#[test]
fn the_published_parabola_is_seen_by_the_same_test() {
    // Not a virtue but a fact, and proof that the test above can fail.
    let found = warp_is_cosine_weighted::<Published, MalleyDisc>(&mut FullState::for_unit(3, 0));
    assert!(found > 1000.0, "{found}");
    // The low bits go round in 65,536 draws and fill every bin alike: too even to be random, four deviations below the
    // mean of 255.
    let found = warp_is_cosine_weighted::<Mixed, MalleyDisc>(&mut LowBits::for_unit(3, 0));
    assert!(found < 255.0 - 4.0 * 22.6, "{found}");
}

/// The scene in these bytes, for an image that can do everything.
fn view(blob: &Blob) -> Scene<'_> {
    Scene::view(blob.bytes(), Capabilities::ALL).unwrap()
}

/// The primitives of a scene of spheres: hollow ones first.
fn records(scene: &Scene<'_>) -> Vec<SphereRecord> {
    let primitives = scene.aggregate.primitives;
    let hollow = primitives.hollow_spheres.iter().map(|sphere| sphere.0);
    hollow
        .chain(primitives.solid_spheres.iter().map(|sphere| sphere.sphere))
        .collect()
}

/// The nearest surface, as `P` finds it.
fn nearest<P: Profile>(scene: &Scene<'_>, ray: &Ray<P::Numbers>) -> Option<Interaction<P::Numbers>> {
    let epsilon = P::Numbers::length(Precise::EPSILON);
    let surface = scene.aggregate.intersect::<P, All>(ray, epsilon)?;
    let sight = |t_max| Sight {
        ray: *ray,
        t_max,
        target: PrimitiveId::NONE,
        is_within: false,
    };
    assert!(
        scene
            .aggregate
            .occludes::<P, All>(&sight(P::Numbers::FAR), epsilon)
    );
    assert!(!scene.aggregate.occludes::<P, All>(&sight(epsilon), epsilon));
    Some(surface)
}

/// The ray that goes on from a surface.
fn from(surface: &Interaction<Mixed>, direction: [I2F30; 3]) -> Ray<Mixed> {
    Ray {
        origin: surface.point,
        direction,
        departed: surface.primitive,
        normal: surface.normal,
    }
}

const Z: [I2F30; 3] = [I2F30::ZERO, I2F30::ZERO, I2F30::ONE];

#[test]
fn a_ray_never_meets_at_once_the_surface_it_leaves() {
    let solid = [
        sphere([0.0, 0.0, 30.0], 7.0, 0.7, Kind::Diffuse),
        sphere([3.0, -11.0, 20.0], 0.02, 0.7, Kind::Diffuse),
        sphere([-9.0, 4.0, 25.0], 3.0, 0.9, Kind::Dielectric),
    ];
    let hollow = [
        sphere([0.0, 0.0, -9900.0], 10_000.0, 0.7, Kind::Diffuse),
        sphere([0.0, 0.0, 0.0], 200.0, 0.7, Kind::Diffuse),
    ];
    let bytes = blob(&hollow, &solid);
    let scene = view(&bytes);
    let records = records(&scene);
    let bounds = scene.aggregate.bounds().unwrap();
    let mut random = FullState::for_unit(9, 9);
    let (mut hits, mut tiny) = (0u32, 0u32);
    for start in 0..200_000 {
        // Aim at a sphere, bounce off it four times.
        let target = [solid[start % 3], hollow[start % 2]][usize::from(start % 5 == 0)]
            .record
            .centre;
        let aim = target.map(|c| I2F30::from_num(c.to_num::<f64>() / 12_000.0));
        let jitter = RejectedDisc::direction::<Mixed, _>(Z, &mut random);
        let mut ray = Ray::<Mixed> {
            origin: [I16F16::ZERO; 3],
            direction: RejectedDisc::direction::<Mixed, _>(Mixed::normalised(aim, jitter), &mut random),
            departed: PrimitiveId::NONE,
            normal: Z,
        };
        for _ in 0..4 {
            let Some(surface) = nearest::<Precise>(&scene, &ray) else {
                panic!("the room is closed")
            };
            let index = surface.primitive.index();
            let sphere = records[index];
            assert_eq!(
                usize::from(surface.from_inside),
                usize::from(index < hollow.len())
            );
            assert!(bounds.contains(surface.point));
            let travelled = length([0, 1, 2].map(|i| (surface.point[i] - ray.origin[i]).to_num()));
            if ray.departs_from(surface.primitive) {
                assert!(
                    index < hollow.len() || sphere.has_inside == 1,
                    "a solid ball met twice"
                );
                hits += 1;
                tiny += u32::from(travelled < 1e-3);
            }
            let from_centre = [0, 1, 2].map(|i| (surface.point[i] - sphere.centre[i]).to_num::<f64>());
            let radius = sphere.radius.to_num::<f64>();
            assert!(
                (length(from_centre) - radius).abs() < 3.0 / 65536.0,
                "the hit is put back on its sphere"
            );
            let direction = RejectedDisc::direction::<Mixed, _>(surface.facing(), &mut random);
            ray = from(&surface, direction);
        }
    }
    assert!(
        hits > 100_000,
        "hollow spheres are met again, at the far end of a chord: {hits}"
    );
    assert!(tiny <= 10, "{tiny} of {hits} chords are shorter than 0.001");
}

/// Light that has entered a ball meets its surface at one angle for ever, and below the critical one, however small the ball
/// and however flat the light came in.
#[test]
fn light_within_a_glass_ball_keeps_its_angle() {
    let mut random = FullState::for_unit(6, 6);
    for radius in [1.0 / 256.0, 0.01, 0.1, 1.0, 16.5, 1000.0, 10_000.0] {
        let wall = sphere([0.0; 3], 10_900.0, 0.7, Kind::Diffuse);
        let bytes = blob(&[wall], &[sphere([0.0; 3], radius, 0.9, Kind::Dielectric)]);
        let (scene, ball) = (view(&bytes), PrimitiveId::new(1));
        let mut entered = 0;
        for ray in 0..2000 {
            let normal = RejectedDisc::direction::<Mixed, _>(Z, &mut random);
            // Ever flatter: the sine of the angle with the surface goes down to 2^-16.
            let steep = I2F30::from_bits(1 << (29 - ray % 16));
            let aside = RejectedDisc::direction::<Mixed, _>(normal, &mut random);
            let height = Mixed::cosine(aside, normal);
            let along = [0, 1, 2].map(|i| aside[i] - Mixed::times(normal[i], height));
            let along = Mixed::normalised(along, normal);
            let inwards = [0, 1, 2].map(|i| along[i] - Mixed::times(normal[i], steep));
            let inwards = Mixed::normalised(inwards, normal);
            let mut ray = Ray::<Mixed> {
                origin: [0, 1, 2].map(|i| Mixed::scale(I16F16::from_num(radius), normal[i])),
                direction: GLASS.direction::<Mixed, _>(inwards, normal, &mut random),
                departed: ball,
                normal,
            };
            let first = Mixed::cosine(ray.direction, normal).to_num::<f64>();
            if first > 0.0 {
                continue;
            }
            entered += 1;
            for _ in 0..100 {
                let surface = nearest::<Precise>(&scene, &ray).unwrap();
                assert_eq!(surface.primitive, ball, "the ball of {radius} was left");
                let cosine = Mixed::cosine(ray.direction, surface.normal);
                // 2^-29 a bounce.
                let apart = cosine.to_num::<f64>() + first;
                assert!(apart.abs() < 100.0 * 2f64.powi(-29), "{radius}: {apart}");
                let ratio = Mixed::ratio_squared(Mixed::ratio(GLASS.leaving));
                let square = Mixed::refracted_square(cosine, ratio).to_bits();
                // The index squared times twice the cosine is at most 4.5, times 100 bounces: 225 units of 2^-28.
                assert!(
                    square > -(1 << 8),
                    "{radius}: past the critical angle by {square}"
                );
                let back = reflected::<Mixed>(ray.direction, surface.normal.map(|c| -c));
                ray = from(&surface, back);
            }
        }
        assert!(
            entered > 200,
            "{entered} of 2,000 rays entered the ball of {radius}"
        );
    }
}

/// `precise`, but by the textbook's formula.
#[derive(Debug)]
enum TextbookPrecise {}

impl Profile for TextbookPrecise {
    const NAME: &'static str = "textbook";
    const STRATIFIED_NAME: &'static str = "textbook";
    const EPSILON: I16F16 = Precise::EPSILON;
    const QUADRATIC: Quadratic = Quadratic::Textbook;
    type Numbers = Mixed;
    type Random = FullState;
    type Hemisphere = RejectedDisc;
}

#[test]
fn both_formulas_find_the_same_hits() {
    let solid = [
        sphere([0.0, 0.0, 30.0], 7.0, 0.7, Kind::Diffuse),
        sphere([-9.0, 4.0, 25.0], 3.0, 0.9, Kind::Dielectric),
    ];
    let hollow = [
        sphere([0.0, 0.0, -900.0], 1000.0, 0.7, Kind::Diffuse),
        sphere([0.0, 0.0, 0.0], 200.0, 0.7, Kind::Diffuse),
    ];
    let bytes = blob(&hollow, &solid);
    let scene = view(&bytes);
    let mut random = FullState::for_unit(4, 4);
    let mut other = 0;
    for _ in 0..200_000 {
        let ray = Ray::<Mixed> {
            origin: [I16F16::ZERO; 3],
            direction: RejectedDisc::direction::<Mixed, _>(Z, &mut random),
            departed: PrimitiveId::NONE,
            normal: Z,
        };
        let ours = nearest::<Precise>(&scene, &ray).unwrap();
        let theirs = nearest::<TextbookPrecise>(&scene, &ray).unwrap();
        if ours.primitive != theirs.primitive {
            other += 1;
            continue;
        }
        for i in 0..3 {
            let apart = (ours.point[i] - theirs.point[i]).to_num::<f64>().abs();
            // Grazing rays magnify what rounding did to the root's square.
            assert!(apart < 0.05, "{apart}");
        }
    }
    assert!(other <= 5, "{other} rays along a silhouette may differ");
}

#[test]
fn nothing_has_no_surface_and_no_bounds() {
    let bytes = blob(&[], &[]);
    let scene = view(&bytes);
    let ray = Ray::<Mixed> {
        origin: [I16F16::ZERO; 3],
        direction: Z,
        departed: PrimitiveId::NONE,
        normal: Z,
    };
    assert!(
        scene
            .aggregate
            .intersect::<Precise, All>(&ray, Precise::EPSILON)
            .is_none()
    );
    let sight = Sight {
        ray,
        t_max: Mixed::FAR,
        target: PrimitiveId::NONE,
        is_within: false,
    };
    assert!(!scene.aggregate.occludes::<Precise, All>(&sight, Precise::EPSILON));
    assert_eq!(scene.aggregate.bounds(), None);
}

fn sums<P: Profile>(blob: &Blob, plan: &Plan, id: u32) -> (Sums, u32) {
    let path = Path::<P, All>::new(plan);
    let camera = Camera::new(&camera(plan.width));
    let mut sums = [[U48F16::MAX; 3]; SPAN];
    let rays = render(&path, &view(blob), &camera, plan, id, &mut sums);
    (sums, rays)
}

/// A closed diffuse room that emits 1 and reflects 1/2: radiance 2 everywhere, exactly the sum of a geometric series.
fn furnace() -> Blob {
    let mut wall: Sphere = sphere([1.0, 2.0, 3.0], 50.0, 0.5, Kind::Diffuse);
    wall.material.emission = [U16F16::ONE; 3];
    wall.material.emits = 1;
    blob(&[wall], &[])
}

fn furnace_mean<P: Profile>(termination: Termination) -> f64 {
    let plan = Plan {
        termination,
        epsilon: P::EPSILON,
        ..plan(16, 16, 512)
    };
    let furnace = furnace();
    let total: f64 = (0..plan.units().unwrap())
        .flat_map(|id| sums::<P>(&furnace, &plan, id).0)
        .flatten()
        .map(|sum| sum.to_num::<f64>())
        .sum();
    total / (16.0 * 16.0 * 512.0 * 3.0)
}

#[test]
fn furnace_radiance_is_a_geometric_series() {
    // Roulette: after five bounces the path's length is geometric with mean 2, worth 2^-5 each: the standard deviation
    // of a sample is 2^-5 sqrt(2), of the mean of 131,072 samples 1.2e-4. Five of them.
    let found = furnace_mean::<Precise>(Termination::Roulette);
    assert!((found - 2.0).abs() < 6e-4, "{found}");
    // At a fixed depth every sample is the same sum, up to the rounding of one multiply a bounce.
    let found = furnace_mean::<Precise>(Termination::Depth(10));
    assert!((found - (2.0 - 2f64.powi(-9))).abs() < 1e-8, "{found}");
    let found = furnace_mean::<Paper>(Termination::Depth(10));
    assert!((found - (2.0 - 2f64.powi(-9))).abs() < 1e-3, "{found}");
}

#[test]
fn a_unit_is_a_pure_function_of_seed_and_id() {
    let plan = plan(16, 16, 64);
    assert_eq!(
        sums::<Precise>(&furnace(), &plan, 3),
        sums::<Precise>(&furnace(), &plan, 3)
    );
    assert_ne!(
        sums::<Precise>(&furnace(), &plan, 3),
        sums::<Precise>(&furnace(), &plan, 4)
    );
    let other = Plan { seed: 8, ..plan };
    assert_ne!(
        sums::<Precise>(&furnace(), &plan, 3),
        sums::<Precise>(&furnace(), &other, 3)
    );
}

#[test]
fn units_cover_every_sample_once() {
    for (width, height, spp, per_unit) in [(1, 1, 4, 4), (5, 3, 12, 8), (16, 16, 64, 64), (33, 7, 100, 16)] {
        let plan = Plan {
            samples_per_unit: per_unit,
            ..plan(width, height, spp)
        };
        let mut samples = vec![0; usize::from(width) * usize::from(height)];
        for id in 0..plan.units().unwrap() {
            let extent = plan.extent(id);
            assert!((1..=SPAN as u8).contains(&extent.pixels) && extent.samples.is_multiple_of(4));
            for pixel in 0..usize::from(extent.pixels) {
                samples[extent.first_pixel as usize + pixel] += u32::from(extent.samples);
            }
        }
        assert!(samples.iter().all(|&count| count == spp), "{width}x{height}");
    }
    let past = plan(16, 16, 64);
    assert_eq!(
        past.extent(past.units().unwrap()).samples,
        16,
        "ids past the last are further full passes"
    );
}

#[test]
fn streams_of_units_do_not_overlap() {
    // That they cannot is arithmetic (tracer::random); that the stride is really taken is seen here.
    let first: Vec<U0F32> = {
        let mut r = FullState::for_unit(5, 0);
        (0..1000).map(|_| r.fraction()).collect()
    };
    for id in 1..2000 {
        let mut random = FullState::for_unit(5, id);
        let head = [random.fraction(), random.fraction(), random.fraction()];
        assert!(
            !first.windows(3).any(|window| window == head),
            "unit {id} starts inside unit 0"
        );
    }
}
