//! What fuzzing starts from: what this code itself writes, so that no seed is of an older format.

use std::fs;
use std::path::Path;

use host::image::openexr;
use host::image::picture::{Estimate, Picture};
use host::platform::workspace;
use host::scene::{Integrator, Scene, compile};
use wire::boot::{PixelOrder, Termination};
use wire::{
    Boot, Command, Farewell, FaultInfo, FromCore, Hello, MAX_PAYLOAD, Message, Name, PixelSums, Pixels,
    ToCore, boot,
};

/// Where the scene texts are, which are seeds as they are.
pub(super) const SCENES: [&str; 4] = ["scenes", "scenes/extra", "scenes/hard", "tests/scenes"];

/// Writes the seeds of each target into a folder of its name.
pub(super) fn write(folder: &Path) -> anyhow::Result<()> {
    let packets = packets();
    for (number, packet) in packets.iter().enumerate() {
        seed(folder, "wire", &format!("packet-{number}"), packet)?;
    }
    seed(folder, "capture", "packets", &capture(&packets))?;
    for scenes in SCENES {
        for file in fs::read_dir(workspace::file(scenes)?)? {
            let path = file?.path();
            if path.extension().is_some_and(|extension| extension == "toml") {
                scene(folder, &path)?;
            }
        }
    }
    picture(folder)?;
    let proof = fs::read(workspace::file("fixedmath/proof.json")?)?;
    seed(folder, "report", "proof", &proof)
}

/// Pictures with and without what only ours have.
fn picture(folder: &Path) -> anyhow::Result<()> {
    let folder = folder.join("picture");
    fs::create_dir_all(&folder)?;
    let pixels = vec![Some([0.25, 12.5, 0.0]); 6];
    let plain = Estimate {
        picture: Picture::new(3, 2, pixels),
        variance: None,
        spp: None,
    };
    openexr::write(&folder.join("plain"), &plain)?;
    let ours = Estimate {
        variance: Some(vec![[0.5, 0.25, 0.125]; 6]),
        spp: Some(16),
        ..plain
    };
    openexr::write(&folder.join("ours"), &ours)?;
    Ok(())
}

fn seed(folder: &Path, target: &str, name: &str, bytes: &[u8]) -> anyhow::Result<()> {
    let folder = folder.join(target);
    fs::create_dir_all(&folder)?;
    Ok(fs::write(folder.join(name), bytes)?)
}

/// A scene as cores have it, alone and in its boot block.
fn scene(folder: &Path, file: &Path) -> anyhow::Result<()> {
    let scene = Scene::load(file)?;
    let compiled = compile(&scene, 64, 48, Integrator::NextEvent);
    let (camera, blob) = (bytemuck::bytes_of(&compiled.camera), compiled.blob.bytes());
    seed(folder, "scene-blob", &scene.name, &[camera, blob].concat())?;
    let block = Boot {
        core: 1,
        cores: 4,
        session: 7,
        epoch: 0,
        width: 64,
        height: 48,
        samples_per_unit: 16,
        spp: 64,
        seed: 1,
        epsilon: 16,
        termination: Termination::Roulette,
        order: PixelOrder::Leased,
        profile: Name::new("precise"),
        collector: [10, 0, 2, 2],
        port: wire::DEFAULT_PORT,
        address: [10, 0, 2, 15],
        camera,
        scene: blob,
    };
    let mut bytes = [0; boot::MAX_LEN];
    let len = block.encode(&mut bytes)?;
    seed(folder, "wire", &scene.name, &bytes[..len])?;
    Ok(())
}

/// One packet of each kind.
fn packets() -> Vec<Vec<u8>> {
    let messages = [
        Message::Hello(Hello {
            version: wire::VERSION,
            scene: 1,
            board: Name::new("versatilepb"),
            profile: Name::new("precise"),
        }),
        Message::Pixels(Pixels {
            unit: 3,
            epoch: 0,
            samples: 64,
            scene: 1,
            ticks: 1000,
            rays: 640,
            sums: PixelSums::new(&[[1, 2, wire::SUM_MAX]; wire::MAX_PIXELS]).expect("they fit"),
        }),
        Message::Farewell(Farewell {
            rejected: 3,
            stack_used: 0x0af0,
            stack_size: 0x4000,
        }),
        Message::Fault(FaultInfo {
            address: Some(0x1a34),
            reason: "bad é",
        }),
    ];
    let from_cores = messages.into_iter().map(|message| {
        let mut bytes = [0; MAX_PAYLOAD];
        let packet = FromCore {
            core: 17,
            seq: 5,
            session: 7,
            message,
        };
        let len = packet.encode(&mut bytes);
        bytes[..len].to_vec()
    });
    let lease = Command::Lease {
        number: 1,
        first: 0,
        count: 2,
    };
    let commands = [lease, Command::Stop];
    let to_cores = commands.into_iter().map(|command| {
        let mut bytes = [0; MAX_PAYLOAD];
        let packet = ToCore {
            core: 17,
            session: 7,
            command,
        };
        let len = packet.encode(&mut bytes);
        bytes[..len].to_vec()
    });
    from_cores.chain(to_cores).collect()
}

/// The packets in a file as QEMU records them: a header, then a frame each.
fn capture(packets: &[Vec<u8>]) -> Vec<u8> {
    // Magic, version 2.4, zone and accuracy, longest frame, Ethernet.
    let words = [0xa1b2_c3d4_u32, 0x0004_0002, 0, 0, 0x1_0000, 1];
    let mut file: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    for packet in packets {
        let udp = 8 + packet.len() as u16;
        let [ip_len, udp_len] = [20 + udp, udp].map(u16::to_be_bytes);
        let [port, unused] = [wire::DEFAULT_PORT, 0].map(u16::to_be_bytes);
        let frame = [
            &[2, 0, 0, 0, 0, 1, 2, 0, 0, 0, 0, 2, 0x08, 0x00],
            &[0x45, 0, ip_len[0], ip_len[1], 0, 0, 0, 0, 64, 17, 0, 0][..],
            &[10, 0, 2, 15, 10, 0, 2, 2],
            &[port, port, udp_len, unused].concat(),
            packet,
        ]
        .concat();
        let len = frame.len() as u32;
        file.extend([0, 0, len, len].iter().flat_map(|word| word.to_le_bytes()));
        file.extend(frame);
    }
    file
}
