//! The decision on machines of every kind.

use super::*;

const ALL: Wanted = Wanted {
    qemu: true,
    firmware: true,
    lints: true,
    dieharder: false,
    gdb: false,
    tshark: false,
    system_linker: false,
    system_compiler: false,
    cxx: false,
    gxx: false,
};

fn compiler(at: &str, has_source: bool) -> Compiler {
    Compiler {
        rustc: format!("{at}/rustc").into(),
        cargo: format!("{at}/cargo").into(),
        has_source,
        has_clippy: false,
    }
}

/// A Debian with rustup's minimal profile and nothing else.
fn fresh() -> Facts {
    Facts {
        qemu: None,
        dieharder: None,
        gdb: None,
        tshark: None,
        compilers: vec![compiler("/rustup", false)],
        linker: Some("/rustup/rust-lld".into()),
        system_linker: None,
        system_compiler: false,
        cxx: false,
        gxx: None,
        rustfmt: true,
        clippy: true,
        rustup: Rustup::Present,
        apt: Apt::AsRoot,
    }
}

fn announced(facts: &Facts, wanted: Wanted) -> String {
    match decide(facts, wanted) {
        Plan::Install(orders) => orders.to_string(),
        other => panic!("expected something to install, got {other:?}"),
    }
}

#[test]
fn a_fresh_machine_gets_the_component_from_rustup_and_the_emulator_from_debian() {
    assert_eq!(
        announced(&fresh(), ALL),
        "set-up: missing here: QEMU for Arm (qemu-system-arm); \
         a Rust compiler with the source of its library (rust-src)\n\
         set-up: to be installed with\n    \
         rustup component add rust-src\n    \
         env DEBIAN_FRONTEND=noninteractive apt-get update\n    \
         env DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends qemu-system-arm\n  \
         (where rustup cannot add a component, Debian's packages of it are taken)"
    );
}

#[test]
fn where_rustup_refused_debian_gives_compiler_and_source_together() {
    let facts = Facts {
        rustup: Rustup::Refused,
        ..fresh()
    };
    assert_eq!(
        announced(&facts, ALL),
        "set-up: missing here: QEMU for Arm (qemu-system-arm); \
         a Rust compiler with the source of its library (rust-src); clippy for the compiler of the boards\n\
         set-up: to be installed with\n    \
         env DEBIAN_FRONTEND=noninteractive apt-get update\n    \
         env DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends \
         qemu-system-arm rustc-web cargo-web rust-web-src rust-web-clippy"
    );
}

#[test]
fn a_user_gets_sudo_and_a_debian_compiler_gets_its_linker_and_lints() {
    let facts = Facts {
        linker: None,
        rustfmt: false,
        clippy: false,
        rustup: Rustup::Absent,
        apt: Apt::BySudo,
        ..fresh()
    };
    let said = announced(&facts, ALL);
    assert!(said.ends_with(
        "    sudo env DEBIAN_FRONTEND=noninteractive apt-get update\n    \
         sudo env DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends qemu-system-arm \
         rustc-web cargo-web rust-web-src lld rustfmt-web rust-web-clippy"
    ));
    assert!(!said.contains("rustup component"));
}

#[test]
fn debian_s_own_compiler_is_installed_beside_rustup_s_where_that_way_is_tested() {
    let facts = Facts {
        rustup: Rustup::Present,
        ..fresh()
    };
    let wanted = Wanted {
        system_compiler: true,
        ..Wanted::default()
    };
    let Plan::Install(orders) = decide(&facts, wanted) else {
        panic!("it is missing")
    };
    assert!(orders.rustup.is_none() && orders.to_string().ends_with("rustc-web cargo-web rust-web-src"));
    let there = Facts {
        system_compiler: true,
        ..facts
    };
    assert!(matches!(decide(&there, wanted), Plan::Ready(_)));
}

