//! The Internet's checksum (RFC 1071): smoltcp's own checks look at slices whose bounds a core would have to check again, with the
//! panic and the formatting of numbers that belong to it, which are kilobytes of code.

/// The sum of the 16-bit words of `bytes`, the last of which may be half a one.
pub(crate) fn sum(bytes: &[u8]) -> u32 {
    let (words, last) = bytes.as_chunks::<2>();
    let words: u32 = words
        .iter()
        .map(|&word| u32::from(u16::from_be_bytes(word)))
        .sum();
    words + last.first().map_or(0, |&byte| u32::from(byte) << 8)
}

/// The checksum of what sums up to `sum`; zero for what has a right checksum in it.
pub(crate) const fn of(sum: u32) -> u16 {
    let sum = (sum >> 16) + (sum & 0xFFFF);
    !(sum + (sum >> 16)) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example of RFC 1071, section 3.
    #[test]
    fn the_published_example() {
        let bytes = [0x00, 0x01, 0xf2, 0x03, 0xf4, 0xf5, 0xf6, 0xf7];
        assert_eq!(sum(&bytes), 0x2_ddf0);
        assert_eq!(of(sum(&bytes)), !0xddf2);
    }

    #[test]
    fn a_last_byte_counts_as_the_upper_half_of_a_word() {
        assert_eq!(sum(&[1, 2, 3]), 0x0102 + 0x0300);
        assert_eq!(of(u32::MAX), 0);
    }
}
