//! Cores that somebody else starts and ends.

use super::{Fleet, Patience, Policy};

/// Cores of which nothing is known but what they send.
#[derive(Debug)]
pub struct Elsewhere;

impl Fleet for Elsewhere {
    fn policy(&self) -> Policy {
        Policy {
            restarts: 0,
            sees_ends: false,
            patience: Patience::InUnits,
        }
    }

    fn how_ended(&self, _core: u16) -> String {
        "started elsewhere".to_owned()
    }
}
