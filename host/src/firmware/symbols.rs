//! What stands at an address of an image: the function, the file and the line, by the image's own line tables.
//!
//! With it, the last words of a core that fails say in which function that was.

use std::error::Error;
use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};

use addr2line::{Loader, demangle_auto};
use object::{Object, ObjectSymbol, SymbolKind};
use wire::FaultInfo;

use super::elf::{ElfError, ElfFault};
use crate::platform::workspace;

/// How the last words of a core that panics begin; file and line follow.
const PANIC: &str = "panic at ";

/// A place in the source of an image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The function whose source it is.
    pub function: String,
    /// File and line of that source, where the image tells them.
    pub line: Option<String>,
    /// The function of the image that the source was inlined into, if it was.
    pub inlined_into: Option<String>,
}

impl Place {
    /// The place of `address` in the image `elf`; nothing where the image cannot be read or does not know it.
    pub fn of(elf: &Path, address: u32) -> Option<Self> {
        let loader = Loader::new(elf).ok()?;
        Self::in_tables(&loader, address.into())
    }

    fn in_tables(loader: &Loader, address: u64) -> Option<Self> {
        let mut frames = frames(loader, address).ok()?.into_iter();
        let innermost = frames.next()?;
        Some(Self {
            function: innermost.function,
            line: innermost.line,
            inlined_into: frames.next_back().map(|frame| frame.function),
        })
    }

    /// The place that a core's panic names in words, and where its code begins.
    pub fn of_panic(elf: &Path, words: &str) -> Option<(u32, Self)> {
        let (file, rest) = words.strip_prefix(PANIC)?.split_once(':')?;
        let line = rest.split(|character: char| !character.is_ascii_digit()).next()?;
        let named = (shortened(file), line.parse().ok()?);
        let loader = Loader::new(elf).ok()?;
        let code = loader.get_section_range(b".text")?;
        let mut lines = loader.find_location_range(code.begin, code.end).ok()?;
        let (address, ..) = lines.find(|(_, _, at)| at.file.map(shortened).zip(at.line) == Some(named))?;
        Some((u32::try_from(address).ok()?, Self::in_tables(&loader, address)?))
    }
}

/// A function that an instruction is part of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Its name, without the arguments of generic functions.
    pub function: String,
    /// File and line: of the instruction's source in the innermost function, of the call in those around it.
    pub line: Option<String>,
    /// Whether that is a file of this project.
    pub ours: bool,
}

/// The line tables and symbols of an image, for many questions.
pub struct Symbols {
    loader: Loader,
    path: PathBuf,
}

impl Symbols {
    /// Those of the image `elf`.
    pub fn of(elf: &Path) -> Result<Self, ElfError> {
        let path = elf.to_owned();
        match Loader::new(elf) {
            Ok(loader) => Ok(Self { loader, path }),
            Err(error) => Err(ElfFault::Lines(error.to_string()).of(elf)),
        }
    }

    /// The functions that an instruction is part of, innermost first: the last is the image's, the others are inlined into it. None
    /// where the image does not know the address.
    pub fn frames(&self, address: u32) -> Result<Vec<Frame>, ElfError> {
        let found = frames(&self.loader, address.into());
        found.map_err(|error| ElfFault::Lines(error.to_string()).of(&self.path))
    }
}

fn frames(loader: &Loader, address: u64) -> Result<Vec<Frame>, Box<dyn Error>> {
    let mut tables = loader.find_frames(address)?;
    let (mut found, mut nameless) = (Vec::new(), None);
    while let Some(frame) = tables.next()? {
        let at = frame.location.and_then(|at| Some((at.file?, at.line?)));
        let at = nameless.take().or(at);
        match frame.function.as_ref().and_then(|name| name.demangle().ok()) {
            Some(name) => found.push(Frame::at(without_arguments(&name), at)),
            None => nameless = at,
        }
    }
    // Assembly has symbols but no functions in the tables. Past the code, the last symbol would be found for anything.
    let code = loader.get_section_range(b".text");
    if found.is_empty() && code.is_some_and(|code| (code.begin..code.end).contains(&address)) {
        let symbol = loader.find_symbol(address);
        found.extend(symbol.map(|symbol| Frame::at(symbol.to_owned(), nameless)));
    }
    Ok(found)
}

impl Frame {
    fn at(function: String, at: Option<(&str, u32)>) -> Self {
        Self {
            function,
            line: at.map(|(file, line)| format!("{}:{line}", shortened(file))),
            ours: at.is_some_and(|(file, _)| workspace::source(Path::new(file)).is_some()),
        }
    }
}

/// The address of the function that renders a unit, and is called once for each.
pub fn unit_renderer(elf: &Path) -> Result<u32, ElfError> {
    let renderers = functions(elf, " as node::worker::Renderer>::render")?;
    match renderers[..] {
        [only] => Ok(only),
        _ => Err(ElfFault::Without("one function that renders units").of(elf)),
    }
}

