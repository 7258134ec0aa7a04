//! Random spheres, points and directions in the formats of cores.

use fixedmath::{I2F30, I16F16};
use tracer::random::{FullState, Random};

/// A stream of random numbers for double precision, and for the tracer's own sampling.
pub(super) struct Draw(pub(super) FullState);

impl Draw {
    /// The stream of one share of the work.
    pub(super) fn new(seed: u64, share: u32) -> Self {
        Self(FullState::for_unit(seed, share))
    }

    /// Uniform between two numbers.
    pub(super) fn number(&mut self, from: f64, to: f64) -> f64 {
        let [high, low] = [(); 2].map(|()| f64::from(self.0.fraction().to_bits()));
        from + (to - from) * (high + low / 4_294_967_296.0) / 4_294_967_296.0
    }

    /// Between two positive numbers, every magnitude alike.
    pub(super) fn magnitude(&mut self, from: f64, to: f64) -> f64 {
        from * (to / from).powf(self.number(0.0, 1.0))
    }

    /// A direction uniform on the sphere.
    pub(super) fn direction(&mut self) -> [f64; 3] {
        let height = self.number(-1.0, 1.0);
        let (sine, cosine) = self.number(0.0, std::f64::consts::TAU).sin_cos();
        let radius = (1.0 - height * height).sqrt();
        [radius * cosine, radius * sine, height]
    }

    /// A direction across another.
    pub(super) fn across(&mut self, axis: [f64; 3]) -> [f64; 3] {
        loop {
            let v = self.direction();
            let along = dot(v, axis);
            let across = combine(1.0, v, -along, axis);
            let length = dot(across, across).sqrt();
            // Nearer to the axis, rounding would turn it.
            if length > 0.1 {
                return across.map(|c| c / length);
            }
        }
    }
}

/// `a . b`.
pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

/// `s a + t b`.
pub(super) fn combine(s: f64, a: [f64; 3], t: f64, b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| s * a[i] + t * b[i])
}

/// A length in 16:16, to the nearest.
pub(super) fn length(units: f64) -> I16F16 {
    I16F16::from_bits((units * 65_536.0).round() as i32)
}

/// A unit vector in 2:30, to the nearest.
pub(super) fn unit(v: [f64; 3]) -> [I2F30; 3] {
    v.map(|c| I2F30::from_bits((c * f64::from(1 << 30)).round() as i32))
}

/// Lengths in ulp.
pub(super) fn ulps(v: [I16F16; 3]) -> [i64; 3] {
    v.map(|c| c.to_bits().into())
}
