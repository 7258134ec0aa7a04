//! Tests that run on a core: one after the other, with a console line each.

use board::Core;
use node::Words;
use runtime::{Board, Exit};

/// Says what a test has found out, if anything is worth saying, or what is wrong.
pub(crate) type Verdict = Result<Option<u64>, &'static str>;

/// A test and its name.
pub(crate) type Test<State> = (&'static str, fn(&mut State) -> Verdict);

/// Runs tests by their names and ends the program. Says `test NAME ok`, with a number if there is one, or `test NAME FAILED`, and
/// why.
pub(crate) fn run<State>(mut state: State, tests: &[Test<State>]) -> ! {
    let mut failed = 0;
    for (name, test) in tests {
        let mut line = Words::of("test ");
        line.and(name);
        match test(&mut state) {
            Ok(None) => line.and(" ok"),
            Ok(Some(number)) => line
                .and(" ok ")
                .hexadecimal((number >> 32) as u32)
                .hexadecimal(number as u32),
            Err(why) => {
                failed += 1;
                line.and(" FAILED: ").and(why)
            }
        };
        Core::say(line.as_str());
    }
    Core::exit(if failed == 0 { Exit::Done } else { Exit::Fault })
}
