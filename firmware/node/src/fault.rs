//! Why a core ends without having been told to, and how the host is told.

use core::fmt;

use tracer::scene::BlobError;
use wire::{Boot, FaultInfo, FromCore, MAX_PAYLOAD, Message, SumsError};

use crate::network::{Network, SendError};

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

/// Tells the host why this core ends, and at which instruction where that is known. Tries once: who sends this has little left to
/// rely on.
#[inline(never)]
pub fn send_fault(
    boot: &Boot<'_>,
    network: &mut dyn Network,
    address: Option<u32>,
    reason: &str,
) -> Result<(), SendError> {
    let mut packet = [0; MAX_PAYLOAD];
    let message = Message::Fault(FaultInfo { address, reason });
    let len = FromCore {
        core: boot.core,
        seq: 0,
        session: boot.session,
        message,
    }
    .encode(&mut packet);
    network.send(packet.get(..len).unwrap_or_default())
}
