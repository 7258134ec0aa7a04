//! Last words, put together where there is no room for formatting.

use heapless::String;
use wire::MAX_REASON;

/// A text put together without `core::fmt`, which would cost kilobytes of code memory. What does not fit is cut.
#[derive(Debug)]
pub struct Words(String<MAX_REASON>);

/// Never inlined: last words are seldom said, and each of their parts in few instructions.
impl Words {
    /// A text that begins so.
    #[inline(never)]
    pub fn of(text: &str) -> Self {
        let mut words = Self(String::new());
        words.and(text);
        words
    }

    /// Appends a text.
    #[inline(never)]
    pub fn and(&mut self, text: &str) -> &mut Self {
        let room = MAX_REASON - self.0.len();
        let fitting = text.get(..text.floor_char_boundary(room)).unwrap_or_default();
        // It fits: it has just been cut to the room there is.
        let _ = self.0.push_str(fitting);
        self
    }

    /// Appends a number in decimal.
    #[inline(never)]
    pub fn decimal(&mut self, number: u32) -> &mut Self {
        if number >= 10 {
            self.decimal(number / 10);
        }
        self.digit(number % 10)
    }

    /// Appends a number as eight hexadecimal digits.
    #[inline(never)]
    pub fn hexadecimal(&mut self, number: u32) -> &mut Self {
        for shift in (0..u32::BITS).step_by(4).rev() {
            self.digit(number >> shift & 15);
        }
        self
    }

    /// The text so far.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    fn digit(&mut self, digit: u32) -> &mut Self {
        const DIGITS: &str = "0123456789abcdef";
        let at = digit as usize;
        self.and(DIGITS.get(at..at + 1).unwrap_or_default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_and_numbers() {
        let mut words = Words::of("at ");
        words
            .decimal(0)
            .and(":")
            .decimal(u32::MAX)
            .and(" 0x")
            .hexadecimal(0x0BEE_F042);
        assert_eq!(words.as_str(), "at 0:4294967295 0x0beef042");
    }

    #[test]
    fn what_does_not_fit_is_cut_between_characters() {
        let mut words = Words::of("x");
        for _ in 0..200 {
            words.and("é");
        }
        assert_eq!(words.as_str().len(), 255);
        assert_eq!(words.and("more").as_str().len(), 256);
    }
}
