//! The price list: that it says the same twice, holds its ceilings, is ahead of what others have, and is what the README
//! shows.

use std::collections::BTreeMap;
use std::fs;
use std::sync::OnceLock;

use host::bench::operations::anchors::ANCHORS;
use host::bench::operations::bench::{Measurement, measure};
use host::bench::operations::table::table;
use host::bench::operations::{Row, readme, with_errors};
use host::firmware::board::Board;
use operations::{Group, Maker};
use whole_system::{qemu, toolchain};

/// Bytes that our tables may take together: an eighth of a core's code memory. Half of it are the fine lines of roots, which save 70
/// cycles each.
const TABLES: u64 = 4096;

/// Fails where a transcript on the core is not the host's.
fn take(groups: &[Group]) -> Vec<Measurement> {
    measure(&toolchain(), &qemu(), Board::Versatilepb, groups).unwrap_or_else(|error| panic!("{error}"))
}

fn list(measurements: &[Measurement]) -> Vec<Row> {
    with_errors(measurements).unwrap_or_else(|error| panic!("{error}"))
}

fn measurements() -> &'static [Measurement] {
    static MEASUREMENTS: OnceLock<Vec<Measurement>> = OnceLock::new();
    MEASUREMENTS.get_or_init(|| take(&Group::ALL))
}

fn rows() -> &'static [Row] {
    static ROWS: OnceLock<Vec<Row>> = OnceLock::new();
    ROWS.get_or_init(|| list(measurements()))
}

fn row(op: &str, variant: &str) -> &'static Row {
    let found = rows()
        .iter()
        .find(|row| (row.op, row.variant) == (op, variant) && row.maker == "ours");
    found.unwrap_or_else(|| panic!("there is no row for {op}, {variant}"))
}

#[test]
fn two_runs_say_the_same() {
    let again = list(&take(&[Group::Roots]));
    let first: Vec<Row> = rows().iter().filter(|row| again.contains(row)).cloned().collect();
    assert!(again.len() > 5 && first.len() == again.len(), "{again:?}");
    assert_eq!(table(&first), table(&again));
}

/// An operation that needs no choice of any compiler: `SMULL`, and two instructions that put the middle of its result together.
#[test]
fn a_product_cut_short_takes_three_instructions() {
    assert_eq!(row("multiply", "product::wrapping_truncated").instructions, 3.0);
}

#[test]
fn ours_cannot_panic_and_need_no_float_and_few_tables() {
    let is_rival = |row: &&Measurement| matches!(row.entry.maker, Maker::Rival(_));
    let (rivals, ours): (Vec<_>, Vec<_>) = measurements().iter().partition(is_rival);
    let panics = |row: &Measurement| row.reach.symbols.iter().any(|symbol| symbol.contains("panic"));
    for row in &ours {
        assert!(
            !panics(row),
            "{} reaches {:?}",
            row.entry.variant,
            row.reach.symbols
        );
    }
    assert!(
        rivals.iter().any(|row| panics(row)),
        "a panic that is there is seen"
    );
    let mut tables = BTreeMap::new();
    for row in &ours {
        let elf = fs::read(&row.elf).unwrap();
        assert!(
            host::firmware::measure(Board::Versatilepb, &elf)
                .unwrap()
                .float_symbols
                .is_empty()
        );
        tables.extend(row.reach.tables.clone());
    }
    let bytes: u64 = tables.values().sum();
    println!("{bytes} bytes of tables: {tables:?}");
    assert!((1..=TABLES).contains(&bytes));
}

#[test]
fn no_operation_costs_more_than_it_may() {
    let ceilings = [
        ("multiply", "product::nearest", 7.0),
        ("divide", "division::nearest", 60.0),
        ("square root", "root::of_length", 50.0),
        ("square root 48:16", "root::of_wide", 90.0),
        ("sine and cosine", "angle::quadratic_cos_sin", 40.0),
        ("sine and cosine", "angle::linear_cos_sin", 12.0),
        ("reciprocal square root", "root::reciprocal_of_length", 45.0),
        ("normalise 16:16", "unit::of_vector", 120.0),
    ];
    for (op, variant, ceiling) in ceilings {
        let row = row(op, variant);
        assert!(
            row.instructions <= ceiling,
            "{op}, {variant}: {} of {ceiling}",
            row.instructions
        );
    }
    let error = |op, variant| row(op, variant).max_error_ulp.unwrap();
    for (op, variant) in [
        ("multiply", "product::nearest"),
        ("divide", "division::nearest"),
        ("square root", "root::of_length"),
        ("square root 48:16", "root::of_wide"),
    ] {
        assert!(is_correctly_rounded(error(op, variant)), "{op}, {variant}");
    }
    assert!(error("sine and cosine", "angle::quadratic_cos_sin") <= 1.0);
    // In 64 bits nothing is lost.
    for variant in ["product::accumulate", "product::wrapping_accumulate"] {
        assert_eq!(error("multiply and add", variant), 0.0, "{variant}");
    }
    for variant in ["product::dot", "product::wrapping_dot"] {
        assert_eq!(error("dot product", variant), 0.0, "{variant}");
    }
}

