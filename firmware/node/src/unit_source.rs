//! Which unit comes next: the published free-running orders, and the leased one.

use wire::Boot;
use wire::boot::PixelOrder;

use crate::division::quotient;
use crate::leases::Leases;

/// Where a core's units come from.
#[derive(Debug)]
pub(crate) enum UnitSource {
    /// The host says which.
    Leased,
    /// One after the other, wrapping at `units`.
    Sequential { next: u32, units: u32 },
    /// Drawn uniformly, each span of pixels as likely as any other.
    Stochastic { limit: u32, random: SplitMix },
}

impl UnitSource {
    /// The source the boot block asks for, over `spans` spans of pixels and `units` units.
    pub(crate) fn new(boot: &Boot<'_>, spans: u32, units: u32) -> Self {
        match boot.order {
            PixelOrder::Leased => Self::Leased,
            PixelOrder::Sequential => {
                let next = share_start(units, boot.core.into(), boot.cores.into());
                Self::Sequential { next, units }
            }
            PixelOrder::Stochastic => Self::Stochastic {
                limit: last_whole_pass(spans),
                random: SplitMix::new(boot.seed ^ u64::from(boot.core).rotate_right(16)),
            },
        }
    }

    /// The next unit; none while there is no lease.
    pub(crate) fn next(&mut self, leases: &mut Leases) -> Option<u32> {
        match self {
            Self::Leased => leases.next(),
            Self::Sequential { next, units } => {
                let unit = *next;
                *next = if unit + 1 < *units { unit + 1 } else { 0 };
                Some(unit)
            }
            Self::Stochastic { limit, random } => loop {
                // Less than half of all draws are thrown away, whatever the size of the picture.
                let unit = random.next();
                if unit <= *limit {
                    return Some(unit);
                }
            },
        }
    }
}

/// core * units / cores, for 16-bit core numbers, without the 64-bit division that a core has no instruction for.
fn share_start(units: u32, core: u32, cores: u32) -> u32 {
    let each = quotient(units, cores);
    each * core + quotient((units - each * cores) * core, cores)
}

/// The greatest unit id of the last whole pass that fits 32 bits: spans * floor(2^32 / spans) - 1, likewise.
fn last_whole_pass(spans: u32) -> u32 {
    let whole = quotient(u32::MAX, spans) * spans;
    // Another pass ends past the last id, or with it.
    if whole.wrapping_add(spans) == 0 {
        u32::MAX
    } else {
        whole - 1
    }
}

/// Steele, Lea and Flood's SplitMix64, of which the upper half is used. It chooses units only: what a unit looks like depends on
/// its id and on nothing that is drawn here.
#[derive(Debug)]
pub(crate) struct SplitMix(u64);

impl SplitMix {
    fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((mixed ^ (mixed >> 31)) >> 32) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_whole_pass_ends_with_a_span() {
        assert_eq!(last_whole_pass(1), u32::MAX);
        assert_eq!(last_whole_pass(192), u32::MAX - 64);
        assert_eq!(last_whole_pass(3), u32::MAX - 1);
        assert_eq!(last_whole_pass((1 << 31) + 1), 1 << 31);
    }

    #[test]
    fn shares_start_where_64_bits_say() {
        for (units, cores) in [
            (24, 4),
            (24, 5),
            (3, 7),
            (u32::MAX, 65535),
            (u32::MAX - 1, 2),
            (0xFFFF_0000, 65534),
        ] {
            for core in [0, 1, cores / 2, cores - 1] {
                let expected = u64::from(units) * u64::from(core) / u64::from(cores);
                assert_eq!(
                    u64::from(share_start(units, core, cores)),
                    expected,
                    "{core} of {cores}"
                );
            }
        }
    }

    /// The first output of the published generator for seed 0.
    #[test]
    fn splitmix_first_output() {
        assert_eq!(SplitMix::new(0).next(), 0xE220_A839);
    }

    /// 64 spans drawn 64,000 times: chi-square with 63 degrees of freedom exceeds 103 once in a thousand.
    #[test]
    fn stochastic_units_cover_the_spans_evenly() {
        let (mut counts, spans) = ([0u32; 64], 64);
        let random = SplitMix::new(42);
        let mut source = UnitSource::Stochastic {
            limit: last_whole_pass(spans),
            random,
        };
        for _ in 0..64_000 {
            let unit = source.next(&mut Leases::default()).unwrap();
            counts[(unit % spans) as usize] += 1;
        }
        let chi2: f64 = counts
            .iter()
            .map(|&n| (f64::from(n) - 1000.0).powi(2) / 1000.0)
            .sum();
        assert!(chi2 < 103.0, "chi-square {chi2}");
    }

    #[test]
    fn sequential_wraps() {
        let mut source = UnitSource::Sequential { next: 3, units: 5 };
        let units: [_; 4] = core::array::from_fn(|_| source.next(&mut Leases::default()).unwrap());
        assert_eq!(units, [3, 4, 0, 1]);
    }
}
