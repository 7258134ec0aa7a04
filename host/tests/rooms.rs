//! The house stays as ARCHITECTURE.md draws it: a dozen rooms at most, and arrows in one direction, between the rooms of the
//! host, between the modules of a room, and between the modules of each crate of the firmware.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// What each module uses, by name.
type Arrows = BTreeMap<String, BTreeSet<String>>;

/// The most rooms that a plan of the host may have to show.
const MOST_ROOMS: usize = 12;
/// How an inline module of tests begins. By custom it ends its file.
const TESTS: [&str; 2] = [
    "#[cfg(test)]\nmod tests {",
    "#[cfg(test)]\npub(crate) mod tests {",
];

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The text of every source file under `folder`, by its path from there, without comments and without what only tests see.
fn sources(folder: &Path) -> BTreeMap<PathBuf, String> {
    let mut texts = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(&next).expect("a folder of sources") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let text = fs::read_to_string(&path).expect("a source file");
                let path = path.strip_prefix(folder).expect("it is in the folder");
                texts.insert(path.to_owned(), text);
            }
        }
    }
    let of_tests: BTreeSet<PathBuf> = texts
        .iter()
        .flat_map(|(path, text)| files_of_tests(path, text))
        .collect();
    texts.retain(|path, _| !of_tests.contains(path));
    for text in texts.values_mut() {
        *text = without_tests(text);
    }
    texts
}

/// The files of modules that are declared behind `#[cfg(test)]` in the file at `path`.
fn files_of_tests(path: &Path, text: &str) -> Vec<PathBuf> {
    let folder = match module_of(path.file_name().map(Path::new).expect("a file has a name")) {
        Some(name) => path.with_file_name(name),
        None => path.with_file_name(""),
    };
    let mut files = Vec::new();
    let mut lines = text.lines().map(str::trim);
    while let Some(line) = lines.next() {
        if line != "#[cfg(test)]" {
            continue;
        }
        let mut next = lines.next().unwrap_or_default();
        let mut beside = None;
        if let Some(quoted) = next.strip_prefix("#[path = \"") {
            beside = quoted.strip_suffix("\"]").map(|name| path.with_file_name(name));
            next = lines.next().unwrap_or_default();
        }
        let declared = next.strip_suffix(';').and_then(|line| line.split("mod ").nth(1));
        files.extend(declared.map(|name| beside.unwrap_or_else(|| folder.join(format!("{name}.rs")))));
    }
    files
}

fn without_tests(text: &str) -> String {
    let end = TESTS.iter().filter_map(|tests| text.find(tests)).min();
    let lines = text[..end.unwrap_or(text.len())].lines();
    let code: Vec<&str> = lines
        .filter(|line| !line.trim_start().starts_with("//"))
        .collect();
    code.join("\n")
}

/// The names right after `path`: of `path::name`, or each of `path::{a, b::c}`.
fn named_after(text: &str, path: &str) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for (at, _) in text.match_indices(path) {
        if text[..at].ends_with(|before: char| before.is_alphanumeric() || before == '_' || before == ':') {
            continue;
        }
        let after = &text[at + path.len()..];
        let listed = after.strip_prefix('{').map_or_else(|| vec![after], entries);
        names.extend(listed.into_iter().map(identifier));
    }
    names
}

/// The entries of a `use` group whose opening brace has been read.
fn entries(group: &str) -> Vec<&str> {
    let (mut depth, mut start, mut found) = (0, 0, Vec::new());
    for (at, character) in group.char_indices() {
        if depth == 0 && (character == ',' || character == '}') {
            found.push(group[start..at].trim_start());
            start = at + 1;
        }
        match character {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            _ => {}
        }
    }
    found
}

fn identifier(text: &str) -> String {
    let of_name = |&character: &char| character.is_alphanumeric() || character == '_';
    text.chars().take_while(of_name).collect()
}

/// The outermost module that a file belongs to; none for the file of the crate or the room itself.
fn module_of(path: &Path) -> Option<String> {
    let part = path.components().next()?.as_os_str().to_string_lossy();
    let name = part.strip_suffix(".rs").unwrap_or(&part);
    (!["lib", "main", "mod"].contains(&name)).then(|| name.to_owned())
}