#[test]
fn only_what_is_wanted_is_installed() {
    let facts = fresh();
    let native = Wanted::default();
    assert_eq!(
        decide(&facts, native),
        Plan::Ready(Tools {
            qemu: None,
            dieharder: None,
            system_linker: None,
            gdb: None,
            gxx: None,
            firmware: None
        })
    );
    let size = Wanted {
        firmware: true,
        ..native
    };
    let said = announced(&facts, size);
    assert!(
        said.contains("rust-src") && !said.contains("qemu") && !said.contains("apt-get"),
        "{said}"
    );
    let battery = Wanted {
        dieharder: true,
        ..native
    };
    assert!(announced(&facts, battery).ends_with("--no-install-recommends dieharder"));
    let debugger = Wanted { gdb: true, ..native };
    assert!(announced(&facts, debugger).ends_with("--no-install-recommends gdb-multiarch"));
    let packets = Wanted {
        tshark: true,
        ..native
    };
    assert!(announced(&facts, packets).ends_with("--no-install-recommends tshark"));
    let fuzzing = Wanted { cxx: true, ..native };
    assert!(announced(&facts, fuzzing).ends_with("--no-install-recommends g++"));
    let rival = Wanted { gxx: true, ..native };
    assert!(announced(&facts, rival).ends_with("--no-install-recommends g++"));
    let both = Wanted { cxx: true, ..rival };
    assert!(announced(&facts, both).ends_with("--no-install-recommends g++"));
}

#[test]
fn a_complete_machine_needs_nothing_and_prefers_the_compiler_in_use() {
    let mut facts = fresh();
    facts.qemu = Some("/usr/bin/qemu-system-arm".into());
    facts.compilers = vec![compiler("/rustup", true), compiler("/usr/bin", true)];
    let Plan::Ready(tools) = decide(&facts, ALL) else {
        panic!("nothing is missing")
    };
    assert_eq!(tools.qemu, facts.qemu);
    assert_eq!(
        tools.firmware.map(|toolchain| toolchain.compiler),
        Some(compiler("/rustup", true))
    );
}

#[test]
fn debians_compiler_is_taken_without_asking_rustup_when_only_it_has_its_source() {
    let mut facts = fresh();
    facts.qemu = Some("/usr/bin/qemu-system-arm".into());
    facts.compilers.push(compiler("/usr/bin", true));
    let render = Wanted { lints: false, ..ALL };
    let Plan::Ready(tools) = decide(&facts, render) else {
        panic!("nothing is missing")
    };
    assert_eq!(
        tools.firmware.map(|toolchain| toolchain.compiler),
        Some(compiler("/usr/bin", true))
    );
    // To lint the boards' code as well, that compiler needs a clippy of its own.
    assert!(announced(&facts, ALL).ends_with("rust-web-clippy"));
    facts.compilers[1].has_clippy = true;
    assert!(matches!(decide(&facts, ALL), Plan::Ready(_)));
}

#[test]
fn without_a_way_to_install_the_missing_things_are_named_with_advice() {
    let facts = Facts {
        apt: Apt::Absent,
        rustup: Rustup::Refused,
        ..fresh()
    };
    let Plan::ByHand { missing, advice } = decide(&facts, ALL) else {
        panic!("nothing can install here")
    };
    assert_eq!(missing, [QEMU, SOURCE, FIRMWARE_CLIPPY]);
    assert!(
        advice.contains("not a Debian") && advice.contains("qemu-system-arm"),
        "{advice}"
    );

    let facts = Facts {
        apt: Apt::Forbidden,
        ..fresh()
    };
    let Plan::ByHand { advice, .. } = decide(&facts, ALL) else {
        panic!("nothing can install here")
    };
    assert_eq!(advice, "run as root: apt-get install qemu-system-arm");
}

#[test]
fn rustup_alone_needs_no_debian() {
    let mut facts = Facts {
        apt: Apt::Absent,
        ..fresh()
    };
    facts.qemu = Some("/opt/qemu-system-arm".into());
    let Plan::Install(orders) = decide(&facts, ALL) else {
        panic!("rustup can add the source")
    };
    assert_eq!(orders.apt, []);
    assert_eq!(
        orders.rustup.map(|command| command.to_string()).as_deref(),
        Some("rustup component add rust-src")
    );
}
