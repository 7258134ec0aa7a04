//! The fast part of `cargo xtask verify stability`: what should hold in hard cases does, in a hundredth of them.

use host::stability::{Effort, PARTS};
use indicatif::ProgressBar;

/// Parts that have nothing to find but figures for people are left out.
const JUDGED: [&str; 1] = ["convergence"];

#[test]
fn what_should_hold_does() {
    for name in JUDGED {
        let part = PARTS
            .iter()
            .find(|part| part.name == name)
            .expect("there is such a part");
        let findings = (part.measure)(&Effort::new(true, ProgressBar::hidden()));
        let findings = findings.unwrap_or_else(|error| panic!("{name}: {error}"));
        for table in &findings.tables {
            println!("{table}");
        }
        assert!(findings.faults.is_empty(), "{name}: {:#?}", findings.faults);
    }
}
