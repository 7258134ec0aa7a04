//! One core.
#![no_std]
#![no_main]

runtime::report_panics!(board::Core);

#[board::entry]
fn start() -> ! {
    runtime::run::<board::Core>()
}
