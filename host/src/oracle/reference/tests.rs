//! Known answers: a furnace's closed form, the standard scene's mean, and what must not matter.

use super::*;

pub(super) fn cornell() -> Scene {
    Scene::parse("cornell.toml", include_str!("../../../../scenes/cornell.toml")).unwrap()
}

/// The inside of one sphere that shines with `emission` and reflects `material` of it.
fn furnace(emission: f64, material: &str) -> Scene {
    let text = format!(
        "format = 1
        [camera]
        position = [3, 2, 1]
        direction = [0.3, -0.2, -1]
        plane_height = 1
        [[sphere]]
        name = \"furnace\"
        hollow = true
        centre = [0, 0, 0]
        radius = 10
        emission = [{emission}, {emission}, {emission}]
        {material}"
    );
    Scene::parse("furnace.toml", &text).unwrap()
}

pub(super) const SMALL: Job = Job {
    width: 16,
    height: 12,
    spp: 64,
    termination: Termination::Roulette,
    seed: 7,
};

/// Mean over pixels and its standard error, by channel.
pub(super) fn mean_and_error(estimate: &Estimate) -> ([f64; 3], [f64; 3]) {
    let mean = estimate.picture.mean().unwrap();
    let variance = estimate.variance.as_ref().unwrap();
    let pixels = variance.len() as f64;
    let error = [0, 1, 2].map(|c| variance.iter().map(|pixel| pixel[c]).sum::<f64>().sqrt() / pixels);
    (mean, error)
}

#[test]
fn the_standard_scene_has_its_published_mean() {
    // rgb 0.3385 0.2603 0.3406, mean 0.3131, from two independent double-precision programs.
    let job = Job {
        width: 128,
        height: 96,
        spp: 64,
        ..SMALL
    };
    let estimate = render(&cornell(), &job, |_| {}).estimate;
    let (mean, error) = mean_and_error(&estimate);
    for ((mean, error), expected) in mean.into_iter().zip(error).zip([0.3385, 0.2603, 0.3406]) {
        assert!(
            (mean - expected).abs() < 5.0 * error + 0.0003,
            "{mean} +- {error}, not {expected}"
        );
        assert!(error < 0.0015, "{error}");
    }
}

#[test]
fn a_furnace_with_roulette_glows_by_its_closed_form() {
    // Every point sees the same radiance L = e + a L.
    for (emission, albedo) in [(1.0, 0.5), (0.25, 0.9), (12.0, 0.0)] {
        for kind in ["diffuse", "mirror"] {
            let scene = furnace(emission, &format!("{kind} = [{albedo}, {albedo}, {albedo}]"));
            let (mean, error) = mean_and_error(&render(&scene, &SMALL, |_| {}).estimate);
            let expected = emission / (1.0 - albedo);
            for (mean, error) in mean.into_iter().zip(error) {
                assert!(
                    (mean - expected).abs() <= 5.0 * error + 1e-9,
                    "{kind}: {mean} +- {error}, not {expected}"
                );
            }
        }
    }
}

#[test]
fn a_furnace_of_fixed_depth_is_a_geometric_sum_without_noise() {
    let scene = furnace(1.0, "diffuse = [0.5, 0.25, 0]");
    for (depth, expected) in [
        (1, [1.0, 1.0, 1.0]),
        (2, [1.5, 1.25, 1.0]),
        (4, [1.875, 1.328125, 1.0]),
    ] {
        let estimate = render(
            &scene,
            &Job {
                termination: Termination::Depth(depth),
                ..SMALL
            },
            |_| {},
        )
        .estimate;
        for pixel in estimate.picture.pixels() {
            let pixel = pixel.unwrap();
            assert!(
                (0..3).all(|c| (pixel[c] - expected[c]).abs() < 1e-12),
                "depth {depth}: {pixel:?}"
            );
        }
        assert!(
            estimate
                .variance
                .unwrap()
                .iter()
                .flatten()
                .all(|&variance| variance < 1e-24)
        );
    }
}

#[test]
fn glass_neither_makes_nor_swallows_light() {
    // In a furnace without loss, a ball that only redirects light cannot be seen at all.
    let ball = "diffuse = [0, 0, 0]
        [[sphere]]
        name = \"ball\"
        centre = [0, 0, -4]
        radius = 2
        glass = [0.999, 0.999, 0.999]
        index = 1.5";
    let estimate = render(&furnace(1.0, ball), &Job { spp: 256, ..SMALL }, |_| {}).estimate;
    let darkest = estimate
        .picture
        .pixels()
        .iter()
        .map(|pixel| pixel.unwrap()[0])
        .fold(f64::INFINITY, f64::min);
    let (mean, _) = mean_and_error(&estimate);
    // A path meets the ball a few times, at 0.1 % each.
    assert!(darkest > 0.99 && darkest < 0.9995, "{darkest}");
    assert!(mean[0] <= 1.0 + 1e-9, "{mean:?}");
}

