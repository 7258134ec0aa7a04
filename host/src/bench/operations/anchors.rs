//! Quoted figures: libraries in C, measured on the same emulated core beforehand and not by this program.
//!
//! gcc 12 with `-O3 -mcpu=arm968e-s -marm`, QEMU 7.2, loop overhead subtracted; newlib and libgcc for single precision.

use crate::firmware::board::Board;

/// The board whose core they were measured on.
pub const BOARD: Board = Board::Versatilepb;

/// A quoted figure.
#[derive(Clone, Copy, Debug)]
pub struct Anchor {
    /// The operation, as the list names it.
    pub op: &'static str,
    /// The library.
    pub library: &'static str,
    /// Instructions.
    pub instructions: f64,
    /// The worst error in ulp of 2^-16; none for single precision, whose results are those of the list's own such rows.
    pub max_error_ulp: Option<f64>,
}

const fn anchor(op: &'static str, library: &'static str, instructions: f64, error: Option<f64>) -> Anchor {
    Anchor {
        op,
        library,
        instructions,
        max_error_ulp: error,
    }
}

const LIBFIXMATH: &str = "libfixmath";
const NEWLIB: &str = "newlib f32";

/// All of them. libfixmath's sine has its cache and table off in the first of the two, and a table of 200 KiB in the other;
/// its error is for |x| < 32.
pub const ANCHORS: [Anchor; 11] = [
    anchor("multiply", LIBFIXMATH, 12.5, Some(0.50)),
    anchor("divide", LIBFIXMATH, 259.0, Some(0.52)),
    anchor("square root", LIBFIXMATH, 165.0, Some(0.50)),
    anchor("sine", LIBFIXMATH, 132.0, Some(495.0)),
    anchor("sine", "libfixmath, 200 KiB", 27.0, Some(4.6)),
    anchor("angle of a vector", LIBFIXMATH, 355.0, Some(665.0)),
    anchor("exponential", LIBFIXMATH, 3088.0, Some(2783.0)),
    anchor("multiply", NEWLIB, 28.0, None),
    anchor("divide", NEWLIB, 115.0, None),
    anchor("square root", NEWLIB, 346.0, None),
    anchor("sine", NEWLIB, 1151.0, None),
];
