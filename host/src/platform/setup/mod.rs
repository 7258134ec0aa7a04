//! Set-up: finds the programs a command needs and installs what is missing.
//!
//! [`survey()`] looks at the machine, [`decide`] says what follows, and [`ensure`] announces that, does it and looks
//! again. On a machine that has everything the whole set-up is a few file checks and one call of the compiler.

mod plan;
mod survey;

use std::process::{Command, ExitStatus};

use crate::platform::interrupt;

pub use plan::{Apt, CommandLine, Compiler, Facts, Orders, Plan, Rustup, Toolchain, Tools, Wanted, decide};
pub use survey::{program, survey};

use crate::platform::console::note;

/// Whether set-up may change the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Install {
    /// Install what is missing.
    Allowed,
    /// `--no-install`: say what is missing and stop.
    Forbidden,
}

impl Install {
    /// What the flag `--no-install` says.
    pub fn unless(no_install: bool) -> Self {
        if no_install {
            Self::Forbidden
        } else {
            Self::Allowed
        }
    }
}

/// Why the needed programs are not there.
#[derive(Debug, thiserror::Error)]
pub enum SetupError {
    /// `--no-install`, and something is missing.
    #[error("{0}\nNothing was installed, because of --no-install: run these, or leave the flag out.")]
    NotAllowed(Orders),
    /// No way to install from here.
    #[error("missing here: {missing}; {advice}")]
    ByHand {
        /// What is missing.
        missing: String,
        /// What to do.
        advice: String,
    },
    /// An installation command could not be started.
    #[error("set-up: `{command}` could not be started")]
    NotStarted {
        /// The command.
        command: CommandLine,
        /// Why.
        #[source]
        cause: std::io::Error,
    },
    /// An installation command failed.
    #[error(
        "set-up: `{command}` failed ({status}); its output above says why. Mend that, or install by hand."
    )]
    Failed {
        /// The command.
        command: CommandLine,
        /// How it ended.
        status: ExitStatus,
    },
    /// Everything was installed and something is still missing.
    #[error("set-up: still missing after the installation: {0}; is it in PATH?")]
    StillMissing(String),
}

/// Finds everything `wanted`, installing what is missing where that is allowed.
pub fn ensure(wanted: Wanted, install: Install) -> Result<Tools, SetupError> {
    let (mut refused, mut installed) = (false, false);
    loop {
        let mut facts = survey();
        if refused {
            facts.rustup = Rustup::Refused;
        }
        let orders = match decide(&facts, wanted) {
            Plan::Ready(tools) => return Ok(tools),
            Plan::ByHand { missing, advice } => {
                return Err(SetupError::ByHand {
                    missing: missing.join("; "),
                    advice,
                });
            }
            Plan::Install(orders) => orders,
        };
        if install == Install::Forbidden {
            return Err(SetupError::NotAllowed(orders));
        }
        if installed {
            return Err(SetupError::StillMissing(orders.missing.join("; ")));
        }
        note(&orders);
        if !add_components(&orders)? {
            refused = true; // The decision is taken anew without rustup.
            continue;
        }
        for command in &orders.apt {
            must_succeed(command)?;
        }
        installed = true;
    }
}

/// Asks rustup; `false` says that it could not.
fn add_components(orders: &Orders) -> Result<bool, SetupError> {
    let Some(command) = &orders.rustup else {
        return Ok(true);
    };
    let status = run(command)?;
    if !status.success() {
        note("set-up: rustup could not add the component; looking at Debian's packages instead");
    }
    Ok(status.success())
}

fn must_succeed(command: &CommandLine) -> Result<(), SetupError> {
    match run(command)? {
        status if status.success() => Ok(()),
        status => Err(SetupError::Failed {
            command: command.clone(),
            status,
        }),
    }
}

fn run(command: &CommandLine) -> Result<ExitStatus, SetupError> {
    note(format!("set-up: {command}"));
    let CommandLine(words) = command;
    let mut child = Command::new(&words[0]);
    child.args(&words[1..]);
    interrupt::status(&mut child).map_err(|cause| SetupError::NotStarted {
        command: command.clone(),
        cause,
    })
}
