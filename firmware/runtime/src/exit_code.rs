//! How a core ends.

/// How a core ended. After one of the last two, the fleet starts the core again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum ExitCode {
    /// It was told to stop.
    Success = 0,
    /// It cannot go on: see the console.
    Fault = 1,
    /// Its boot block is unusable.
    BadBoot = 2,
    /// The program has a bug: it panicked.
    Panic = 3,
    /// The processor took an exception.
    Exception = 4,
}

impl ExitCode {
    /// The operation SYS_EXIT_EXTENDED of a semihosting call, whose second argument points to [`ExitCode::semihosting`].
    pub const SEMIHOSTING_OPERATION: u32 = 0x20;

    /// ADP_Stopped_ApplicationExit, "the program ended by itself", and the exit code.
    pub const fn semihosting(self) -> [u32; 2] {
        [0x2_0026, self as u32]
    }
}
