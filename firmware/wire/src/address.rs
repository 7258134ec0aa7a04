//! Core numbers as SDP addresses.
//!
//! A core's number n is its place in the fleet. On a SpiNNaker machine it would live on chip n / 17, on processor n % 17 + 1 of
//! that chip (processor 0 is the monitor). Chips are laid out 256 to a row.

use crate::DecodeError;

/// Application cores on one chip: 18, less the monitor.
pub const CORES_PER_CHIP: u16 = 17;

/// The SDP port a core listens on and sends from. Port 0 is the monitor's own.
const CORE_PORT: u8 = 1;

/// One end of a datagram as the SDP header spells it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Address {
    /// Port in the upper three bits, processor in the lower five.
    pub(crate) port_cpu: u8,
    /// Row of the chip.
    pub(crate) y: u8,
    /// Column of the chip.
    pub(crate) x: u8,
}

impl Address {
    /// The host: "whatever is at the end of the Ethernet", port 7 and processor 31.
    pub(crate) const HOST: Self = Self {
        port_cpu: 0xFF,
        y: 0,
        x: 0,
    };

    /// The address of core number `core`.
    pub(crate) const fn of_core(core: u16) -> Self {
        let (chip, cpu) = (core / CORES_PER_CHIP, core % CORES_PER_CHIP + 1);
        Self {
            port_cpu: CORE_PORT << 5 | cpu as u8,
            y: (chip >> 8) as u8,
            x: chip as u8,
        }
    }

    /// The core number this address stands for.
    pub(crate) fn core(self) -> Result<u16, DecodeError> {
        let (port, cpu) = (self.port_cpu >> 5, u32::from(self.port_cpu & 31));
        if port != CORE_PORT || !(1..=u32::from(CORES_PER_CHIP)).contains(&cpu) {
            return Err(DecodeError::Address);
        }
        let chip = u32::from(self.y) << 8 | u32::from(self.x);
        u16::try_from(chip * u32::from(CORES_PER_CHIP) + cpu - 1).map_err(|_| DecodeError::Address)
    }
}
