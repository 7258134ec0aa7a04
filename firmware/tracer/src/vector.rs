//! Three-vectors are arrays; these are the few operations that are the same for every component type.

use core::ops::{Add, Neg, Sub};

/// `a + b`.
#[inline]
pub fn add<T: Copy + Add<Output = T>>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// `a - b`.
#[inline]
pub fn sub<T: Copy + Sub<Output = T>>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `-a`.
#[inline]
pub fn neg<T: Copy + Neg<Output = T>>(a: [T; 3]) -> [T; 3] {
    [-a[0], -a[1], -a[2]]
}
