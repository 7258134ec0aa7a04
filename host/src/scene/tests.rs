//! Every way a scene's text can be wrong by itself, and where the message says it is.

use proptest::prelude::*;

use super::fitting_tests::check_compiled;
use super::*;

pub(super) const CORNELL: &str = include_str!("../../../scenes/cornell.toml");

/// One lamp in a hollow ball; the tests spoil it line by line.
pub(super) const GOOD: &str = "format = 1
[camera]
position = [0, 0, 5]
direction = [0, 0, -1]
plane_height = 0.5
[[sphere]]
name = \"room\"
hollow = true
centre = [0, 0, 0]
radius = 20
diffuse = [0.5, 0.5, 0.5]
[[sphere]]
name = \"lamp\"
centre = [0, 0, -5]
radius = 2
emission = [4, 4, 4]
diffuse = [0, 0, 0]
";

pub(super) fn messages(text: &str) -> Vec<String> {
    match Scene::parse("test.toml", text) {
        Ok(scene) => panic!("accepted: {scene:?}"),
        Err(SceneError::Invalid(faults)) => faults.iter().map(ToString::to_string).collect(),
        Err(other) => panic!("{other}"),
    }
}

/// `GOOD` with its line `number` replaced must fail there, once, saying all of `words`.
fn spoiled(number: usize, line: &str, words: &[&str]) {
    let mut lines: Vec<&str> = GOOD.lines().collect();
    lines[number - 1] = line;
    let found = messages(&lines.join("\n"));
    assert_eq!(found.len(), 1, "{found:#?}");
    assert!(
        found[0].starts_with(&format!("test.toml:{number}:")),
        "{number}: {}",
        found[0]
    );
    for word in words {
        assert!(found[0].contains(word), "`{word}` is not in: {}", found[0]);
    }
}

/// `text` must fail at line `at`, once, saying `words`.
fn found_at(at: usize, text: &str, words: &str) {
    let found = messages(text);
    assert_eq!(found.len(), 1, "{found:#?}");
    assert!(
        found[0].starts_with(&format!("test.toml:{at}:")),
        "{at}: {}",
        found[0]
    );
    assert!(found[0].contains(words), "`{words}` is not in: {}", found[0]);
}

/// `GOOD` without its line `number` must fail at line `at`.
fn without(number: usize, at: usize, words: &[&str]) {
    let lines: Vec<&str> = GOOD
        .lines()
        .enumerate()
        .filter(|(i, _)| i + 1 != number)
        .map(|(_, line)| line)
        .collect();
    let found = messages(&lines.join("\n"));
    assert_eq!(found.len(), 1, "{found:#?}");
    assert!(
        found[0].starts_with(&format!("test.toml:{at}:")),
        "{at}: {}",
        found[0]
    );
    for word in words {
        assert!(found[0].contains(word), "`{word}` is not in: {}", found[0]);
    }
}

#[test]
fn the_cornell_box_is_what_it_should_be() {
    let scene = Scene::parse("scenes/cornell.toml", CORNELL).unwrap();
    assert_eq!(scene.name, "cornell");
    assert_eq!(scene.spheres.len(), 9);
    let camera = scene.camera;
    assert_eq!(
        (camera.position, camera.near, camera.plane_height),
        ([50.0, 52.0, 295.6], 140.0, 0.5135)
    );
    assert_eq!(camera.up, [0.0, 1.0, 0.0]);
    let length = (1.0 + 0.042612f64 * 0.042612).sqrt();
    assert!((camera.direction[1] + 0.042612 / length).abs() < 1e-15);
    let wall = |name: &str, centre: [f64; 3], colour: [f64; 3]| Sphere {
        name: name.to_owned(),
        centre,
        radius: 1e4,
        hollow: true,
        emission: [0.0; 3],
        material: Material::Diffuse(colour),
    };
    let expected = [
        wall("left", [1e4 + 1.0, 40.8, 81.6], [0.75, 0.25, 0.25]),
        wall("right", [-1e4 + 99.0, 40.8, 81.6], [0.25, 0.25, 0.75]),
        wall("back", [50.0, 40.8, 1e4], [0.75; 3]),
        wall("front", [50.0, 40.8, -1e4 + 170.0], [0.0; 3]),
        wall("bottom", [50.0, 1e4, 81.6], [0.75; 3]),
        wall("top", [50.0, -1e4 + 81.6, 81.6], [0.75; 3]),
    ];
    assert_eq!(scene.spheres[..6], expected);
    assert_eq!(scene.spheres[6].material, Material::Mirror([0.999; 3]));
    assert_eq!(
        scene.spheres[7].material,
        Material::Glass {
            tint: [0.999; 3],
            index: 1.5
        }
    );
    let light = &scene.spheres[8];
    assert_eq!(
        (light.radius, light.emission, light.hollow),
        (600.0, [12.0; 3], false)
    );
    assert!((light.centre[1] - (681.6 - 0.27)).abs() < 1e-12);
}

