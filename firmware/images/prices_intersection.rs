//! Prices of the formulas that meet a sphere.
#![no_std]
#![no_main]

mod bench;

use bench::{Itself, Printer};
use operations::intersection;

/// All formulas. They have no transcript.
struct Intersections;

impl bench::Prices for Intersections {
    fn cases(&self) -> u32 {
        0
    }

    #[inline(always)]
    fn show(self, printer: &mut Printer) {
        intersection::show(&mut Itself::start(), |price| printer.line(price, 0, 0));
    }
}

#[board::entry]
fn start() -> ! {
    bench::print(Intersections)
}
