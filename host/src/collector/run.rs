//! The collection itself: one loop over the socket.

use std::collections::HashSet;
use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::os::fd::AsFd;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use wire::boot::PixelOrder;
use wire::{Command, FromCore, MAX_PAYLOAD, Message, Pixels, ToCore};

use super::attended::Attended;
use super::intake::{Rejection, judge};
use super::leases::{Arrival, Leases};
use super::progress::{Progress, State};
use super::silence::Silence;
use super::{Collection, CoreRecord, End, Packets};
use crate::firmware::symbols;
use crate::fleet::session::Session;
use crate::fleet::{Fleet, RESTARTS};
use crate::image::film::{Film, FilmError};
use crate::platform::wait;

/// How long the socket is waited for at once, and so how often deaths and late leases are looked for.
const TICK: Duration = Duration::from_millis(10);
/// How long cores that were told to stop are waited for.
const FAREWELL_TIME: Duration = Duration::from_secs(2);
/// STOP is said again this often to a core that has not answered.
const STOP_EVERY: Duration = Duration::from_millis(100);

/// Why a collection could not go on.
#[derive(Debug, thiserror::Error)]
pub enum CollectError {
    /// The socket failed.
    #[error("the collector's socket failed: {0}")]
    Socket(#[from] io::Error),
    /// A unit could not be added.
    #[error(transparent)]
    Film(#[from] FilmError),
    /// The picture is cut into more units than there are numbers for.
    #[error("the picture has more than 2^32 units; choose a smaller --size or --spp")]
    TooManyUnits,
}

/// Collects the session's picture from its cores.
///
/// Returns also when the fleet is gone or `interrupted` gets true, with what came until then; when all cores have been silent for
/// `patience`, too, and of [cores that nobody sees](Silence) also without it. Whatever the end, the cores that are left have been
/// told to stop.
pub fn collect(
    session: &Session,
    socket: &UdpSocket,
    fleet: &mut Fleet,
    patience: Option<Duration>,
    interrupted: &AtomicBool,
    progress: &mut Progress,
) -> Result<Collection, CollectError> {
    let start = Instant::now();
    let silence = Silence::new(patience);
    collect_by(
        &|| start.elapsed(),
        session,
        socket,
        fleet,
        silence,
        interrupted,
        progress,
    )
}

/// The same by any clock.
pub(super) fn collect_by(
    clock: &dyn Fn() -> Duration,
    session: &Session,
    socket: &UdpSocket,
    fleet: &mut Fleet,
    silence: Silence,
    interrupted: &AtomicBool,
    progress: &mut Progress,
) -> Result<Collection, CollectError> {
    socket.set_nonblocking(true)?;
    let mut run = Run::new(clock, session, socket, fleet, silence, progress)?;
    let end = run.work(interrupted)?;
    let elapsed = clock();
    run.close()?;
    run.progress.finish();
    let mut packets = run.packets;
    packets.lost = run.cores.iter().map(|core| core.sequence.lost()).sum();
    Ok(Collection {
        film: run.film,
        end,
        packets,
        cores: run.cores,
        elapsed,
    })
}

/// What is still to be done.
enum Work {
    /// The host says who does what.
    Leased(Leases),
    /// The cores choose; these units are in.
    Free(HashSet<u32>),
}

struct Run<'a> {
    clock: &'a dyn Fn() -> Duration,
    session: &'a Session,
    socket: &'a UdpSocket,
    fleet: &'a mut Fleet,
    progress: &'a mut Progress,
    attended: Attended,
    /// The time attended until the last look at the socket: what all else goes by.
    now: Duration,
    /// When the socket was last seen empty: no packet in it was sent before.
    emptied: Duration,
    silence: Silence,
    film: Film,
    work: Work,
    samples: u64,
    packets: Packets,
    cores: Vec<CoreRecord>,
    last_rejection: Option<Rejection>,
}

impl<'a> Run<'a> {
    fn new(
        clock: &'a dyn Fn() -> Duration,
        session: &'a Session,
        socket: &'a UdpSocket,
        fleet: &'a mut Fleet,
        silence: Silence,
        progress: &'a mut Progress,
    ) -> Result<Self, CollectError> {
        let units = session.plan.units().ok_or(CollectError::TooManyUnits)?;
        Ok(Self {
            clock,
            session,
            socket,
            fleet,
            progress,
            attended: Attended::default(),
            now: Duration::ZERO,
            emptied: Duration::ZERO,
            silence,
            film: Film::new(session.plan.width, session.plan.height).with_exponent(session.exponent),
            work: match session.order {
                PixelOrder::Leased => Work::Leased(Leases::new(units)),
                PixelOrder::Sequential | PixelOrder::Stochastic => Work::Free(HashSet::new()),
            },
            samples: 0,
            packets: Packets::default(),
            cores: (0..session.cores)
                .map(|core| CoreRecord {
                    core,
                    ..CoreRecord::default()
                })
                .collect(),
            last_rejection: None,
        })
    }

