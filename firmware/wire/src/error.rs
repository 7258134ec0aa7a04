//! Why bytes were refused.

use core::fmt;

/// Why a packet or a boot block was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DecodeError {
    /// The bytes end before the fields do.
    Truncated,
    /// There are bytes after the last field.
    TooLong,
    /// The two padding bytes are not zero.
    Padding,
    /// The SDP addresses name no core, or not the other end.
    Address,
    /// The command is not one of this direction's; the number is its code.
    Command(u16),
    /// A count or size is outside its range: no pixels, an odd number of samples, a lease of nothing.
    Range,
    /// A text is not printable ASCII (names) or not UTF-8 (last words).
    Text,
    /// A boot block does not start with its magic number: nothing was loaded at that address.
    Magic,
    /// The other side speaks another version of the format; the number is its version.
    Version(u16),
    /// A checksum does not match: the bytes were damaged or cut.
    Checksum,
}

impl fmt::Display for DecodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Truncated => "the bytes end before the fields do",
            Self::TooLong => "there are bytes after the last field",
            Self::Padding => "the padding is not zero",
            Self::Address => "the SDP addresses do not name a core and the host",
            Self::Command(code) => return write!(f, "unknown command {code:#06x}"),
            Self::Range => "a count or size is outside its range",
            Self::Text => "a text is not readable",
            Self::Magic => "the magic number is missing: nothing was loaded there",
            Self::Version(version) => {
                return write!(
                    f,
                    "version {version} of the format, where this side speaks {}",
                    crate::VERSION
                );
            }
            Self::Checksum => "a checksum does not match: the bytes were damaged or cut",
        })
    }
}

impl core::error::Error for DecodeError {}
