//! One core.
#![no_std]
#![no_main]

#[board::entry]
fn start() -> ! {
    runtime::run::<board::Core>()
}
