//! Where fields lie. A message states each offset once, in a [`layout!`]; what reads it, what writes it and what tests its
//! documentation take it from there.

use crate::DecodeError;

/// What a field holds: a little-endian number, or bytes as they are.
pub(crate) trait Field: Sized {
    /// Bytes it takes.
    const LEN: usize;

    /// The field that begins at `at`.
    fn read<const N: usize>(message: &[u8; N], at: usize) -> Self;

    /// The same of a message that begins at a multiple of 8, where a field is one load.
    #[inline(always)]
    fn read_aligned<const N: usize>(message: &Aligned<N>, at: usize) -> Self {
        Self::read(&message.0, at)
    }

    /// Puts the field there.
    fn write<const N: usize>(self, message: &mut [u8; N], at: usize);
}

/// A message that begins at a multiple of 8.
#[repr(align(8))]
pub(crate) struct Aligned<const N: usize>(pub(crate) [u8; N]);

impl<const LEN: usize> Field for [u8; LEN] {
    const LEN: usize = LEN;

    #[inline(always)]
    fn read<const N: usize>(message: &[u8; N], at: usize) -> Self {
        core::array::from_fn(|index| message[at + index])
    }

    #[inline(always)]
    fn write<const N: usize>(self, message: &mut [u8; N], at: usize) {
        message[at..at + LEN].copy_from_slice(&self);
    }
}

/// Numbers are taken apart and put together by one small function a width: a core that can only load aligned words takes many
/// instructions for each, and a message has many.
macro_rules! numbers {
    ($($number:ident)*) => {$(
        impl Field for $number {
            const LEN: usize = size_of::<Self>();

            #[inline(always)]
            fn read<const N: usize>(message: &[u8; N], at: usize) -> Self {
                #[inline(never)]
                fn get(bytes: &[u8; size_of::<$number>()]) -> $number {
                    $number::from_le_bytes(*bytes)
                }
                get(message[at..].first_chunk().expect("a layout ends within its message"))
            }

            #[inline(always)]
            fn read_aligned<const N: usize>(message: &Aligned<N>, at: usize) -> Self {
                let bytes = message.0[at..].first_chunk().expect("a layout ends within its message");
                Self::from_le_bytes(*bytes)
            }

            #[inline(always)]
            fn write<const N: usize>(self, message: &mut [u8; N], at: usize) {
                #[inline(never)]
                fn put(number: $number, bytes: &mut [u8; size_of::<$number>()]) {
                    *bytes = number.to_le_bytes();
                }
                put(self, message[at..].first_chunk_mut().expect("a layout ends within its message"));
            }
        }
    )*};
}

numbers!(u8 u16 u32 u64 i32);

