//! Prices and transcripts of unit vectors, ours and the published.
#![no_std]
#![no_main]

mod bench;

use operations::Group;

#[board::entry]
fn start() -> ! {
    bench::print(Group::Directions)
}
