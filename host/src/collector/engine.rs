//! What a collection does, without a socket, a fleet or a clock: packets and what became of cores go in, with the time; packets to
//! cores, [events](Event) and a film come out.

use std::net::SocketAddr;
use std::path::Path;
use std::time::Duration;

use wire::boot::PixelOrder;
use wire::{Command, FromCore, Message, Pixels, ToCore};

use super::cores::{Cause, CoreRecord};
use super::events::{Event, State};
use super::intake::{Rejection, judge};
use super::leases::{Arrival, Grant, Leases};
use super::silence::Silence;
use super::{CollectError, Collection, End, Packets};
use crate::fleet::session::Session;
use crate::fleet::{Fleet, Policy};
use crate::image::film::Film;

/// When something is done.
#[derive(Clone, Copy, Debug, Default)]
pub struct Moment {
    /// The time [attended](super::attended::Attended) until now: what all else goes by.
    pub now: Duration,
    /// When the socket was last seen empty: no packet in it was sent before.
    pub emptied: Duration,
}

/// A collection under way.
#[derive(Debug)]
pub struct Engine<'a> {
    session: &'a Session,
    policy: Policy,
    silence: Silence,
    film: Film,
    packets: Packets,
    pub(super) cores: Vec<CoreRecord>,
    leases: Leases,
    samples: u64,
    last_rejection: Option<Rejection>,
    outbox: Vec<(SocketAddr, ToCore)>,
    events: Vec<Event>,
}

impl<'a> Engine<'a> {
    /// Nothing has been said yet by the cores of `fleet`.
    pub fn new(session: &'a Session, fleet: &dyn Fleet, silence: Silence) -> Result<Self, CollectError> {
        let units = session.plan.units().ok_or(CollectError::TooManyUnits)?;
        let record = |core| CoreRecord {
            core,
            image: fleet.image(core).map(Path::to_owned),
            ..CoreRecord::default()
        };
        Ok(Self {
            session,
            policy: fleet.policy(),
            silence,
            film: Film::new(session.plan.width, session.plan.height).with_exponent(session.exponent),
            packets: Packets::default(),
            cores: (0..session.cores).map(record).collect(),
            leases: Leases::new(units),
            samples: 0,
            last_rejection: None,
            outbox: Vec::new(),
            events: Vec::new(),
        })
    }

    /// What was collected when it came to its `end`, after `elapsed`.
    pub fn collection(mut self, end: End, elapsed: Duration) -> Collection {
        let packets = &mut self.packets;
        packets.lost = self.cores.iter().map(|core| core.sequence.lost()).sum();
        packets.duplicate_share = packets.duplicate as f64 / packets.received.max(1) as f64;
        Collection {
            film: self.film,
            end,
            packets: self.packets,
            cores: self.cores,
            elapsed,
        }
    }

    /// Whether the picture has all its samples.
    pub fn is_complete(&self) -> bool {
        self.samples >= self.session.samples()
    }

    /// What is to be sent, and where to, since the last call.
    pub fn outbox(&mut self) -> Vec<(SocketAddr, ToCore)> {
        std::mem::take(&mut self.outbox)
    }

    /// What has happened since the last call.
    pub fn events(&mut self) -> Vec<Event> {
        std::mem::take(&mut self.events)
    }

    /// Judges a packet, and answers it where it asks for work or makes room for some.
    pub fn take(&mut self, payload: &[u8], source: SocketAddr, at: Moment) -> Result<(), CollectError> {
        let Some(packet) = self.admit(payload, source, at) else {
            return Ok(());
        };
        let core = packet.core;
        match packet.message {
            Message::Hello(_) => {
                let record = &mut self.cores[usize::from(core)];
                if let Some(skipped) = record.sequence.sent_before(packet.seq) {
                    self.leases.idle(core, skipped, at.now);
                }
            }
            Message::Pixels(pixels) => self.take_pixels(core, packet.seq, &pixels, at.now)?,
            Message::Farewell(_) => {}
            // Its end follows, and says whether it has another life.
            Message::Fault(_) if self.policy.sees_ends => self.leases.ended(core),
            Message::Fault(fault) => {
                let fault = self.cores[usize::from(core)].fault(&fault);
                self.retire(core, Cause::Fault(fault));
            }
        }
        for grant in self.leases.again(core, at.emptied, at.now) {
            self.tell(core, grant);
        }
        self.hand_out(core, at.now);
        Ok(())
    }

    /// The accounts of a packet after the end: what it brings is counted, but no longer added.
    pub fn take_late(&mut self, payload: &[u8], source: SocketAddr, at: Moment) {
        let Some(packet) = self.admit(payload, source, at) else {
            return;
        };
        if let Message::Pixels(pixels) = packet.message {
            self.cores[usize::from(packet.core)].sequence.received(packet.seq);
            self.packets.received += 1;
            self.packets.duplicate += u64::from(self.leases.is_done(pixels.unit));
        }
    }