#[test]
fn threads_do_not_matter_but_the_seed_does() {
    let on = |threads: usize, seed: u64| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| render(&cornell(), &Job { seed, ..SMALL }, |_| {}))
    };
    let one = on(1, 7);
    assert_eq!(one, on(5, 7));
    assert_ne!(one, on(1, 8));
}

#[test]
fn no_two_rows_share_their_noise() {
    let scene = furnace(1.0, "diffuse = [0.9, 0.9, 0.9]");
    let estimate = render(&scene, &SMALL, |_| {}).estimate;
    let mut rows: Vec<Vec<_>> = estimate
        .picture
        .pixels()
        .chunks(16)
        .map(|row| {
            row.iter()
                .flatten()
                .flatten()
                .map(|value| value.to_bits())
                .collect()
        })
        .collect();
    rows.sort();
    rows.dedup();
    assert_eq!(rows.len(), 12);
}

#[test]
fn the_stated_variance_is_that_of_repeated_renders() {
    let runs: Vec<Estimate> = (0..24)
        .map(|seed| {
            render(
                &cornell(),
                &Job {
                    spp: 64,
                    seed,
                    ..SMALL
                },
                |_| {},
            )
            .estimate
        })
        .collect();
    let (mut stated, mut seen) = (0.0, 0.0);
    for pixel in 0..16 * 12 {
        let means: Vec<f64> = runs
            .iter()
            .map(|run| run.picture.pixels()[pixel].unwrap()[1])
            .collect();
        let mean = means.iter().sum::<f64>() / means.len() as f64;
        seen += means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (means.len() - 1) as f64;
        stated += runs
            .iter()
            .map(|run| run.variance.as_ref().unwrap()[pixel][1])
            .sum::<f64>()
            / runs.len() as f64;
    }
    // 192 pixels x 23 degrees of freedom, with the heavy tails of path tracing.
    assert!((seen / stated - 1.0).abs() < 0.15, "seen {seen}, stated {stated}");
}

#[test]
fn red_is_left_and_the_light_is_at_the_top() {
    let estimate = render(
        &cornell(),
        &Job {
            width: 32,
            height: 24,
            spp: 256,
            ..SMALL
        },
        |_| {},
    )
    .estimate;
    let at = |column: usize, row: usize| estimate.picture.pixels()[row * 32 + column].unwrap();
    let (left, right) = (at(1, 12), at(30, 12));
    assert!(left[0] > 2.0 * left[2], "{left:?}");
    assert!(right[2] > 2.0 * right[0], "{right:?}");
    let brightest = (0..32 * 24)
        .max_by(|&a, &b| at(a % 32, a / 32)[1].total_cmp(&at(b % 32, b / 32)[1]))
        .unwrap();
    assert!(brightest / 32 < 6, "row {}", brightest / 32);
}

#[test]
fn progress_ends_at_all_samples() {
    let most = AtomicU64::new(0);
    render(&cornell(), &SMALL, |done| {
        most.fetch_max(done, Ordering::Relaxed);
    });
    assert_eq!(most.into_inner(), SMALL.samples());
}

/// As many samples of one variance as of another: the mean of both.
#[test]
fn noise_is_that_of_all_samples() {
    let estimate = |variance: f64, spp: u32| Estimate {
        picture: Picture::new(1, 1, vec![Some([0.5; 3])]),
        variance: Some(vec![[variance / f64::from(spp); 3]]),
        spp: Some(spp),
    };
    let known = Rendered {
        estimate: estimate(0.1, 192),
        plain_variance: vec![[4.0; 3]],
        looking_variance: vec![[2.0; 3]],
    };
    for (integrator, variance) in [(Integrator::Path, 3.0), (Integrator::NextEvent, 1.5)] {
        let pooled = known.pooled_noise(estimate(0.0, 64), integrator);
        assert_eq!(pooled.variance, Some(vec![[variance / 64.0; 3]]));
    }
    let unknown = Estimate {
        variance: None,
        ..estimate(0.0, 64)
    };
    assert_eq!(known.pooled_noise(unknown.clone(), Integrator::Path), unknown);
}
