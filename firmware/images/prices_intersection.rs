//! Prices of the formulas that meet a sphere.
#![no_std]
#![no_main]

mod bench;

#[board::entry]
fn start() -> ! {
    bench::print_intersections()
}
