//! The blob: what is encoded is decoded, and nothing else is accepted.

mod support;

use proptest::prelude::*;
use support::{GLASS, blob, sphere};
use tracer::numbers::Mixed;
use tracer::scene::{
    All, BlobError, HEADER_BYTES, Header, MaterialRecord, Needs, SPHERE_BYTES, Scene, SphereRecord,
};

enum OnlyDiffuse {}

impl Needs for OnlyDiffuse {
    const DIFFUSE: bool = true;
    const MIRROR: bool = false;
    const GLASS: bool = false;
    const TWOSIDED: bool = false;
    const ROULETTE: bool = true;
}

fn decode<F: Needs>(blob: &[u8]) -> Result<(usize, usize), BlobError> {
    let scene = Scene::<Mixed>::decode::<F>(blob)?;
    Ok((scene.hollow().len(), scene.solid().len()))
}

#[test]
fn records_survive_the_round_trip() {
    for material in [MaterialRecord::Diffuse, MaterialRecord::Mirror, GLASS] {
        let record = sphere([1.5, -2.25, 1e4], 16.5, 0.75, material);
        for two_sided in [false, true] {
            let record = SphereRecord { two_sided, ..record };
            assert_eq!(SphereRecord::decode(&record.encode()), Ok(record));
        }
    }
    let blob = blob([1.0, 2.0, 3.0], &[], &[], 64);
    let (header, rest) = Header::decode(&blob).unwrap();
    assert_eq!(
        (header.encode().as_slice(), rest),
        (blob.as_slice(), [].as_slice())
    );
}

#[test]
fn a_sphere_is_these_bytes() {
    let bytes = sphere([1.0, -1.0, 0.5], 2.0, 0.5, MaterialRecord::Mirror).encode();
    let mut expected = [0xa5; SPHERE_BYTES];
    let words: [u32; 21] = [
        0x1_0000,
        0xffff_0000,
        0x8000,
        0x2_0000,
        0,
        4,
        1 << 30,
        12 | 1 << 8,
        0,
        0,
        0,
        1 << 31,
        1 << 31,
        1 << 31,
        u32::MAX,
        u32::MAX,
        u32::MAX,
        1 << 29,
        0,
        0,
        0,
    ];
    // 2^60 over a radius of exactly 2^29 is 2^31, which saturates to the largest i32.
    let words = words.map(|word| if word == 1 << 30 { i32::MAX as u32 } else { word });
    expected
        .chunks_exact_mut(4)
        .zip(words)
        .for_each(|(to, word)| to.copy_from_slice(&word.to_le_bytes()));
    assert_eq!(bytes, expected);
}

#[test]
fn faulty_blobs_are_refused() {
    let good = blob(
        [0.0; 3],
        &[],
        &[sphere([0.0; 3], 1.0, 0.5, MaterialRecord::Mirror)],
        8,
    );
    assert_eq!(decode::<All>(&good), Ok((0, 1)));
    assert_eq!(decode::<OnlyDiffuse>(&good), Err(BlobError::NotInThisImage));
    assert_eq!(
        decode::<All>(&good[..HEADER_BYTES - 1]),
        Err(BlobError::Truncated)
    );
    assert_eq!(decode::<All>(&good[..good.len() - 1]), Err(BlobError::BadCounts));
    let mut bad = good.clone();
    bad[0] ^= 1;
    assert_eq!(decode::<All>(&bad), Err(BlobError::BadMagic));
    let mut bad = good.clone();
    bad[6] = 2;
    assert_eq!(
        decode::<All>(&bad),
        Err(BlobError::BadCounts),
        "more hollow spheres than spheres"
    );
    for (byte, value) in [(29, 3), (30, 2), (31, 1)] {
        let mut bad = good.clone();
        bad[HEADER_BYTES + byte] = value;
        assert_eq!(decode::<All>(&bad), Err(BlobError::BadMaterial));
    }
}

#[test]
fn a_solid_that_is_cut_open_needs_code_for_its_inside() {
    let ball = SphereRecord {
        two_sided: true,
        ..sphere([0.0; 3], 1.0, 0.5, MaterialRecord::Diffuse)
    };
    let blob = blob([0.0; 3], &[], &[ball], 8);
    assert_eq!(decode::<All>(&blob), Ok((0, 1)));
    assert_eq!(decode::<OnlyDiffuse>(&blob), Err(BlobError::NotInThisImage));
}

#[test]
fn a_black_wall_needs_no_diffuse_code() {
    enum Nothing {}
    impl Needs for Nothing {
        const DIFFUSE: bool = false;
        const MIRROR: bool = false;
        const GLASS: bool = false;
        const TWOSIDED: bool = false;
        const ROULETTE: bool = false;
    }
    let wall = |reflectance| {
        blob(
            [0.0; 3],
            &[sphere([0.0; 3], 9.0, reflectance, MaterialRecord::Diffuse)],
            &[],
            8,
        )
    };
    assert_eq!(decode::<Nothing>(&wall(0.0)), Ok((1, 0)));
    assert_eq!(decode::<Nothing>(&wall(0.5)), Err(BlobError::NotInThisImage));
}

proptest! {
    #[test]
    fn no_bytes_make_decoding_panic(mut bytes in prop::collection::vec(any::<u8>(), 0..600), spheres in 0u8..8, hollow in 0u8..8) {
        if let Some(head) = bytes.get_mut(..8) {
            head.copy_from_slice(&[b'F', b'X', b'S', b'1', spheres, 0, hollow, 0]);
        }
        let whole = HEADER_BYTES + usize::from(spheres) * SPHERE_BYTES;
        let _ = decode::<All>(&bytes);
        bytes.resize(whole, 0x5a);
        let _ = decode::<All>(&bytes);
    }
}
