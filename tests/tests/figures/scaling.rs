//! `cargo xtask bench scaling`: what it says does not depend on this host, and the wire bends the curve where it should.

use std::fs;

use serde_json::Value;
use whole_system::{said, xtask};

/// The figures of a quick run on so many cores.
fn quick(cores: &str) -> Value {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("scaling.json");
    let mut command = xtask(&[
        "bench",
        "scaling",
        "--quick",
        "--no-install",
        "--cores",
        cores,
        "--json",
    ]);
    let output = command.arg(&file).output().expect("it starts");
    assert!(output.status.success(), "{}", said(&output));
    let text = said(&output);
    assert!(
        text.contains("modelled:") && text.contains("samples that a packet needs"),
        "{text}"
    );
    serde_json::from_slice(&fs::read(file).expect("the figures")).expect("JSON")
}

fn list(value: &Value) -> &[Value] {
    value.as_array().expect("a list")
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("{key} of {value}"))
}

/// All points, each with its series.
fn points(figures: &Value) -> Vec<(&Value, &Value)> {
    let series = list(&figures["scaling"]["series"]).iter();
    series
        .flat_map(|series| list(&series["points"]).iter().map(move |point| (series, point)))
        .collect()
}

#[test]
fn every_core_works_and_the_wire_bends_the_curve_where_it_carries_too_little() {
    let figures = quick("1,4");
    for run in list(&figures["scaling"]["runs"]) {
        assert_eq!(run["cores"], run["cores_at_work"], "{run}");
        assert!(number(run, "most_ticks_apart") <= 1.0, "{run}");
    }
    let mut saturated = 0;
    for (series, point) in points(&figures) {
        let (share, rate) = (
            number(point, "share_of_linear"),
            number(point, "samples_per_second"),
        );
        assert!(share <= 1.0001, "{point}");
        let Some(limit) = series["packets_per_second"].as_f64() else {
            assert!(share > 0.95, "{point}");
            continue;
        };
        let carried = limit * number(series, "samples_per_packet");
        assert!(rate <= carried, "{point} of {series}");
        if share < 0.7 {
            saturated += 1;
            let quiet = number(point, "quiet_samples_per_second");
            assert!(quiet > 0.9 * carried && quiet <= carried, "{point} of {series}");
        }
    }
    // Four cores that send 64 samples a packet, by roulette and by depth.
    assert_eq!(saturated, 2);
    for derivation in list(&figures["scaling"]["derivations"]) {
        let derived = number(derivation, "samples_per_packet");
        let at_it = list(&derivation["sweep"]).iter();
        let at_it = at_it.filter(|sweep| number(sweep, "samples_per_packet") == derived);
        let shares: Vec<f64> = at_it.map(|sweep| number(sweep, "share_of_linear")).collect();
        assert!(matches!(shares[..], [share] if share > 0.95), "{derivation}");
    }
}

/// Which core renders what in the emulated fleet is this host's affair, and differs each time.
#[test]
fn virtual_time_is_the_same_each_time() {
    let (first, second) = (quick("1,2"), quick("1,2"));
    let (first, second) = (points(&first), points(&second));
    assert_eq!(first.len(), second.len());
    for ((series, one), (_, other)) in first.iter().zip(&second) {
        let mut keys = vec!["quiet_samples_per_second"];
        // On a full wire HELLOs race each other, and a tick may decide which is first.
        if series["packets_per_second"].is_null() {
            keys.extend(["samples_per_second", "seconds"]);
        }
        for key in keys {
            let apart = number(one, key) / number(other, key) - 1.0;
            // A unit is known to a tick, a five-thousandth of the smallest; where two cores are done within one, it decides which gets the
            // next unit, and the last of so few units ends the later for it. Seen: 5.6e-4.
            assert!(apart.abs() < 2e-3, "{key}: {one} and {other}");
        }
    }
}
