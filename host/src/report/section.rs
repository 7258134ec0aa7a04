//! What a section of the page holds.

use maud::{Markup, html};

use super::picture::{Image, ImageError};
use super::plot::{Plot, PlotError, drawing};
use super::table::Table;

/// A part of the page that answers one question.
#[derive(Clone, Debug)]
pub struct Section {
    /// What links call it.
    pub name: &'static str,
    /// Its heading.
    pub title: &'static str,
    /// What is measured, how, and what is found.
    pub prose: Markup,
    /// The commands that measure it.
    pub commands: &'static [&'static str],
    /// What there is to see.
    pub figures: Vec<Figure>,
}

/// Something to see.
#[derive(Clone, Debug)]
pub enum Figure {
    /// A plot, with its data as a table.
    Plot(Plot),
    /// Small plots side by side.
    Plots(Vec<Plot>),
    /// Pictures side by side, under a heading.
    Pictures {
        /// The heading.
        title: String,
        /// The pictures.
        images: Vec<Image>,
    },
    /// A table.
    Table(Table),
    /// Tables that only some will want to read.
    Folded {
        /// What is in them.
        title: String,
        /// The tables.
        tables: Vec<Table>,
    },
}

/// Why a section is not fit to be shown.
#[derive(Debug, thiserror::Error)]
pub enum SectionError {
    /// A plot cannot be drawn.
    #[error(transparent)]
    Plot(#[from] PlotError),
    /// A picture cannot be put into the page.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// A section shows nothing, or a table or a row of pictures has none.
    #[error("the section `{section}` has {what} with nothing in it: what should measure it gave no row")]
    Empty {
        /// The section.
        section: &'static str,
        /// What is empty.
        what: String,
    },
}

impl Section {
    /// Whether all that it shows has its data.
    pub fn check(&self) -> Result<(), SectionError> {
        let empty = |what: String| SectionError::Empty {
            section: self.name,
            what,
        };
        if self.figures.is_empty() {
            return Err(empty("a page".to_owned()));
        }
        let table = |table: &Table| {
            let what = format!("a table, `{}`,", table.caption());
            if table.rows().is_empty() {
                Err(empty(what))
            } else {
                Ok(())
            }
        };
        for figure in &self.figures {
            match figure {
                Figure::Plot(plot) => plot.check()?,
                Figure::Plots(plots) if plots.is_empty() => return Err(empty("a row of plots".to_owned())),
                Figure::Plots(plots) => plots.iter().try_for_each(Plot::check)?,
                Figure::Pictures { title, images } if images.is_empty() => {
                    return Err(empty(format!("a row of pictures, `{title}`,")));
                }
                Figure::Pictures { .. } => {}
                Figure::Table(only) => table(only)?,
                Figure::Folded { title, tables } if tables.is_empty() => {
                    return Err(empty(format!("a fold, `{title}`,")));
                }
                Figure::Folded { tables, .. } => tables.iter().try_for_each(table)?,
            }
        }
        Ok(())
    }

    /// The section as a part of the page.
    pub fn markup(&self) -> Result<Markup, SectionError> {
        let figures: Vec<Markup> = self
            .figures
            .iter()
            .map(Figure::markup)
            .collect::<Result<_, _>>()?;
        let heading = format!("{}-heading", self.name);
        Ok(html! {
            section id=(self.name) aria-labelledby=(heading) {
                h2 id=(heading) { a href={ "#" (self.name) } { (self.title) } }
                (self.prose)
                @for command in self.commands { pre class="command" { code { (command) } } }
                @for figure in &figures { (figure) }
            }
        })
    }
}

impl Figure {
    fn markup(&self) -> Result<Markup, ImageError> {
        Ok(match self {
            Self::Plot(plot) => plotted(plot),
            Self::Plots(plots) => html! { div class="plots" { @for plot in plots { (plotted(plot)) } } },
            Self::Pictures { title, images } => {
                let images: Vec<Markup> = images.iter().map(Image::markup).collect::<Result<_, _>>()?;
                html! {
                    h3 { (title) }
                    div class="pictures" { @for image in &images { (image) } }
                }
            }
            Self::Table(table) => table.markup(),
            Self::Folded { title, tables } => html! {
                details { summary { (title) } @for table in tables { (table.markup()) } }
            },
        })
    }
}

fn plotted(plot: &Plot) -> Markup {
    html! {
        figure class="plotted" id=(plot.name) {
            figcaption { strong { (plot.title) } @if !plot.about.is_empty() { " " (plot.about) } }
            div class="drawing" { (drawing(plot)) }
            details { summary { "Data" } (plot.table().markup()) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::plot::tests::plot;
    use super::*;

    fn section(figures: Vec<Figure>) -> Section {
        Section {
            name: "section",
            title: "A section",
            prose: html! { p { "Prose." } },
            commands: &["cargo xtask report"],
            figures,
        }
    }

    #[test]
    fn a_section_without_data_is_refused() {
        let table = Table::new("table", vec!["head".to_owned()]);
        let title = String::new;
        for figures in [
            vec![],
            vec![Figure::Plot(plot(&[]))],
            vec![Figure::Plots(vec![])],
            vec![Figure::Plots(vec![plot(&[[1.0, 1.0]]), plot(&[])])],
            vec![Figure::Pictures {
                title: title(),
                images: vec![],
            }],
            vec![Figure::Table(table.clone())],
            vec![Figure::Folded {
                title: title(),
                tables: vec![],
            }],
            vec![Figure::Folded {
                title: title(),
                tables: vec![table],
            }],
        ] {
            assert!(section(figures.clone()).check().is_err(), "{figures:?}");
        }
        assert!(section(vec![Figure::Plot(plot(&[[1.0, 1.0]]))]).check().is_ok());
    }
}
