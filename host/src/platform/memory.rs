//! Peak memory, as Linux counts it.

use std::fs;

/// The peak of this process and, added to it, that of its cores' processes; `None` where the system does not say.
pub fn peak(cores: u64) -> Option<u64> {
    peak_of("self").map(|own| own + cores)
}

/// The peak resident memory of a process, in bytes: `VmHWM:   43210 kB` in its status.
pub fn peak_of(process: &str) -> Option<u64> {
    let status = fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kilobytes * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn this_process_takes_some_memory() {
        let before = peak(0).expect("Linux says");
        let large = vec![1_u8; 64 << 20];
        assert!(peak(1000).expect("Linux says") >= 1000 + large.len() as u64);
        assert!(before > 1 << 20);
        assert_eq!(peak_of("no such process"), None);
    }
}
