//! Prices and transcripts of functions of angles, ours and the published.
#![no_std]
#![no_main]

mod bench;

use operations::Group;

#[board::entry]
fn start() -> ! {
    bench::print(Group::Angles)
}
