//! A core like any other, whose tracer computes in soft `f32`: what a render costs without fixed point.
#![no_std]
#![no_main]

mod soft_float;

#[board::entry]
fn start() -> ! {
    soft_float::run::<f32>()
}
