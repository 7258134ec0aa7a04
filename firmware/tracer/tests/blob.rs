//! The scene's bytes: what is written is seen, and nothing else is accepted.

mod support;

use bytemuck::Zeroable;
use fixedmath::{I2F30, I16F16, U0F32};
use proptest::prelude::*;
use support::{Blob, GRID, blob, blob_for, camera, sphere};
use tracer::aggregate::Room;
use tracer::camera::CameraRecord;
use tracer::geometry::sphere::{SolidSphere, SphereRecord, VastSphere};
use tracer::geometry::{Grid, PrimitiveId, PrimitiveSet};
use tracer::light::{BallLight, CapLight, Emitter, Guide, MAX_GUIDES, Magnitude};
use tracer::material::{Kind, MaterialId, MaterialRecord};
use tracer::scene::{BlobError, Capabilities, Capability, Header, MAX_BYTES, MAX_PRIMITIVES, Scene};

/// What one diffuse ball needs.
const DIFFUSE_BALL: Capabilities = Capabilities::of(&[Capability::Solid, Capability::Diffuse]);

const HEADER: usize = size_of::<Header>();
const SPHERE: usize = size_of::<SolidSphere>();
const MATERIAL: usize = size_of::<MaterialRecord>();

/// Where a header has its counts of emitters that are balls, and of guides.
const BALLS_AT: usize = 14;
const GUIDES_AT: usize = 16;

/// A scene with these records behind it, of a kind whose count is at `place` of its header, that needs all but what it is `without`.
fn with_records<T: bytemuck::NoUninit>(
    plain: &Blob,
    place: usize,
    records: &[T],
    without: &[Capability],
) -> Blob {
    let mut bytes = [plain.bytes(), bytemuck::cast_slice(records)].concat();
    bytes[place] = records.len() as u8;
    let mut blob = Blob(vec![0; bytes.len() / 8]);
    let without = without.iter().chain(&[Capability::Room, Capability::Coarse]);
    let needs = without.fold(Capabilities::ALL, |needs, &capability| needs.without(capability));
    bytes[4..8].copy_from_slice(bytemuck::bytes_of(&needs));
    blob.bytes_mut().copy_from_slice(&bytes);
    blob
}

fn counts(blob: &Blob, image: Capabilities) -> Result<(usize, usize), BlobError> {
    let primitives = Scene::view(blob.bytes(), image)?.aggregate.primitives;
    Ok((primitives.hollow_spheres.len(), primitives.solid_spheres.len()))
}

#[test]
fn a_sphere_is_these_bytes() {
    let blob = blob_for(
        DIFFUSE_BALL,
        &[],
        &[sphere([1.0, -1.0, 0.5], 2.0, 0.5, Kind::Diffuse)],
    );
    let words: [u32; 32] = [
        u32::from_le_bytes(*b"FXS6"),
        // The third and the seventh capability.
        0b100_0100,
        // One material, and the grid's shift; no emitter; no guide and no hollow sphere; one solid, and no vast one.
        1 | GRID << 16,
        0,
        0,
        1,
        // A centre of (0, -1, 0) on the grid; a square of less than 2, 4.9 of the longest distance, and 7.
        0xffff_0000,
        0,
        -(2 + 16_384i32 * 49 / 10 + 7) as u32,
        0,
        // Centre and radius, and 4 in 32:32.
        0x1_0000,
        0xffff_0000,
        0x8000,
        0x2_0000,
        0,
        4,
        // 2^60 over a radius of exactly 2^29 is 2^31, which saturates.
        i32::MAX as u32,
        12,
        // Diffuse, dark, of one half.
        0,
        1 << 29,
        0,
        0,
        0,
        1 << 31,
        1 << 31,
        1 << 31,
        u32::MAX,
        u32::MAX,
        u32::MAX,
        0,
        0,
        0,
    ];
    assert_eq!(bytemuck::cast_slice::<u8, u32>(blob.bytes()), words);
    assert_eq!(counts(&blob, Capabilities::ALL), Ok((0, 1)));
}

