//! What a program says: its results on standard output, all else on standard error.
//!
//! The macros for that panic where the reader has gone or the disk is full. Here a result that cannot be written is an error
//! like any other, and a note that cannot be written is dropped: nobody is left to be told.

use std::error::Error;
use std::fmt::Display;
use std::io::{self, ErrorKind, Write};
use std::iter;
use std::process::ExitCode;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};

/// How long nothing may be said.
const SILENCE: Duration = Duration::from_secs(5);

/// The exit code where the reader of the results has gone: that of a program which the system ends for it by SIGPIPE.
pub const CLOSED_PIPE: u8 = 128 + 13;

/// Results that could not be written to standard output.
#[derive(Debug, thiserror::Error)]
#[error("cannot write to standard output")]
pub struct OutputError(#[from] io::Error);

impl OutputError {
    /// Ends a program that has this error: with a note, or quietly where the reader has gone, which is no fault.
    pub fn end(&self) -> ExitCode {
        if self.0.kind() == ErrorKind::BrokenPipe {
            return ExitCode::from(CLOSED_PIPE);
        }
        note(format!("error: {}", in_full(self)));
        ExitCode::FAILURE
    }
}

/// Writes a line, or several, of the results.
pub fn say(text: impl Display) -> Result<(), OutputError> {
    put(format!("{text}\n").as_bytes())
}

/// Writes results that need not be text.
pub fn put(bytes: &[u8]) -> Result<(), OutputError> {
    let mut output = io::stdout().lock();
    output.write_all(bytes)?;
    Ok(output.flush()?)
}

/// An error with what caused it, each in its own words.
pub fn in_full(error: &dyn Error) -> String {
    let causes = iter::successors(error.source(), |&cause| cause.source());
    causes.fold(error.to_string(), |text, cause| format!("{text}: {cause}"))
}

/// Tells whoever watches.
pub fn note(text: impl Display) {
    // In one piece, so that no other program's line comes between.
    let _nobody_watches = io::stderr().write_all(format!("{text}\n").as_bytes());
}

/// A bar on the terminal, with a message in front.
pub fn bar(message: &'static str) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg} {bar:40} {percent:>3} %, {eta} to go");
    ProgressBar::new(0)
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        .with_message(message)
}

/// Does what may take its time; whoever watches is told now and then that it goes on, in the words of `what`.
pub fn patiently<T>(what: &str, action: impl FnOnce() -> T) -> T {
    let tell = |time: Duration| note(format!("{what}, for {} s so far", time.as_secs()));
    with_ticks(SILENCE, tell, action)
}

/// Calls `tick` after each `interval` until `action` is done.
fn with_ticks<T>(interval: Duration, tick: impl Fn(Duration) + Send, action: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let (doing, done) = mpsc::channel::<()>();
    thread::scope(|scope| {
        scope.spawn(move || {
            while done.recv_timeout(interval) == Err(RecvTimeoutError::Timeout) {
                tick(start.elapsed());
            }
        });
        // Dropped at the end, also that of a panic.
        let _doing = doing;
        action()
    })
}

/// The program's arguments. What else there may be to say about them (help, the version, a fault) is said, and the program
/// then ends with the exit code.
pub fn arguments<P: Parser>() -> Result<P, ExitCode> {
    P::try_parse().map_err(|answer| {
        let said = answer.print().and_then(|()| io::stdout().flush());
        match said {
            Err(cause) if !answer.use_stderr() => OutputError(cause).end(),
            _ => ExitCode::from(answer.exit_code() as u8),
        }
    })
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU32, Ordering};

    use super::*;

    #[test]
    fn what_takes_long_ticks_until_it_is_done() {
        let (interval, ticks) = (Duration::from_millis(20), AtomicU32::new(0));
        let count = |_| {
            ticks.fetch_add(1, Ordering::Relaxed);
        };
        assert_eq!(with_ticks(Duration::from_secs(60), count, || 7), 7);
        assert_eq!(ticks.load(Ordering::Relaxed), 0);
        let long = || {
            while ticks.load(Ordering::Relaxed) < 3 {
                thread::yield_now();
            }
        };
        with_ticks(interval, count, long);
    }
}
