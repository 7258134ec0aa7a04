//! What differs from one board to another.

use node::ethernet::Device;

use crate::exit_code::ExitCode;

/// A board.
pub trait Board {
    /// The name HELLO gives.
    const NAME: &'static str;
    /// What is said where no Ethernet controller answers.
    const NO_CONTROLLER: &'static str;
    /// The rate of the counter.
    const COUNTER_MEGAHERTZ: u32;
    /// The driver of its Ethernet controller.
    type Controller: Device;

    /// Starts the Ethernet controller with this address; in whatever state it was, it starts anew. None where there is no such
    /// controller.
    fn controller(mac: [u8; 6]) -> Option<Self::Controller>;

    /// What a free-running counter of 32 bits shows. Under QEMU's `-icount shift=0` an instruction takes a nanosecond of its time.
    fn count() -> u32;

    /// Writes one line on the console.
    fn println(line: &str);

    /// Ends the program.
    fn exit(code: ExitCode) -> !;
}
