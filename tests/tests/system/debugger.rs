//! `cargo xtask gdb`: a core that stands at `main`, a collector that waits for it, and a terminal that is the debugger's.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use host::firmware::board::Board;
use whole_system::{program, repository, said, xtask};

/// 48 units of work: a moment.
const SMALL: [&str; 6] = ["--size", "32x24", "--spp", "8", "--reference", "none"];
const UNITS: u64 = 48;

/// What gdb says when it is given these commands once core 1 stands at `main`.
fn debugged(board: Board, commands: &[&str]) -> String {
    let out = tempfile::tempdir().expect("a folder");
    let mut command = xtask(&["gdb", "--core", "1", "--board", board.name()]);
    command.args(SMALL).arg("--out").arg(out.path());
    command.args(["--", "--batch"]);
    for words in commands {
        command.args(["-ex", words]);
    }
    let output = command.output().expect("it starts");
    assert!(output.status.success(), "{}", said(&output));
    said(&output)
}

#[test]
fn a_core_of_every_board_stands_at_main_with_its_source_known() {
    for board in Board::ALL {
        let text = debugged(board, &["info symbol $pc", "info source"]);
        let symbol = text.lines().find(|line| line.ends_with("in section .text"));
        let symbol = symbol.unwrap_or_else(|| panic!("no symbol at $pc: {text}"));
        // `main` is `kmain` to aarch32-rt.
        assert!(
            symbol.starts_with("main + ") || symbol.starts_with("kmain + "),
            "{symbol}"
        );
        // What stands there may be of a function in line, from another file.
        let source = format!("file firmware/{board}/src/main.rs, line ");
        assert!(text.contains(&source), "{text}");
        assert!(text.contains("Current source file is firmware/"), "{text}");
    }
}

/// Longer than the collector would wait for a core that nobody stopped.
#[test]
fn a_core_that_stood_at_a_breakpoint_gets_its_work_all_the_same() {
    let text = debugged(
        Board::Versatilepb,
        &[
            "break node::worker::Worker::send",
            "ignore 2 5",
            "continue",
            "shell sleep 10",
            "ignore 2 1000000",
            "continue",
            "info breakpoints",
        ],
    );
    assert!(text.contains("exited normally"), "{text}");
    let hits = text.split("breakpoint already hit ").nth(1);
    let hits = hits.and_then(|text| text.split(' ').next()?.parse().ok());
    assert!(
        hits.is_some_and(|hits: u64| hits > UNITS),
        "it says something for every unit: {text}"
    );
}

#[test]
fn a_core_that_the_session_does_not_have_is_refused() {
    let output = xtask(&["gdb", "--core", "4"]).output().expect("it starts");
    let text = said(&output);
    assert!(!output.status.success(), "{text}");
    assert!(text.contains("no core 4") && text.contains("0 to 3"), "{text}");
}

fn wait_for(what: &str, log: &Path, mut happened: impl FnMut(&str) -> bool) {
    let start = Instant::now();
    loop {
        let text = String::from_utf8_lossy(&fs::read(log).unwrap_or_default()).into_owned();
        if happened(&text) {
            return;
        }
        assert!(
            start.elapsed() < Duration::from_secs(300),
            "{what} does not happen: {text}"
        );
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Processor time that a process has taken so far, in clock ticks: `utime` of proc(5).
fn time_taken(process: &Path) -> u64 {
    let stat = fs::read_to_string(process.join("stat")).expect("it lives");
    let (_, fields) = stat.rsplit_once(") ").expect("a name in parentheses");
    let utime = fields.split(' ').nth(11).expect("52 fields");
    utime.parse().expect("a count")
}

/// By `script`, which gives the command a terminal.
#[test]
fn an_interruption_stops_the_core_and_ends_neither_its_emulator_nor_the_session() {
    let out = tempfile::tempdir().expect("a folder");
    let (folder, log) = (out.path().display(), out.path().join("typescript"));
    let commands = program("commands");
    // Without `exec` there may be a shell between: it would be interrupted as well, and its end would hide the program's.
    let line = format!(
        "exec '{}' gdb --spp 4096 --reference none --out '{folder}'",
        commands.display()
    );
    let mut terminal = Command::new("script")
        .args(["--quiet", "--flush", "--return", "--command", &line])
        .arg(&log)
        .current_dir(repository("."))
        .env("SHELL", "/bin/sh")
        .env("TERM", "dumb")
        // The terminal's own size, not that of one around it, in which gdb would stop to page.
        .env_remove("LINES")
        .env_remove("COLUMNS")
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
        .expect("script, of the package bsdutils");
    let mut keys = terminal.stdin.take().expect("a keyboard");
    let mut type_in = |text: &str| {
        keys.write_all(text.as_bytes()).expect("it listens");
        keys.flush().expect("it listens");
    };

    wait_for("the stop at main", &log, |text| {
        text.contains("Temporary breakpoint 1, ")
    });
    let process = fs::read_to_string(out.path().join("gdb/core-0.pid")).expect("its process");
    let process = Path::new("/proc").join(process.trim());
    let before = time_taken(&process);
    type_in("continue\n");
    // What gdb writes does not tell when it has let the core go: an interruption before that would end the command.
    wait_for("the start", &log, |_| time_taken(&process) > before + 5);
    type_in("\x03");
    wait_for("the stop", &log, |text| {
        text.contains("Program received signal SIGINT")
    });
    assert!(process.exists(), "QEMU has ended");
    type_in("quit\n");
    assert!(terminal.wait().expect("its end").success());
    assert!(!process.exists(), "QEMU goes with the debugger");
}