#[test]
fn faulty_scenes_are_refused() {
    let good = blob_for(DIFFUSE_BALL, &[], &[sphere([0.0; 3], 1.0, 0.5, Kind::Diffuse)]);
    let view = |bytes: &[u8]| Scene::view(bytes, Capabilities::ALL).map(|_| ());
    assert_eq!(view(good.bytes()), Ok(()));
    assert_eq!(view(&good.bytes()[..HEADER - 1]), Err(BlobError::Length));
    assert_eq!(
        view(&good.bytes()[..good.bytes().len() - 1]),
        Err(BlobError::Length)
    );
    let longer = Blob([&good.0[..], &[0]].concat());
    assert_eq!(view(longer.bytes()), Err(BlobError::Length));
    let mut shifted = Blob(vec![0; good.0.len() + 1]);
    let room = &mut shifted.bytes_mut()[4..][..good.bytes().len()];
    room.copy_from_slice(good.bytes());
    assert_eq!(view(room), Err(BlobError::Misaligned));
    let spoiled = |byte: usize, value: u8| {
        let mut bad = good.clone();
        bad.bytes_mut()[byte] = value;
        view(bad.bytes())
    };
    let (ball, material) = (HEADER + SPHERE - size_of::<SphereRecord>(), HEADER + SPHERE);
    assert_eq!(spoiled(0, b'f'), Err(BlobError::BadMagic));
    assert_eq!(
        spoiled(7, 0x80),
        Err(BlobError::NotInThisImage),
        "nobody knows this need"
    );
    assert_eq!(
        spoiled(16, 2),
        Err(BlobError::Length),
        "more spheres than there are"
    );
    assert_eq!(
        spoiled(17, 2),
        Err(BlobError::BadHeader),
        "more than there can be"
    );
    assert_eq!(
        spoiled(12, 2),
        Err(BlobError::BadHeader),
        "more emitters than spheres"
    );
    assert_eq!(
        spoiled(14, 1),
        Err(BlobError::Length),
        "an emitter that is not there"
    );
    assert_eq!(spoiled(10, 32), Err(BlobError::BadHeader), "a grid without bits");
    assert_eq!(
        spoiled(4, 0b100_0000),
        Err(BlobError::BadShape),
        "needs that leave out the ball"
    );
    assert_eq!(
        spoiled(4, 0b100),
        Err(BlobError::BadMaterial),
        "needs that leave out its material"
    );
    assert_eq!(spoiled(ball + 28, 32), Err(BlobError::BadShape), "a shift");
    assert_eq!(spoiled(ball + 29, 2), Err(BlobError::BadShape), "an inside");
    assert_eq!(
        spoiled(ball + 30, 1),
        Err(BlobError::BadShape),
        "a material that is not there"
    );
    assert_eq!(
        spoiled(material, 3),
        Err(BlobError::BadMaterial),
        "an unknown BSDF"
    );
}

#[test]
fn a_room_has_walls_that_there_are() {
    let wall = sphere([0.0; 3], 9.0, 0.5, Kind::Diffuse);
    let plain = blob(&[wall], &[]);
    let with = |primitive: usize| {
        let mut room = Room::zeroed();
        for wall in room.walls.as_flattened_mut() {
            wall.primitive = PrimitiveId::new(primitive);
        }
        let mut bytes = plain.bytes().to_vec();
        bytes.splice(HEADER..HEADER, bytemuck::bytes_of(&room).iter().copied());
        bytes[4] |= 1 << Capability::Room as u8;
        let mut blob = Blob(vec![0; bytes.len() / 8]);
        blob.bytes_mut().copy_from_slice(&bytes);
        Scene::view(blob.bytes(), Capabilities::ALL).map(|scene| scene.aggregate.room == Some(&room))
    };
    assert_eq!(with(0), Ok(true));
    assert_eq!(with(1), Err(BlobError::BadShape));
}

