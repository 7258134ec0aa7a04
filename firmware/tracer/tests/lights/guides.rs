//! Guided paths: wherever they go, what counts of a path is 1 on average, and mirrors show the emitter where they are guided to.

use fixedmath::random::Lcg64;
use fixedmath::{I2F30, I16F16, U0F32};
use tracer::arithmetic::{Mixed, Sampling};
use tracer::capability::All;
use tracer::geometry::{Interaction, MaterialId, PrimitiveId, Ray};
use tracer::light::{Guidance, Guide, Lights, MisWeight};
use tracer::profile::{Precise, Profile};
use tracer::random::Random;

use super::magnitude;

type Samples = <Precise as Profile>::Random;

/// A ball that is guided to.
#[derive(Clone, Copy)]
struct Ball {
    centre: [f64; 3],
    radius: f64,
    angle: f64,
    steps: u16,
    share: f64,
}

const EMITTER: [f64; 3] = [0.0, 9.0, 0.0];

/// The records of balls, whose primitives are 0 and on.
fn guides(balls: &[Ball]) -> Vec<Guide> {
    let all: f64 = balls.iter().map(|ball| ball.share).sum();
    let mut sum = 0.0;
    let guides = balls.iter().enumerate().map(|(index, ball)| {
        sum += ball.share;
        let height = 1.0 - ball.angle.cos();
        Guide {
            centre: ball.centre.map(I16F16::from_num),
            radius: I16F16::from_num(ball.radius),
            emitter: EMITTER.map(I16F16::from_num),
            spread: I2F30::from_num((2.0 * height).sqrt()),
            edge: I2F30::from_num(1.0 - height),
            threshold: U0F32::from_num(sum),
            reach: magnitude(2.0 * ball.radius * height * (1.0 - all) / ball.share),
            primitive: PrimitiveId::new(index),
            steps: ball.steps,
            reserved: 0,
        }
    });
    guides.collect()
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The first ball on the way, and where.
fn first(balls: &[Ball], point: [f64; 3], direction: [f64; 3]) -> Option<(usize, [f64; 3], [f64; 3])> {
    let hits = balls.iter().enumerate().filter_map(|(index, ball)| {
        let to = sub(ball.centre, point);
        let along = dot(to, direction);
        let left = ball.radius.powi(2) - (dot(to, to) - along * along);
        let t = along - left.max(0.0).sqrt();
        (left > 0.0 && t > 1e-3).then_some((t, index))
    });
    let (t, index) = hits.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let hit = [0, 1, 2].map(|i| point[i] + t * direction[i]);
    Some((
        index,
        hit,
        sub(hit, balls[index].centre).map(|c| c / balls[index].radius),
    ))
}

/// A place on the floor below, which leans.
fn place(point: [f64; 3], normal: [f64; 3]) -> Interaction<Mixed> {
    let length = dot(normal, normal).sqrt();
    Interaction {
        point: point.map(I16F16::from_num),
        normal: normal.map(|c| I2F30::from_num(c / length)),
        from_inside: false,
        primitive: PrimitiveId::new(9),
        material: MaterialId::new(0),
    }
}

/// What counts of one path that goes on from `at`.
fn weight(balls: &[Ball], lights: &Lights<'_>, at: &Interaction<Mixed>, random: &mut Samples) -> f64 {
    let own = 1.0 - balls.iter().map(|ball| ball.share).sum::<f64>();
    let (direction, to) = match lights.guide::<Precise, All>(at, random) {
        Guidance::Nowhere => return 0.0,
        Guidance::To(direction, ball) => (direction, ball),
        Guidance::Unguided => loop {
            if let Some(found) = Mixed::on_hemisphere(random.fraction()) {
                break (Mixed::around(at.normal, found), PrimitiveId::NONE);
            }
        },
    };
    let point = at.point.map(|c| c.to_num::<f64>());
    let Some((index, hit, normal)) = first(balls, point, direction.map(|c| c.to_num())) else {
        return if to == PrimitiveId::NONE { 1.0 / own } else { 0.0 };
    };
    let ray = Ray {
        origin: at.point,
        direction,
        departed: at.primitive,
        normal: at.normal,
    };
    let met = Interaction {
        point: hit.map(I16F16::from_num),
        normal: normal.map(I2F30::from_num),
        from_inside: false,
        primitive: PrimitiveId::new(index),
        material: MaterialId::new(0),
    };
    let share = lights.weight_of_guided::<Precise, All>(&ray, &met, to, random);
    match share {
        MisWeight::One => 1.0 / own,
        MisWeight::Share(share) => share.to_num::<f64>() / own,
        MisWeight::Zero => 0.0,
    }
}

const MIRROR: Ball = Ball {
    centre: [2.0, 3.0, 1.0],
    radius: 1.5,
    angle: 0.2,
    steps: 2,
    share: 0.03,
};
const GLASS: Ball = Ball {
    centre: [-3.0, 2.0, 0.5],
    radius: 1.0,
    angle: 1.2,
    steps: 0,
    share: 0.05,
};

/// The chances of either way and what counts of each fit together: from near and from far, past another ball, from where a part of the cap is
/// below the horizon, and with a share that is far too large.
#[test]
fn what_counts_of_a_path_is_one_on_average() {
    const PATHS: u32 = 400_000;
    let often = Ball { share: 0.5, ..MIRROR };
    let wide = Ball {
        angle: 1.5,
        share: 0.2,
        ..MIRROR
    };
    let tiny = Ball {
        radius: 1.0 / 64.0,
        ..MIRROR
    };
    let cases: [(&[Ball], [f64; 3], [f64; 3]); 9] = [
        (&[MIRROR, GLASS], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
        (&[MIRROR, GLASS], [2.5, 1.45, 1.2], [0.0, 1.0, 0.0]),
        (&[MIRROR, GLASS], [-60.0, 1.0, 2.0], [1.0, 0.1, 0.0]),
        (&[MIRROR, GLASS], [-6.0, 1.7, 0.2], [1.0, 0.5, 0.0]),
        (&[MIRROR], [0.0, 3.0, 1.0], [0.3, 1.0, 0.2]),
        (&[often], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
        (&[wide, GLASS], [1.0, 0.0, 3.0], [0.0, 1.0, -1.0]),
        (&[tiny], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
        (&[GLASS], [-3.0, 0.9, 0.5], [0.0, 1.0, 0.0]),
    ];
    for (case, (balls, point, normal)) in cases.into_iter().enumerate() {
        let guides = guides(balls);
        let lights = Lights {
            caps: &[],
            balls: &[],
            guides: &guides,
        };
        let (at, mut random) = (place(point, normal), Samples::for_unit(11, case as u32));
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..PATHS {
            let weight = weight(balls, &lights, &at, &mut random);
            sum += weight;
            squares += weight * weight;
        }
        let mean = sum / f64::from(PATHS);
        let error = ((squares / f64::from(PATHS) - mean * mean) / f64::from(PATHS)).sqrt();
        println!("case {case}: {mean:.5} +- {error:.5}");
        // By chance, one of nine is farther off than 4 standard errors once in 1,700 seeds.
        assert!((mean - 1.0).abs() < 4.0 * error, "case {case}: {mean} +- {error}");
        assert!(error < 4e-3, "case {case}: a test of nothing");
    }
}

/// Each guided ray is reflected to near the emitter: what the cap's half angle, turned twice, lets it miss, and what steps leave.
#[test]
fn a_mirror_shows_the_emitter_where_paths_are_guided_to() {
    let narrow = Ball {
        angle: 0.02,
        ..MIRROR
    };
    let guides = guides(&[narrow]);
    let lights = Lights {
        caps: &[],
        balls: &[],
        guides: &guides,
    };
    let mut random = Lcg64::new(5);
    let mut samples = Samples::for_unit(3, 3);
    let mut seen = 0;
    for _ in 0..20_000 {
        let mut coordinate = || f64::from(random.next_fraction()) / 2f64.powi(32) * 12.0 - 6.0;
        let point = [coordinate(), -1.0, coordinate()];
        let Guidance::To(direction, _) =
            lights.guide::<Precise, All>(&place(point, [0.0, 1.0, 0.0]), &mut samples)
        else {
            continue;
        };
        let direction = direction.map(|c| c.to_num::<f64>());
        let (_, hit, normal) = first(&[narrow], point, direction).expect("it is aimed at the ball");
        let turned = 2.0 * dot(direction, normal);
        let reflected = [0, 1, 2].map(|i| direction[i] - turned * normal[i]);
        let way = sub(EMITTER, hit);
        let cosine = dot(reflected, way) / dot(way, way).sqrt();
        assert!(cosine > 0.1f64.cos(), "{point:?}: {}", cosine.acos());
        seen += 1;
    }
    assert!(seen > 100, "{seen}");
}

/// A path that was guided to one ball and has met another counts for nothing, and one that was not guided and meets a mirror elsewhere in full.
#[test]
fn a_guided_path_counts_only_where_it_was_guided_to() {
    let guides = guides(&[MIRROR, GLASS]);
    let lights = Lights {
        caps: &[],
        balls: &[],
        guides: &guides,
    };
    let at = place([0.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    let (to, mut random) = (MIRROR.centre, Samples::for_unit(1, 1));
    let direction = to.map(|c| c / dot(to, to).sqrt());
    let (index, hit, normal) = first(&[MIRROR], [0.0; 3], direction).expect("the way to its centre");
    let ray = Ray {
        origin: at.point,
        direction: direction.map(I2F30::from_num),
        departed: at.primitive,
        normal: at.normal,
    };
    let met = |primitive| Interaction {
        point: hit.map(I16F16::from_num),
        normal: normal.map(I2F30::from_num),
        from_inside: false,
        primitive,
        material: MaterialId::new(0),
    };
    let mut share =
        |primitive, to| lights.weight_of_guided::<Precise, All>(&ray, &met(primitive), to, &mut random);
    let [mirror, glass, other] = [index, 1, 5].map(PrimitiveId::new);
    assert_eq!(share(mirror, glass), MisWeight::Zero);
    assert_eq!(share(other, glass), MisWeight::Zero);
    assert_eq!(share(other, PrimitiveId::NONE), MisWeight::One);
}
