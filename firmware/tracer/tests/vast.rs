//! Vast spheres against the same in double precision.

use fixedmath::random::Lcg64;
use fixedmath::{I2F30, I16F16};
use tracer::arithmetic::{Formats, Mixed};
use tracer::geometry::sphere::{Bend, VastNumbers};

/// Half-width of the cube that scenes lie in: a third of the 16:16 range, over the root of 3.
const ROOM: f64 = 6_300.0;

struct Draw(Lcg64);

impl Draw {
    fn number(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * f64::from(self.0.next_fraction()) / 4_294_967_296.0
    }

    fn unit(&mut self) -> [f64; 3] {
        loop {
            let v = [(); 3].map(|()| self.number(-1.0, 1.0));
            let square: f64 = v.iter().map(|c| c * c).sum();
            if (0.01..1.0).contains(&square) {
                return v.map(|c| c / square.sqrt());
            }
        }
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

fn bend(radius: f64, towards: bool) -> Bend {
    let sign = if towards { 1 } else { -1 };
    let shift = (radius.log2().floor() as i32 - 14).clamp(0, 30);
    Bend {
        curvature: sign * (2f64.powi(44) / radius).round() as i32,
        radius: sign * (radius * 2f64.powi(16 - shift)) as i32,
        shift: shift as u32,
    }
}

/// A ray above or below a sphere, in both arithmetics.
struct Case {
    bend: Bend,
    curvature: f64,
    normal: [I2F30; 3],
    above: [I16F16; 3],
    direction: [I2F30; 3],
    height: f64,
    slope: f64,
}

fn case(draw: &mut Draw) -> Case {
    let radius = 2f64.powf(draw.number(14.5, 44.0));
    let bend = bend(radius, draw.number(0.0, 1.0) < 0.5);
    let normal = draw.unit().map(I2F30::from_num);
    let above = [(); 3].map(|()| I16F16::from_num(draw.number(-ROOM, ROOM)));
    let direction = draw.unit().map(I2F30::from_num);
    let (n, v, d) = (
        normal.map(I2F30::to_num::<f64>),
        above.map(I16F16::to_num::<f64>),
        direction.map(I2F30::to_num::<f64>),
    );
    let curvature = f64::from(bend.curvature) * 2f64.powi(-44);
    Case {
        bend,
        curvature,
        normal,
        above,
        direction,
        height: dot(n, v) - curvature / 2.0 * dot(v, v),
        slope: dot(n, d) - curvature * dot(v, d),
    }
}

/// Both are rounded once: a height by far less than an ulp of a length, a slope by 2^-30.
#[test]
fn heights_and_slopes_are_double_precision_s() {
    let mut draw = Draw(Lcg64::new(1));
    for _ in 0..200_000 {
        let case = case(&mut draw);
        let height = Mixed::height(case.normal, case.bend, case.above).to_num::<f64>();
        assert!(
            (height - case.height).abs() < 2f64.powi(-30),
            "{height} {}",
            case.height
        );
        let slope = Mixed::slope(case.normal, case.bend, case.above, case.direction).to_num::<f64>();
        assert!(
            (slope - case.slope).abs() < 2f64.powi(-30),
            "{slope} {}",
            case.slope
        );
    }
}

/// Where a ray is said to go under or to come up, it is at height 0: within the ulp that t is cut to, and what a slope that is
/// off by 2^-30 makes of the way there.
#[test]
fn what_is_met_is_on_the_surface() {
    let mut draw = Draw(Lcg64::new(2));
    let mut met = 0;
    for _ in 0..400_000 {
        let case = case(&mut draw);
        let height = Mixed::height(case.normal, case.bend, case.above);
        let slope = Mixed::slope(case.normal, case.bend, case.above, case.direction);
        let square = case.slope * case.slope + 2.0 * case.curvature * case.height;
        let Some(root) = Mixed::root_of_slope(case.bend, height, slope) else {
            assert!(square < 2f64.powi(-28), "it is steep enough: {square}");
            continue;
        };
        assert!(square > -2f64.powi(-28), "it passes by: {square}");
        let hits = [
            (
                height >= 0,
                Mixed::goes_under(case.bend, height, slope, root, Mixed::FAR),
            ),
            (
                height <= 0,
                Mixed::goes_under(case.bend.turned(), -height, -slope, root, Mixed::FAR),
            ),
        ];
        for t in hits
            .into_iter()
            .filter_map(|(starts_there, t)| t.filter(|_| starts_there))
        {
            met += 1;
            let t = t.to_num::<f64>();
            let left = case.height + case.slope * t - case.curvature / 2.0 * t * t;
            let steepness = square.max(0.0).sqrt().max(2f64.powi(-14));
            let bound = 2f64.powi(-16) + t * 2f64.powi(-29) * (1.0 + 1.0 / steepness);
            assert!(
                left.abs() < bound,
                "{left} at {t}, slope {} of {steepness}",
                case.slope
            );
        }
    }
    assert!(met > 100_000, "{met}");
}

/// A point is put back on the surface within its own rounding, and the normal there is a unit vector.
#[test]
fn points_are_put_back() {
    let mut draw = Draw(Lcg64::new(3));
    for _ in 0..200_000 {
        let case = case(&mut draw);
        let put_back = |point: [I16F16; 3]| {
            let upward = Mixed::upward(case.normal, case.bend, point);
            let length: f64 = upward.iter().map(|c| c.to_num::<f64>().powi(2)).sum();
            (
                Mixed::lowered(point, Mixed::height(case.normal, case.bend, point), upward),
                length,
            )
        };
        // Hits are a few ulp off: the first time brings a point near enough.
        if Mixed::height(case.normal, case.bend, case.above).abs() > 4 {
            continue;
        }
        let (near, _) = put_back(case.above);
        let (lowered, length) = put_back(near);
        assert!((length - 1.0).abs() < 2f64.powi(-28), "{length}");
        let left = Mixed::height(case.normal, case.bend, lowered).to_num::<f64>();
        // Half an ulp of the height, and of each component along the normal.
        assert!(left.abs() < 2f64.powi(-16) * 1.4, "{left}");
    }
}
