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
    /// A text is not printable ASCII (names) or not UTF-8 (the reason of a FAULT).
    Text,
    /// A boot block does not start with its magic number: nothing was loaded at that address.
    Magic,
    /// The other side speaks another version of the format; the number is its version.
    Version(u16),
    /// A checksum does not match: the bytes were damaged or cut.
    Checksum,
}

impl DecodeError {
    /// The error in words, without numbers: for boards that have no room for formatting.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Truncated => "the bytes end before the fields do",
            Self::TooLong => "there are bytes after the last field",
            Self::Padding => "the padding is not zero",
            Self::Address => "the SDP addresses do not name a core and the host",
            Self::Command(_) => "the command is not known",
            Self::Range => "a count or size is outside its range",
            Self::Text => "a text is not readable",
            Self::Magic => "the magic number is missing: nothing was loaded there",
            Self::Version(_) => "the other side speaks another version of the format",
            Self::Checksum => "a checksum does not match: the bytes were damaged or cut",
        }
    }
}

impl fmt::Display for DecodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Command(code) => write!(f, "{}: {code:#06x}", self.as_str()),
            Self::Version(version) => write!(f, "{}: {version}, not {}", self.as_str(), crate::VERSION),
            _ => f.write_str(self.as_str()),
        }
    }
}

impl core::error::Error for DecodeError {}
