//! Cores as threads of this host: the same worker and the same packets, over a socket instead of a network card.

use std::net::{Ipv4Addr, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use node::{Clock, Fault, Network, Outcome, SendError, StackUse, TICKS_PER_SECOND};
use tracer::profile::{Paper, Precise};
use tracer::scene::All;
use wire::{Boot, MAX_PAYLOAD, Name, Order, ToCore};

use super::FleetError;
use crate::arithmetic::Arithmetic;

/// The longest rest of an idle core: packets wait no longer than this.
const REST: Duration = Duration::from_millis(1);

/// Cores as threads. Dropping it tells them to stop and waits for them.
#[derive(Debug)]
pub struct NativeFleet {
    cores: Vec<Core>,
    stop: Arc<AtomicBool>,
}

#[derive(Debug)]
enum Core {
    Running(JoinHandle<Result<Outcome, String>>),
    Ended(String),
}

impl NativeFleet {
    /// Starts one thread a boot block.
    pub fn start(boot_blocks: &[Vec<u8>], profile: Arithmetic) -> Result<Self, FleetError> {
        let mut fleet = Self {
            cores: Vec::with_capacity(boot_blocks.len()),
            stop: Arc::default(),
        };
        for (core, block) in (0..).zip(boot_blocks) {
            let (block, stop) = (block.clone(), Arc::clone(&fleet.stop));
            let spawned = thread::Builder::new()
                .name(format!("core {core}"))
                .spawn(move || run(&block, profile, stop))
                .map_err(|cause| FleetError::Start {
                    core,
                    program: "a thread".to_owned(),
                    cause,
                })?;
            fleet.cores.push(Core::Running(spawned));
        }
        Ok(fleet)
    }

    pub(super) fn newly_ended(&mut self) -> Vec<u16> {
        let mut ended = Vec::new();
        for (number, core) in self.cores.iter_mut().enumerate() {
            if matches!(core, Core::Running(thread) if thread.is_finished())
                && let Core::Running(thread) = std::mem::replace(core, Core::Ended(String::new()))
            {
                *core = Core::Ended(how(thread));
                ended.extend(u16::try_from(number));
            }
        }
        ended
    }

    pub(super) fn how_ended(&self, core: u16) -> Option<String> {
        match self.cores.get(usize::from(core))? {
            Core::Running(_) => None,
            Core::Ended(how) => Some(how.clone()),
        }
    }
}

impl Drop for NativeFleet {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        for core in self.cores.drain(..) {
            if let Core::Running(thread) = core {
                let _how = thread.join();
            }
        }
    }
}

/// How a finished thread ended.
fn how(thread: JoinHandle<Result<Outcome, String>>) -> String {
    match thread.join() {
        Ok(Ok(outcome)) => format!("it stopped after {} units", outcome.units),
        Ok(Err(fault)) => format!("it failed: {fault}"),
        Err(_) => "its thread panicked (its message is above)".to_owned(),
    }
}

fn run(block: &[u8], profile: Arithmetic, stop: Arc<AtomicBool>) -> Result<Outcome, String> {
    let boot = Boot::decode(block).map_err(|error| format!("its boot block: {error}"))?;
    let network = Loopback::open(&boot, stop).map_err(|error| format!("its socket: {error}"))?;
    let clock = HostClock(Instant::now());
    let board = Name::new("native");
    let outcome: Result<Outcome, Fault> = match profile {
        Arithmetic::Paper => node::run::<Paper, All>(&boot, board, network, clock, StackUse::default),
        Arithmetic::Precise => node::run::<Precise, All>(&boot, board, network, clock, StackUse::default),
    };
    outcome.map_err(|fault| fault.to_string())
}

/// A core's way to the collector: a socket of this host.
struct Loopback {
    socket: UdpSocket,
    stop: Arc<AtomicBool>,
    /// What the worker hears once `stop` is set.
    order: ToCore,
}

impl Loopback {
    fn open(boot: &Boot<'_>, stop: Arc<AtomicBool>) -> std::io::Result<Self> {
        let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0))?;
        socket.connect((Ipv4Addr::from(boot.collector), boot.port))?;
        socket.set_nonblocking(true)?;
        Ok(Self {
            socket,
            stop,
            order: ToCore {
                core: boot.core,
                session: boot.session,
                order: Order::Stop,
            },
        })
    }
}

impl Network for Loopback {
    fn send(&mut self, payload: &[u8]) -> Result<(), SendError> {
        self.socket.send(payload).map(|_| ()).map_err(|_| SendError)
    }

    fn receive(&mut self, buffer: &mut [u8]) -> Option<usize> {
        if self.stop.load(Ordering::Relaxed) {
            let mut payload = [0; MAX_PAYLOAD];
            let len = self.order.encode(&mut payload);
            buffer.get_mut(..len)?.copy_from_slice(&payload[..len]);
            return Some(len);
        }
        self.socket.recv(buffer).ok()
    }

    fn wait(&mut self, ticks: u32) {
        let asked = Duration::from_secs(1) * ticks / TICKS_PER_SECOND;
        thread::sleep(asked.min(REST));
    }
}

/// 24 MHz by the host's clock.
struct HostClock(Instant);

impl Clock for HostClock {
    fn ticks(&mut self) -> u32 {
        let per_second = u128::from(TICKS_PER_SECOND);
        (self.0.elapsed().as_nanos() * per_second / 1_000_000_000) as u32
    }
}
