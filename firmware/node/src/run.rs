//! A core from its boot block on.

use fixedmath::I16F16;
use tracer::camera::{Camera, CameraRecord};
use tracer::integrator::Integrator;
use tracer::profile::Profile;
use tracer::scene::{Capabilities, Scene};
use tracer::unit::{Plan, Sums, Termination};
use wire::{Boot, Name, boot};

use crate::clock::Clock;
use crate::fault::Fault;
use crate::network::Network;
use crate::worker::{Outcome, StackUse, Worker};

/// Runs the core that `boot` describes until it is told to stop.
///
/// `board` is the name that HELLO gives. `stack` measures the stack when the work is over.
pub fn run<P: Profile, I: Integrator<P>>(
    boot: &Boot<'_>,
    board: Name,
    network: &mut dyn Network,
    clock: &mut dyn Clock,
    stack: fn() -> StackUse,
) -> Result<Outcome, Fault> {
    if boot.profile != Name::new(P::NAME) {
        return Err(Fault::Profile);
    }
    let (scene, record) = scene(boot, I::CAPABILITIES)?;
    let plan = plan(boot);
    let (camera, integrator) = (Camera::new(record), I::new(&plan));
    let mut renderer =
        |unit, sums: &mut Sums| tracer::unit::render::<P>(&integrator, &scene, &camera, &plan, unit, sums);
    Worker::new(boot, plan, board, &mut renderer, network, clock)?.run(stack)
}

/// The scene and the camera, for an image with these capabilities.
#[inline(never)]
fn scene<'b>(boot: &Boot<'b>, image: Capabilities) -> Result<(Scene<'b>, &'b CameraRecord), Fault> {
    let record = CameraRecord::of_bytes(boot.camera).ok_or(Fault::Scene)?;
    let scene = Scene::view(boot.scene, image)?.seen_from(record, image)?;
    Ok((scene, record))
}

/// What the tracer has to know of the boot block.
#[inline(never)]
pub fn plan(boot: &Boot<'_>) -> Plan {
    Plan {
        width: boot.width,
        height: boot.height,
        spp: boot.spp,
        samples_per_unit: boot.samples_per_unit,
        seed: boot.seed,
        termination: match boot.termination {
            boot::Termination::Roulette => Termination::Roulette,
            boot::Termination::Depth(depth) => Termination::Depth(depth.get()),
        },
        epsilon: I16F16::from_bits(boot.epsilon),
    }
}