#[test]
fn defaults_are_as_documented() {
    let scene = Scene::parse("test.toml", GOOD).unwrap();
    assert_eq!((scene.camera.near, scene.camera.up), (0.0, [0.0, 1.0, 0.0]));
    assert_eq!(
        (scene.spheres[0].emission, scene.spheres[1].hollow),
        ([0.0; 3], false)
    );
}

#[test]
fn text_that_is_not_toml() {
    spoiled(7, "name = room\"", &["not valid TOML"]);
    spoiled(3, "position = [0, 0 5]", &["not valid TOML"]);
    let twice = GOOD.replace("radius = 2\n", "radius = 2\nradius = 3\n");
    assert!(
        messages(&twice)[0].starts_with("test.toml:16:"),
        "{:?}",
        messages(&twice)
    );
}

#[test]
fn other_formats_are_refused_before_anything_else() {
    without(1, 1, &["no `format`", "`format = 1`"]);
    spoiled(1, "format = 2", &["this build reads scene format 1"]);
    spoiled(1, "format = \"1\"", &["this build reads scene format 1"]);
}

#[test]
fn unknown_keys_and_the_nearest_known_one() {
    spoiled(
        8,
        "hollows = true",
        &["sphere \"room\"", "`hollows`", "did you mean `hollow`?"],
    );
    assert!(
        messages(&GOOD.replace("[camera]\n", "[camera]\nzoom = 2\n"))[0]
            .contains("the keys here are position")
    );
    assert!(
        messages(&GOOD.replace("format = 1\n", "format = 1\nshperes = 1\n"))[0]
            .contains("did you mean `sphere`?")
    );
}

#[test]
fn missing_fields() {
    without(3, 2, &["the camera has no `position`"]);
    without(4, 2, &["the camera has no `direction`"]);
    without(5, 2, &["the camera has no `plane_height`", "0.5135"]);
    without(7, 6, &["sphere 1 has no `name`"]);
    without(9, 6, &["sphere \"room\" has no `centre`"]);
    without(10, 6, &["sphere \"room\" has no `radius`", "radius = 16.5"]);
    without(11, 6, &["sphere \"room\" has no material"]);
    let no_camera = "format = 1\n[[sphere]]\nname = \"a\"\ncentre = [0,0,0]\nradius = 1\ndiffuse = [0,0,0]\n";
    assert!(messages(no_camera)[0].contains("no `camera`"));
}

#[test]
fn wrong_types() {
    spoiled(3, "position = 3", &["three numbers", "integer"]);
    spoiled(3, "position = [0, 0]", &["three numbers", "a list of 2"]);
    spoiled(3, "position = [0, \"0\", 5]", &["a number", "string"]);
    spoiled(7, "name = 7", &["a string"]);
    spoiled(7, "name = \"\"", &["empty `name`"]);
    spoiled(8, "hollow = 1", &["true or false"]);
    spoiled(10, "radius = \"20\"", &["a number"]);
    let single = GOOD.replacen("[[sphere]]", "[sphere]", 1);
    assert!(!messages(&single).is_empty());
    let camera = "format = 1\ncamera = 3\nsphere = 4\n";
    let found = messages(camera);
    assert!(
        found[0].contains("`[camera]`") && found[1].contains("`[[sphere]]`"),
        "{found:?}"
    );
    assert!(
        messages("format = 1\nsphere = [1]\n[camera]\n")
            .iter()
            .any(|m| m.contains("`[[sphere]]`"))
    );
}

