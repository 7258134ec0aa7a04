//! What a tracer can do, and what a scene needs of that: the one list, which the scene compiler, the firmware's build script and
//! the tests read.

use core::fmt;

macro_rules! capabilities {
    ($($(#[$meta:meta])* $name:ident = $word:literal,)+) => {
        /// Something that an image has code for only if its scene needs it.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Capability {
            $($(#[$meta])* $name,)+
        }

        impl Capability {
            /// All there are.
            pub const ALL: &'static [Self] = &[$(Self::$name),+];

            /// Its word in lists for people.
            pub const fn word(self) -> &'static str {
                match self {
                    $(Self::$name => $word,)+
                }
            }
        }
    };
}

capabilities! {
    /// A sphere seen from within.
    Hollow = "hollow",
    /// Hollow spheres that are the walls of a [`Room`](crate::aggregate::Room).
    Room = "room",
    /// A sphere seen from without.
    Solid = "solid",
    /// Solids that most rays miss by far: see [`CoarseSphere`](crate::geometry::sphere::CoarseSphere).
    Coarse = "coarse",
    /// A solid that light goes through.
    Inside = "inside",
    /// An opaque solid that camera rays start in.
    TwoSided = "twosided",
    /// A diffuse surface that reflects at all.
    Diffuse = "diffuse",
    /// A mirror.
    Mirror = "mirror",
    /// A dielectric.
    Glass = "glass",
    /// A sphere whose radius 16:16 has no room for.
    Vast = "vast",
    /// Emitters that diffuse surfaces look for: see [`Lights`](crate::light::Lights).
    Lights = "lights",
    /// More than one of them.
    ManyLights = "many-lights",
    /// Such emitters that hollow shapes hide a part of.
    ClippedLights = "clipped-lights",
    /// Such emitters that are balls: see [`BallLight`](crate::light::BallLight).
    BallLights = "ball-lights",
    /// Specular balls that paths are guided to: see [`Guide`](crate::light::Guide).
    Guides = "guides",
    /// Samples by an additive recurrence: see [`Kronecker`](crate::kronecker::Kronecker).
    Kronecker = "kronecker",
    /// Russian roulette; otherwise paths end at a fixed depth.
    Roulette = "roulette",
}

/// A set of capabilities. Its bits, in the order of the list, are part of the scene's format.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub struct Capabilities(u32);

const _: () = assert!(Capability::ALL.len() <= 32);

impl Capabilities {
    /// None at all.
    pub const NONE: Self = Self(0);
    /// Everything there is.
    pub const ALL: Self = Self::of(Capability::ALL);

    /// What paths may need that meet light and do not look for it, with independent samples. All there is does not fit a core together.
    pub const PATHS: Self = Self::ALL
        .without(Capability::Lights)
        .without(Capability::ManyLights)
        .without(Capability::ClippedLights)
        .without(Capability::BallLights)
        .without(Capability::Guides)
        .without(Capability::Kronecker);

    /// The set of these.
    pub const fn of(capabilities: &[Capability]) -> Self {
        let mut set = Self::NONE;
        let mut at = 0;
        while at < capabilities.len() {
            set = set.with(capabilities[at]);
            at += 1;
        }
        set
    }

    /// This set and one more.
    #[must_use]
    pub const fn with(self, capability: Capability) -> Self {
        Self(self.0 | 1 << capability as u32)
    }

    /// This set, and one more on a condition.
    #[must_use]
    pub const fn with_if(self, is_wanted: bool, capability: Capability) -> Self {
        if is_wanted { self.with(capability) } else { self }
    }

    /// This set without one.
    #[must_use]
    pub const fn without(self, capability: Capability) -> Self {
        Self(self.0 & !(1 << capability as u32))
    }

    /// What is in either.
    #[must_use]
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether one is in it.
    pub const fn has(self, capability: Capability) -> bool {
        self.0 >> capability as u32 & 1 == 1
    }

    /// Whether it has all of `other`.
    pub const fn covers(self, other: Self) -> bool {
        other.0 & !self.0 == 0
    }

    /// What is in it, in the list's order.
    pub fn iter(self) -> impl Iterator<Item = Capability> {
        Capability::ALL
            .iter()
            .copied()
            .filter(move |&capability| self.has(capability))
    }
}

impl fmt::Display for Capabilities {
    /// Their words, comma-separated.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (place, capability) in self.iter().enumerate() {
            let comma = if place == 0 { "" } else { "," };
            write!(f, "{comma}{}", capability.word())?;
        }
        Ok(())
    }
}

/// What a scene needs, as a type: code for the rest is not in the image.
pub trait Needs: 'static {
    /// The set.
    const NEEDS: Capabilities;
}

/// Everything the tracer can do; for hosts, where code size is no matter.
#[derive(Clone, Copy, Debug)]
pub enum All {}

impl Needs for All {
    const NEEDS: Capabilities = Capabilities::ALL;
}
