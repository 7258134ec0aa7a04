//! Short names of fixed width.

use core::fmt;

use crate::DecodeError;

/// A name of at most 12 printable ASCII characters, padded with zero bytes.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Name([u8; Name::LEN]);

impl Name {
    /// Bytes a name takes on the wire.
    pub const LEN: usize = 12;

    /// The name; cut after 12 characters, and every character that is not printable ASCII replaced by `?`.
    pub const fn new(name: &str) -> Self {
        let (name, mut padded, mut at) = (name.as_bytes(), [0; Self::LEN], 0);
        while at < name.len() && at < Self::LEN {
            padded[at] = if name[at].is_ascii_graphic() {
                name[at]
            } else {
                b'?'
            };
            at += 1;
        }
        Self(padded)
    }

    /// The name without its padding.
    pub fn as_str(&self) -> &str {
        let len = self.0.iter().position(|&byte| byte == 0).unwrap_or(Self::LEN);
        // Both constructors let only ASCII in, so the empty string never stands for a name.
        core::str::from_utf8(&self.0[..len]).unwrap_or_default()
    }

    pub(crate) fn to_bytes(self) -> [u8; Self::LEN] {
        self.0
    }

    pub(crate) fn from_bytes(bytes: [u8; Self::LEN]) -> Result<Self, DecodeError> {
        let len = bytes.iter().position(|&byte| byte == 0).unwrap_or(Self::LEN);
        let (name, padding) = bytes.split_at(len);
        if name.iter().all(u8::is_ascii_graphic) && padding.iter().all(|&byte| byte == 0) {
            Ok(Self(bytes))
        } else {
            Err(DecodeError::Text)
        }
    }
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl fmt::Debug for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.as_str(), f)
    }
}
