//! Jobs that fail early, and small ones on threads of this host.

use std::net::UdpSocket;
use std::sync::atomic::AtomicBool;

use clap::Parser;
use serde_json::Value;

use super::*;
use crate::collector::{Cause, CoreRecord};

static RUNNING: AtomicBool = AtomicBool::new(false);
static INTERRUPTED: AtomicBool = AtomicBool::new(true);

#[derive(Parser)]
#[command(args_override_self = true)]
struct Program {
    #[command(flatten)]
    options: RenderOptions,
}

/// A native render of the Cornell box into `out`, unless `more` says otherwise.
fn options(out: &Path, more: &[&str]) -> RenderOptions {
    let scene = workspace::scene(None).expect("tests run in the checkout");
    let mut words = vec![
        "render",
        scene.to_str().expect("UTF-8"),
        "--out",
        out.to_str().expect("UTF-8"),
    ];
    words.extend([
        "--backend",
        "native",
        "--size",
        "16x12",
        "--spp",
        "4",
        "--cores",
        "2",
        "--reference",
        "none",
    ]);
    words.extend(more);
    Program::try_parse_from(words)
        .unwrap_or_else(|error| panic!("{error}"))
        .options
}

fn report(out: &Path) -> Value {
    let text = std::fs::read(out.join("report.json")).expect("a report");
    serde_json::from_slice(&text).expect("JSON")
}

fn sha256(more: &[&str]) -> String {
    let out = tempfile::tempdir().expect("a folder");
    render(&options(out.path(), more), &RUNNING).expect("a picture");
    report(out.path())["image_sha256"]
        .as_str()
        .expect("a digest")
        .to_owned()
}

#[test]
fn the_picture_depends_on_the_seed_and_not_on_the_cores() {
    let one = sha256(&["--cores", "1"]);
    assert_eq!(one, sha256(&["--cores", "4"]));
    assert_eq!(one, sha256(&["--cores", "3", "--pixels", "sequential"]));
    assert_ne!(one, sha256(&["--cores", "1", "--seed", "2"]));
}

/// As many as the flag allows: idle cores must leave the collector its time, and its answers must not be taken for lost.
#[test]
fn a_thousand_cores_do_not_keep_the_collector_from_its_work() {
    let out = tempfile::tempdir().expect("a folder");
    let start = Instant::now();
    render(
        &options(out.path(), &["--cores", "1024", "--size", "128x128"]),
        &RUNNING,
    )
    .expect("a picture");
    let took = start.elapsed();
    let duplicate = report(out.path())["packets"]["duplicate"]
        .as_u64()
        .expect("a count");
    assert!(
        took < Duration::from_secs(20) && duplicate < 100,
        "1024 units: {took:?}, {duplicate} of them twice"
    );
}

#[test]
fn the_report_says_what_was_done_and_null_for_what_was_not_measured() {
    let out = tempfile::tempdir().expect("a folder");
    render(&options(out.path(), &[]), &RUNNING).expect("a picture");
    let report = report(out.path());
    assert_eq!(report["samples"], 16 * 12 * 4);
    assert_eq!(
        (&report["complete"], &report["backend"]),
        (&Value::from(true), &Value::from("native"))
    );
    assert_eq!(report["cost"]["instructions_per_sample"], Value::Null);
    assert_eq!(report["error"]["bias"], Value::Null);
    assert!(
        report["error"]["mean"][0]
            .as_f64()
            .is_some_and(|mean| mean > 0.01)
    );
    assert!(out.path().join("image.png").is_file() && out.path().join("image.exr").is_file());
    assert!(!out.path().join("difference.png").exists());
}

#[test]
fn the_report_says_of_each_core_what_went_wrong_last() {
    let mut record = CoreRecord {
        core: 2,
        ..CoreRecord::default()
    };
    let said = |record: &CoreRecord| {
        let core = results::per_core(record, true);
        (core.restarts, core.fault)
    };
    assert_eq!(said(&record), (0, None));
    let ended = |how: &str| Cause::Ended(how.to_owned());
    record.restarts = ["panic", "undefined instruction"].map(ended).to_vec();
    assert_eq!(said(&record), (2, Some("undefined instruction".to_owned())));
    record.ended = Some(ended("killed"));
    assert_eq!(said(&record), (2, Some("killed".to_owned())));
}