    /// Until the picture is complete or cannot become so.
    fn work(&mut self, interrupted: &AtomicBool) -> Result<End, CollectError> {
        let mut next_look = Duration::ZERO;
        let mut buffer = [0; MAX_PAYLOAD + 1];
        while self.samples < self.session.samples() {
            if interrupted.load(Ordering::Relaxed) {
                return Ok(End::Interrupted);
            }
            let received = self.receive(&mut buffer)?;
            if let Some(payload) = received {
                self.take(&buffer[..payload.0], payload.1)?;
            }
            if self.now < next_look {
                continue;
            }
            next_look = self.now + TICK;
            self.look_after_cores()?;
            self.show();
            // The packets of cores that have ended may still be in the socket: only an empty one is the end.
            if received.is_some() {
                continue;
            }
            if let Some(why) = self.desertion() {
                return Ok(End::Deserted(why));
            }
            if let Some(long) = self.silence.announce(self.fleet, self.last_word(), self.now) {
                self.progress.say(&long);
            }
        }
        Ok(End::Complete)
    }

    /// One payload's length and source, or nothing within a tick.
    fn receive(&mut self, buffer: &mut [u8]) -> io::Result<Option<(usize, SocketAddr)>> {
        let mut received = self.take_from_socket(buffer)?;
        if received.is_none() {
            wait([self.socket.as_fd()], TICK);
            received = self.take_from_socket(buffer)?;
        }
        Ok(received)
    }

    /// One payload's length and source, if there is one.
    fn take_from_socket(&mut self, buffer: &mut [u8]) -> io::Result<Option<(usize, SocketAddr)>> {
        self.now = self.attended.look((self.clock)());
        match self.socket.recv_from(buffer) {
            Ok(received) => Ok(Some(received)),
            Err(error) => match error.kind() {
                io::ErrorKind::WouldBlock => {
                    self.emptied = self.now;
                    Ok(None)
                }
                io::ErrorKind::Interrupted => Ok(None),
                _ => Err(error),
            },
        }
    }

    /// Judges a packet, and answers it where it asks for work or makes room for some.
    fn take(&mut self, payload: &[u8], source: SocketAddr) -> Result<(), CollectError> {
        let Some(packet) = self.judge(payload, source) else {
            return Ok(());
        };
        let (core, now) = (packet.core, self.now);
        match packet.message {
            Message::Hello(_) => {
                if let Work::Leased(leases) = &mut self.work {
                    leases.idle(core, self.emptied, now);
                }
            }
            Message::Pixels(pixels) => self.take_pixels(core, &pixels)?,
            Message::Farewell(_) => {}
            // Its end follows, and says whether it has another life.
            Message::Fault(_) if self.fleet.sees_ends() => self.take_leases_back(core),
            Message::Fault(fault) => self.retire(core, fault.reason),
        }
        self.hand_out(core);
        Ok(())
    }

