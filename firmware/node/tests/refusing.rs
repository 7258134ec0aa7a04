//! Jobs that a core refuses before it says a word, and the fault that it reports.

use bytemuck::Zeroable;
use node::{Clock, Fault, Network, SendError, StackUse};
use tracer::camera::CameraRecord;
use tracer::integrator::Path;
use tracer::profile::Precise;
use tracer::scene::All;
use wire::boot::{PixelOrder, Termination};
use wire::{Boot, FaultInfo, FromCore, Message, Name};

/// Keeps what is sent, as long as there is room for it.
#[derive(Default)]
struct Mailbox {
    sent: Vec<Vec<u8>>,
    full: bool,
}

impl Network for &mut Mailbox {
    fn send(&mut self, payload: &[u8]) -> Result<(), SendError> {
        if self.full {
            return Err(SendError);
        }
        self.sent.push(payload.to_vec());
        Ok(())
    }

    fn receive(&mut self, _buffer: &mut [u8]) -> Option<usize> {
        None
    }

    fn wait(&mut self, _ticks: u32) {}
}

struct Stopped;

impl Clock for Stopped {
    fn ticks(&mut self) -> u32 {
        0
    }
}

fn job() -> Boot<'static> {
    Boot {
        core: 20,
        cores: 21,
        session: 77,
        epoch: 0,
        width: 16,
        height: 1,
        samples_per_unit: 4,
        spp: 4,
        seed: 0,
        epsilon: 0,
        termination: Termination::Roulette,
        order: PixelOrder::Leased,
        profile: Name::new("precise"),
        collector: [10, 0, 2, 2],
        port: 17893,
        address: [10, 0, 2, 15],
        camera: &[],
        scene: b"this is no scene",
    }
}

fn refused(boot: &Boot<'_>) -> Fault {
    let mut mailbox = Mailbox::default();
    let outcome = node::run::<Precise, Path<Precise, All>>(
        boot,
        Name::new("fake"),
        &mut &mut mailbox,
        &mut Stopped,
        StackUse::default,
    );
    assert!(mailbox.sent.is_empty(), "a core that cannot work asks for none");
    outcome.unwrap_err()
}

#[test]
fn a_job_for_another_profile() {
    let profile = Name::new("paper");
    assert_eq!(refused(&Boot { profile, ..job() }), Fault::Profile);
}

#[test]
fn a_scene_that_is_none() {
    assert_eq!(refused(&job()), Fault::Scene, "it has no camera either");
    let camera = CameraRecord::zeroed();
    let seen = Boot {
        camera: bytemuck::bytes_of(&camera),
        ..job()
    };
    assert_eq!(refused(&seen), Fault::Scene);
    assert_eq!(refused(&Boot { scene: &[], ..seen }), Fault::Scene);
}

#[test]
fn a_fault_names_the_core() {
    let mut mailbox = Mailbox::default();
    let reason = Fault::Scene.as_str();
    let address = Some(0x1A34);
    node::send_fault(&job(), &mut &mut mailbox, address, reason).unwrap();
    let expected = FromCore {
        core: 20,
        seq: 0,
        session: 77,
        message: Message::Fault(FaultInfo { address, reason }),
    };
    assert_eq!(FromCore::decode(&mailbox.sent[0]), Ok(expected));
}

#[test]
fn a_fault_is_sent_once() {
    let mut mailbox = Mailbox {
        full: true,
        ..Mailbox::default()
    };
    let refused = node::send_fault(&job(), &mut &mut mailbox, None, "!");
    assert_eq!(refused, Err(SendError));
}
