//! Ctrl-C, a closed terminal and a polite kill: all ask for an orderly end.

use std::sync::atomic::{AtomicBool, Ordering};

/// The exit code of a program that was interrupted.
pub const EXIT_CODE: u8 = 130;

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// From now on an interruption sets the returned flag; a second one ends the program at once.
pub fn watch() -> Result<&'static AtomicBool, ctrlc::Error> {
    ctrlc::set_handler(|| {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            std::process::exit(EXIT_CODE.into());
        }
    })?;
    Ok(&INTERRUPTED)
}

/// From now on an interruption is left to the child that has the terminal, and means nothing here.
pub fn leave_to_child() -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(|| ())
}
