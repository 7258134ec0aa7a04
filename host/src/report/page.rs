//! The page: all sections in one file that needs no other.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::plot::STYLE;
use super::section::{Section, SectionError};

/// What the page says of the run that made it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Origin {
    /// The command.
    pub command: String,
    /// Whether it did so little work that its figures mean nothing.
    pub is_quick: bool,
    /// The version of the compiler that made the images.
    pub compiler: String,
}

const TITLE: &str = "Speed against error";

/// The page, if every section of it has its data.
pub(super) fn page(sections: &[Section], origin: &Origin) -> Result<String, SectionError> {
    sections.iter().try_for_each(Section::check)?;
    let parts: Vec<Markup> = sections.iter().map(Section::markup).collect::<Result<_, _>>()?;
    let page = html! {
        (DOCTYPE)
        html lang="en" xmlns="http://www.w3.org/1999/xhtml" {
            head {
                // Closed like elements of XML, which HTML allows: so a test can read the page back.
                (PreEscaped(r#"<meta charset="utf-8"/><meta name="viewport" content="width=device-width, initial-scale=1"/>"#))
                title { (TITLE) ": a path tracer for cores without a floating-point unit" }
                style { (PreEscaped(include_str!("page.css"))) (PreEscaped(STYLE)) }
            }
            body {
                (head(sections, origin))
                main { @for part in &parts { (part) } }
                footer {
                    p { "Made by " code { (origin.command) } ", with images by rustc " (origin.compiler)
                        ". Counts of instructions and cycles are the same in every run; so is every picture." }
                }
            }
        }
    };
    Ok(page.into_string() + "\n")
}

fn head(sections: &[Section], origin: &Origin) -> Markup {
    html! {
        header {
            h1 { (TITLE) }
            p { "A path tracer in fixed point, as firmware for cores without a floating-point unit: what each choice costs in cycles, \
                 and what it does to the picture. " code { "precise" } " is this project's arithmetic, " code { "paper" }
                " the published system's. All is measured by the commands beside it, on emulated cores and against double precision." }
            p { "Cycles are those of an ARM9E-S (ARM968E-S, 200 MHz) unless a board is named. An " em { "ulp" } " is 2" sup { "−16" }
                " unless a plot says otherwise. " em { "Lockstep" } " compares each sample with the same sample in double precision, so that \
                 what is left is arithmetic. Each plot has its data below it, and shows a mark's values under the pointer." }
            @if origin.is_quick {
                p class="warning" { "A quick run, to see that everything can be measured: too little work for its figures to mean anything." }
            }
            nav aria-label="Contents" {
                ol { @for section in sections { li { a href={ "#" (section.name) } { (section.title) } } } }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::super::picture::Image;
    use super::super::plot::tests::plot;
    use super::super::section::Figure;
    use super::super::table::Table;
    use super::*;
    use crate::image::picture::Picture;

    fn origin() -> Origin {
        Origin {
            command: "cargo xtask report --quick".to_owned(),
            is_quick: true,
            compiler: "1.95.0".to_owned(),
        }
    }

    fn sections() -> Vec<Section> {
        let mut table = Table::new("A table of `x`", vec!["a".to_owned(), "b".to_owned()]);
        table.push(vec!["1".to_owned(), "< 2 & more".to_owned()]);
        let picture = Picture::new(1, 1, vec![Some([0.5; 3])]);
        let section = |name, figures| Section {
            name,
            title: "A <title>",
            prose: html! { p { "Prose." } },
            commands: &["cargo xtask report"],
            figures,
        };
        vec![
            section(
                "first",
                vec![
                    Figure::Plot(plot(&[[1.0, 1.0], [5.0, 0.1]])),
                    Figure::Table(table.clone()),
                ],
            ),
            section(
                "second",
                vec![
                    Figure::Pictures {
                        title: "Pictures".to_owned(),
                        images: vec![Image::of("a pixel", &picture)],
                    },
                    Figure::Folded {
                        title: "More".to_owned(),
                        tables: vec![table],
                    },
                ],
            ),
        ]
    }

    #[test]
    fn the_page_is_well_formed_and_whole() {
        let page = page(&sections(), &origin()).expect("it has its data");
        let options = roxmltree::ParsingOptions {
            allow_dtd: true,
            ..roxmltree::ParsingOptions::default()
        };
        let parsed = roxmltree::Document::parse_with_options(&page, options).expect("it is well formed");
        let ids: Vec<&str> = parsed
            .descendants()
            .filter_map(|node| node.attribute("id"))
            .collect();
        let distinct: BTreeSet<&str> = ids.iter().copied().collect();
        assert_eq!(ids.len(), distinct.len(), "{ids:?}");
        for node in parsed.descendants() {
            for name in ["href", "aria-labelledby"] {
                let targets = node
                    .attribute(name)
                    .into_iter()
                    .flat_map(|value| value.split(' '));
                for target in targets {
                    assert!(
                        distinct.contains(target.trim_start_matches('#')),
                        "{name}={target}"
                    );
                }
            }
        }
    }

    #[test]
    fn the_page_needs_nothing_from_outside() {
        let page = page(&sections(), &origin()).expect("it has its data");
        let options = roxmltree::ParsingOptions {
            allow_dtd: true,
            ..roxmltree::ParsingOptions::default()
        };
        let parsed = roxmltree::Document::parse_with_options(&page, options).expect("it is well formed");
        for node in parsed.descendants() {
            let tag = node.tag_name().name();
            assert!(
                !matches!(tag, "script" | "link" | "iframe" | "object" | "embed"),
                "{tag}"
            );
            for attribute in node.attributes() {
                let is_ours = attribute.value().starts_with('#')
                    || attribute.value().starts_with("data:image/png;base64,");
                assert!(
                    is_ours || !matches!(attribute.name(), "src" | "href" | "srcset"),
                    "{}",
                    attribute.value()
                );
            }
        }
        assert!(!page.contains("url(") && !page.contains("@import"));
    }

    #[test]
    fn a_section_without_data_ends_it() {
        let mut sections = sections();
        sections[1].figures.push(Figure::Plot(plot(&[])));
        assert!(page(&sections, &origin()).is_err());
    }
}
