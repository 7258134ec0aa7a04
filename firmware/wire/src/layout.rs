//! Where fields lie. A message states each offset once, in a [`layout!`]; what reads it, what writes it and what tests its
//! documentation take it from there.

/// What a field holds: a little-endian number, or bytes as they are.
pub(crate) trait Field: Sized {
    /// Bytes it takes.
    const LEN: usize;

    /// The field that begins at `at`.
    fn read(bytes: &[u8], at: usize) -> Self;

    /// Puts the field there.
    fn write(self, bytes: &mut [u8], at: usize);
}

macro_rules! numbers {
    ($($number:ty)*) => {$(
        impl Field for $number {
            const LEN: usize = size_of::<Self>();

            #[inline(always)]
            fn read(bytes: &[u8], at: usize) -> Self {
                Self::from_le_bytes(Field::read(bytes, at))
            }

            #[inline(always)]
            fn write(self, bytes: &mut [u8], at: usize) {
                self.to_le_bytes().write(bytes, at);
            }
        }
    )*};
}

numbers!(u8 u16 u32 u64 i32);

impl<const N: usize> Field for [u8; N] {
    const LEN: usize = N;

    #[inline(always)]
    fn read(bytes: &[u8], at: usize) -> Self {
        core::array::from_fn(|index| bytes[at + index])
    }

    #[inline(always)]
    fn write(self, bytes: &mut [u8], at: usize) {
        bytes[at..at + N].copy_from_slice(&self);
    }
}

/// A field's name, offset and length.
pub(crate) type Place = (&'static str, usize, usize);

/// Whether fields fill the bytes from `start` to `end`, one right after the other.
pub(crate) const fn is_contiguous(fields: &[Place], start: usize, end: usize) -> bool {
    let (mut next, mut index) = (start, 0);
    while index < fields.len() {
        let (_, at, len) = fields[index];
        if at != next {
            return false;
        }
        (next, index) = (at + len, index + 1);
    }
    next == end
}

/// Declares the fields of bytes `start..end` of a message, by offset, name and type, as a struct of the values in them. Its
/// `read` and `write` work on an array of just these bytes, so that no field can be out of bounds, and a core needs no code to
/// see that. Fields that overlap or leave a gap do not compile.
macro_rules! layout {
    (
        $(#[$attribute:meta])*
        struct $name:ident[$start:tt..$end:tt] { $($at:literal => $field:ident: $kind:ty,)+ }
    ) => {
        $(#[$attribute])*
        #[derive(Clone, Copy)]
        pub(crate) struct $name {
            $(pub(crate) $field: $kind,)+
        }

        impl $name {
            pub(crate) const LEN: usize = $end - $start;
            pub(crate) const FIELDS: &[$crate::layout::Place] =
                &[$((stringify!($field), $at, <$kind as $crate::layout::Field>::LEN),)+];

            #[inline(always)]
            pub(crate) fn read(bytes: &[u8; Self::LEN]) -> Self {
                Self { $($field: $crate::layout::Field::read(bytes, $at - $start),)+ }
            }

            #[inline(always)]
            pub(crate) fn write(self, bytes: &mut [u8; Self::LEN]) {
                $($crate::layout::Field::write(self.$field, bytes, $at - $start);)+
            }
        }

        const _: () = assert!($crate::layout::is_contiguous($name::FIELDS, $start, $end));
    };
}

pub(crate) use layout;

#[cfg(test)]
pub(crate) mod tests {
    extern crate std;

    use std::borrow::ToOwned;
    use std::string::String;
    use std::vec::Vec;

    use super::*;

    layout! {
        struct Sample[4..14] {
            4 => byte: u8,
            5 => bytes: [u8; 3],
            8 => word: u32,
            12 => half: u16,
        }
    }

    #[test]
    fn fields_are_little_endian_at_their_offsets() {
        let sample = Sample {
            byte: 1,
            bytes: [2, 3, 4],
            word: 0x0807_0605,
            half: 0x0A09,
        };
        let mut bytes = [0; Sample::LEN];
        sample.write(&mut bytes);
        assert_eq!(bytes, [1, 2, 3, 4, 5, 6, 7, 8, 9, 10]);
        assert_eq!(Sample::read(&bytes).word, sample.word);
    }

    #[test]
    fn a_gap_an_overlap_and_another_length_are_seen() {
        assert!(is_contiguous(Sample::FIELDS, 4, 14));
        assert!(!is_contiguous(Sample::FIELDS, 4, 15));
        assert!(!is_contiguous(Sample::FIELDS, 3, 14));
        assert!(!is_contiguous(&[("a", 0, 2), ("b", 1, 1)], 0, 2));
        assert!(!is_contiguous(&[("a", 0, 2), ("b", 3, 1)], 0, 4));
    }

    /// Checks the first table of offsets after `heading` in a module's documentation: a row a field, which begins with the
    /// field's name. Rows that name no single number of bytes are not of the layout.
    pub(crate) fn assert_documented(source: &str, heading: &str, fields: &[Place]) {
        let (_, text) = source.split_once(heading).expect("the heading is there");
        let rows = text
            .lines()
            .map(|line| line.trim_start_matches("//! "))
            .skip_while(|line| !line.starts_with('|'))
            .take_while(|line| line.starts_with('|'));
        let documented: Vec<(String, usize, usize)> = rows
            .filter_map(|row| {
                let mut cells = row.trim_matches('|').split('|').map(str::trim);
                let (at, len, words) = (cells.next()?, cells.next()?, cells.next()?);
                let name = words.split([':', ',', '(']).next()?;
                Some((
                    name.trim().replace([' ', '-'], "_").to_lowercase(),
                    at.parse().ok()?,
                    len.parse().ok()?,
                ))
            })
            .collect();
        let stated: Vec<_> = fields
            .iter()
            .map(|&(name, at, len)| (name.to_owned(), at, len))
            .collect();
        assert_eq!(documented, stated, "after {heading:?}");
    }
}
