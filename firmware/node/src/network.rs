//! What carries a core's packets.

/// Carries UDP payloads to the collector and back.
pub trait Network {
    /// Sends one payload to the collector. On an error the packet has not left, and the worker tries again a few times.
    fn send(&mut self, payload: &[u8]) -> Result<(), SendError>;

    /// Takes the next payload, if one has arrived, and returns how many bytes of `buffer` it fills. A payload that is longer than
    /// the buffer is cut; the worker's buffer is a byte longer than the longest valid packet, so that such a one is noticed.
    fn receive(&mut self, buffer: &mut [u8]) -> Option<usize>;

    /// Sleeps until a payload may have arrived, or about `ticks` have passed. May return early; must not return much later.
    fn wait(&mut self, ticks: u32);

    /// Packets for this core that the network has dropped because they were malformed. They count as rejected.
    fn malformed(&self) -> u32 {
        0
    }
}

/// The packet has not left: no buffer is free, or nobody takes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SendError;

impl core::fmt::Display for SendError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the packet could not be sent")
    }
}

impl core::error::Error for SendError {}
