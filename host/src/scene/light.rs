//! How bright a scene is for a core: the common exponent of all its light.
//!
//! A core keeps emission in 16:16 and sends a unit's sums in 24:16. Light that is very dim would be rounded away in them, and
//! a path that lives long between bright mirrors would overflow them. Light is linear, so a scene whose light does not fit as
//! it is written is rendered with every emission times 2^exponent, and its picture divided by that. All scenes whose light
//! fits have the exponent 0.

use super::guides::MOST_OF_LOSS;
use super::{Integrator, Material, Sphere};

/// The most samples of one pixel in one unit.
pub(super) const UNIT_SAMPLES: u16 = 64;
/// What a sum of one unit must stay below: 2^24, for 24:16.
const SUM_LIMIT: f64 = 16_777_216.0;
/// What an emission must stay below: 2^16, for 16:16 without a sign.
const EMISSION_LIMIT: f64 = 65_536.0;
/// A sum exceeds [`Light::largest_sum`] with a chance below e^-66.5 = 2^-96: there are less than 2^32 units of 48 sums.
const CHANCE: f64 = 66.5;

/// An emission of 1/8 is rounded by 2^-14 of itself at most: light that is no dimmer needs no exponent.
const FINE_EMISSION: f64 = 1.0 / 8.0;
/// An emission of 1/128 is rounded by 2^-10 of itself, a thousandth, at most; a dimmer one is refused.
const LEAST_EMISSION: f64 = 1.0 / 128.0;
/// Rounding the sum of 64 samples moves a pixel by 2^-23 at most: by 2^-10 of such light, reflected once. (In units of fewer
/// samples it moves it by more, but there a pixel's noise is larger, too.)
const FINE_REFLECTION: f64 = 1.0 / 8192.0;
/// By 2^-7 of such light, reflected once; dimmer light is refused.
const LEAST_REFLECTION: f64 = 1.0 / 65536.0;
/// A reflectance of 2^-23 is rounded by 2^-10 of itself at most in 0:32.
const LEAST_REFLECTANCE: f64 = 1.0 / 8_388_608.0;

/// The least emission of all, far above the least number of 32 bits, in which pictures are kept.
const LEAST: f64 = 1e-30;

/// A number of a scene, and whose it is.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Faintest {
    sphere: usize,
    value: f64,
}

/// What a scene's lights and surfaces may do together.
#[derive(Debug)]
pub(super) struct Light {
    brightest: f64,
    dimmest: Option<Faintest>,
    least_reflectance: Option<Faintest>,
    /// Higher than any sum of one unit, or so likely that the difference does not matter.
    largest_sum: f64,
}

/// A number that a core's formats would lose.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TooFaint {
    /// The sphere's place in the list.
    pub(super) sphere: usize,
    /// What is too small, and how large it must be.
    pub(super) cause: String,
}