/// A field's name, offset and length.
pub(crate) type Place = (&'static str, usize, usize);

/// The fields of a message that have fixed places, as [`layout!`] declares them.
pub(crate) trait Layout: Sized {
    /// Where they are.
    const FIELDS: &'static [Place];
    /// Where the last one ends.
    const END: usize;

    /// The fields of a message, and what follows them.
    fn split(message: &[u8]) -> Result<(Self, &[u8]), DecodeError>;

    /// The same of a message that is copied to where its fields are one load each.
    fn split_aligned(message: &[u8]) -> Result<(Self, &[u8]), DecodeError>;

    /// Puts them into a message.
    fn write<const N: usize>(self, message: &mut [u8; N]);

    /// The fields of a message that ends with them.
    #[inline(always)]
    fn whole(message: &[u8]) -> Result<Self, DecodeError> {
        match Self::split(message)? {
            (fields, []) => Ok(fields),
            _ => Err(DecodeError::TooLong),
        }
    }
}

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

/// Declares the fields of bytes `start..end` of a message, by offset, name and type, as a struct of the values in them. Fields
/// that overlap or leave a gap do not compile.
macro_rules! layout {
    (
        $(#[$attribute:meta])*
        struct $name:ident[$start:tt..$end:tt] { $($at:literal => $field:ident: $kind:ty,)+ }
    ) => {
        $(#[$attribute])*
        #[derive(Clone, Copy)]
        struct $name {
            $($field: $kind,)+
        }

        impl $crate::layout::Layout for $name {
            const FIELDS: &'static [$crate::layout::Place] =
                &[$((stringify!($field), $at, <$kind as $crate::layout::Field>::LEN),)+];
            const END: usize = $end;

            // The length is a constant: a core needs no code to see that no field is out of bounds.
            #[inline(always)]
            fn split(message: &[u8]) -> Result<(Self, &[u8]), $crate::DecodeError> {
                let (front, rest) = message
                    .split_first_chunk::<$end>()
                    .ok_or($crate::DecodeError::Truncated)?;
                let fields = Self { $($field: $crate::layout::Field::read(front, $at),)+ };
                Ok((fields, rest))
            }

            #[inline(always)]
            fn split_aligned(message: &[u8]) -> Result<(Self, &[u8]), $crate::DecodeError> {
                let (front, rest) = message
                    .split_first_chunk::<$end>()
                    .ok_or($crate::DecodeError::Truncated)?;
                let front = $crate::layout::Aligned(*front);
                let fields = Self { $($field: $crate::layout::Field::read_aligned(&front, $at),)+ };
                Ok((fields, rest))
            }

            #[inline(always)]
            fn write<const N: usize>(self, message: &mut [u8; N]) {
                const { assert!($end <= N, "the layout ends within the message") };
                $($crate::layout::Field::write(self.$field, message, $at);)+
            }
        }

        const _: () = assert!($crate::layout::is_contiguous(
            <$name as $crate::layout::Layout>::FIELDS,
            $start,
            $end,
        ));
    };
}

pub(crate) use layout;

#[cfg(test)]
pub(crate) mod tests {
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
        let mut bytes = [0; 15];
        sample.write(&mut bytes);
        assert_eq!(bytes, [0, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 0]);
        let (read, rest) = Sample::split(&bytes).expect("it is long enough");
        assert_eq!((read.word, rest), (sample.word, &[0][..]));
        assert!(Sample::whole(&bytes[..14]).is_ok());
        assert_eq!(Sample::whole(&bytes).err(), Some(DecodeError::TooLong));
        assert_eq!(Sample::split(&bytes[..13]).err(), Some(DecodeError::Truncated));
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

    const DISSECTOR: &str = include_str!("../../../docs/sdp.lua");

    /// What stands between two texts in the dissector that shows Wireshark our packets.
    pub(crate) fn dissector(from: &str, to: &str) -> &'static str {
        let (_, text) = DISSECTOR.split_once(from).expect("the dissector has it");
        text.split_once(to).expect("and it ends").0
    }

    /// Checks a part of the dissector: what it takes from the bytes of a layout, it takes by the layout's names from the layout's
    /// places, and it looks at all of them.
    pub(crate) fn assert_placed(part: &str, fields: &[Place]) {
        let end = fields.last().map_or(0, |&(_, at, len)| at + len);
        // What the dissector works out has no place.
        let from_bytes = |line: &&str| line.trim().starts_with("tree:add") && !line.contains("set_generated");
        for line in part.lines().filter(from_bytes) {
            let (_, call) = line.split_once("f.").expect("a field");
            let (name, place) = call.split_once(", packet(").expect("its place");
            let mut numbers = place.split([',', ')']).map_while(|word| word.trim().parse().ok());
            if let (Some(at), Some(len)) = (numbers.next(), numbers.next())
                && at < end
            {
                assert!(fields.contains(&(name, at, len)), "{line}");
            }
        }
        for (name, at, len) in fields {
            assert!(part.contains(&std::format!("packet({at}, {len})")), "{name}");
        }
    }

    /// Checks what the dissector makes of a command that has at least so many bytes.
    pub(crate) fn assert_dissected(name: &str, command: u16, fields: &[Place], least: usize) {
        let code = std::format!("[{command:#06x}] = \"{name}\"");
        assert!(dissector("local COMMANDS = {", "}").contains(&code), "{code}");
        let shortest = std::format!(" {name} = {least} ");
        let list = dissector("local LEAST = {", "}").replace(',', " ");
        assert!(list.contains(&shortest), "{shortest} in {list}");
        let body = dissector(&std::format!("    {name} = function"), "\n    end");
        assert_placed(body, fields);
    }
}
