//! The way out: a debugger's, here QEMU's, exit call.

/// How a core ended; the value is the exit code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Exit {
    /// It was told to stop.
    Done = 0,
    /// It cannot go on: see the console.
    Fault = 1,
    /// Its boot block is unusable.
    BadBoot = 2,
    /// The program has a bug: it panicked.
    Panic = 3,
    /// The processor took an exception.
    Exception = 4,
}

/// SYS_EXIT_EXTENDED.
const EXIT_EXTENDED: u32 = 0x20;
/// ADP_Stopped_ApplicationExit: "the program ended by itself".
const APPLICATION_EXIT: u32 = 0x2_0026;

/// Ends the program.
pub fn exit(code: Exit) -> ! {
    let block = [APPLICATION_EXIT, code as u32];
    // SAFETY: the semihosting call of A32 code: r0 says what, r1 points to two words, which outlive it. Without a debugger it is a
    // supervisor call, whose default handler never returns; lr is then overwritten only in the mode it came from.
    unsafe {
        core::arch::asm!("svc #0x123456", inout("r0") EXIT_EXTENDED => _, in("r1") block.as_ptr(), options(nostack, readonly));
    }
    loop {
        crate::rest::until_packet_or(u32::MAX);
    }
}
