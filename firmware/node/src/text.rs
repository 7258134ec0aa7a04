//! Text put together where there is no room for formatting.

use heapless::String;
use wire::MAX_REASON;

use crate::division::quotient;

/// A line put together without `core::fmt`, which would cost kilobytes of code memory. It is as long as the reason that a FAULT
/// carries; what does not fit is cut.
#[derive(Debug)]
pub struct Text(String<MAX_REASON>);

impl From<&str> for Text {
    #[inline(never)]
    fn from(text: &str) -> Self {
        let mut line = Self(String::new());
        line.push_str(text);
        line
    }
}

/// Never inlined: lines are seldom written, and each call takes few instructions.
impl Text {
    /// Appends a text.
    #[inline(never)]
    pub fn push_str(&mut self, text: &str) -> &mut Self {
        let room = MAX_REASON - self.0.len();
        let fitting = text.get(..text.floor_char_boundary(room)).unwrap_or_default();
        // It fits: it has just been cut to the room there is.
        let _ = self.0.push_str(fitting);
        self
    }

    /// Appends a number in decimal.
    #[inline(never)]
    pub fn push_decimal(&mut self, number: u32) -> &mut Self {
        let tens = quotient(number, 10);
        if tens > 0 {
            self.push_decimal(tens);
        }
        self.push_digit(number - 10 * tens)
    }

    /// Appends a number as eight hexadecimal digits.
    #[inline(never)]
    pub fn push_hex(&mut self, number: u32) -> &mut Self {
        for shift in (0..u32::BITS).step_by(4).rev() {
            self.push_digit(number >> shift & 15);
        }
        self
    }

    /// The text so far.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    fn push_digit(&mut self, digit: u32) -> &mut Self {
        const DIGITS: &str = "0123456789abcdef";
        let at = digit as usize;
        self.push_str(DIGITS.get(at..at + 1).unwrap_or_default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_and_numbers() {
        let mut text = Text::from("at ");
        text.push_decimal(0)
            .push_str(":")
            .push_decimal(u32::MAX)
            .push_str(" 0x")
            .push_hex(0x0BEE_F042);
        assert_eq!(text.as_str(), "at 0:4294967295 0x0beef042");
    }

    #[test]
    fn what_does_not_fit_is_cut_between_characters() {
        let mut text = Text::from("x");
        for _ in 0..200 {
            text.push_str("é");
        }
        assert_eq!(text.as_str().len(), 255);
        assert_eq!(text.push_str("more").as_str().len(), 256);
    }
}