    /// The accounts of a packet, and the packet if it is ours.
    fn judge<'p>(&mut self, payload: &'p [u8], source: SocketAddr) -> Option<FromCore<'p>> {
        let packet = match judge(self.session, payload) {
            Ok(packet) => packet,
            Err(rejection) => {
                self.packets.rejected += 1;
                self.last_rejection = Some(rejection);
                return None;
            }
        };
        let record = &mut self.cores[usize::from(packet.core)];
        record.source = Some(source);
        let before = record.heard.replace(self.now);
        match packet.message {
            Message::Pixels(_) => {
                record.sequence.received(packet.seq);
                if let Some(before) = before {
                    self.silence.unit_after(self.now.saturating_sub(before));
                }
            }
            Message::Hello(hello) => {
                record.board = Some(hello.board);
                record.sequence.sent_before(packet.seq);
            }
            Message::Farewell(farewell) => {
                record.sequence.sent_before(packet.seq);
                record.farewell = Some(farewell);
            }
            Message::Fault(fault) => {
                let image = self.fleet.image(packet.core);
                record.last_words = Some(match image {
                    Some(elf) => symbols::explained(elf, &fault),
                    None => fault.reason.to_owned(),
                });
            }
        }
        Some(packet)
    }

    fn take_pixels(&mut self, core: u16, pixels: &Pixels) -> Result<(), CollectError> {
        let now = self.now;
        self.packets.received += 1;
        let arrival = match &mut self.work {
            Work::Leased(leases) => leases.arrived(core, pixels.unit, now),
            Work::Free(done) => match done.insert(pixels.unit) {
                true => Arrival::First,
                false => Arrival::Duplicate,
            },
        };
        if arrival == Arrival::Duplicate {
            self.packets.duplicate += 1;
            return Ok(());
        }
        let run: Vec<[u64; 3]> = pixels.sums.iter().collect();
        let first = self.session.plan.extent(pixels.unit).first_pixel;
        self.film.add(first, u32::from(pixels.samples), &run)?;
        self.samples += run.len() as u64 * u64::from(pixels.samples);
        let record = &mut self.cores[usize::from(core)];
        record.units += 1;
        record.ticks += u64::from(pixels.ticks);
        record.rays += u64::from(pixels.rays);
        Ok(())
    }

    /// Notices deaths, warnings and silence, and gives what came back of that to others.
    fn look_after_cores(&mut self) -> Result<(), CollectError> {
        let ended = self.fleet.newly_ended();
        if !ended.is_empty() {
            // What they have ever said is in the socket, and must not be taken for the words of their next lives.
            self.drain()?;
        }
        for core in ended {
            self.part_from(core);
        }
        for warning in self.fleet.warnings() {
            self.progress.say(&warning);
        }
        let Work::Leased(leases) = &mut self.work else {
            return Ok(());
        };
        let late = leases.late(self.now);
        for core in late.into_iter().filter(|_| leases.any_speaks()) {
            self.progress
                .say(&format!("core {core} is silent; its work goes to the others"));
        }
        for core in leases.holders() {
            self.hand_out(core);
        }
        Ok(())
    }

    /// Takes all that has arrived.
    fn drain(&mut self) -> Result<(), CollectError> {
        let mut buffer = [0; MAX_PAYLOAD + 1];
        while self.samples < self.session.samples()
            && let Some((len, source)) = self.take_from_socket(&mut buffer)?
        {
            self.take(&buffer[..len], source)?;
        }
        Ok(())
    }

    /// Sends the core as many leases as it may have.
    fn hand_out(&mut self, core: u16) {
        while let Work::Leased(leases) = &mut self.work
            && let Some(lease) = leases.grant(core, self.now)
        {
            self.send(
                core,
                Command::Lease {
                    number: lease.number,
                    first: lease.first,
                    count: lease.count,
                },
            );
        }
    }

    /// The core has ended before it was told to: it is started again, or gone for good.
    fn part_from(&mut self, core: u16) {
        let record = &self.cores[usize::from(core)];
        if record.ended.is_some() {
            return;
        }
        let said = record.last_words.clone();
        let how = said.unwrap_or_else(|| self.fleet.how_ended(core));
        match self.fleet.start_again(core) {
            Ok(true) => self.welcome_back(core, how),
            Ok(false) => self.retire(core, &how),
            Err(error) => self.retire(core, &format!("{how}; {error}")),
        }
    }

    fn welcome_back(&mut self, core: u16, why: String) {
        self.take_leases_back(core);
        if let Work::Leased(leases) = &mut self.work {
            leases.started_again(core);
        }
        let record = &mut self.cores[usize::from(core)];
        let time = record.restarts.len() + 1;
        self.progress.say(&format!(
            "core {core} is started again ({time} of {RESTARTS}): {why}"
        ));
        record.start_again(why);
    }

    fn retire(&mut self, core: u16, how: &str) {
        self.cores[usize::from(core)].ended = Some(how.to_owned());
        self.progress.say(&format!("core {core} is gone: {how}"));
        self.take_leases_back(core);
    }

    fn take_leases_back(&mut self, core: u16) {
        if let Work::Leased(leases) = &mut self.work {
            leases.ended(core);
        }
    }

    /// Sends to where the core was last heard. A packet that cannot be sent is a lost one, and made good like any other.
    fn send(&self, core: u16, command: Command) {
        let mut payload = [0; MAX_PAYLOAD];
        let len = ToCore {
            core,
            session: self.session.id,
            command,
        }
        .encode(&mut payload);
        if let Some(source) = self.cores[usize::from(core)].source {
            let _lost = self.socket.send_to(&payload[..len], source);
        }
    }

    /// When any core last said something; the start, if none ever did.
    fn last_word(&self) -> Duration {
        let heard = self.cores.iter().filter_map(|core| core.heard).max();
        heard.unwrap_or_default()
    }

    /// Why nothing more will come, if so.
    fn desertion(&self) -> Option<String> {
        let all_ended = self.cores.iter().all(|core| core.ended.is_some());
        let limit = self.silence.limit(self.fleet);
        let silent = limit.is_some_and(|limit| self.now.saturating_sub(self.last_word()) >= limit);
        if !all_ended && !silent {
            return None;
        }
        let (units, state) = (self.session.plan.units().unwrap_or(u32::MAX), self.state());
        let what = if all_ended {
            "all cores have ended"
        } else {
            "no core says anything any more"
        };
        let mut text = format!("{what}, with {} of {units} units in", state.units);
        for record in &self.cores {
            text.push_str(&record.describe(self.fleet, self.now));
        }
        if let Some(rejection) = self.last_rejection {
            text.push_str(&format!(
                "\n  {} packets were rejected; of the last: {rejection}",
                self.packets.rejected
            ));
        }
        Some(text)
    }

    fn state(&self) -> State {
        State {
            elapsed: (self.clock)(),
            units: self.cores.iter().map(|core| core.units).sum(),
            samples: self.samples,
            wanted: self.session.samples(),
            packets: self.packets.received,
        }
    }

    fn show(&mut self) {
        let state = self.state();
        self.progress.show(&state);
    }

    /// Tells the cores to stop and waits a little for their last reports. What else comes is counted but not added.
    fn close(&mut self) -> Result<(), CollectError> {
        let mut gone = HashSet::new();
        let (end, mut next_stop) = (self.now + FAREWELL_TIME, Duration::ZERO);
        let mut buffer = [0; MAX_PAYLOAD + 1];
        loop {
            let waiting: Vec<u16> = self
                .cores
                .iter()
                .filter(|core| core.source.is_some() && core.farewell.is_none() && core.ended.is_none())
                .filter(|core| !gone.contains(&core.core))
                .map(|core| core.core)
                .collect();
            if waiting.is_empty() || self.now >= end {
                return Ok(());
            }
            if self.now >= next_stop {
                waiting.iter().for_each(|&core| self.send(core, Command::Stop));
                next_stop = self.now + STOP_EVERY;
            }
            if let Some((len, source)) = self.receive(&mut buffer)? {
                self.judge(&buffer[..len], source);
            } else {
                gone.extend(self.fleet.newly_ended());
            }
        }
    }
}
