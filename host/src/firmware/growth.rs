//! What a change cost: the memory of the same images before and after it.

use std::collections::BTreeSet;

use super::footprint::Footprint;

/// Symbols that are shown of an image at most.
const SYMBOLS: usize = 12;

/// Nothing in two lists is the same image.
#[derive(Debug, thiserror::Error)]
#[error(
    "nothing to compare: what was saved is of {before}, and this is of {after}; name the scene that was saved, or save this one"
)]
pub struct NothingShared {
    before: String,
    after: String,
}

/// Compares images by board, scene and profile, for people.
pub fn table(before: &[Footprint], after: &[Footprint]) -> Result<String, NothingShared> {
    let same =
        |a: &Footprint, b: &Footprint| (&a.board, &a.scene, &a.profile) == (&b.board, &b.scene, &b.profile);
    let pairs: Vec<(&Footprint, &Footprint)> = after
        .iter()
        .filter_map(|after| Some((before.iter().find(|before| same(before, after))?, after)))
        .collect();
    if pairs.is_empty() {
        return Err(NothingShared {
            before: names(before),
            after: names(after),
        });
    }
    let mut lines = vec![format!(
        "{:12} {:10} {:8} {:>16} {:>16} {:>16} {:>16}",
        "change", "scene", "profile", "code", "of it tracer", "data", "stacks"
    )];
    for (before, after) in &pairs {
        lines.push(format!(
            "{:12} {:10} {:8} {:>16} {:>16} {:>16} {:>16}",
            after.board,
            after.scene,
            after.profile,
            change(before.size.itcm_bytes, after.size.itcm_bytes),
            change(before.tracer_bytes, after.tracer_bytes),
            change(before.size.dtcm_bytes, after.size.dtcm_bytes),
            change(before.size.stack_bytes, after.size.stack_bytes),
        ));
    }
    for (before, after) in pairs {
        lines.extend(symbols(before, after));
    }
    Ok(lines.join("\n"))
}

fn change(before: u64, after: u64) -> String {
    format!("{after} ({:+})", difference(before, after))
}

fn difference(before: u64, after: u64) -> i64 {
    // Sizes in memories of 64 KiB.
    after as i64 - before as i64
}

/// The symbols of an image whose size changed most, the most first.
fn symbols(before: &Footprint, after: &Footprint) -> Vec<String> {
    let names: BTreeSet<&String> = before.symbols.keys().chain(after.symbols.keys()).collect();
    let bytes = |of: &Footprint, name| of.symbols.get(name).copied().unwrap_or_default();
    let mut changed: Vec<(i64, u64, &String)> = names
        .into_iter()
        .map(|name| {
            (
                difference(bytes(before, name), bytes(after, name)),
                bytes(after, name),
                name,
            )
        })
        .filter(|(difference, ..)| *difference != 0)
        .collect();
    changed.sort_by_key(|(difference, ..)| -difference.abs());
    let more = changed.len().saturating_sub(SYMBOLS);
    let mut lines = Vec::new();
    if !changed.is_empty() {
        lines.push(format!("\n{}, {}, by symbol:", after.board, after.profile));
    }
    lines.extend(
        changed
            .iter()
            .take(SYMBOLS)
            .map(|(difference, bytes, name)| format!("{difference:+8} {bytes:8}  {name}")),
    );
    if more > 0 {
        lines.push(format!("and {more} smaller changes"));
    }
    lines
}

fn names(footprints: &[Footprint]) -> String {
    let names: BTreeSet<String> = footprints
        .iter()
        .map(|of| format!("{} on {} with {}", of.scene, of.board, of.profile))
        .collect();
    if names.is_empty() {
        "no image".to_owned()
    } else {
        names.into_iter().collect::<Vec<_>>().join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::super::elf::ImageSize;
    use super::*;

    fn footprint(scene: &str, code: u64, symbols: &[(&str, u64)]) -> Footprint {
        Footprint {
            board: "versatilepb".to_owned(),
            scene: scene.to_owned(),
            profile: "precise".to_owned(),
            size: ImageSize {
                itcm_bytes: code,
                dtcm_bytes: 800,
                stack_bytes: 4096,
                float_symbols: Vec::new(),
            },
            tracer_bytes: code - 100,
            frame_bytes: 100,
            symbols: symbols
                .iter()
                .map(|&(name, bytes)| (name.to_owned(), bytes))
                .collect(),
        }
    }

    #[test]
    fn a_change_is_told_by_kind_of_memory_and_by_symbol() {
        let before = footprint(
            "cornell",
            1000,
            &[("same", 10), ("grown", 100), ("gone", 50), ("a", 1)],
        );
        let after = footprint(
            "cornell",
            1090,
            &[("same", 10), ("grown", 220), ("new", 20), ("a", 1)],
        );
        let said = table(&[before], &[after]).expect("they are the same image");
        let lines: Vec<&str> = said.lines().collect();
        assert!(
            lines[1].contains("1090 (+90)") && lines[1].contains("800 (+0)"),
            "{said}"
        );
        let symbols: Vec<Vec<&str>> = lines[4..]
            .iter()
            .map(|line| line.split_whitespace().collect())
            .collect();
        assert_eq!(
            symbols,
            [
                ["+120", "220", "grown"],
                ["-50", "0", "gone"],
                ["+20", "20", "new"]
            ]
        );
    }

    #[test]
    fn small_changes_are_counted_and_images_without_any_have_no_list() {
        let many: Vec<(String, u64)> = (0..20).map(|n| (format!("f{n}"), n + 1)).collect();
        let many: Vec<(&str, u64)> = many.iter().map(|(name, bytes)| (name.as_str(), *bytes)).collect();
        let said = table(&[footprint("a", 500, &[])], &[footprint("a", 500, &many)]).expect("shared");
        assert!(said.ends_with("and 8 smaller changes"), "{said}");
        let said = table(&[footprint("a", 500, &many)], &[footprint("a", 500, &many)]).expect("shared");
        assert_eq!(said.lines().count(), 2);
    }

    #[test]
    fn lists_that_share_no_image_are_not_compared() {
        let error = table(&[footprint("a", 500, &[])], &[footprint("b", 500, &[])]).expect_err("two scenes");
        let error = error.to_string();
        assert!(
            error.contains("a on versatilepb") && error.contains("b on versatilepb"),
            "{error}"
        );
        let error = table(&[], &[footprint("b", 500, &[])])
            .expect_err("nothing")
            .to_string();
        assert!(error.contains("of no image"), "{error}");
    }
}