#[test]
fn numbers_that_are_slips() {
    spoiled(
        10,
        "radius = 1e13",
        &["`radius` 10000000000000 exceeds", "a longer unit of length"],
    );
    spoiled(3, "position = [0, 0, 2e12]", &["exceeds 1000000000000"]);
    spoiled(3, "position = [0, -4e14, 5]", &["below -1000000000000"]);
    spoiled(10, "radius = 99999999999999999999", &["exceeds"]);
    for not_finite in ["nan", "-nan"] {
        spoiled(9, &format!("centre = [0, {not_finite}, 0]"), &["not a number"]);
    }
    spoiled(10, "radius = inf", &["exceeds"]);
    spoiled(9, "centre = [0, -inf, 0]", &["below"]);
}

#[test]
fn numbers_out_of_their_own_range() {
    spoiled(15, "radius = 0", &["a radius is positive"]);
    spoiled(15, "radius = -2", &["`radius` -2", "a radius is positive"]);
    spoiled(15, "radius = 1e-13", &["a shorter unit of length"]);
    spoiled(
        16,
        "emission = [4, 4096, 4]",
        &["exceeds 4095", "dim every light"],
    );
    spoiled(16, "emission = [4, -1, 4]", &["cannot be negative"]);
    spoiled(11, "diffuse = [0.5, 1, 0.5]", &["exceeds 0.999"]);
    spoiled(11, "mirror = [0.5, -0.1, 0.5]", &["below 0"]);
    spoiled(5, "plane_height = 0", &["narrower"]);
    spoiled(5, "plane_height = 17", &["165 degrees"]);
    spoiled(
        5,
        "plane_width = 0\nplane_height = 1",
        &["plane_width", "narrower"],
    );
    spoiled(
        5,
        "plane_width = 17\nplane_height = 1",
        &["plane_width", "165 degrees"],
    );
    found_at(
        6,
        &GOOD.replace(
            "[[sphere]]\nname = \"room\"",
            "near = -1\n[[sphere]]\nname = \"room\"",
        ),
        "behind",
    );
}

#[test]
fn materials() {
    found_at(
        18,
        &format!("{GOOD}mirror = [0, 0, 0]\n"),
        "both `diffuse` and `mirror`",
    );
    found_at(18, &format!("{GOOD}index = 1.5\n"), "only glass has one");
    let glass = |lines: &str| GOOD.replace("emission = [4, 4, 4]\ndiffuse = [0, 0, 0]\n", lines);
    let lit = |text: String| text.replace("diffuse = [0.5", "emission = [1, 1, 1]\ndiffuse = [0.5");
    assert!(Scene::parse("test.toml", &lit(glass("glass = [0.9, 0.9, 0.9]\nindex = 1.5\n"))).is_ok());
    for (index, word) in [
        ("1", "below 1.0"),
        ("0.5", "below 1.0"),
        ("4.5", "exceeds 4"),
        ("nan", "not a number"),
    ] {
        let found = messages(&lit(glass(&format!(
            "glass = [0.9, 0.9, 0.9]\nindex = {index}\n"
        ))));
        assert!(found.len() == 1 && found[0].contains(word), "{index}: {found:?}");
    }
    let bare = messages(&lit(glass("glass = [0.9, 0.9, 0.9]\n")));
    assert!(bare[0].contains("no `index`"), "{bare:?}");
    let hollow = messages(&lit(glass(
        "glass = [0.9, 0.9, 0.9]\nindex = 1.5\nhollow = true\n",
    )));
    assert!(hollow[0].contains("glass is solid"), "{hollow:?}");
    let shining = messages(&lit(glass(
        "glass = [0.9, 0.9, 0.9]\nindex = 1.5\nemission = [1, 1, 1]\n",
    )));
    assert!(shining[0].contains("glass does not shine"), "{shining:?}");
}

