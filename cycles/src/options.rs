//! The plugin's arguments: `KEY=VALUE` each, as QEMU hands them over.

use std::ffi::{OsStr, OsString};
use std::os::unix::ffi::OsStrExt;
use std::path::PathBuf;

use crate::flow::Isa;
use crate::recorder::Wanted;

/// What the plugin says where it is only tried, with `probe=on`.
pub const READY: &str = "ready";

/// What to record, and the file for it.
pub fn parse(words: &[OsString]) -> Result<(Wanted, PathBuf), String> {
    let mut wanted = Wanted {
        isa: Isa::Arm,
        entries: Vec::new(),
        each: false,
        code_end: 0,
    };
    let mut file = None;
    for word in words {
        let mut parts = word.as_bytes().splitn(2, |&byte| byte == b'=');
        let [key, value] = [(); 2].map(|()| parts.next().unwrap_or_default());
        match (key, value) {
            (b"isa", b"arm") => wanted.isa = Isa::Arm,
            (b"isa", b"thumb") => wanted.isa = Isa::Thumb,
            (b"each", b"on" | b"off") => wanted.each = value == b"on",
            (b"code_end", _) => wanted.code_end = address(value)?,
            // A Thumb function's symbol has its lowest bit set; its instructions lie at even addresses.
            (b"entry", _) => wanted.entries.push(address(value)? & !1),
            (b"out", _) => file = Some(PathBuf::from(OsStr::from_bytes(value))),
            (b"probe", b"on") => return Err(READY.to_owned()),
            _ => return Err(format!("`{}` is none of its arguments", word.display())),
        }
    }
    let file = file.ok_or("it needs `out=PATH`")?;
    match wanted.entries.is_empty() {
        true => Err("it needs `entry=ADDRESS`, once or more".to_owned()),
        false => Ok((wanted, file)),
    }
}

fn address(text: &[u8]) -> Result<u32, String> {
    let text = String::from_utf8_lossy(text);
    let digits = text.strip_prefix("0x").unwrap_or(&text);
    u32::from_str_radix(digits, 16).map_err(|_| format!("`{text}` is no hexadecimal address"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(words: &[&str]) -> Result<(Wanted, PathBuf), String> {
        parse(&words.iter().map(OsString::from).collect::<Vec<_>>())
    }

    #[test]
    fn every_argument_is_taken_and_all_else_refused_by_name() {
        let words = [
            "isa=thumb",
            "entry=0x101",
            "entry=200",
            "each=on",
            "code_end=8000",
            "out=a=b",
        ];
        let wanted = Wanted {
            isa: Isa::Thumb,
            entries: vec![0x100, 0x200],
            each: true,
            code_end: 0x8000,
        };
        assert_eq!(parsed(&words), Ok((wanted, "a=b".into())));
        for (words, said) in [
            (&["out=x"][..], "entry=ADDRESS"),
            (&["entry=1"], "out=PATH"),
            (&["isa=mips"], "isa=mips"),
            (&["entry=xyz"], "xyz"),
            (&["probe=on"], READY),
        ] {
            let error = parsed(words).expect_err(said);
            assert!(error.contains(said), "{error}");
        }
    }
}
