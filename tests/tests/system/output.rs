//! What commands say, where nobody reads it and where there is no room for it: no panic, whichever of them it is.

use std::fs::File;
use std::io::pipe;
use std::process::{Command, Output, Stdio};

use host::platform::console::CLOSED_PIPE;
use whole_system::{program, said, xtask};

/// A pipe whose reader has gone.
fn closed() -> Stdio {
    let (_, writer) = pipe().expect("a pipe");
    writer.into()
}

fn full() -> Stdio {
    File::options()
        .write(true)
        .open("/dev/full")
        .expect("Linux has it")
        .into()
}

fn output(mut command: Command) -> Output {
    command.output().expect("it starts")
}

/// The verbs that the help lists, and what stands below `bench`.
fn verbs() -> Vec<Vec<String>> {
    let listed = |arguments: &[&str]| -> Vec<String> {
        let help = String::from_utf8(output(xtask(arguments)).stdout).expect("UTF-8");
        let (_, commands) = help.split_once("Commands:\n").expect("a list of commands");
        let lines = commands.lines().take_while(|line| !line.is_empty());
        let names = lines.filter_map(|line| line.strip_prefix("  ")?.split(' ').next());
        names.filter(|name| !name.is_empty()).map(str::to_owned).collect()
    };
    let below = listed(&["bench", "-h"])
        .into_iter()
        .map(|verb| vec!["bench".to_owned(), verb]);
    let verbs: Vec<_> = listed(&["-h"]).into_iter().map(|verb| vec![verb]).collect();
    assert!(verbs.len() > 9 && verbs.contains(&vec!["render".to_owned()]));
    verbs.into_iter().chain(below).collect()
}

/// Commands that say something at once: everybody's help, and results of those that need no QEMU.
fn commands() -> Vec<Command> {
    let mut commands: Vec<Command> = verbs()
        .into_iter()
        .filter(|verb| verb[verb.len() - 1] != "help")
        .map(|verb| {
            let mut command = xtask(&[]);
            command.args(verb).arg("--help");
            command
        })
        .collect();
    commands.push(xtask(&["--version"]));
    commands.push(xtask(&["verify", "--op", "divide"]));
    commands.push(xtask(&["toolchain", "--no-install"]));
    let mut collector = Command::new(program("collector"));
    collector.arg("--help");
    commands.push(collector);
    commands
}

#[test]
fn every_command_ends_quietly_where_the_reader_has_gone() {
    for mut command in commands() {
        command.stdout(closed());
        let name = format!("{command:?}");
        let output = output(command);
        assert_eq!(
            output.status.code(),
            Some(CLOSED_PIPE.into()),
            "{name}: {}",
            said(&output)
        );
        assert!(output.stderr.is_empty(), "{name}: {}", said(&output));
    }
}

#[test]
fn every_command_says_that_there_is_no_room_for_what_it_says() {
    for mut command in commands() {
        command.stdout(full());
        let name = format!("{command:?}");
        let output = output(command);
        assert_eq!(output.status.code(), Some(1), "{name}: {}", said(&output));
        assert_eq!(
            String::from_utf8_lossy(&output.stderr),
            "error: cannot write to standard output: No space left on device (os error 28)\n",
            "{name}"
        );
    }
}

/// The picture is worth more than what is said of its progress.
#[test]
fn a_render_whose_notes_nobody_can_read_is_a_render() {
    for nobody in [closed, full] {
        let out = tempfile::tempdir().expect("a folder");
        let mut command = xtask(&["render", "--backend", "native", "--size", "16x12", "--spp", "4"]);
        command.args(["--reference-spp", "4", "--out"]).arg(out.path());
        command.stderr(nobody());
        let rendered = output(command);
        assert!(rendered.status.success(), "{}", said(&rendered));
        assert!(out.path().join("difference.png").is_file());
        let mut wrong = xtask(&["render", "--no-such-flag"]);
        wrong.stderr(nobody());
        assert_eq!(output(wrong).status.code(), Some(2));
        let mut missing = xtask(&["render", "no-such-scene.toml"]);
        missing.stderr(nobody());
        assert_eq!(output(missing).status.code(), Some(1));
    }
}
