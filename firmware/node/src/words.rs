//! Last words, put together where there is no room for formatting.

use wire::MAX_DATA;

/// A text put together without `core::fmt`, which would cost 3 KiB of code memory. What does not fit is cut.
#[derive(Debug)]
pub struct Words {
    text: [u8; MAX_DATA],
    len: usize,
}

/// Never inlined: last words are seldom said, and each of their parts in few instructions.
impl Words {
    /// A text that begins so.
    #[inline(never)]
    pub fn of(text: &str) -> Self {
        let mut words = Self {
            text: [0; MAX_DATA],
            len: 0,
        };
        words.and(text);
        words
    }

    /// Appends a text.
    #[inline(never)]
    pub fn and(&mut self, text: &str) -> &mut Self {
        text.bytes().for_each(|byte| self.push(byte));
        self
    }

    /// Appends a number in decimal.
    #[inline(never)]
    pub fn decimal(&mut self, number: u32) -> &mut Self {
        if number >= 10 {
            self.decimal(number / 10);
        }
        self.push(b'0' + (number % 10) as u8);
        self
    }

    /// Appends a number as eight hexadecimal digits.
    #[inline(never)]
    pub fn hexadecimal(&mut self, number: u32) -> &mut Self {
        for shift in (0..u32::BITS).step_by(4).rev() {
            let digit = (number >> shift) as u8 & 15;
            self.push(if digit < 10 {
                b'0' + digit
            } else {
                b'a' - 10 + digit
            });
        }
        self
    }

    /// The text so far, without the first half of a character that was cut in two.
    pub fn as_str(&self) -> &str {
        let text = self.text.get(..self.len).unwrap_or_default();
        match str::from_utf8(text) {
            Ok(text) => text,
            Err(error) => str::from_utf8(&text[..error.valid_up_to()]).unwrap_or_default(),
        }
    }

    fn push(&mut self, byte: u8) {
        if let Some(slot) = self.text.get_mut(self.len) {
            *slot = byte;
            self.len += 1;
        }
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
        assert_eq!(words.and("more").as_str().len(), 255);
    }
}
