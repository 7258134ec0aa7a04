//! Three-vectors are arrays; these are the few operations that are the same for every number format.

use core::ops::{Add, Neg, Sub};

use super::Directions;

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

/// `a` cross `b`.
pub fn cross<N: Directions>(a: [N::Unit; 3], b: [N::Unit; 3]) -> [N::Unit; 3] {
    let minor = |i: usize, j: usize| N::times(a[i], b[j]) - N::times(a[j], b[i]);
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

/// `d` mirrored in the plane across the unit vector `n`.
pub fn reflected<N: Directions>(d: [N::Unit; 3], n: [N::Unit; 3]) -> [N::Unit; 3] {
    let cosine = N::cosine(d, n);
    N::renormalised([0, 1, 2].map(|i| {
        let share = N::times(n[i], cosine);
        d[i] - share - share
    }))
}
