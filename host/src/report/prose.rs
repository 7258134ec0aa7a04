//! Text, of which what stands between backticks is code.

use maud::{Markup, html};

/// A text as a part of a page.
pub(super) fn prose(text: &str) -> Markup {
    // A value and its error stay on one line.
    let text = text.replace(" ± ", "\u{a0}±\u{a0}");
    html! {
        @for (place, part) in text.split('`').enumerate() {
            @if place % 2 == 1 { code { (part) } } @else { (part) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_between_backticks_is_code() {
        assert_eq!(prose("a `b < c` d").into_string(), "a <code>b &lt; c</code> d");
    }
}
