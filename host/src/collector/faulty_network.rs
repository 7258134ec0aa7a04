//! A core's network that is made to fail, for tests.

use std::net::UdpSocket;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use node::{Network, SendError};
use rand_xoshiro::Xoshiro256StarStar;
use rand_xoshiro::rand_core::Rng;

/// What goes wrong on a core's network.
#[derive(Clone, Copy, Default)]
pub(super) struct Faults {
    pub(super) loss_percent: u64,
    pub(super) duplicate_percent: u64,
    /// Every packet is followed by one of another run.
    pub(super) foreign: bool,
    /// Nothing leaves the core after this many packets.
    pub(super) dies_after: Option<u32>,
}

pub(super) struct FaultyNetwork {
    pub(super) socket: UdpSocket,
    pub(super) chance: Xoshiro256StarStar,
    pub(super) faults: Faults,
    pub(super) sent: u32,
    pub(super) given_up: Arc<AtomicBool>,
}

impl FaultyNetwork {
    fn percent(&mut self, percent: u64) -> bool {
        self.chance.next_u64() % 100 < percent
    }

    fn is_dead(&self) -> bool {
        self.faults.dies_after.is_some_and(|packets| self.sent > packets)
    }
}

impl Network for FaultyNetwork {
    fn send(&mut self, payload: &[u8]) -> Result<(), SendError> {
        self.sent += 1;
        if self.is_dead() || self.given_up.load(Ordering::Relaxed) {
            return Err(SendError);
        }
        let copies = 1 + u64::from(self.percent(self.faults.duplicate_percent));
        for _ in 0..copies {
            if !self.percent(self.faults.loss_percent) {
                self.socket.send(payload).map_err(|_| SendError)?;
            }
        }
        if self.faults.foreign {
            let mut other = payload.to_vec();
            other[14] ^= 1; // The session's lowest byte.
            self.socket.send(&other).map_err(|_| SendError)?;
        }
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8]) -> Option<usize> {
        let len = self.socket.recv(buffer).ok()?;
        (!self.percent(self.faults.loss_percent)).then_some(len)
    }

    fn wait(&mut self, _ticks: u32) {
        thread::sleep(Duration::from_millis(1));
    }
}
