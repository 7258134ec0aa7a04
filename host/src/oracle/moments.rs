//! Mean and variance of a pixel's channels, as numbers come in.

/// Running mean and sum of squared deviations (Welford's).
#[derive(Clone, Copy, Default)]
pub(super) struct Moments {
    count: f64,
    pub(super) mean: [f64; 3],
    squares: [f64; 3],
}

impl Moments {
    pub(super) fn add(&mut self, sample: [f64; 3]) {
        self.count += 1.0;
        for ((mean, squares), value) in self.mean.iter_mut().zip(&mut self.squares).zip(sample) {
            let before = value - *mean;
            *mean += before / self.count;
            *squares += before * (value - *mean);
        }
    }

    /// Of one sample.
    pub(super) fn variance(&self, channel: usize) -> f64 {
        self.squares[channel] / (self.count - 1.0)
    }

    pub(super) fn variance_of_mean(&self, channel: usize) -> f64 {
        self.variance(channel) / self.count
    }
}
