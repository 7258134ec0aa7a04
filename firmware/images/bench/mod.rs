//! What the price list's images share: the core as a bench, and a console line a row.

use board::Core;
use node::{Clock as _, Text};
use operations::price::{Bench, Price, called, price};
use operations::transcript::transcript;
use operations::{Group, Variant, Visitor, intersection};
use panic_halt as _;
use runtime::clock::Clock;
use runtime::{Board, ExitCode};

/// The core that measures itself.
struct Itself(Clock<Core>);

impl Bench for Itself {
    fn ticks(&mut self) -> u32 {
        self.0.ticks()
    }

    #[inline(always)]
    fn opaque(mut word: u32) -> u32 {
        // SAFETY: no instruction at all. That it may touch memory is only what the compiler is told.
        unsafe { core::arch::asm!("@ {0}", inout(reg) word, options(nostack, preserves_flags)) };
        word
    }
}

/// Prints what it measures.
struct Printer {
    row: u32,
    cases: u32,
}

/// Prints the rows of a group and ends the program.
#[allow(dead_code, reason = "an image prints a group or the intersections")]
#[inline(always)]
pub(crate) fn print(group: Group) -> ! {
    let cases = group.transcript_cases();
    group.show(&mut Printer { row: 0, cases });
    Core::exit(ExitCode::Success)
}

/// Prints what the formulas that meet a sphere cost, and ends the program. They have no transcript.
#[allow(dead_code, reason = "an image prints a group or the intersections")]
#[inline(always)]
pub(crate) fn print_intersections() -> ! {
    let mut printer = Printer { row: 0, cases: 0 };
    intersection::show(&mut Itself(Clock::start()), |price| printer.line(price, 0, 0));
    Core::exit(ExitCode::Success)
}

impl Visitor for Printer {
    #[inline(never)]
    fn visit<V: Variant>(&mut self) {
        let price = price::<V>(&mut Itself(Clock::start()));
        let hash = transcript::<V>(self.cases);
        self.line(price, hash, called::<V> as *const () as u32);
    }
}

impl Printer {
    fn line(&mut self, price: Price, hash: u64, address: u32) {
        let mut line = Text::from("row");
        for word in [
            self.row,
            self.cases,
            price.baseline,
            price.inline,
            price.called,
            (hash >> 32) as u32,
            hash as u32,
            address,
        ] {
            line.push_str(" ").push_hex(word);
        }
        Core::println(line.as_str());
        self.row += 1;
    }
}
