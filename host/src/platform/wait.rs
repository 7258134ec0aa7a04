//! Waiting for sockets and pipes.

use std::os::fd::BorrowedFd;
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};

/// Waits until one of `sources` has something to read or has ended, or `longest` has passed, or a signal comes.
pub(crate) fn wait<const N: usize>(sources: [BorrowedFd<'_>; N], longest: Duration) {
    let timeout = Timespec {
        tv_sec: longest.as_secs().try_into().unwrap_or(i64::MAX),
        tv_nsec: longest.subsec_nanos().into(),
    };
    let mut sources = sources.map(|source| PollFd::from_borrowed_fd(source, PollFlags::IN));
    // However it ends, the caller looks at its sources next; what is wrong with them it hears then.
    let _ready = poll(&mut sources, Some(&timeout));
}
