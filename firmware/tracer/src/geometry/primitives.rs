//! All primitives of a scene: one array a kind of shape, numbered through.

use super::Shape;

/// Primitives in a scene, at most: with a material of its own for each, that is what a core's data memory holds.
pub const MAX_PRIMITIVES: usize = 256;

/// The number of a primitive in its scene: kinds in their order, and each kind's in the order of its records.
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub struct PrimitiveId(u32);

impl PrimitiveId {
    /// The number of no primitive. (An `Option` would be asked for its variant at each primitive that a ray may meet.)
    pub const NONE: Self = Self(u32::MAX);

    /// The primitive at `index`, from 0.
    #[inline]
    pub const fn new(index: usize) -> Self {
        Self(index as u32)
    }

    /// Its place, from 0.
    #[inline]
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

/// A set of primitives by their ids.
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub struct PrimitiveSet([u32; PrimitiveSet::WORDS]);

impl PrimitiveSet {
    const WORDS: usize = MAX_PRIMITIVES.div_ceil(32);

    /// No primitive.
    pub const EMPTY: Self = Self([0; Self::WORDS]);

    /// Whether there is none in it.
    pub fn is_empty(&self) -> bool {
        self.0 == [0; Self::WORDS]
    }

    /// Whether it holds a primitive.
    #[inline]
    pub fn contains(&self, primitive: PrimitiveId) -> bool {
        let index = primitive.index();
        self.0
            .get(index / 32)
            .is_some_and(|word| word >> (index % 32) & 1 == 1)
    }

    /// Adds a primitive; those past the most that a scene has are none.
    pub fn insert(&mut self, primitive: PrimitiveId) {
        let index = primitive.index();
        if let Some(word) = self.0.get_mut(index / 32) {
            *word |= 1 << (index % 32);
        }
    }
}

/// What is done with primitives of whichever kind.
pub trait Visitor {
    /// Looks at all primitives of a kind; the first of them has the id of `first`.
    fn visit<S: Shape>(&mut self, first: usize, shapes: &[S]);
}

/// The list of shapes: an array in [`Primitives`], the shape and the arithmetic it needs, in the order of their records.
macro_rules! shapes {
    ($($(#[$meta:meta])* $array:ident: $shape:ident, $numbers:ident;)+) => {
        /// What all shapes together need of the number formats.
        pub trait ShapeNumbers: $($numbers +)+ {}

        impl<N: $($numbers +)+> ShapeNumbers for N {}

        /// Kinds of shape.
        pub const KINDS: usize = [$(stringify!($array)),+].len();

        /// The primitives of a scene.
        #[derive(Clone, Copy, Debug, Default)]
        pub struct Primitives<'s> {
            $($(#[$meta])* pub $array: &'s [$shape],)+
        }

        impl<'s> Primitives<'s> {
            /// Primitives in all.
            pub const fn len(&self) -> usize {
                0 $(+ self.$array.len())+
            }

            /// Whether there is none.
            pub const fn is_empty(&self) -> bool {
                self.len() == 0
            }

            /// Takes the records of so many of each kind from the front of a scene's bytes.
            pub(crate) fn take(
                bytes: &mut &'s [u8],
                [$($array),+]: [u16; KINDS],
            ) -> Result<Self, $crate::blob::BlobError> {
                Ok(Self {
                    $($array: $crate::blob::take_records(bytes, $array)?,)+
                })
            }

            /// Shows a visitor one kind after the other.
            #[inline]
            pub fn visit(&self, visitor: &mut impl $crate::geometry::Visitor) {
                let mut first = 0;
                $(
                    visitor.visit(first, self.$array);
                    first += self.$array.len();
                )+
                let _all = first;
            }

            /// What `f` makes of the one primitive of this id; none where there is none, or none of a kind that it is for.
            #[inline]
            pub fn with<T, F: $crate::geometry::OnShape<T>>(
                &self,
                primitive: $crate::geometry::PrimitiveId,
                f: F,
            ) -> Option<T> {
                let index = primitive.index();
                $(
                    if F::is_for::<$shape>()
                        && let Some(shape) = self.$array.get(index)
                    {
                        return Some(f.call(shape));
                    }
                    let index = index - self.$array.len();
                )+
                let _past_the_last = index;
                None
            }
        }
    };
}

/// A function of one shape of whichever kind.
pub trait OnShape<T> {
    /// Whether it is for this kind: there is no code for the others.
    fn is_for<S: Shape>() -> bool;

    /// Calls it.
    fn call<S: Shape>(self, shape: &S) -> T;
}

pub(super) use shapes;
