//! Firmware images: what must not link does not, what goes wrong on a core is said, and every image fits.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use host::firmware::arithmetic::Arithmetic;
use host::firmware::board::{Board, DTCM_BUDGET, ITCM_BUDGET};
use host::firmware::{self, Recipe, build};
use host::fleet::run_to_end;
use object::{Object, ObjectSymbol};
use tracer::scene::{Capabilities, Capability};
use whole_system::{qemu, said, system_linker, toolchain};

/// What the Cornell box needs.
const CORNELL: Capabilities = Capabilities::of(&[
    Capability::Hollow,
    Capability::Solid,
    Capability::Inside,
    Capability::Diffuse,
    Capability::Mirror,
    Capability::Glass,
    Capability::Roulette,
]);

fn recipe(profile: Arithmetic, needs: Capabilities) -> Recipe {
    Recipe {
        profile,
        needs,
        log: None,
        soft_float: None,
        choice: None,
    }
}

/// Every board with every profile.
fn both() -> impl Iterator<Item = (Board, Arithmetic)> {
    let boards = Board::ALL.into_iter();
    boards.flat_map(|board| Arithmetic::ALL.map(|profile| (board, profile)))
}

/// Builds one of a board's examples, and says where its ELF is.
fn example(board: Board, name: &str) -> (Output, PathBuf) {
    let mut command = firmware::cargo(
        &toolchain(),
        board,
        "build",
        &recipe(Arithmetic::Precise, Capabilities::PATHS),
    )
    .unwrap();
    let output = command.args(["--example", name]).output().unwrap();
    (output, firmware::example(board, name).unwrap())
}

/// As [`example`], but linked by the linker of a machine without rustup, which may be years older than the compiler.
fn linked_by_the_system(board: Board, name: &str) -> (Output, PathBuf) {
    // All but the last crate are compiled already.
    let mut command = firmware::cargo(
        &toolchain(),
        board,
        "rustc",
        &recipe(Arithmetic::Precise, Capabilities::PATHS),
    )
    .unwrap();
    command.args(["--example", name, "--", "-Clinker-flavor=gnu-lld"]);
    command.arg(format!("-Clinker={}", system_linker().display()));
    (command.output().unwrap(), firmware::example(board, name).unwrap())
}

