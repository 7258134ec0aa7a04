//! Single choices: a core draws with each what the host does, and each is another picture.

use std::fs;

use host::firmware::Choice;
use host::firmware::board::Board;
use host::oracle::direct;
use host::scene::{Integrator, compile};
use tracer::kronecker::Stratified;
use tracer::profile::Precise;
use whole_system::{cornell, plan, said, xtask};

#[test]
fn every_choice_gives_the_hosts_picture_to_the_bit() {
    let plan = plan::<Precise>(16, 12, 4);
    let compiled = compile(&cornell(), 16, 12, Integrator::NextEvent);
    let mut pictures = vec![direct::film::<Stratified<Precise>>(&compiled, &plan).sha256()];
    // The boards take turns: an image is some seconds.
    for (choice, board) in Choice::ALL.into_iter().zip(Board::ALL.into_iter().cycle()) {
        let folder = tempfile::tempdir().expect("a folder");
        let mut render = xtask(&["render", "--no-install", "--reference", "none"]);
        render.args([
            "--choice",
            choice.word(),
            "--size",
            "16x12",
            "--spp",
            "4",
            "--cores",
            "2",
        ]);
        render.args(["--board", board.name(), "--out"]);
        let output = render.arg(folder.path()).output().expect("it starts");
        assert!(output.status.success(), "{}", said(&output));
        let report = fs::read(folder.path().join("report.json")).expect("a report");
        let report: serde_json::Value = serde_json::from_slice(&report).expect("JSON");
        let expected = direct::film_of_choice(choice, &compiled, &plan).sha256();
        assert_eq!(report["image_sha256"], expected.as_str(), "{choice:?}");
        assert_eq!(
            report["profile"],
            format!("precise but for {}", choice.word()).as_str()
        );
        // A choice that changes nothing would not be one.
        assert!(!pictures.contains(&expected), "{choice:?}");
        pictures.push(expected);
    }
}
