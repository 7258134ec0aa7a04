//! The licences of all that we build with, against the list of `deny.toml`: what cargo-deny says of them, without a program to install.
//! Advisories need the network, and are the forge's affair.

use std::fs;

use anyhow::{Context, ensure};
use host::firmware::board::Board;
use host::platform::interrupt;
use host::platform::workspace;
use serde::Deserialize;

use crate::step::cargo;

/// What we read of `deny.toml`.
#[derive(Deserialize)]
struct Deny {
    licenses: Licenses,
}

#[derive(Deserialize)]
struct Licenses {
    allow: Vec<String>,
}

/// What we read of cargo's metadata.
#[derive(Deserialize)]
struct Metadata {
    packages: Vec<Package>,
}

#[derive(Deserialize)]
struct Package {
    name: String,
    version: String,
    license: Option<String>,
}

/// Fails where a package that is built here has a licence that is not allowed.
pub(crate) fn check() -> anyhow::Result<()> {
    let path = workspace::file("deny.toml")?;
    let text = fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
    let deny: Deny = toml::from_str(&text).with_context(|| path.display().to_string())?;
    let packages = packages()?;
    let refused: Vec<String> = packages
        .iter()
        .filter_map(|package| fault(package, &deny.licenses.allow))
        .collect();
    ensure!(
        refused.is_empty(),
        "not allowed by {}:\n{}",
        path.display(),
        refused.join("\n")
    );
    Ok(())
}

/// All packages that are built here, for this machine and for the boards.
fn packages() -> anyhow::Result<Vec<Package>> {
    let mut command = cargo(&["metadata", "--locked", "--format-version", "1"])?;
    for target in ["host-tuple"].into_iter().chain(Board::ALL.map(Board::target)) {
        command.args(["--filter-platform", target]);
    }
    let output = interrupt::output(&mut command).context("cannot start cargo")?;
    ensure!(
        output.status.success(),
        "cargo metadata ended with {}:\n{}",
        output.status,
        String::from_utf8_lossy(&output.stderr).trim_end()
    );
    let metadata: Metadata = serde_json::from_slice(&output.stdout).context("what cargo metadata says")?;
    Ok(metadata.packages)
}

/// What there is to say against a package, if anything.
fn fault(package: &Package, allowed: &[String]) -> Option<String> {
    let Package {
        name,
        version,
        license,
    } = package;
    let cause = match license.as_deref() {
        None => "names no licence".to_owned(),
        Some(license) => match Expression::read(license).map(|expression| expression.is_met(allowed)) {
            Some(true) => return None,
            Some(false) => license.to_owned(),
            None => format!("`{license}` is no licence expression"),
        },
    };
    Some(format!("{name} {version}: {cause}"))
}

/// A licence expression of SPDX, and the slash that stood for OR before it.
#[derive(Debug, PartialEq)]
enum Expression {
    Licence(String),
    All(Vec<Self>),
    Any(Vec<Self>),
}

impl Expression {
    fn read(text: &str) -> Option<Self> {
        let spaced = text.replace('(', " ( ").replace(')', " ) ").replace('/', " OR ");
        let mut words: Vec<&str> = spaced.split_whitespace().rev().collect();
        let whole = Self::any(&mut words)?;
        words.is_empty().then_some(whole)
    }

    fn any(words: &mut Vec<&str>) -> Option<Self> {
        let mut parts = vec![Self::all(words)?];
        while words.pop_if(|word| *word == "OR").is_some() {
            parts.push(Self::all(words)?);
        }
        Some(Self::Any(parts))
    }

    fn all(words: &mut Vec<&str>) -> Option<Self> {
        let mut parts = vec![Self::single(words)?];
        while words.pop_if(|word| *word == "AND").is_some() {
            parts.push(Self::single(words)?);
        }
        Some(Self::All(parts))
    }

    fn single(words: &mut Vec<&str>) -> Option<Self> {
        match words.pop()? {
            "(" => {
                let inner = Self::any(words)?;
                (words.pop()? == ")").then_some(inner)
            }
            ")" | "OR" | "AND" | "WITH" => None,
            licence if words.pop_if(|word| *word == "WITH").is_some() => {
                Some(Self::Licence(format!("{licence} WITH {}", words.pop()?)))
            }
            licence => Some(Self::Licence(licence.to_owned())),
        }
    }

    fn is_met(&self, allowed: &[String]) -> bool {
        match self {
            Self::Licence(name) => allowed.contains(name),
            Self::All(parts) => parts.iter().all(|part| part.is_met(allowed)),
            Self::Any(parts) => parts.iter().any(|part| part.is_met(allowed)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(license: Option<&str>) -> Option<String> {
        let package = Package {
            name: "some".to_owned(),
            version: "1.0.0".to_owned(),
            license: license.map(str::to_owned),
        };
        fault(&package, &["MIT".to_owned(), "NCSA".to_owned()])
    }

    #[test]
    fn what_is_allowed_passes() {
        for license in [
            "MIT",
            "GPL-3.0-only OR MIT",
            "Apache-2.0/MIT",
            "(MIT OR Apache-2.0) AND NCSA",
            "Apache-2.0 WITH LLVM-exception OR MIT",
        ] {
            assert_eq!(said(Some(license)), None, "{license}");
        }
    }

    #[test]
    fn what_is_not_is_named() {
        for license in [
            "GPL-3.0-only",
            "MIT AND GPL-3.0-only",
            "NCSA AND (GPL-3.0-only OR Apache-2.0)",
            "MIT WITH some-exception",
        ] {
            assert_eq!(said(Some(license)), Some(format!("some 1.0.0: {license}")));
        }
        for license in ["", "MIT OR", "(MIT", "MIT MIT", "OR MIT", "MIT WITH"] {
            let said = said(Some(license)).unwrap();
            assert!(said.ends_with("is no licence expression"), "{said}");
        }
        assert!(said(None).unwrap().ends_with("names no licence"));
    }
}
