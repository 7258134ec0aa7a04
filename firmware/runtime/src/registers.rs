//! Volatile access to device registers.

/// A device register of the width of `T`.
#[derive(Clone, Copy, Debug)]
pub struct Register<T>(*mut T);

impl<T: Copy> Register<T> {
    /// The register at `address`.
    ///
    /// # Safety
    ///
    /// - `address` is that of a device register which may be accessed at the width of `T`, and is aligned for it;
    /// - no access to it changes memory that belongs to a Rust object: no DMA is started by it.
    pub const unsafe fn new(address: usize) -> Self {
        Self(address as *mut T)
    }

    /// Reads the register.
    pub fn read(self) -> T {
        // SAFETY: `new` demands a register that may be read at this width.
        unsafe { self.0.read_volatile() }
    }

    /// Writes the register.
    pub fn write(self, value: T) {
        // SAFETY: `new` demands a register that may be written at this width, without effect on Rust's memory.
        unsafe { self.0.write_volatile(value) }
    }
}
