//! What something costs, as sums that are exact.

use std::ops::AddAssign;

use cycles::Priced;
use serde::{Deserialize, Serialize};

/// What some instructions cost together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Cost {
    /// Cycles, stalls and all.
    pub cycles: u64,
    /// Instructions that ran, those whose condition failed included.
    pub instructions: u64,
    /// Cycles spent waiting for a load.
    pub load_stalls: u64,
    /// Cycles spent waiting for a product.
    pub multiply_stalls: u64,
}

impl From<&Priced> for Cost {
    fn from(priced: &Priced) -> Self {
        Self {
            cycles: priced.cycles,
            instructions: priced.executions,
            load_stalls: priced.load_stalls,
            multiply_stalls: priced.multiply_stalls,
        }
    }
}

impl AddAssign for Cost {
    fn add_assign(&mut self, other: Self) {
        self.cycles += other.cycles;
        self.instructions += other.instructions;
        self.load_stalls += other.load_stalls;
        self.multiply_stalls += other.multiply_stalls;
    }
}

impl Cost {
    /// Cycles spent waiting for anything.
    pub fn stalls(&self) -> u64 {
        self.load_stalls + self.multiply_stalls
    }
}
