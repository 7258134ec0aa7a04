//! The machine of a million cores that the publication looks forward to, on paper: what it would render, and what would have to take
//! that in.
//!
//! Each board has an Ethernet of its own, so a board is what fills a wire. All boards together fill a collector.

use serde::Serialize;
use tracer::unit::SPAN;
use wire::{FromCore, MAX_PAYLOAD, MAX_SAMPLES, Message, PixelSums, Pixels};

use super::published::{
    Assumption, BOARD_CHIPS, CHIP_CORES, CHIP_RENDERERS, COLLECTOR, FRAMING, MILLION_CHIPS, MILLION_POWER,
    WIRE,
};
use super::{PACKET_PIXELS, samples_of_a_pixel};

/// Bits in a byte, and in a megabit.
const BITS: f64 = 8.0;
const MEGABIT: f64 = 1e6;

/// What the machine would do. All of it is computed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Million {
    /// `roulette` or `depth:N`.
    pub termination: String,
    /// What it is computed from besides the core's rate.
    pub assumptions: Vec<Assumption>,
    /// Samples a second of one core, as measured here.
    pub samples_per_second_a_core: f64,
    /// Cores in all, and those that render.
    pub cores: f64,
    /// As said.
    pub rendering_cores: f64,
    /// Boards, each with a wire.
    pub boards: f64,
    /// Samples a second of all.
    pub samples_per_second: f64,
    /// Samples a joule.
    pub samples_per_joule: f64,
    /// At the unit that the project has by default and at the one that a board's wire carries, and at the largest there is.
    pub packets: Vec<Flood>,
}

/// What leaves the boards with so many samples in a packet.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Flood {
    /// Samples in a packet.
    pub samples_per_packet: u32,
    /// Seconds that a core renders for one.
    pub seconds_per_packet: f64,
    /// Packets a second that a board's cores make.
    pub packets_per_second_a_board: f64,
    /// Whether its wire carries them.
    pub carried: bool,
    /// Packets a second that reach the collectors: at most what the wires carry.
    pub packets_per_second: f64,
    /// The same in 10^6 bits a second, frames and gaps included.
    pub megabits_per_second: f64,
    /// Collectors that take that in.
    pub collectors: f64,
    /// The samples a second that arrive.
    pub samples_per_second: f64,
}

impl Million {
    /// Of cores that do so many samples a second; the project's unit has so many samples.
    pub fn of(termination: &str, samples_per_second_a_core: f64, usual_samples_per_packet: u32) -> Self {
        let rendering_cores = MILLION_CHIPS.value * CHIP_RENDERERS.value;
        let boards = MILLION_CHIPS.value / BOARD_CHIPS.value;
        let samples_per_second = rendering_cores * samples_per_second_a_core;
        let board_rate = samples_per_second / boards;
        let carried = PACKET_PIXELS * samples_of_a_pixel(board_rate / WIRE.value);
        let most = PACKET_PIXELS * u32::from(MAX_SAMPLES);
        let mut sizes = vec![usual_samples_per_packet, carried, most];
        sizes.sort_unstable();
        sizes.dedup();
        sizes.retain(|&size| size <= most);
        let flood = |size| Flood::of(size, samples_per_second_a_core, board_rate, boards);
        Self {
            termination: termination.to_owned(),
            assumptions: vec![
                MILLION_CHIPS,
                CHIP_CORES,
                CHIP_RENDERERS,
                BOARD_CHIPS,
                WIRE,
                COLLECTOR,
                FRAMING,
                MILLION_POWER,
            ],
            samples_per_second_a_core,
            cores: MILLION_CHIPS.value * CHIP_CORES.value,
            rendering_cores,
            boards,
            samples_per_second,
            samples_per_joule: samples_per_second / MILLION_POWER.value,
            packets: sizes.into_iter().map(flood).collect(),
        }
    }
}

impl Flood {
    fn of(samples_per_packet: u32, core_rate: f64, board_rate: f64, boards: f64) -> Self {
        let samples = f64::from(samples_per_packet);
        let made = board_rate / samples;
        let packets_per_second = boards * made.min(WIRE.value);
        let bytes = payload() as f64 + FRAMING.value;
        Self {
            samples_per_packet,
            seconds_per_packet: samples / core_rate,
            packets_per_second_a_board: made,
            carried: made <= WIRE.value,
            packets_per_second,
            megabits_per_second: packets_per_second * bytes * BITS / MEGABIT,
            collectors: (packets_per_second / COLLECTOR.value).ceil(),
            samples_per_second: packets_per_second * samples,
        }
    }
}

/// Bytes of a whole unit's packet, whatever it says.
fn payload() -> usize {
    let packet = FromCore {
        core: 0,
        seq: 0,
        session: 0,
        message: Message::Pixels(Pixels {
            unit: 0,
            epoch: 0,
            samples: MAX_SAMPLES,
            scene: 0,
            ticks: 0,
            rays: 0,
            sums: PixelSums::new(&[[0; 3]; SPAN]).expect("a whole unit fits"),
        }),
    };
    packet.encode(&mut [0; MAX_PAYLOAD])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1,200 boards of 816 cores; at 1,000 samples/s a core, a board makes 816,000, and a packet of 544 is what 1,500 a second carry.
    #[test]
    fn a_board_fills_its_wire_and_all_boards_a_collector() {
        let million = Million::of("roulette", 1000.0, 64);
        assert_eq!(
            (million.cores, million.rendering_cores, million.boards),
            (1_036_800.0, 979_200.0, 1_200.0)
        );
        assert_eq!(million.samples_per_second, 979_200_000.0);
        let sizes: Vec<u32> = million
            .packets
            .iter()
            .map(|flood| flood.samples_per_packet)
            .collect();
        assert_eq!(sizes, [64, 576, 65_536]);
        let [usual, carried, most] = &million.packets[..] else {
            panic!("three");
        };
        assert!(!usual.carried && carried.carried && most.carried);
        assert_eq!(usual.packets_per_second, 1_800_000.0);
        assert_eq!(usual.samples_per_second, 1_800_000.0 * 64.0);
        assert_eq!(usual.collectors, 24.0);
        assert!((carried.samples_per_second / million.samples_per_second - 1.0).abs() < 1e-12);
        assert_eq!((most.collectors, most.seconds_per_packet), (1.0, 65.536));
    }
}