/// The arrows between the outermost modules of `folder`, whose own path in its crate is `path`.
fn arrows_between(folder: &Path, path: &str) -> Arrows {
    let mut arrows = Arrows::new();
    for (file, text) in sources(folder) {
        let Some(module) = module_of(&file) else { continue };
        let mut used = named_after(&text, path);
        if file.components().count() == 1 {
            used.extend(named_after(&text, "super::"));
        }
        arrows.entry(module).or_default().extend(used);
    }
    let modules: BTreeSet<String> = arrows.keys().cloned().collect();
    for (module, used) in &mut arrows {
        used.retain(|name| name != module && modules.contains(name));
    }
    arrows
}

/// A way along the arrows that comes back to where it has been.
fn circle(arrows: &Arrows) -> Option<Vec<&str>> {
    fn search<'a>(arrows: &'a Arrows, way: &mut Vec<&'a str>, seen: &mut BTreeSet<&'a str>) -> bool {
        let here = *way.last().expect("a way has a beginning");
        for next in &arrows[here] {
            let closes = way.contains(&next.as_str());
            if closes || seen.insert(next) {
                way.push(next);
                if closes || search(arrows, way, seen) {
                    return true;
                }
                way.pop();
            }
        }
        false
    }
    let mut seen = BTreeSet::new();
    arrows.keys().find_map(|start| {
        let mut way = vec![start.as_str()];
        search(arrows, &mut way, &mut seen).then_some(way)
    })
}

#[track_caller]
fn assert_one_way(plan: &Path, arrows: &Arrows) {
    let way = circle(arrows);
    assert_eq!(way, None, "a circle in {}", plan.display());
}

#[test]
fn the_hosts_rooms_are_a_dozen_at_most_with_arrows_one_way() {
    let source = repository().join("host/src");
    let mut arrows = arrows_between(&source, "crate::");
    arrows.remove("bin");
    println!("{arrows:#?}");
    assert!((2..=MOST_ROOMS).contains(&arrows.len()), "{} rooms", arrows.len());
    assert_one_way(&source, &arrows);
    for room in arrows.keys() {
        let folder = source.join(room);
        assert_one_way(&folder, &arrows_between(&folder, &format!("crate::{room}::")));
    }
}

#[test]
fn the_firmwares_modules_have_arrows_one_way() {
    for name in [
        "mps2-an385",
        "node",
        "operations",
        "runtime",
        "versatilepb",
        "wire",
    ] {
        let source = repository().join("firmware").join(name).join("src");
        let arrows = arrows_between(&source, "crate::");
        assert!(arrows.len() > 1, "{name} has {} modules", arrows.len());
        assert_one_way(&source, &arrows);
    }
    // A profile names what every room needs of the number formats, and every room works by whichever profile.
    let source = repository().join("firmware/tracer/src");
    let mut arrows = arrows_between(&source, "crate::");
    arrows.remove("profile");
    arrows.values_mut().for_each(|used| _ = used.remove("profile"));
    assert!(arrows.len() > 1, "the tracer has {} modules", arrows.len());
    assert_one_way(&source, &arrows);
}

#[test]
fn a_circle_would_be_found() {
    let plan = |arrows: &[(&str, &[&str])]| -> Arrows {
        let named = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
        let arrows = arrows.iter();
        arrows
            .map(|&(module, used)| (module.to_owned(), named(used)))
            .collect()
    };
    let tree = plan(&[("a", &["b", "c"]), ("b", &["c"]), ("c", &[])]);
    assert_eq!(circle(&tree), None);
    let around = plan(&[("a", &[]), ("b", &["c"]), ("c", &["d"]), ("d", &["b"])]);
    assert_eq!(circle(&around), Some(vec!["b", "c", "d", "b"]));
}

#[test]
fn what_a_file_uses_is_found() {
    let text = "use crate::fleet::{self, Fleet};\nlet x = crate::scene::Scene;\nuse crate::{image, oracle::{noise, direct}, bench};";
    let named: Vec<String> = named_after(text, "crate::").into_iter().collect();
    assert_eq!(named, ["bench", "fleet", "image", "oracle", "scene"]);
    let text =
        "#[cfg(test)]\nmod support;\n#[cfg(test)]\n#[path = \"other_tests.rs\"]\nmod tests;\nmod real;";
    let files = files_of_tests(Path::new("room/mod.rs"), text);
    assert_eq!(
        files,
        [Path::new("room/support.rs"), Path::new("room/other_tests.rs")]
    );
    assert_eq!(without_tests("a\n// b\n#[cfg(test)]\nmod tests {\nc"), "a");
}