#[test]
fn emitters_are_of_a_kind_and_a_material_that_there_is() {
    let plain = blob(&[], &[sphere([0.0; 3], 1.0, 0.5, Kind::Diffuse)]);
    let light = BallLight {
        radius: I16F16::ONE,
        reach: Magnitude::new(2, 0),
        ..BallLight::zeroed()
    };
    let with = |light: BallLight, without: &[Capability]| {
        let blob = with_records(&plain, BALLS_AT, &[light], without);
        Scene::view(blob.bytes(), Capabilities::ALL).map(|scene| scene.lights.balls == [light])
    };
    assert_eq!(with(light, &[]), Ok(true));
    for missing in [Capability::Lights, Capability::BallLights] {
        assert_eq!(with(light, &[missing]), Err(BlobError::BadLight));
    }
    for bad in [
        BallLight {
            radius: I16F16::ZERO,
            ..light
        },
        BallLight {
            reach: Magnitude::zeroed(),
            ..light
        },
        BallLight {
            reach: Magnitude::new(1, 1 << 20),
            ..light
        },
        BallLight {
            emitter: Emitter {
                material: MaterialId::new(1),
                ..light.emitter
            },
            ..light
        },
        BallLight {
            emitter: Emitter {
                flags: Emitter::HOLLOW,
                ..light.emitter
            },
            ..light
        },
        BallLight {
            emitter: Emitter {
                flags: 4,
                ..light.emitter
            },
            ..light
        },
    ] {
        assert_eq!(with(bad, &[]), Err(BlobError::BadLight), "{bad:?}");
    }
}

#[test]
fn guides_are_sound() {
    let plain = blob(&[], &[sphere([0.0; 3], 1.0, 0.5, Kind::Diffuse)]);
    let guide = Guide {
        radius: I16F16::ONE,
        spread: I2F30::from_num(0.5),
        reach: Magnitude::new(2, 0),
        steps: Guide::MOST_STEPS,
        ..Guide::zeroed()
    };
    let with = |guides: &[Guide], without: &[Capability]| {
        let blob = with_records(&plain, GUIDES_AT, guides, without);
        Scene::view(blob.bytes(), Capabilities::ALL).map(|scene| scene.lights.guides == guides)
    };
    assert_eq!(with(&[guide; MAX_GUIDES], &[]), Ok(true));
    assert_eq!(with(&[guide; MAX_GUIDES + 1], &[]), Err(BlobError::BadHeader));
    assert_eq!(with(&[guide], &[Capability::Guides]), Err(BlobError::BadLight));
    for bad in [
        Guide {
            radius: I16F16::ZERO,
            ..guide
        },
        Guide {
            spread: I2F30::ZERO,
            ..guide
        },
        Guide {
            reach: Magnitude::zeroed(),
            ..guide
        },
        Guide {
            steps: Guide::MOST_STEPS + 1,
            ..guide
        },
    ] {
        assert_eq!(with(&[bad], &[]), Err(BlobError::BadLight), "{bad:?}");
    }
}

#[test]
fn an_image_takes_no_more_than_it_can_do() {
    let mirror = blob_for(
        Capabilities::of(&[Capability::Solid, Capability::Mirror]),
        &[],
        &[sphere([0.0; 3], 1.0, 0.5, Kind::Mirror)],
    );
    assert_eq!(counts(&mirror, DIFFUSE_BALL), Err(BlobError::NotInThisImage));
    assert_eq!(counts(&mirror, DIFFUSE_BALL.with(Capability::Mirror)), Ok((0, 1)));
}

#[test]
fn a_camera_within_a_solid_needs_code_for_its_inside() {
    let blob = blob_for(DIFFUSE_BALL, &[], &[sphere([0.0; 3], 1.0, 0.5, Kind::Diffuse)]);
    let mut camera = camera(8);
    let seen = |camera: &CameraRecord, image| {
        Scene::view(blob.bytes(), image)
            .unwrap()
            .seen_from(camera, image)
            .map(|_| ())
    };
    assert_eq!(seen(&camera, DIFFUSE_BALL), Ok(()));
    camera.opened.insert(PrimitiveId::new(0));
    assert_eq!(seen(&camera, DIFFUSE_BALL), Err(BlobError::NotInThisImage));
    assert_eq!(seen(&camera, DIFFUSE_BALL.with(Capability::TwoSided)), Ok(()));
}

