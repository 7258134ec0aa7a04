//! Why a core ends without having been told to.

use core::fmt;

use tracer::scene::BlobError;
use wire::SumsError;

/// Why a core ends without having been told to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The image was built for another arithmetic profile than the job is for.
    Profile,
    /// The scene blob is not one that this image can decode.
    Scene,
    /// The scene needs a material that this image was built without.
    Material,
    /// The picture has more units than there are ids.
    Units,
    /// The network took no packet in several tries.
    Network,
    /// A unit's sums do not fit a packet.
    Sums(SumsError),
}

impl Fault {
    /// The fault in words, without formatting, for which boards have no room.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Profile => "this image was built for another arithmetic profile than the job is for",
            Self::Scene => "the scene blob does not decode: host and image are of different versions",
            Self::Material => {
                "the scene needs a material that this image was built without: see TRACER_NEEDS"
            }
            Self::Units => "the picture has more units than ids: raise the samples per unit",
            Self::Network => "the network takes no packets",
            Self::Sums(error) => error.as_str(),
        }
    }
}

impl From<BlobError> for Fault {
    fn from(error: BlobError) -> Self {
        match error {
            BlobError::NotInThisImage => Self::Material,
            _ => Self::Scene,
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl core::error::Error for Fault {}