impl Light {
    pub(super) fn of<'s>(spheres: impl Iterator<Item = &'s Sphere> + Clone, integrator: Integrator) -> Self {
        let least = |value: fn(&Sphere) -> [f64; 3]| {
            let all = (0..)
                .zip(spheres.clone())
                .flat_map(|(sphere, it)| value(it).map(|value| Faintest { sphere, value }));
            all.filter(|found| found.value > 0.0)
                .min_by(|a, b| a.value.total_cmp(&b.value))
        };
        let most = |values: [f64; 3]| values.into_iter().fold(0.0, f64::max);
        let brightest = spheres
            .clone()
            .map(|sphere| most(sphere.emission))
            .fold(0.0, f64::max);
        let reflecting = spheres.clone().filter(|sphere| most(reflectance(sphere)) > 0.0);
        let brightest_on_the_way = reflecting.map(|sphere| most(sphere.emission)).fold(0.0, f64::max);
        let survival = spheres
            .clone()
            .map(|sphere| most(reflectance(sphere)))
            .fold(0.0, f64::max);
        let albedo = spheres
            .clone()
            .filter(|sphere| matches!(sphere.material, Material::Diffuse(_)))
            .map(|sphere| most(reflectance(sphere)))
            .fold(0.0, f64::max);
        let (looked_for, [survival, albedo]) = match integrator {
            Integrator::Path => (0.0, [survival, albedo]),
            // At each diffuse surface, of which a path meets as many as it survives, and of guided ones some more.
            Integrator::NextEvent => (brightest, [survival, albedo].map(guided)),
        };
        Self {
            brightest,
            dimmest: least(|sphere| sphere.emission),
            least_reflectance: least(reflectance),
            largest_sum: largest_sum(brightest, brightest_on_the_way, survival)
                + largest_sum(0.0, looked_for, albedo),
        }
    }

    /// The power of two that cores' radiance is larger by than the scene's.
    pub(super) fn exponent(&self) -> i32 {
        let room = self.room();
        let fine = self.dimmest.is_none_or(|dimmest| {
            dimmest.value >= FINE_EMISSION && dimmest.value * self.reflected() >= FINE_REFLECTION
        });
        if fine { room.min(0) } else { room }
    }

    /// The largest exponent there is room for.
    fn room(&self) -> i32 {
        if self.brightest == 0.0 {
            return 0;
        }
        let room = (SUM_LIMIT / self.largest_sum)
            .log2()
            .min((EMISSION_LIMIT / self.brightest).log2());
        // Not to the last bit, where rounding up would leave the format.
        (room - 1e-6).floor() as i32
    }

    /// The least share of light that a surface leaves, if it leaves any.
    fn reflected(&self) -> f64 {
        self.least_reflectance.map_or(1.0, |least| least.value)
    }

    /// What a core would lose, although all is as bright as there is room for.
    pub(super) fn too_faint(&self) -> Option<TooFaint> {
        let dimmest = self.dimmest?;
        if dimmest.value < LEAST {
            let cause = format!(
                "an emission of {} is less than OpenEXR holds well; use 0, or at least {LEAST:e}",
                dimmest.value
            );
            return Some(TooFaint {
                sphere: dimmest.sphere,
                cause,
            });
        }
        let unit = 2f64.powi(-self.exponent());
        if dimmest.value < LEAST_EMISSION * unit {
            return Some(TooFaint {
                sphere: dimmest.sphere,
                cause: format!(
                    "an emission of {} is lost beside the scene's brightest light, {}; use 0, or at least {:.1e}",
                    dimmest.value,
                    self.brightest,
                    rounded_up(LEAST_EMISSION * unit)
                ),
            });
        }
        let least = self.least_reflectance?;
        let needed = (LEAST_REFLECTION * unit / dimmest.value).max(LEAST_REFLECTANCE);
        (least.value < needed).then(|| TooFaint {
            sphere: least.sphere,
            cause: format!(
                "a reflectance of {} is lost in fixed point, in light as dim as the scene's dimmest, {}; use 0, or at least {:.1e}",
                least.value,
                dimmest.value,
                rounded_up(needed)
            ),
        })
    }
}

/// The most that a surface of this reflectance reflects where some paths are guided.
fn guided(reflectance: f64) -> f64 {
    reflectance / (1.0 - MOST_OF_LOSS * (1.0 - reflectance))
}

fn reflectance(sphere: &Sphere) -> [f64; 3] {
    match sphere.material {
        Material::Diffuse(colour) | Material::Mirror(colour) | Material::Glass { tint: colour, .. } => colour,
    }
}

/// What no sum of one unit's samples reaches, but with a chance of e^-[`CHANCE`].
///
/// A sample meets at most six surfaces before roulette can end it, and then as many more as it survives: a geometric number,
/// below an exponential one of rate -ln survival. It adds `on_the_way` at each of them at most, and at the last one, which may
/// be a light that reflects nothing, `brightest`. The sum of n such numbers exceeds n x / rate with a chance of
/// (x e^(1 - x))^n at most (Chernoff). A path of fixed depth brings less: on_the_way / (1 - survival) at most.
fn largest_sum(brightest: f64, on_the_way: f64, survival: f64) -> f64 {
    const BEFORE_ROULETTE: f64 = 6.0;
    let sure = f64::from(UNIT_SAMPLES) * (brightest + BEFORE_ROULETTE * on_the_way);
    if on_the_way == 0.0 || survival == 0.0 {
        return sure;
    }
    // x = 1 + ln x + CHANCE / n, from below; each step at least halves what is missing, as ln x is flat there.
    let mut x = 2.0;
    for _ in 0..64 {
        x = 1.0 + f64::ln(x) + CHANCE / f64::from(UNIT_SAMPLES);
    }
    sure + on_the_way * f64::from(UNIT_SAMPLES) * x / -survival.ln()
}

