//! Why a core ends without having been told to.

use core::fmt;

use wire::{Name, SumsError};

/// Why a core ends without having been told to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The image was built for another arithmetic profile than the job is for.
    Profile {
        /// What the boot block asks for.
        wanted: Name,
        /// What the image was built with.
        built: Name,
    },
    /// The scene blob is not one that this image can decode.
    Scene,
    /// The picture has more units than there are ids.
    Units,
    /// The network took no packet in several tries.
    Network,
    /// A unit's sums do not fit a packet.
    Sums(SumsError),
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Profile { wanted, built } => {
                f.write_str("the job is for profile ")?;
                f.write_str(wanted.as_str())?;
                f.write_str(", this image was built for ")?;
                f.write_str(built.as_str())
            }
            Self::Scene => {
                f.write_str("the scene blob does not decode: host and image are of different versions")
            }
            Self::Units => f.write_str("the picture has more units than ids: raise samples per unit"),
            Self::Network => f.write_str("the network takes no packets"),
            Self::Sums(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for Fault {}
