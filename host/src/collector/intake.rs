//! The judgement of one packet: what it says, or why it does not count.

use std::fmt;

use wire::boot::PixelOrder;
use wire::{DecodeError, FromCore, Hello, Message, Name, Pixels};

use crate::fleet::session::Session;

/// Why a packet does not count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rejection {
    /// The bytes are no packet.
    Malformed(DecodeError),
    /// It belongs to another run.
    Session(u32),
    /// It names a core that is not of this fleet.
    Core(u16),
    /// The core speaks another version of the wire.
    Version(u16),
    /// The core works at another scene.
    Scene(u32),
    /// The core was built for another arithmetic profile.
    Profile(Name),
    /// The pixels are for another camera.
    Epoch(u16),
    /// There is no such unit.
    Unit(u32),
    /// The unit has another number of pixels or samples.
    Shape(u32),
}

impl fmt::Display for Rejection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Malformed(error) => write!(f, "it is malformed: {error}"),
            Self::Session(session) => write!(f, "it is of another run ({session:#010x})"),
            Self::Core(core) => write!(f, "core {core} is not of this fleet"),
            Self::Version(version) => {
                write!(
                    f,
                    "its core speaks version {version} of the wire, this host {}",
                    wire::VERSION
                )
            }
            Self::Scene(scene) => write!(f, "it is of another scene ({scene:#010x})"),
            Self::Profile(profile) => write!(f, "its core was built for profile {profile}"),
            Self::Epoch(epoch) => write!(f, "it is for another camera (epoch {epoch})"),
            Self::Unit(unit) => write!(f, "the picture has no unit {unit}"),
            Self::Shape(unit) => write!(f, "unit {unit} has another number of pixels or samples"),
        }
    }
}

/// Decodes a payload and checks it against the session.
pub fn judge<'a>(session: &Session, payload: &'a [u8]) -> Result<FromCore<'a>, Rejection> {
    let packet = FromCore::decode(payload).map_err(Rejection::Malformed)?;
    if packet.session != session.id {
        return Err(Rejection::Session(packet.session));
    }
    if packet.core >= session.cores {
        return Err(Rejection::Core(packet.core));
    }
    match &packet.message {
        Message::Hello(hello) => judge_hello(session, hello)?,
        Message::Pixels(pixels) => judge_pixels(session, pixels)?,
        Message::Farewell(_) | Message::Fault(_) => {}
    }
    Ok(packet)
}

fn judge_hello(session: &Session, hello: &Hello) -> Result<(), Rejection> {
    if hello.version != wire::VERSION {
        Err(Rejection::Version(hello.version))
    } else if hello.scene != session.scene_id {
        Err(Rejection::Scene(hello.scene))
    } else if hello.profile != session.profile {
        Err(Rejection::Profile(hello.profile))
    } else {
        Ok(())
    }
}

fn judge_pixels(session: &Session, pixels: &Pixels) -> Result<(), Rejection> {
    if pixels.scene != session.scene_id {
        return Err(Rejection::Scene(pixels.scene));
    }
    if pixels.epoch != session.epoch {
        return Err(Rejection::Epoch(pixels.epoch));
    }
    // The stochastic order draws from all ids; those past the picture's own are further passes.
    let is_planned = session.plan.units().is_some_and(|units| pixels.unit < units);
    if !is_planned && session.order != PixelOrder::Stochastic {
        return Err(Rejection::Unit(pixels.unit));
    }
    let extent = session.plan.extent(pixels.unit);
    if pixels.sums.pixels() != extent.pixels || pixels.samples != extent.samples {
        return Err(Rejection::Shape(pixels.unit));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fleet::session::tests::small;
    use wire::{MAX_PAYLOAD, PixelSums};

    fn pixels(session: &Session, unit: u32) -> Pixels {
        Pixels {
            unit,
            epoch: 0,
            samples: 4,
            scene: session.scene_id,
            ticks: 1,
            rays: 1,
            sums: PixelSums::new(&[[1; 3]; 16]).expect("small sums"),
        }
    }

    fn judged(session: &Session, change: impl FnOnce(&mut FromCore<'_>, &mut Pixels)) -> Option<Rejection> {
        let mut pixels = pixels(session, 3);
        let mut packet = FromCore {
            core: 0,
            seq: 0,
            session: session.id,
            message: Message::Pixels(pixels),
        };
        change(&mut packet, &mut pixels);
        packet.message = Message::Pixels(pixels);
        let mut payload = [0; MAX_PAYLOAD];
        let len = packet.encode(&mut payload);
        judge(session, &payload[..len]).err()
    }

    #[test]
    fn each_thing_that_can_be_wrong_is_named() {
        let session = small(2, PixelOrder::Leased);
        assert_eq!(judged(&session, |_, _| {}), None);
        assert_eq!(
            judged(&session, |packet, _| packet.session = 7),
            Some(Rejection::Session(7))
        );
        assert_eq!(
            judged(&session, |packet, _| packet.core = 2),
            Some(Rejection::Core(2))
        );
        assert_eq!(
            judged(&session, |_, pixels| pixels.scene = 9),
            Some(Rejection::Scene(9))
        );
        assert_eq!(
            judged(&session, |_, pixels| pixels.epoch = 1),
            Some(Rejection::Epoch(1))
        );
        assert_eq!(
            judged(&session, |_, pixels| pixels.unit = 40),
            Some(Rejection::Unit(40))
        );
        assert_eq!(
            judged(&session, |_, pixels| pixels.samples = 8),
            Some(Rejection::Shape(3))
        );
        let short = |_: &mut FromCore<'_>, pixels: &mut Pixels| {
            pixels.sums = PixelSums::new(&[[1; 3]; 15]).expect("small sums");
        };
        assert_eq!(judged(&session, short), Some(Rejection::Shape(3)));
        assert!(matches!(
            judge(&session, b"GET / HTTP/1.1"),
            Err(Rejection::Malformed(_))
        ));
    }

    #[test]
    fn only_the_stochastic_order_has_units_past_the_pictures_own() {
        let session = small(1, PixelOrder::Stochastic);
        assert_eq!(judged(&session, |_, pixels| pixels.unit = 4_000_000_000), None);
        let session = small(1, PixelOrder::Sequential);
        let far = judged(&session, |_, pixels| pixels.unit = 4_000_000_000);
        assert_eq!(far, Some(Rejection::Unit(4_000_000_000)));
    }

    #[test]
    fn a_core_with_the_wrong_image_is_told_apart() {
        let session = small(1, PixelOrder::Leased);
        let hello = Hello {
            version: wire::VERSION,
            scene: session.scene_id,
            board: Name::new("versatilepb"),
            profile: session.profile,
        };
        let paper = Name::new("paper");
        assert_eq!(judge_hello(&session, &hello), Ok(()));
        assert_eq!(
            judge_hello(&session, &Hello { version: 9, ..hello }),
            Err(Rejection::Version(9))
        );
        assert_eq!(
            judge_hello(&session, &Hello { scene: 9, ..hello }),
            Err(Rejection::Scene(9))
        );
        assert_eq!(
            judge_hello(
                &session,
                &Hello {
                    profile: paper,
                    ..hello
                }
            ),
            Err(Rejection::Profile(paper))
        );
    }
}
