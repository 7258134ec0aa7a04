//! The checksum.

/// CRC-32 as in Ethernet and PNG (reflected, polynomial 0x04C11DB7). A scene's id is the CRC-32 of its blob.
///
/// Bit by bit: a core does this once, over a few KiB, and a table would cost it a KiB of code memory.
#[inline(never)]
pub const fn crc32(bytes: &[u8]) -> u32 {
    let mut crc = u32::MAX;
    let mut at = 0;
    while at < bytes.len() {
        crc ^= bytes[at] as u32;
        let mut bit = 0;
        while bit < 8 {
            crc = (crc >> 1) ^ (0xEDB8_8320 & (crc & 1).wrapping_neg());
            bit += 1;
        }
        at += 1;
    }
    !crc
}
