//! Prices and transcripts of points drawn from distributions, ours and the published.
#![no_std]
#![no_main]

mod bench;

use operations::Group;

#[board::entry]
fn start() -> ! {
    bench::print(Group::Warps)
}
