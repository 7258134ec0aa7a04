//! The report: every section has its data, and the page needs nothing but itself.

use std::fs;

use host::report::PARTS;
use whole_system::{said, xtask};

#[test]
fn a_quick_report_has_every_section_and_needs_no_other_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut report = xtask(&["report", "--quick", "--no-install", "--out"]);
    let output = report.arg(folder.path()).output().expect("it starts");
    assert!(output.status.success(), "{}", said(&output));
    let page = fs::read_to_string(folder.path().join("index.html")).expect("a page");
    for part in PARTS {
        assert!(
            page.contains(&format!("<section id=\"{}\"", part.name)),
            "{}",
            part.name
        );
    }
    assert!(
        page.contains("class=\"warning\">A quick run"),
        "its figures are not taken for good ones"
    );
    for from_outside in [
        "http-equiv",
        "<script",
        "<link",
        "src=\"http",
        "href=\"http",
        "url(",
        "@import",
    ] {
        assert!(!page.contains(from_outside), "{from_outside}");
    }
    let plot = fs::read_to_string(folder.path().join("error-against-time.svg")).expect("a plot");
    assert!(plot.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\""));
    let files = fs::read_dir(folder.path()).expect("the folder").count();
    assert_eq!(files, 2, "nothing half-written stays");
}
