//! What an image takes of a core's memory, as `cargo xtask size` lists it and keeps it in a file.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::{fs, io};

use object::{Object, ObjectSymbol, SymbolKind};
use serde::{Deserialize, Serialize};

use super::arithmetic::Arithmetic;
use super::board::{Board, DTCM_BUDGET, ITCM_BUDGET};
use super::build::Image;
use super::elf::{ElfError, ElfFault, ImageSize};
use super::share::tracer_bytes;
use super::symbols::readable;

/// One image's memory.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Footprint {
    /// The board.
    pub board: String,
    /// The scene.
    pub scene: String,
    /// The profile.
    pub profile: String,
    /// Its memory by kind, with the scene's boot block.
    #[serde(flatten)]
    pub size: ImageSize,
    /// Code memory that the tracer takes, with its arithmetic.
    pub tracer_bytes: u64,
    /// Code memory of the frame around it.
    pub frame_bytes: u64,
    /// Bytes of each function and each named constant or variable, by name.
    pub symbols: BTreeMap<String, u64>,
}

/// A file that holds no list of footprints.
#[derive(Debug, thiserror::Error)]
pub enum FootprintError {
    /// It cannot be read.
    #[error("cannot read {}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        #[source]
        cause: io::Error,
    },
    /// It holds something else.
    #[error(
        "{} is not what this version of `cargo xtask size --json` writes; write it anew with the sources to compare with",
        path.display()
    )]
    Form {
        /// The file.
        path: PathBuf,
        /// Where it differs.
        #[source]
        cause: serde_json::Error,
    },
}

impl Footprint {
    /// The footprint of an image with a scene whose boot block has so many bytes.
    pub fn of(
        board: Board,
        profile: Arithmetic,
        scene: &str,
        image: &Image,
        boot_block: usize,
    ) -> Result<Self, ElfError> {
        let tracer_bytes = tracer_bytes(&image.elf)?;
        Ok(Self {
            board: board.name().to_owned(),
            scene: scene.to_owned(),
            profile: profile.name().to_owned(),
            size: image.size.clone().with_boot_block(boot_block),
            tracer_bytes,
            frame_bytes: image.size.itcm_bytes - tracer_bytes,
            symbols: symbols(&image.elf).map_err(|fault| fault.of(&image.elf))?,
        })
    }

    /// Bytes of data memory, stacks and all.
    pub fn data_bytes(&self) -> u64 {
        self.size.dtcm_bytes + self.size.stack_bytes
    }

    /// Whether code and data fit a core.
    pub fn is_within_budget(&self) -> bool {
        self.size.itcm_bytes <= ITCM_BUDGET && self.data_bytes() <= DTCM_BUDGET
    }
}

/// What `cargo xtask size --json` has written.
pub fn read(path: &Path) -> Result<Vec<Footprint>, FootprintError> {
    let path = path.to_owned();
    match fs::read(&path) {
        Ok(bytes) => serde_json::from_slice(&bytes).map_err(|cause| FootprintError::Form { path, cause }),
        Err(cause) => Err(FootprintError::Read { path, cause }),
    }
}

/// How the linker names what has no name, by a number that any change changes.
const NAMELESS: &str = ".Lanon.";

/// Bytes by name: instances of a generic function are one, and so are constants without a name.
fn symbols(elf: &Path) -> Result<BTreeMap<String, u64>, ElfFault> {
    let bytes = fs::read(elf)?;
    let file = object::File::parse(&bytes[..])?;
    let mut found = BTreeMap::new();
    let kinds = [SymbolKind::Text, SymbolKind::Data];
    for symbol in file
        .symbols()
        .filter(|symbol| symbol.size() > 0 && kinds.contains(&symbol.kind()))
    {
        let name = match symbol.name()? {
            name if name.starts_with(NAMELESS) => "(constants without a name)".to_owned(),
            name => readable(name),
        };
        *found.entry(name).or_default() += symbol.size();
    }
    Ok(found)
}

/// The list for people.
pub fn table(footprints: &[Footprint]) -> String {
    let mut lines = vec![format!(
        "{:12} {:10} {:8} {:>32} {:>22}",
        "board", "scene", "profile", "code memory (tracer + frame)", "data memory (stacks)"
    )];
    lines.extend(footprints.iter().map(|footprint| {
        let Footprint {
            size,
            board,
            scene,
            profile,
            tracer_bytes,
            frame_bytes,
            ..
        } = footprint;
        format!(
            "{board:12} {scene:10} {profile:8} {:>32} {:>22}",
            format!("{} ({tracer_bytes} + {frame_bytes})", size.itcm_bytes),
            format!("{} ({})", footprint.data_bytes(), size.stack_bytes)
        )
    }));
    lines.push(format!("{:32} {ITCM_BUDGET:>32} {DTCM_BUDGET:>22}", "budget"));
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_is_read_as_it_was_written_and_nothing_else_is() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("size.json");
        let missing = read(&file).expect_err("there is no file");
        assert!(missing.to_string().contains("size.json"), "{missing}");
        let list = [Footprint {
            board: "versatilepb".to_owned(),
            scene: "cornell".to_owned(),
            profile: "precise".to_owned(),
            size: ImageSize {
                itcm_bytes: 3,
                dtcm_bytes: 2,
                stack_bytes: 1,
                float_symbols: Vec::new(),
            },
            tracer_bytes: 2,
            frame_bytes: 1,
            symbols: [("main".to_owned(), 2)].into(),
        }];
        let json = serde_json::to_string(&list).expect("JSON");
        fs::write(&file, &json).expect("a file");
        assert_eq!(read(&file).expect("the list"), list);
        // The form of before there were symbols, another command's, and a half.
        let older = json.replace("symbols", "nothing");
        for other in [
            &older,
            "[{\"op\": \"divide\"}]",
            "{}",
            &json[..json.len() / 2],
            "",
        ] {
            fs::write(&file, other).expect("a file");
            let error = read(&file).expect_err(other).to_string();
            assert!(error.contains("size --json") && error.contains("anew"), "{error}");
        }
    }
}
