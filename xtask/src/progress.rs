//! What cargo says while it builds, for whoever watches: on a terminal as it is, elsewhere as a line every few seconds.

use std::io::{self, BufRead, BufReader, Read, Write};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

/// Between two lines where there is no terminal.
const INTERVAL: Duration = Duration::from_secs(5);

/// Shows what cargo says until it has no more to say.
pub(crate) fn show(said: impl Read + Send + 'static, terminal: bool) {
    let (sender, receiver) = mpsc::channel();
    thread::spawn(move || pieces(said, |piece| sender.send(piece).is_ok()));
    let mut view = View::new(terminal);
    loop {
        let text = match receiver.recv_timeout(INTERVAL) {
            Ok(piece) => view.piece(&piece, Instant::now()),
            // One crate may take a minute, in which cargo says nothing.
            Err(RecvTimeoutError::Timeout) => view.count(Instant::now()),
            Err(RecvTimeoutError::Disconnected) => return,
        };
        let _nobody_watches = io::stderr().write_all(&text);
    }
}

/// Cuts what is said after each line and each drawing of the bar, which ends with a return.
fn pieces(said: impl Read, mut take: impl FnMut(Vec<u8>) -> bool) {
    let mut said = BufReader::new(said);
    loop {
        let mut piece = Vec::new();
        let ended = loop {
            let available = match said.fill_buf() {
                Ok(available) if !available.is_empty() => available,
                // A pipe that cannot be read has ended, too: how the build went, cargo's exit code says.
                _ => break true,
            };
            let end = available
                .iter()
                .position(|byte| matches!(byte, b'\n' | b'\r'))
                .map(|at| at + 1);
            let taken = end.unwrap_or(available.len());
            piece.extend_from_slice(&available[..taken]);
            said.consume(taken);
            if end.is_some() {
                break false;
            }
        };
        if !piece.is_empty() && !take(piece) || ended {
            return;
        }
    }
}

/// What is shown, and what has been.
struct View {
    terminal: bool,
    /// Something is being built or fetched, and that has been said.
    announced: bool,
    begun: Instant,
    last_line: Instant,
    /// Cargo's bar: how many crates are done, of how many, and which are being compiled.
    bar: Option<Bar>,
}

impl View {
    fn new(terminal: bool) -> Self {
        let now = Instant::now();
        Self {
            terminal,
            announced: false,
            begun: now,
            last_line: now,
            bar: None,
        }
    }

    /// What to write when cargo has said this.
    fn piece(&mut self, piece: &[u8], now: Instant) -> Vec<u8> {
        let said = plain(&String::from_utf8_lossy(piece));
        let says = |word: &str| said.contains(word);
        let mut text = Vec::new();
        let works = ["Compiling ", "Building ", "Downloading ", "Updating "];
        if !self.announced && works.into_iter().any(says) {
            self.announced = true;
            text.extend(
                b"cargo xtask: builds the project's commands first, which takes a minute or two on a fresh clone\n",
            );
        }
        if self.terminal {
            if self.announced || !says("Finished ") {
                text.extend(piece);
            }
            return text;
        }
        if let Some(bar) = Bar::read(&said) {
            self.bar = Some(bar);
        } else if !["Compiling ", "Building ", "Downloaded ", "Finished "]
            .into_iter()
            .any(says)
        {
            text.extend(piece);
        }
        if now.duration_since(self.last_line) >= INTERVAL {
            text.extend(self.count(now));
        }
        text
    }

    /// The line that says how far it is, where there is no bar.
    fn count(&mut self, now: Instant) -> Vec<u8> {
        let Some(Bar { done, all, now_at }) = self.bar.as_ref().filter(|_| !self.terminal) else {
            return Vec::new();
        };
        self.last_line = now;
        let seconds = now.duration_since(self.begun).as_secs();
        format!("cargo xtask: {done} of {all} compiled, {seconds} s, now at {now_at}\n").into_bytes()
    }
}

/// Cargo's bar: `    Building [====>    ] 12/240: exr, host`.
struct Bar {
    done: u32,
    all: u32,
    now_at: String,
}

impl Bar {
    fn read(said: &str) -> Option<Self> {
        let (_, bar) = said.split_once("] ")?;
        let (counts, now_at) = bar.split_once(": ")?;
        let (done, all) = counts.split_once('/')?;
        Some(Self {
            done: done.parse().ok()?,
            all: all.parse().ok()?,
            now_at: now_at.trim().to_owned(),
        })
    }
}

/// A text without what colours it: escape sequences up to their letter.
fn plain(text: &str) -> String {
    let mut parts = text.split('\x1b');
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |plain, part| {
        let end = part
            .find(|c: char| c.is_ascii_alphabetic())
            .map_or(part.len(), |at| at + 1);
        plain + &part[end..]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(terminal: bool, pieces: &[&str]) -> String {
        let mut view = View::new(terminal);
        let now = view.begun;
        let text: Vec<u8> = pieces
            .iter()
            .flat_map(|piece| view.piece(piece.as_bytes(), now))
            .collect();
        String::from_utf8(text).unwrap()
    }

    #[test]
    fn where_all_is_fresh_nothing_is_said() {
        for terminal in [true, false] {
            assert_eq!(shown(terminal, &["    Finished `release` profile in 0.2s\n"]), "");
        }
    }

    #[test]
    fn a_terminal_gets_the_bar_after_one_line() {
        let pieces = [
            "\x1b[1m\x1b[92m   Compiling\x1b[0m libc v0.2\n",
            "\x1b[1m\x1b[96m    Building\x1b[0m [==>  ] 1/240: libc\r\x1b[K",
            "    Finished `release` profile\n",
        ];
        let text = shown(true, &pieces);
        let (first, rest) = text.split_once('\n').unwrap();
        assert!(
            first.starts_with("cargo xtask: builds the project's commands"),
            "{first}"
        );
        assert_eq!(rest, pieces.concat());
    }

    #[test]
    fn elsewhere_there_is_a_line_every_few_seconds_and_what_went_wrong() {
        let mut view = View::new(false);
        let begun = view.begun;
        let mut after =
            |seconds, piece: &str| view.piece(piece.as_bytes(), begun + Duration::from_secs(seconds));
        assert!(!after(0, "   Compiling libc v0.2\n").is_empty());
        assert!(after(1, "\x1b[92m    Building\x1b[0m [==>  ] 1/240: libc\r").is_empty());
        assert_eq!(
            after(7, "    Building [==>  ] 30/240: exr, host(build)\r"),
            b"cargo xtask: 30 of 240 compiled, 7 s, now at exr, host(build)\n"
        );
        assert!(after(8, "    Building [==>  ] 31/240: exr\r").is_empty());
        assert_eq!(after(9, "error: no such thing\n"), b"error: no such thing\n");
        assert_eq!(
            view.count(begun + Duration::from_secs(30)),
            b"cargo xtask: 31 of 240 compiled, 30 s, now at exr\n"
        );
    }

    #[test]
    fn a_piece_is_a_line_or_a_bar() {
        let mut found = Vec::new();
        pieces(&b"a\nbar 1\rbar 2\rlast"[..], |piece| {
            found.push(String::from_utf8(piece).unwrap());
            true
        });
        assert_eq!(found, ["a\n", "bar 1\r", "bar 2\r", "last"]);
    }
}