/// Half an ulp, but for what a double's rounding adds.
fn is_correctly_rounded(error: f64) -> bool {
    error <= 0.5 + 1e-9
}

#[test]
fn ours_are_faster_and_closer_than_libraries_in_c() {
    for anchor in ANCHORS {
        let mut ours = rows()
            .iter()
            .filter(|row| row.op == anchor.op && row.maker == "ours");
        let is_ahead = |row: &Row| {
            let error = row.max_error_ulp.unwrap();
            let closer = anchor
                .max_error_ulp
                .is_none_or(|others| error < others || is_correctly_rounded(error));
            // Without conditions on the result, as the library is.
            row.instructions < anchor.instructions && closer && !row.domain.contains("fit")
        };
        assert!(ours.any(is_ahead), "{anchor:?}");
    }
}

/// Whether the costs that are written down are of the compiler at hand. Another one schedules and spills otherwise.
fn is_the_readme_s_compiler(printed: &str) -> bool {
    readme::compiler(printed) == Some(rows()[0].compiler.as_str())
}

/// What a table says but for costs, and for what depends on them: the order of rows, and which are printed bold.
fn without_costs(table: &str) -> Vec<String> {
    let mut operation = String::new();
    let mut lines: Vec<String> = Vec::new();
    for line in table
        .lines()
        .filter(|line| line.starts_with("| ") || line.starts_with("|  |"))
    {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        if !cells[1].is_empty() {
            operation = cells[1].to_owned();
        }
        let kept = [&[operation.as_str()], &cells[2..4], &cells[7..]].concat();
        lines.push(kept.join(" ").replace('*', ""));
    }
    lines.sort_unstable();
    lines
}

#[test]
fn the_readme_shows_what_the_bench_prints() {
    let printed = readme::printed().unwrap_or_else(|error| panic!("{error}"));
    let measured = readme::markdown(rows());
    let advice = "the list has changed: look at it, and write it anew with `cargo xtask bench ops --bless`";
    assert_eq!(without_costs(&printed), without_costs(&measured), "{advice}");
    if is_the_readme_s_compiler(&printed) {
        assert!(printed == measured, "{advice}");
    }
}

/// The cost that a function's documentation gives, if there is such a function in `fixedmath`.
fn documented_cost(variant: &str) -> Option<u32> {
    let (module, function) = (variant.split("::").next()?, variant.split("::").last()?);
    let path = whole_system::repository(&format!("fixedmath/src/{module}.rs"));
    let source = fs::read_to_string(path).ok()?;
    let lines: Vec<&str> = source.lines().map(str::trim).collect();
    let head = [format!("pub fn {function}("), format!("pub const fn {function}(")];
    let place = lines
        .iter()
        .position(|line| head.iter().any(|head| line.starts_with(head.as_str())))?;
    let documentation = lines[..place]
        .iter()
        .rev()
        .take_while(|line| line.starts_with("///") || line.starts_with("#["));
    let cost = documentation
        .filter_map(|line| line.strip_prefix("/// Cost: "))
        .next();
    let cost = cost.unwrap_or_else(|| panic!("the documentation of {variant} gives no cost"));
    Some(cost.split(' ').next()?.parse().unwrap())
}

#[test]
fn documentation_gives_the_prices_that_are_measured() {
    let ours = rows()
        .iter()
        .filter(|row| ["ours", "published"].contains(&row.maker) && !row.variant.contains(' '));
    let printed = readme::printed().unwrap_or_else(|error| panic!("{error}"));
    // With another compiler, a quarter more or less, or three instructions.
    let tolerance = |measured: f64| match is_the_readme_s_compiler(&printed) {
        true => 0.0,
        false => (measured / 4.0).max(3.0),
    };
    let mut checked = 0;
    let mut seen = std::collections::BTreeSet::new();
    // A function that serves several operations is documented for the first.
    for row in ours.filter(|row| seen.insert(row.variant)) {
        let Some(documented) = documented_cost(row.variant) else {
            continue;
        };
        checked += 1;
        let measured = row.instructions.round();
        let off = (f64::from(documented) - measured).abs();
        assert!(
            off <= tolerance(measured),
            "{}: {documented}, not {measured}",
            row.variant
        );
    }
    assert!(checked > 40, "only {checked} functions were found");
}