#[test]
fn empty_scenes_and_full_ones() {
    let camera = GOOD.split("[[sphere]]").next().unwrap();
    assert!(messages(camera)[0].contains("the scene is empty"));
    assert!(messages(&format!("sphere = []\n{camera}"))[0].contains("the scene is empty"));
    let balls = |count: usize| {
        let ball = |i: usize| {
            let x = i as f64 / 10.0;
            format!("[[sphere]]\nname = \"{i}\"\ncentre = [{x}, 3, -9]\nradius = 1\ndiffuse = [0, 0, 0]\n")
        };
        GOOD.to_owned() + &(0..count).map(ball).collect::<String>()
    };
    assert!(Scene::parse("test.toml", &balls(MAX_SPHERES - 2)).is_ok());
    let found = messages(&balls(MAX_SPHERES - 1));
    assert!(
        found.len() == 1 && found[0].contains("257 spheres, but a core has room for 256"),
        "{found:?}"
    );
}

#[test]
fn names_light_and_camera_up() {
    found_at(
        12,
        &GOOD.replace("\"lamp\"", "\"room\""),
        "a second sphere \"room\" (the first is at line 6)",
    );
    found_at(6, &GOOD.replace("emission = [4, 4, 4]\n", ""), "nothing shines");
    let parallel = messages(&GOOD.replace("plane_height", "up = [0, 0, 3]\nplane_height"));
    assert!(
        parallel[0].starts_with("test.toml:2:") && parallel[0].contains("parallel"),
        "{parallel:?}"
    );
    spoiled(4, "direction = [0, 0, 0]", &["no length"]);
}

#[test]
fn all_faults_are_told_at_once_in_the_order_of_the_text() {
    let text = GOOD
        .replace("position = [0, 0, 5]", "position = [nan, 0, 5]")
        .replace("radius = 2\n", "radius = -2\n");
    let found = messages(&text.replace("plane_height", "plane_hight"));
    assert_eq!(found.len(), 4, "{found:#?}");
    assert!(
        found.is_sorted_by_key(|m| m.split(':').nth(1).unwrap().parse::<u32>().unwrap()),
        "{found:#?}"
    );
}

#[test]
fn columns_count_characters() {
    let found = messages(&GOOD.replace("name = \"lamp\"\n", "\"näme\" = 1\nname = \"lamp\"\n"));
    assert!(found[0].starts_with("test.toml:13:1:"), "{found:?}");
    let inline = "format = 1\nsphere = [{ name = \"ä\", radius = -1 }]\n[camera]\n";
    assert!(
        messages(inline).iter().any(|m| m.starts_with("test.toml:2:34:")),
        "{:?}",
        messages(inline)
    );
}

#[test]
fn a_file_that_is_not_there_is_named() {
    let message = Scene::load(Path::new("no/such/scene.toml"))
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("no/such/scene.toml") && message.contains("scenes/cornell.toml"),
        "{message}"
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn no_text_makes_the_parser_panic(text in any::<String>()) {
        let _ = Scene::parse("any.toml", &text);
    }

    #[test]
    fn nor_does_a_damaged_scene(
        edits in prop::collection::vec((0..CORNELL.len(), 0..40usize, "[ -~\n]{0,12}|\\[\\[|-?[0-9]{1,25}|nan|ä"), 1..4)
    ) {
        let mut text = CORNELL.to_owned();
        for (at, cut, insert) in edits {
            let start = text.floor_char_boundary(at);
            let end = text.floor_char_boundary(start + cut).max(start);
            text.replace_range(start..end, &insert);
        }
        if let Ok(scene) = Scene::parse("damaged.toml", &text) {
            // What is accepted is within range, whatever was done to it.
            for sphere in &scene.spheres {
                prop_assert!(sphere.radius >= MIN_RADIUS && sphere.radius <= MAX_LENGTH);
                prop_assert!(sphere.centre.iter().all(|c| c.abs() <= MAX_LENGTH));
                prop_assert!(sphere.emission.iter().all(|e| (0.0..=MAX_EMISSION).contains(e)));
            }
            let length: f64 = scene.camera.direction.iter().map(|c| c * c).sum();
            prop_assert!((length - 1.0).abs() < 1e-12);
            check_compiled(&scene);
        }
    }
}