fn refused(board: Board, name: &str) -> String {
    let (output, _) = example(board, name);
    assert!(!output.status.success(), "{name} was built for {board}");
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Runs an example on a core: its exit code and what it said.
fn run(board: Board, name: &str) -> (Option<i32>, String) {
    let (output, elf) = example(board, name);
    assert!(output.status.success(), "{}", said(&output));
    run_image(board, &elf)
}

fn run_image(board: Board, elf: &Path) -> (Option<i32>, String) {
    let output = run_to_end(&qemu(), board, elf).unwrap();
    (output.status.code(), format!("{board}: {}", said(&output)))
}

#[test]
fn an_image_with_a_float_in_it_does_not_link() {
    for board in Board::ALL {
        let text = refused(board, "floating_point");
        assert!(text.contains("float"), "{text}");
        assert!(
            text.contains("__aeabi_fmul") || text.contains("__mulsf3"),
            "{text}"
        );
    }
}

#[test]
fn an_image_with_too_much_code_or_data_does_not_link() {
    for (board, region) in [(Board::Versatilepb, "CODE"), (Board::Mps2An385, "FLASH")] {
        let text = refused(board, "too_much_code");
        assert!(text.contains("ITCM") || text.contains(region), "{text}");
        let text = refused(board, "too_much_data");
        assert!(text.contains("data and stacks do not fit"), "{text}");
    }
}

#[test]
fn the_core_s_clock_counts_instructions() {
    for board in Board::ALL {
        let (code, said) = run(board, "clock_test");
        assert_eq!(code, Some(0), "{said}");
    }
}

#[test]
fn the_system_s_own_linker_links_what_fits_and_names_the_one_cause_why_something_does_not() {
    for board in Board::ALL {
        let (output, elf) = linked_by_the_system(board, "clock_test");
        assert!(output.status.success(), "{}", said(&output));
        let (code, text) = run_image(board, &elf);
        assert_eq!(code, Some(0), "{text}");

        let (output, _) = linked_by_the_system(board, "too_much_data");
        let text = said(&output);
        assert!(!output.status.success(), "{text}");
        assert!(text.contains("data and stacks do not fit"), "{text}");
        assert!(!text.contains("floating point"), "{text}");

        // Not every linker knows which routines are left in the image; the host finds them there.
        let (output, elf) = linked_by_the_system(board, "floating_point");
        let found = match output.status.success() {
            true => {
                firmware::measure(board, &fs::read(elf).unwrap())
                    .unwrap()
                    .float_symbols
            }
            false => vec![said(&output)],
        };
        assert!(found.iter().any(|text| text.contains("mul")), "{found:?}");
    }
}

#[test]
fn a_panic_and_a_fault_say_what_and_where_and_end_the_core() {
    for board in Board::ALL {
        let (code, said) = run(board, "panicking");
        assert_eq!(code, Some(3), "{said}");
        assert!(said.contains("panicking.rs"), "{said}");
        let (code, said) = run(board, "undefined_instruction");
        assert_eq!(code, Some(4), "{said}");
        assert!(said.contains("undefined instruction at 0x"), "{said}");
    }
}

#[test]
fn every_image_fits_and_holds_no_more_than_its_scene_needs() {
    let toolchain = toolchain();
    for (board, profile) in both() {
        let full = build(&toolchain, board, &recipe(profile, Capabilities::PATHS))
            .unwrap()
            .size;
        println!("{board}, {profile}: {full}");
        assert!(full.float_symbols.is_empty());
        assert!(full.itcm_bytes <= ITCM_BUDGET && full.dtcm_bytes + full.stack_bytes <= DTCM_BUDGET);
        let plain = Capabilities::of(&[
            Capability::Hollow,
            Capability::Solid,
            Capability::Diffuse,
            Capability::Roulette,
        ]);
        let plain = build(&toolchain, board, &recipe(profile, plain)).unwrap().size;
        println!("{board}, {profile}, diffuse only: {plain}");
        assert!(
            plain.itcm_bytes + 500 < full.itcm_bytes,
            "a mirror and a dielectric are code"
        );
    }
}

/// Whatever else its scene has, an image that looks for one emitter, a cap, is optimised as all others are, and fits.
#[test]
fn an_image_that_looks_for_one_cap_fits() {
    let needs = Capabilities::ALL
        .without(Capability::TwoSided)
        .without(Capability::Vast)
        .without(Capability::ManyLights)
        .without(Capability::BallLights);
    for board in Board::ALL {
        let size = build(&toolchain(), board, &recipe(Arithmetic::Precise, needs))
            .unwrap()
            .size;
        println!("{board}: {size}");
        assert!(size.itcm_bytes <= ITCM_BUDGET);
    }
}

/// `memory.x` states a core's memory, and `board.x` where it lies: the linker has written both into the image.
#[test]
fn the_host_and_the_loader_know_the_memory_that_images_are_linked_for() {
    let toolchain = toolchain();
    for board in Board::ALL {
        let image = build(&toolchain, board, &recipe(Arithmetic::Precise, CORNELL)).unwrap();
        let elf = fs::read(image.elf).unwrap();
        let file = object::File::parse(&*elf).unwrap();
        let symbol = |name| file.symbol_by_name(name).expect(name).address();
        let memory = |start, size| symbol(start)..symbol(start) + symbol(size);
        assert_eq!(memory("__itcm_start", "__itcm_size"), board.itcm());
        assert_eq!(memory("__dtcm_start", "__dtcm_size"), board.dtcm());
        assert_eq!(symbol("__itcm_size") - symbol("__itcm_reserved"), ITCM_BUDGET);
        assert_eq!(symbol("__dtcm_size") - symbol("__dtcm_reserved"), DTCM_BUDGET);
        assert_eq!(symbol("__boot_block"), board.dtcm().start);
        assert_eq!(symbol("__boot_block_size"), wire::boot::MAX_LEN as u64);
    }
}

/// What is not the tracer's must leave 17 KiB to what a scene needs.
#[test]
fn the_frame_around_the_tracer_is_small() {
    const BUDGET: u64 = 15 * 1024;
    for (board, profile) in both() {
        let image = build(&toolchain(), board, &recipe(profile, CORNELL)).unwrap();
        let tracer = firmware::tracer_bytes(&image.elf).unwrap();
        let frame = image.size.itcm_bytes - tracer;
        println!("{board}, {profile}: tracer {tracer} bytes, frame {frame}");
        // The shares are told apart: neither is next to nothing.
        assert!(
            tracer > 4096 && frame > 4096,
            "{board}, {profile}: {tracer}, {frame}"
        );
        assert!(frame <= BUDGET, "{board}, {profile}: {frame} bytes");
    }
}

/// Code that comes from `fixedmath`, wherever it was inlined.
#[test]
fn the_arithmetic_of_the_cornell_box_is_small() {
    const BUDGET: u64 = 4096;
    let image = build(
        &toolchain(),
        Board::Versatilepb,
        &recipe(Arithmetic::Precise, CORNELL),
    )
    .unwrap();
    let bytes = firmware::code_bytes(&image.elf, &["fixedmath/src/"]).unwrap();
    println!("fixedmath's code in the Cornell box's image: {bytes} bytes");
    assert!((1000..=BUDGET).contains(&bytes), "{bytes}");
}
