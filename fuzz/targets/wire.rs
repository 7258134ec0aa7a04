//! Everything that comes from outside: decoding must not panic, and what decodes must encode to the same bytes.
#![no_main]

use libfuzzer_sys::fuzz_target;
use wire::{Boot, FromCore, MAX_PAYLOAD, ToCore, boot, crc32};

/// Offsets of the SDP flags and tag, which decoding ignores.
const FLAGS_AND_TAG: core::ops::Range<usize> = 2..4;

fn same(ours: &mut [u8], theirs: &[u8]) {
    ours[FLAGS_AND_TAG].copy_from_slice(&theirs[FLAGS_AND_TAG]);
    assert_eq!(ours, theirs);
}

fn check_block(bytes: &[u8]) {
    if let Ok(block) = Boot::decode(bytes) {
        let mut out = [0xa5; boot::MAX_LEN];
        // A block may lie in more memory than a core keeps for it, and be longer.
        if let Ok(len) = block.encode(&mut out) {
            assert_eq!(out[..len], bytes[..len]);
        }
    }
}

/// Puts the header's checksum right, which chance would not.
fn with_checksum(bytes: &[u8]) -> Option<Vec<u8>> {
    let mut block = bytes.to_vec();
    let header = block.first_chunk_mut::<{ boot::HEADER_LEN }>()?;
    let (fields, checksum) = header.split_last_chunk_mut::<4>()?;
    *checksum = crc32(fields).to_le_bytes();
    Some(block)
}

fuzz_target!(|bytes: &[u8]| {
    let mut out = [0xa5; MAX_PAYLOAD];
    if let Ok(packet) = FromCore::decode(bytes) {
        let len = packet.encode(&mut out);
        same(&mut out[..len], bytes);
    }
    if let Ok(packet) = ToCore::decode(bytes) {
        let len = packet.encode(&mut out);
        same(&mut out[..len], bytes);
    }
    check_block(bytes);
    if let Some(block) = with_checksum(bytes) {
        check_block(&block);
    }
});
