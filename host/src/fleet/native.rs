//! Cores as threads of this host: the same worker and the same packets, over a socket instead of a network card.

use std::io::{PipeReader, PipeWriter, pipe};
use std::net::{Ipv4Addr, UdpSocket};
use std::os::fd::AsFd;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use node::{Clock, Fault, Network, Outcome, SendError, StackUse, TICKS_PER_SECOND};
use rustix::process::{Resource, Rlimit, getrlimit, setpriority_process, setrlimit};
use tracer::integrator::Path;
use tracer::profile::Profile;
use tracer::scene::All;
use wire::{Boot, Command, MAX_PAYLOAD, Name, ToCore};

use super::{Fleet, FleetError, Patience, Policy, RUNNING};
use crate::firmware::arithmetic::{Arithmetic, Sampler, with_profile};
use crate::platform::wait;
use crate::scene::Blob;

/// How much cores stand back behind the thread that collects, which must empty its socket however many they are.
const NICE: i32 = 10;

/// Cores as threads. Dropping it tells them to stop and waits for them.
#[derive(Debug)]
pub struct NativeFleet {
    cores: Vec<Core>,
    end: Arc<End>,
    /// Once it is closed, no core rests any more.
    open: Option<PipeWriter>,
}

/// How cores learn that they shall end, though nobody sends them a packet any more.
#[derive(Debug)]
struct End {
    /// Looked at before every unit.
    stop: AtomicBool,
    /// Its other side is closed then, which wakes whoever rests.
    closed: PipeReader,
}

#[derive(Debug)]
enum Core {
    Running(JoinHandle<Result<Outcome, String>>),
    Ended(String),
}

impl NativeFleet {
    /// Starts one thread a boot block.
    pub fn start(boot_blocks: &[Vec<u8>], profile: Arithmetic, sampler: Sampler) -> Result<Self, FleetError> {
        let failed = |core| {
            move |cause| FleetError::Start {
                core,
                program: "a thread".to_owned(),
                cause,
            }
        };
        allow_many_files();
        let (closed, open) = pipe().map_err(failed(0))?;
        let stop = AtomicBool::new(false);
        let mut fleet = Self {
            cores: Vec::with_capacity(boot_blocks.len()),
            end: Arc::new(End { stop, closed }),
            open: Some(open),
        };
        for (core, block) in (0..).zip(boot_blocks) {
            let (block, end) = (block.clone(), Arc::clone(&fleet.end));
            let spawned = thread::Builder::new()
                .name(format!("core {core}"))
                .spawn(move || run(&block, (profile, sampler), end))
                .map_err(failed(core))?;
            fleet.cores.push(Core::Running(spawned));
        }
        Ok(fleet)
    }
}

impl Fleet for NativeFleet {
    /// A thread is not started again: it runs the very program that looks after it.
    fn policy(&self) -> Policy {
        Policy {
            restarts: 0,
            sees_ends: true,
            patience: Patience::WhileTheyLive,
        }
    }

    fn newly_ended(&mut self) -> Vec<u16> {
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

    fn how_ended(&self, core: u16) -> String {
        match self.cores.get(usize::from(core)) {
            Some(Core::Ended(how)) => how.clone(),
            Some(Core::Running(_)) | None => RUNNING.to_owned(),
        }
    }
}

impl Drop for NativeFleet {
    fn drop(&mut self) {
        self.end.stop.store(true, Ordering::Relaxed);
        drop(self.open.take());
        for core in self.cores.drain(..) {
            if let Core::Running(thread) = core {
                let _how = thread.join();
            }
        }
    }
}

/// Every core has a socket of its own, and many systems grant a program 1024 files unless it asks for more.
fn allow_many_files() {
    let limit = getrlimit(Resource::Nofile);
    // Where that is refused, the cores that get no socket say so.
    let _granted = setrlimit(
        Resource::Nofile,
        Rlimit {
            current: limit.maximum,
            ..limit
        },
    );
}

/// How a finished thread ended.
fn how(thread: JoinHandle<Result<Outcome, String>>) -> String {
    match thread.join() {
        Ok(Ok(outcome)) => format!("it stopped after {} units", outcome.units),
        Ok(Err(fault)) => format!("it failed: {fault}"),
        Err(_) => "its thread panicked (its message is above)".to_owned(),
    }
}

fn run(block: &[u8], kind: (Arithmetic, Sampler), end: Arc<End>) -> Result<Outcome, String> {
    // Of this thread alone. Where the system does not let it, the collector waits for its turn like any core.
    let _as_before = setpriority_process(None, NICE);
    let block = Blob::new(block);
    let boot = Boot::decode(block.bytes()).map_err(|error| format!("its boot block: {error}"))?;
    let network = Loopback::open(&boot, end).map_err(|error| format!("its socket: {error}"))?;
    let clock = HostClock(Instant::now());
    let outcome = with_profile!(kind.0, kind.1, P => work::<P>(&boot, network, clock));
    outcome.map_err(|fault| fault.to_string())
}

fn work<P: Profile>(boot: &Boot<'_>, mut network: Loopback, mut clock: HostClock) -> Result<Outcome, Fault> {
    let board = const { Name::new("native") };
    node::run::<P, Path<P, All>>(boot, board, &mut network, &mut clock, StackUse::default)
}

/// A core's way to the collector: a socket of this host.
struct Loopback {
    socket: UdpSocket,
    end: Arc<End>,
    /// What the worker hears when it shall end.
    order: ToCore,
}

impl Loopback {
    fn open(boot: &Boot<'_>, end: Arc<End>) -> std::io::Result<Self> {
        let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0))?;
        socket.connect((Ipv4Addr::from(boot.collector), boot.port))?;
        socket.set_nonblocking(true)?;
        Ok(Self {
            socket,
            end,
            order: ToCore {
                core: boot.core,
                session: boot.session,
                command: Command::Stop,
            },
        })
    }
}

impl Network for Loopback {
    fn send(&mut self, payload: &[u8]) -> Result<(), SendError> {
        // What the host's network does not take now is lost on the way, and made good like any other loss.
        let _lost = self.socket.send(payload);
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8]) -> Option<usize> {
        if self.end.stop.load(Ordering::Relaxed) {
            let mut payload = [0; MAX_PAYLOAD];
            let len = self.order.encode(&mut payload);
            buffer.get_mut(..len)?.copy_from_slice(&payload[..len]);
            return Some(len);
        }
        self.socket.recv(buffer).ok()
    }

    fn wait(&mut self, ticks: u32) {
        let asked = Duration::from_secs(1) * ticks / TICKS_PER_SECOND;
        wait([self.socket.as_fd(), self.end.closed.as_fd()], asked);
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
