//! What is known of the published system, and of the machines that it is compared with: nothing here is measured by us.

use serde::Serialize;

/// A figure that a result rests on and that nobody here has measured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Assumption {
    /// What it is of.
    pub what: &'static str,
    /// The figure.
    pub value: f64,
    /// Its unit.
    pub unit: &'static str,
    /// Where it is from.
    pub source: &'static str,
}

/// Cores that the published system rendered on, in figure 4 the most.
pub const CORES: u16 = 136;

/// Numbers of cores in figure 4, up to the published one.
pub const FIGURE_4: [u16; 8] = [1, 2, 4, 8, 16, 32, 64, CORES];

/// Clock of an ARM968E-S of SpiNNaker: its makers' figure.
pub const CLOCK: Assumption = Assumption {
    what: "clock of a core",
    value: 200e6,
    unit: "Hz",
    source: "the published machine, an ARM968E-S of SpiNNaker",
};

/// What the published system's Ethernet carries, by its authors.
pub const WIRE: Assumption = Assumption {
    what: "packets out of a board",
    value: 1500.0,
    unit: "packets/s",
    source: "the publication: about 1,500 packets a second",
};

/// Samples a second of one core of the published system: 530,226 by four sub-samples by 136 cores.
pub const CORE_RATE: Assumption = Assumption {
    what: "samples of a published core",
    value: 530_226.0 / 4.0 / CORES as f64,
    unit: "samples/s",
    source: "the publication: 530,226 over 4 sub-samples and 136 cores",
};

/// Samples a second of the publication's desktop processor.
pub const PROCESSOR_RATE: Assumption = Assumption {
    what: "samples of the published processor",
    value: 530_226.0,
    unit: "samples/s",
    source: "the publication's figure for its desktop processor, as we were told it",
};

/// Power of that processor: the middle of the thermal design powers, 65 to 95 W, of desktop processors of its years. Its model is not
/// known to us.
pub const PROCESSOR_POWER: Assumption = Assumption {
    what: "power of the published processor",
    value: 80.0,
    unit: "W",
    source: "assumed: desktop processors of 2012 had thermal design powers of 65 to 95 W",
};

/// Power of a thread of a host whose processor is not known: between the thermal design powers over threads, 1.9 to 3.4 W, of servers' processors.
pub const THREAD_POWER: Assumption = Assumption {
    what: "power of a thread of this host",
    value: 2.2,
    unit: "W",
    source: "assumed, where its processor does not say its model: an EPYC 7763's 280 W over 128 threads",
};

/// Power of a chip of SpiNNaker: its makers' figure for one under load.
pub const CHIP_POWER: Assumption = Assumption {
    what: "power of a chip",
    value: 1.0,
    unit: "W",
    source: "SpiNNaker's makers, 1 W at most",
};

/// Cores of a chip.
pub const CHIP_CORES: Assumption = Assumption {
    what: "cores of a chip",
    value: 18.0,
    unit: "cores",
    source: "SpiNNaker's makers",
};

/// Cores of a chip that render: 136 is 8 times 17, so the 18th, which looks after the chip, does not.
pub const CHIP_RENDERERS: Assumption = Assumption {
    what: "cores of a chip that render",
    value: 17.0,
    unit: "cores",
    source: "136 published cores are 8 chips of 17; the 18th looks after its chip",
};

/// Chips of a board.
pub const BOARD_CHIPS: Assumption = Assumption {
    what: "chips of a board",
    value: 48.0,
    unit: "chips",
    source: "SpiNNaker's boards; each has an Ethernet of its own",
};

/// Chips of the machine of a million cores, which was finished in 2018.
pub const MILLION_CHIPS: Assumption = Assumption {
    what: "chips of the machine",
    value: 57_600.0,
    unit: "chips",
    source: "SpiNNaker's largest machine: 1,036,800 cores",
};

/// Power of the whole machine of a million cores.
pub const MILLION_POWER: Assumption = Assumption {
    what: "power of the machine",
    value: 100e3,
    unit: "W",
    source: "SpiNNaker's largest machine: about 100 kW, cooling apart",
};

/// Packets that a collector takes in: as many as were seen to come through QEMU's network without loss.
pub const COLLECTOR: Assumption = Assumption {
    what: "packets that one collector takes in",
    value: 77_000.0,
    unit: "packets/s",
    source: "seen once through QEMU's network without loss; not measured by this command",
};

/// Bytes of a packet on the wire beside its UDP payload: UDP 8, IPv4 20, Ethernet 14 and 4, preamble 8, gap 12.
pub const FRAMING: Assumption = Assumption {
    what: "bytes of a frame beside the payload",
    value: 66.0,
    unit: "bytes",
    source: "UDP 8, IPv4 20, Ethernet 14 + 4, preamble 8, gap 12",
};

/// Current of a Cortex-M3 whose memories hold our image, by clock. The part has 1 MiB of flash and 128 KiB of memory.
pub const M3_CURRENT: Assumption = Assumption {
    what: "current of a Cortex-M3 by clock",
    value: 219.0,
    unit: "uA/MHz",
    source: "EFM32GG's reference manual, rev. 1.20: as little as 219 uA/MHz in run mode",
};

/// Voltage at which that current is given.
pub const M3_VOLTAGE: Assumption = Assumption {
    what: "voltage of that Cortex-M3",
    value: 3.0,
    unit: "V",
    source: "assumed: EFM32's data sheets give currents at 3 V",
};

/// Its fastest clock.
pub const M3_CLOCK: Assumption = Assumption {
    what: "clock of that Cortex-M3",
    value: 48e6,
    unit: "Hz",
    source: "EFM32GG's reference manual: up to 48 MHz",
};
