//! The loop around the [engine](Engine): it empties the socket, looks after the fleet, and passes on what comes of that.

use std::collections::HashSet;
use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::os::fd::AsFd;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use wire::MAX_PAYLOAD;

use super::attended::Attended;
use super::cores::Cause;
use super::engine::{Engine, Moment};
use super::events::Event;
use super::silence::Silence;
use super::{CollectError, Collection, End};
use crate::fleet::Fleet;
use crate::fleet::session::Session;
use crate::platform::console::in_full;
use crate::platform::wait;

/// How long the socket is waited for at once, and so how often deaths and late leases are looked for.
const TICK: Duration = Duration::from_millis(10);
/// How long cores that were told to stop are waited for.
const FAREWELL_TIME: Duration = Duration::from_secs(2);
/// STOP is said again this often to a core that has not answered.
const STOP_EVERY: Duration = Duration::from_millis(100);

/// Collects the session's picture from its cores, and tells `observer` what happens. It is called in this thread, between two looks at
/// the socket, and must not take long.
///
/// Returns also when the fleet is gone or `interrupted` gets true, with what came until then; when all cores have been silent for
/// `patience`, too, and of [cores that nobody sees](Silence) also without it. Whatever the end, the cores that are left have been
/// told to stop.
pub fn collect(
    session: &Session,
    socket: &UdpSocket,
    fleet: &mut dyn Fleet,
    patience: Option<Duration>,
    interrupted: &AtomicBool,
    observer: &mut dyn FnMut(Event),
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
        observer,
    )
}

/// The same by any clock.
pub(super) fn collect_by(
    clock: &dyn Fn() -> Duration,
    session: &Session,
    socket: &UdpSocket,
    fleet: &mut dyn Fleet,
    silence: Silence,
    interrupted: &AtomicBool,
    observer: &mut dyn FnMut(Event),
) -> Result<Collection, CollectError> {
    socket.set_nonblocking(true)?;
    let mut run = Run {
        clock,
        socket,
        engine: Engine::new(session, fleet, silence)?,
        fleet,
        observer,
        attended: Attended::default(),
        at: Moment::default(),
    };
    let end = run.work(interrupted)?;
    let elapsed = clock();
    run.close()?;
    run.tell();
    Ok(run.engine.collection(end, elapsed))
}

struct Run<'a> {
    clock: &'a dyn Fn() -> Duration,
    socket: &'a UdpSocket,
    engine: Engine<'a>,
    fleet: &'a mut dyn Fleet,
    observer: &'a mut dyn FnMut(Event),
    attended: Attended,
    at: Moment,
}

impl Run<'_> {
    /// Until the picture is complete or cannot become so.
    fn work(&mut self, interrupted: &AtomicBool) -> Result<End, CollectError> {
        let mut next_look = Duration::ZERO;
        let mut buffer = [0; MAX_PAYLOAD + 1];
        while !self.engine.is_complete() {
            if interrupted.load(Ordering::Relaxed) {
                return Ok(End::Interrupted);
            }
            let received = self.receive(&mut buffer)?;
            if let Some((len, source)) = received {
                self.take(&buffer[..len], source)?;
            }
            if self.at.now < next_look {
                continue;
            }
            next_look = self.at.now + TICK;
            self.look_after_cores()?;
            // The packets of cores that have ended may still be in the socket: only an empty one is the end.
            if received.is_some() {
                continue;
            }
            if self.engine.is_deserted(self.at.now) {
                let why = self.engine.describe_desertion(self.fleet, self.at.now);
                return Ok(End::Deserted(why));
            }
            self.engine.mind_silence(self.at.now);
        }
        Ok(End::Complete)
    }

    fn take(&mut self, payload: &[u8], source: SocketAddr) -> Result<(), CollectError> {
        self.engine.take(payload, source, self.at)?;
        self.send();
        Ok(())
    }

    /// Notices deaths, warnings and silence, and passes on what comes of that.
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
            (self.observer)(Event::Logged(warning));
        }
        self.engine.tick(self.at.now);
        self.send();
        self.tell();
        (self.observer)(Event::State(self.engine.state((self.clock)())));
        Ok(())
    }

    /// Tells the observer what has happened.
    fn tell(&mut self) {
        self.engine.events().into_iter().for_each(&mut self.observer);
    }

    /// Takes all that has arrived.
    fn drain(&mut self) -> Result<(), CollectError> {
        let mut buffer = [0; MAX_PAYLOAD + 1];
        while !self.engine.is_complete()
            && let Some((len, source)) = self.take_from_socket(&mut buffer)?
        {
            self.take(&buffer[..len], source)?;
        }
        Ok(())
    }

    /// The core has ended before it was told to: it is started again, or gone for good.
    fn part_from(&mut self, core: u16) {
        let record = &self.engine.cores[usize::from(core)];
        if record.ended.is_some() {
            return;
        }
        let cause = record.cause(|| self.fleet.how_ended(core));
        match self.fleet.start_again(core) {
            Ok(true) => self.engine.started_again(core, cause),
            Ok(false) => self.engine.retire(core, cause),
            Err(error) => {
                let why = format!("{cause}; {}", in_full(&error));
                self.engine.retire(core, Cause::Ended(why));
            }
        }
    }

    /// Tells the cores to stop and waits a little for their last reports. What else comes is counted but not added.
    fn close(&mut self) -> Result<(), CollectError> {
        let mut gone = HashSet::new();
        let (end, mut next_stop) = (self.at.now + FAREWELL_TIME, Duration::ZERO);
        let mut buffer = [0; MAX_PAYLOAD + 1];
        loop {
            let mut working = self.engine.working();
            working.retain(|core| !gone.contains(core));
            if working.is_empty() || self.at.now >= end {
                return Ok(());
            }
            if self.at.now >= next_stop {
                self.engine.stop(&working);
                self.send();
                next_stop = self.at.now + STOP_EVERY;
            }
            if let Some((len, source)) = self.receive(&mut buffer)? {
                self.engine.take_late(&buffer[..len], source, self.at);
            } else {
                gone.extend(self.fleet.newly_ended());
            }
        }
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
        self.at.now = self.attended.look((self.clock)());
        match self.socket.recv_from(buffer) {
            Ok(received) => Ok(Some(received)),
            Err(error) => match error.kind() {
                io::ErrorKind::WouldBlock => {
                    self.at.emptied = self.at.now;
                    Ok(None)
                }
                io::ErrorKind::Interrupted => Ok(None),
                _ => Err(error),
            },
        }
    }

    /// Sends what is to be sent. A packet that cannot be is a lost one, and made good like any other.
    fn send(&mut self) {
        let mut payload = [0; MAX_PAYLOAD];
        for (to, packet) in self.engine.outbox() {
            let len = packet.encode(&mut payload);
            let _lost = self.socket.send_to(&payload[..len], to);
        }
    }
}