#[test]
fn a_folder_that_cannot_be_written_is_refused_first() {
    let out = tempfile::tempdir().expect("a folder");
    let file = out.path().join("file");
    std::fs::write(&file, "in the way").expect("a file");
    let message = render(&options(&file, &[]), &RUNNING)
        .expect_err("a file is no folder")
        .to_string();
    assert!(
        message.contains("--out") && message.contains(file.to_str().expect("UTF-8")),
        "{message}"
    );
}

#[test]
fn a_taken_port_is_refused() {
    let other = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).expect("a free port");
    let port = other.local_addr().expect("it is bound").port().to_string();
    let out = tempfile::tempdir().expect("a folder");
    let refused = render(&options(out.path(), &["--port", &port]), &RUNNING);
    let message = refused.expect_err("it is taken").to_string();
    assert!(message.contains(&port) && message.contains("--port"), "{message}");
}

#[test]
fn a_reference_of_another_size_is_refused_before_the_render() {
    let small = tempfile::tempdir().expect("a folder");
    render(&options(small.path(), &["--size", "8x6"]), &RUNNING).expect("a picture");
    let reference = small.path().join("image.exr");
    let out = tempfile::tempdir().expect("a folder");
    let refused = render(
        &options(out.path(), &["--reference", reference.to_str().expect("UTF-8")]),
        &RUNNING,
    );
    let message = refused.expect_err("8x6 is not 16x12").to_string();
    assert!(message.contains("8x6") && message.contains("16x12"), "{message}");
    assert!(!out.path().join("report.json").exists());
}

#[test]
fn an_interruption_ends_it_with_its_own_error() {
    let out = tempfile::tempdir().expect("a folder");
    let ended = render(&options(out.path(), &["--spp", "4096"]), &INTERRUPTED);
    assert!(matches!(ended, Err(RenderError::Interrupted(_))), "{ended:?}");
}

/// Whatever was there, the folder holds one render's files; and it holds the earlier ones until there are others.
#[test]
fn results_of_an_earlier_render_go_when_there_are_new_ones_and_not_before() {
    let out = tempfile::tempdir().expect("a folder");
    let is_there = |name: &str| out.path().join(name).is_file();
    render(&options(out.path(), &[]), &RUNNING).expect("a picture");
    let reference = out.path().join("image.exr");
    let with = ["--reference", reference.to_str().expect("UTF-8")];
    render(&options(out.path(), &with), &RUNNING).expect("a picture");
    assert!(is_there("reference.exr") && is_there("difference.png"));
    let before = std::fs::read(out.path().join("report.json")).expect("a report");

    let other = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).expect("a free port");
    let port = other.local_addr().expect("it is bound").port().to_string();
    render(&options(out.path(), &["--port", &port]), &RUNNING).expect_err("the port is taken");
    assert!(is_there("reference.exr") && is_there("difference.png"));
    assert_eq!(
        std::fs::read(out.path().join("report.json")).expect("a report"),
        before
    );

    let first = Job::new(&options(out.path(), &[]).picture).expect("a job");
    let second = render(&options(out.path(), &[]), &RUNNING).expect_err("the folder is taken");
    assert!(matches!(second, RenderError::Busy(_)), "{second}");
    drop(first);

    render(&options(out.path(), &["--seed", "2"]), &RUNNING).expect("a picture");
    assert!(is_there("image.png") && !is_there("reference.exr") && !is_there("difference.png"));
}

/// Nobody has to say how many samples the reference needs, and its noise is never most of what a comparison sees.
#[test]
fn the_reference_takes_as_many_samples_as_leave_it_half_of_the_noise() {
    let [out, cache] = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
    for spp in ["16", "256"] {
        let mut options = options(out.path(), &["--size", "32x24", "--spp", spp]);
        options.picture.reference = None;
        options.picture.reference_cache = Some(cache.path().to_owned());
        let said = render(&options, &RUNNING).expect("a picture").summary;
        let error = &report(out.path())["error"];
        let figure = |key: &str| error[key].as_f64().unwrap_or_else(|| panic!("{key}: {error}"));
        assert!(
            figure("reference_standard_error") < figure("standard_error") / 2.0,
            "{error}"
        );
        assert!(figure("reference_tile_noise_share") < 0.5, "{error}");
        let reference_spp = format!("at {} samples per pixel", figure("reference_spp"));
        assert!(said.contains("noise ") && said.contains(&reference_spp), "{said}");
    }
}