/// The next number that two digits can say.
pub(super) fn rounded_up(value: f64) -> f64 {
    let digit = 10f64.powi(value.log10().floor() as i32 - 1);
    (value / digit).ceil() * digit
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sphere(emission: f64, reflectance: f64) -> Sphere {
        Sphere {
            name: "ball".to_owned(),
            centre: [0.0; 3],
            radius: 1.0,
            hollow: false,
            emission: [emission; 3],
            material: Material::Diffuse([reflectance; 3]),
        }
    }

    fn light(spheres: &[Sphere]) -> Light {
        Light::of(spheres.iter(), Integrator::Path)
    }

    #[test]
    fn ordinary_light_is_left_as_it_is() {
        for (emission, reflectance) in [(12.0, 0.999), (0.125, 0.001), (4095.0, 0.5), (100.0, 0.0)] {
            let lamp = [sphere(emission, 0.0), sphere(0.0, reflectance)];
            assert_eq!(light(&lamp).exponent(), 0, "{emission} on {reflectance}");
        }
    }

    #[test]
    fn dim_light_gets_all_the_room_there_is() {
        for emission in [1e-30, 1e-6, 2e-5, 1e-4, 0.124] {
            let light = light(&[sphere(emission, 0.5)]);
            let scaled = 2f64.powi(light.exponent());
            assert!(light.largest_sum * scaled < SUM_LIMIT && light.largest_sum * scaled * 2.1 > SUM_LIMIT);
            assert_eq!(light.too_faint(), None);
        }
    }

    #[test]
    fn bright_mirrors_are_dimmed() {
        let light = light(&[sphere(200.0, 0.999)]);
        assert_eq!(light.exponent(), -2);
        assert_eq!(light.too_faint(), None);
    }

    /// What a core would hold is within a thousandth.
    #[test]
    fn what_is_accepted_keeps_its_value() {
        let cases = [(1e-3, 12.0), (1e-5, 0.01), (0.5, 4000.0), (3e-4, 100.0)];
        for (dim, bright) in cases {
            let light = light(&[sphere(dim, 0.9), sphere(bright, 0.0), sphere(0.0, 0.3)]);
            assert_eq!(light.too_faint(), None, "{dim} beside {bright}");
            let scaled = dim * 2f64.powi(light.exponent() + 16);
            assert!(
                (scaled.round() / scaled - 1.0).abs() < 1.0 / 1024.0,
                "{dim} beside {bright}"
            );
        }
    }

    /// What the message calls enough: its last word.
    fn enough(found: &TooFaint) -> f64 {
        let word = found.cause.rsplit(' ').next();
        word.and_then(|word| word.parse().ok()).expect("a number")
    }

    #[test]
    fn what_would_be_lost_is_named_with_what_would_not() {
        let spheres = [sphere(12.0, 0.0), sphere(1e-9, 0.5)];
        let found = light(&spheres).too_faint().expect("lost");
        assert_eq!(found.sphere, 1);
        let least = enough(&found);
        assert_eq!(light(&[sphere(12.0, 0.0), sphere(least, 0.5)]).too_faint(), None);
        assert!(
            light(&[sphere(12.0, 0.0), sphere(least * 0.9, 0.5)])
                .too_faint()
                .is_some()
        );
        let found = light(&[sphere(1.0, 0.0), sphere(0.0, 1e-9)])
            .too_faint()
            .expect("lost");
        assert_eq!(found.sphere, 1);
        let least = enough(&found);
        assert_eq!(light(&[sphere(1.0, 0.0), sphere(0.0, least)]).too_faint(), None);
    }

    /// The bound against what it bounds: the mean of a furnace's sums, and how far they spread.
    #[test]
    fn the_largest_sum_is_above_the_mean_by_many_deviations() {
        for survival in [0.1, 0.5, 0.9, 0.999f64] {
            let mean = f64::from(UNIT_SAMPLES) / (1.0 - survival);
            let deviation = (f64::from(UNIT_SAMPLES) * survival).sqrt() / (1.0 - survival);
            let found = largest_sum(1.0, 1.0, survival);
            assert!(found > mean + 9.0 * deviation, "{survival}: {found}, mean {mean}");
            assert!(found < 20.0 * mean, "{survival}: {found}, mean {mean}");
        }
    }
}