#[test]
fn a_black_wall_needs_no_diffuse_code() {
    let needs = Capabilities::of(&[Capability::Hollow]);
    let wall = |reflectance| blob_for(needs, &[sphere([0.0; 3], 9.0, reflectance, Kind::Diffuse)], &[]);
    assert_eq!(counts(&wall(0.0), needs), Ok((1, 0)));
    assert_eq!(counts(&wall(0.5), needs), Err(BlobError::BadMaterial));
}

#[test]
fn as_many_spheres_as_there_may_be() {
    let ball = sphere([0.0; 3], 1.0, 0.5, Kind::Diffuse);
    let most = blob(&[], &vec![ball; MAX_PRIMITIVES]);
    let lights = MAX_PRIMITIVES * size_of::<BallLight>();
    let guides = MAX_GUIDES * size_of::<Guide>();
    assert_eq!(
        most.bytes().len() + size_of::<Room>() + lights + guides,
        MAX_BYTES
    );
    assert_eq!(counts(&most, Capabilities::ALL), Ok((0, MAX_PRIMITIVES)));
    let more = blob(&[ball], &vec![ball; MAX_PRIMITIVES]);
    assert_eq!(counts(&more, Capabilities::ALL), Err(BlobError::BadHeader));
}

#[test]
fn capabilities_have_a_word_each() {
    for (index, capability) in Capability::ALL.iter().enumerate() {
        let alone = Capabilities::of(&[*capability]);
        assert_eq!(alone.to_string(), capability.word());
        assert_eq!(alone.iter().collect::<Vec<_>>(), [*capability]);
        assert!(
            Capability::ALL[..index]
                .iter()
                .all(|other| other.word() != capability.word())
        );
        assert!(Capabilities::ALL.covers(alone) && !Capabilities::NONE.covers(alone));
    }
}

#[test]
fn sets_of_primitives() {
    let mut set = PrimitiveSet::EMPTY;
    for index in [0, 31, 32, 255, 256, 100_000] {
        let primitive = PrimitiveId::new(index);
        assert!(!set.contains(primitive));
        set.insert(primitive);
        assert_eq!(set.contains(primitive), index < MAX_PRIMITIVES, "{index}");
    }
    assert!(!set.contains(PrimitiveId::new(1)) && !set.is_empty());
}

/// What the list says of each record is what its fields are.
#[test]
fn a_material_says_what_it_is() {
    let mut record = sphere([0.0; 3], 1.0, 0.25, Kind::Mirror).material;
    assert_eq!(record.kind(), Some(Kind::Mirror));
    assert_eq!(record.capability(), Some(Capability::Mirror));
    assert!(!record.absorbs_all() && !record.emits());
    record.bsdf = 3;
    assert_eq!((record.kind(), record.capability()), (None, None));
    record.continuation = I2F30::ZERO;
    assert!(record.absorbs_all());
    assert_eq!(record.reflectance, [U0F32::from_num(0.25); 3]);
    assert_eq!(MaterialId::new(9).index(), 9);
}

proptest! {
    #[test]
    fn no_bytes_make_a_view_panic(
        mut words in prop::collection::vec(any::<u64>(), 3..90),
        materials in 0u16..6,
        hollow in 0u16..6,
        solid in 0u16..6,
        vast in 0u16..6,
        caps in 0u16..6,
        balls in 0u16..6,
        guides in 0u16..6,
    ) {
        let header = Header::new(Capabilities::ALL, materials, Grid::new(GRID), [hollow, solid, vast], [caps, balls, guides]);
        bytemuck::cast_slice_mut(&mut words)[..HEADER].copy_from_slice(bytemuck::bytes_of(&header));
        let whole = HEADER
            + size_of::<Room>()
            + usize::from(hollow) * size_of::<SphereRecord>()
            + usize::from(solid) * SPHERE
            + usize::from(vast) * size_of::<VastSphere>()
            + usize::from(materials) * MATERIAL
            + usize::from(caps) * size_of::<CapLight>()
            + usize::from(balls) * size_of::<BallLight>()
            + usize::from(guides) * size_of::<Guide>();
        let _ = counts(&Blob(words.clone()), Capabilities::ALL);
        words.resize(whole / 8, 0x0001_0000_0000_0000);
        let _ = counts(&Blob(words), Capabilities::ALL);
    }
}