    /// The accounts of a packet, and the packet if it is ours.
    fn admit<'p>(&mut self, payload: &'p [u8], source: SocketAddr, at: Moment) -> Option<FromCore<'p>> {
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
        let before = record.heard.replace(at.now);
        match packet.message {
            Message::Pixels(_) => {
                if let Some(before) = before {
                    self.silence.unit_after(at.now.saturating_sub(before));
                }
            }
            Message::Hello(hello) => record.board = Some(hello.board),
            Message::Farewell(farewell) => {
                record.sequence.sent_before(packet.seq);
                record.farewell = Some(farewell);
            }
            Message::Fault(fault) => record.failed = Some(record.fault(&fault)),
        }
        Some(packet)
    }

    fn take_pixels(
        &mut self,
        core: u16,
        seq: u16,
        pixels: &Pixels,
        now: Duration,
    ) -> Result<(), CollectError> {
        self.packets.received += 1;
        let record = &mut self.cores[usize::from(core)];
        let skipped = record.sequence.received(seq);
        if self.leases.arrived(core, pixels.unit, skipped, now) == Arrival::Duplicate {
            self.packets.duplicate += 1;
            return Ok(());
        }
        let sums: Vec<[u64; 3]> = pixels.sums.iter().collect();
        let first = self.session.plan.extent(pixels.unit).first_pixel;
        self.film.add(first, u32::from(pixels.samples), &sums)?;
        self.samples += sums.len() as u64 * u64::from(pixels.samples);
        record.units += 1;
        record.ticks += u64::from(pixels.ticks);
        record.rays += u64::from(pixels.rays);
        let (unit, ticks) = (pixels.unit, pixels.ticks);
        self.events.push(Event::Unit { core, unit, ticks });
        Ok(())
    }

    /// Gives what has come back of silent cores, and what was lost, to others.
    pub fn tick(&mut self, now: Duration) {
        self.leases.settle(now);
        let late = self.leases.late(now);
        if self.leases.any_speaks() {
            self.events
                .extend(late.into_iter().map(|core| Event::Late { core }));
        }
        for core in self.leases.holders() {
            self.hand_out(core, now);
        }
    }

    /// Grants the core as many leases as it may have.
    fn hand_out(&mut self, core: u16, now: Duration) {
        if self.session.order != PixelOrder::Leased {
            return;
        }
        while let Some(grant) = self.leases.grant(core, now) {
            self.tell(core, grant);
        }
    }

    fn tell(&mut self, core: u16, grant: Grant) {
        let Grant { number, first, count } = grant;
        self.send(core, Command::Lease { number, first, count });
    }

    /// To where the core was last heard.
    fn send(&mut self, core: u16, command: Command) {
        let session = self.session.id;
        if let Some(source) = self.cores[usize::from(core)].source {
            self.outbox.push((
                source,
                ToCore {
                    core,
                    session,
                    command,
                },
            ));
        }
    }

    /// The core has failed and was started again.
    pub fn started_again(&mut self, core: u16, cause: Cause) {
        self.leases.ended(core);
        self.leases.started_again(core);
        let record = &mut self.cores[usize::from(core)];
        record.start_again(cause.clone());
        self.events.push(Event::Restarted {
            core,
            time: record.restarts.len(),
            most: self.policy.restarts,
            cause,
        });
    }

    /// The core has ended for good.
    pub fn retire(&mut self, core: u16, cause: Cause) {
        self.leases.ended(core);
        self.cores[usize::from(core)].ended = Some(cause.clone());
        self.events.push(Event::Retired { core, cause });
    }

    /// The cores that shall stop and have not said farewell yet.
    pub fn working(&self) -> Vec<u16> {
        let working = |core: &&CoreRecord| core.farewell.is_none() && core.ended.is_none();
        let cores = self.cores.iter().filter(|core| core.source.is_some());
        cores.filter(working).map(|core| core.core).collect()
    }

    /// Tells cores to stop.
    pub fn stop(&mut self, cores: &[u16]) {
        cores.iter().for_each(|&core| self.send(core, Command::Stop));
    }

    /// Whether nothing more will come.
    pub fn is_deserted(&self, now: Duration) -> bool {
        let limit = self.silence.limit(self.policy.patience);
        self.all_ended() || limit.is_some_and(|limit| now.saturating_sub(self.last_word()) >= limit)
    }

    /// Tells, once, of a silence of all cores that the user should know about.
    pub fn mind_silence(&mut self, now: Duration) {
        let began = self.last_word();
        let lasts = self.silence.worth_a_word(self.policy.patience, began, now);
        self.events.extend(lasts.map(|lasts| Event::Silence { lasts }));
    }

    /// Why nothing more will come, with all that is known of the cores.
    pub fn describe_desertion(&self, fleet: &dyn Fleet, now: Duration) -> String {
        let (units, done) = (self.session.plan.units().unwrap_or(u32::MAX), self.leases.done());
        let what = if self.all_ended() {
            "all cores have ended"
        } else {
            "no core says anything any more"
        };
        let mut text = format!("{what}, with {done} of {units} units in");
        for record in &self.cores {
            text.push_str(&record.describe(fleet, now));
        }
        if let Some(rejection) = self.last_rejection {
            text.push_str(&format!(
                "\n  {} packets were rejected; of the last: {rejection}",
                self.packets.rejected
            ));
        }
        text
    }

    /// How far it is after `elapsed`.
    pub fn state(&self, elapsed: Duration) -> State {
        State {
            elapsed,
            units: self.leases.done(),
            samples: self.samples,
            wanted: self.session.samples(),
            packets: self.packets.received,
        }
    }

    fn all_ended(&self) -> bool {
        self.cores.iter().all(|core| core.ended.is_some())
    }

    /// When any core last said something; the start, if none ever did.
    fn last_word(&self) -> Duration {
        let heard = self.cores.iter().filter_map(|core| core.heard).max();
        heard.unwrap_or_default()
    }
}
