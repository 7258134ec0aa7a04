//! Prices and transcripts of square roots, ours and the published.
#![no_std]
#![no_main]

mod bench;

use operations::Group;

#[board::entry]
fn start() -> ! {
    bench::print(Group::Roots)
}
