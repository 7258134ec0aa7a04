//! `cargo xtask qemu-run`

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use anyhow::{Context, anyhow};
use host::firmware;
use host::firmware::board::Board;
use host::platform::interrupt;
use host::platform::setup::{self, Wanted};

use crate::SetUp;

/// Arguments of `qemu-run`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The image
    elf: PathBuf,
    /// Board to run it on [default: the one it was linked for]
    #[arg(long, value_enum)]
    board: Option<Board>,
    /// Boot block for the core, as the collector writes it
    #[arg(long, value_name = "FILE")]
    boot: Option<PathBuf>,
    #[command(flatten)]
    set_up: SetUp,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<ExitCode> {
    for file in [Some(&arguments.elf), arguments.boot.as_ref()]
        .into_iter()
        .flatten()
    {
        std::fs::File::open(file).with_context(|| format!("cannot read {}", file.display()))?;
    }
    let board = match arguments.board {
        Some(board) => board,
        None => linked_for(&arguments.elf)?,
    };
    let tools = setup::ensure(
        Wanted {
            qemu: true,
            ..Wanted::default()
        },
        arguments.set_up.install(),
    )?;
    let qemu = tools.qemu.context("set-up gave no QEMU")?;
    let mut command = Command::new(&qemu);
    command.args(board.command_line(&arguments.elf, arguments.boot.as_deref()));
    let status =
        interrupt::status(&mut command).with_context(|| format!("cannot start {}", qemu.display()))?;
    let code = status
        .code()
        .with_context(|| format!("QEMU did not end by itself: {status}"))?;
    // Exit codes have eight bits.
    Ok(ExitCode::from(code as u8))
}

fn linked_for(elf: &Path) -> anyhow::Result<Board> {
    let bytes = std::fs::read(elf).with_context(|| format!("cannot read {}", elf.display()))?;
    let board = firmware::board_of(&bytes);
    board.map_err(|cause| anyhow!("{}: {cause}; say which with --board", elf.display()))
}
