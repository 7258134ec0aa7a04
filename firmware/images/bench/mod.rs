//! What the price list's images share: the core as a bench, and a console line a row.

use board::Core;
use node::{Clock as _, Text};
use operations::price::{Bench, Price, called, price};
use operations::transcript::transcript;
use operations::{Group, Variant, Visitor};
use panic_halt as _;
use runtime::clock::Clock;
use runtime::{Board, ExitCode};

/// The core that measures itself.
pub(crate) struct Itself(Clock<Core>);

impl Itself {
    pub(crate) fn start() -> Self {
        Self(Clock::start())
    }
}

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
pub(crate) struct Printer {
    row: u32,
    cases: u32,
}

/// What an image measures.
pub(crate) trait Prices {
    /// Inputs of each transcript; 0 where there is none.
    fn cases(&self) -> u32;
    /// Prints a row for each variant.
    fn show(self, printer: &mut Printer);
}

impl Prices for Group {
    #[inline(always)]
    fn cases(&self) -> u32 {
        self.transcript_cases()
    }

    #[inline(always)]
    fn show(self, printer: &mut Printer) {
        Group::show(self, printer);
    }
}

/// Prints the rows and ends the program.
#[inline(always)]
pub(crate) fn print(prices: impl Prices) -> ! {
    let cases = prices.cases();
    prices.show(&mut Printer { row: 0, cases });
    Core::exit(ExitCode::Success)
}

impl Visitor for Printer {
    #[inline(never)]
    fn visit<V: Variant>(&mut self) {
        let price = price::<V>(&mut Itself::start());
        let hash = transcript::<V>(self.cases);
        self.line(price, hash, called::<V> as *const () as u32);
    }
}

impl Printer {
    /// One row. Without a transcript its hash is 0, and so is the address of what is not called.
    pub(crate) fn line(&mut self, price: Price, hash: u64, address: u32) {
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
