//! The end of the program, by a debugger's, here QEMU's, exit call.

use runtime::ExitCode;

/// Ends the program. The call's number is that of A32 code, whatever code the rest of the image is.
#[instruction_set(arm::a32)]
#[inline(never)]
pub fn exit(code: ExitCode) -> ! {
    let block = code.semihosting();
    // SAFETY: the semihosting call of A32 code: r0 says what, r1 points to two words, which outlive it. Without a debugger it is a
    // supervisor call, whose default handler never returns; lr is then overwritten only in the mode it came from.
    unsafe {
        core::arch::asm!("svc #0x123456", inout("r0") ExitCode::SEMIHOSTING_OPERATION => _, in("r1") block.as_ptr(), options(nostack, readonly));
    }
    loop {
        crate::sleep::until_packet_or_timeout(u32::MAX);
    }
}
