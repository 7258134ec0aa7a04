//! Tests that run on a core: one after the other, with a console line each.

use board::Core;
use node::Text;
use runtime::{Board, ExitCode};

/// Says what a test has found out, if anything is worth saying, or what is wrong.
pub(crate) type Verdict = Result<Option<u64>, &'static str>;

/// A test and its name.
pub(crate) type Test<State> = (&'static str, fn(&mut State) -> Verdict);

runtime::report_panics!(board::Core);

/// Runs tests by their names and ends the program. Says `test NAME ok`, with a number if there is one, or `test NAME FAILED`, and
/// why.
pub(crate) fn run<State>(mut state: State, tests: &[Test<State>]) -> ! {
    let mut failed = 0;
    for (name, test) in tests {
        let mut line = Text::from("test ");
        line.push_str(name);
        match test(&mut state) {
            Ok(None) => line.push_str(" ok"),
            Ok(Some(number)) => line
                .push_str(" ok ")
                .push_hex((number >> 32) as u32)
                .push_hex(number as u32),
            Err(why) => {
                failed += 1;
                line.push_str(" FAILED: ").push_str(why)
            }
        };
        Core::println(line.as_str());
    }
    Core::exit(if failed == 0 {
        ExitCode::Success
    } else {
        ExitCode::Fault
    })
}