/// The addresses of the functions whose names end so; none where there is no such.
pub fn functions(elf: &Path, ending: &str) -> Result<Vec<u32>, ElfError> {
    let found = || {
        let bytes = fs::read(elf)?;
        let file = object::File::parse(&bytes[..])?;
        let named = |symbol: &object::Symbol<'_, '_>| {
            symbol.name().is_ok_and(|name| readable(name).ends_with(ending))
        };
        let functions = file.symbols().filter(|symbol| symbol.kind() == SymbolKind::Text);
        // Thumb's symbols are odd.
        Ok(functions
            .filter(named)
            .map(|symbol| symbol.address() as u32 & !1)
            .collect())
    };
    found().map_err(|fault: ElfFault| fault.of(elf))
}

/// A core's last words, and the function in its image that they came from, where that can be found out.
pub fn explained(elf: &Path, fault: &FaultInfo<'_>) -> String {
    let words = fault.reason;
    let found = match fault.address {
        Some(address) => Place::of(elf, address).map(|place| format!("{words}, in {place}")),
        None => Place::of_panic(elf, words)
            .map(|(address, place)| format!("{words}, in {} at {address:#010x}", place.function)),
    };
    found.unwrap_or_else(|| words.to_owned())
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.function)?;
        if let Some(line) = &self.line {
            write!(f, " ({line})")?;
        }
        match &self.inlined_into {
            Some(function) => write!(f, ", inlined into {function}"),
            None => Ok(()),
        }
    }
}

/// A symbol of the linker's as people name it.
pub(super) fn readable(symbol: &str) -> String {
    without_arguments(&demangle_auto(symbol.into(), None))
}

/// A demangled name without the arguments of generic functions and types, which make it longer than any line.
fn without_arguments(name: &str) -> String {
    let (mut kept, mut depth, mut before) = (String::new(), 0, ' ');
    for character in name.chars() {
        // At the start of a name, `<` opens no arguments but a type: `<T as Trait>::method`.
        let opens = character == '<' && (depth > 0 || before.is_alphanumeric() || "_:}".contains(before));
        if opens {
            depth += 1;
        } else if depth == 0 {
            kept.push(character);
        } else if character == '>' && before != '-' {
            depth -= 1;
        }
        if opens && kept.ends_with("::") {
            kept.truncate(kept.len() - 2);
        }
        before = character;
    }
    kept
}

/// A source file as people name it: from the workspace's root, from its crate, or from the standard library's.
fn shortened(file: &str) -> &str {
    if let Some(ours) = workspace::source(Path::new(file)) {
        return ours.to_str().unwrap_or(file);
    }
    if let Some((_, of_registry)) = file.split_once("/registry/src/")
        && let Some((_, of_crate)) = of_registry.split_once('/')
    {
        return of_crate;
    }
    match file.rfind("/library/") {
        Some(slash) => &file[slash + 1..],
        None => file,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_named_from_where_people_know_them() {
        let ours = workspace::file("firmware/node/src/worker.rs").expect("tests run in the checkout");
        let ours = ours.to_str().expect("UTF-8");
        for (file, expected) in [
            (ours, "firmware/node/src/worker.rs"),
            (
                "/home/me/.cargo/registry/src/index.example-0123/smoltcp-0.13.0/src/wire/udp.rs",
                "smoltcp-0.13.0/src/wire/udp.rs",
            ),
            (
                "/usr/lib/rustlib/src/rust/library/core/src/num/mod.rs",
                "library/core/src/num/mod.rs",
            ),
            ("/elsewhere/a.rs", "/elsewhere/a.rs"),
        ] {
            assert_eq!(shortened(file), expected);
        }
    }

    #[test]
    fn names_lose_their_arguments_and_nothing_else() {
        for (name, expected) in [
            ("node::last_words", "node::last_words"),
            ("tracer::unit::walk::<Precise, F<u8>>", "tracer::unit::walk"),
            (
                "<tracer::scene::Scene<Mixed>>::load::<Needs>",
                "<tracer::scene::Scene>::load",
            ),
            (
                "<node::run<fn(u8) -> u8, Needs>::{closure#0} as Renderer<T>>::render::{closure#1}",
                "<node::run::{closure#0} as Renderer>::render::{closure#1}",
            ),
            (
                "<u64 as core::convert::From<u32>>::from",
                "<u64 as core::convert::From>::from",
            ),
        ] {
            assert_eq!(without_arguments(name), expected);
        }
    }

    #[test]
    fn a_place_is_told_with_what_is_known_of_it() {
        let bare = Place {
            function: "_start".to_owned(),
            line: None,
            inlined_into: None,
        };
        assert_eq!(bare.to_string(), "_start");
        let inlined = Place {
            function: "tracer::intersect::nearest".to_owned(),
            line: Some("firmware/tracer/src/intersect.rs:88".to_owned()),
            inlined_into: Some("tracer::unit::render".to_owned()),
        };
        assert_eq!(
            inlined.to_string(),
            "tracer::intersect::nearest (firmware/tracer/src/intersect.rs:88), inlined into tracer::unit::render"
        );
    }

    #[test]
    fn what_is_no_image_has_no_places() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("no.elf");
        assert_eq!(Place::of(&file, 0), None);
        std::fs::write(&file, b"no ELF at all").expect("a file");
        assert_eq!(Place::of(&file, 0), None);
    }
}
