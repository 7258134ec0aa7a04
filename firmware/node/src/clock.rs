//! What tells a core the time.

/// Ticks of a [`Clock`] in a second.
pub const TICKS_PER_SECOND: u32 = 24_000_000;

/// A free-running counter.
pub trait Clock {
    /// [`TICKS_PER_SECOND`] ticks a second; wraps every three minutes.
    fn ticks(&mut self) -> u32;
}
