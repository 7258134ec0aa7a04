//! The tracer in soft float, which fixed point is measured against: on cores it computes what the same formats give on the host.

use std::fs;

use floating::{Float, Lockstep};
use tracer::profile::Precise;
use whole_system::{cornell, film, plan, said, xtask};

/// What a core of each board renders together, in a format.
fn picture_of_cores(format: &str) -> serde_json::Value {
    let folder = tempfile::tempdir().expect("a folder");
    let mut render = xtask(&[
        "render",
        "--no-install",
        "--reference",
        "none",
        "--soft-float",
        format,
    ]);
    render.args(["--size", "16x12", "--spp", "4", "--cores", "2"]);
    render.args(["--integrator", "path", "--sampler", "independent"]);
    render.args(["--board", "versatilepb,mps2-an385", "--out"]);
    let output = render.arg(folder.path()).output().expect("it starts");
    assert!(output.status.success(), "{}", said(&output));
    let report = fs::read(folder.path().join("report.json")).expect("a report");
    serde_json::from_slice(&report).expect("JSON")
}

fn picture_of_the_host<F: Float>() -> String {
    let plan = plan::<Lockstep<Precise, F>>(16, 12, 4);
    film::<Lockstep<Precise, F>>(&cornell(), &plan).sha256()
}

#[test]
fn soft_float_gives_the_hosts_picture_to_the_bit() {
    for (format, expected) in [
        ("f32", picture_of_the_host::<f32>()),
        ("f64", picture_of_the_host::<f64>()),
    ] {
        let report = picture_of_cores(format);
        assert_eq!(report["image_sha256"], expected.as_str(), "{format}");
        assert_eq!(report["profile"], format!("precise in {format}").as_str());
        // It is the rival that it is taken for: no fixed point takes so long.
        let instructions = report["cost"]["instructions_per_sample"].as_f64();
        println!("{format}: {instructions:?} instructions a sample");
        assert!(instructions > Some(30_000.0), "{instructions:?}");
    }
}

#[test]
fn threads_have_no_soft_float() {
    let output = xtask(&[
        "render",
        "--no-install",
        "--backend",
        "native",
        "--soft-float",
        "f32",
    ])
    .output();
    let output = output.expect("it starts");
    let text = said(&output);
    assert!(
        !output.status.success() && text.contains("leave out --soft-float"),
        "{text}"
    );
}
