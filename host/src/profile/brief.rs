//! Names of functions that fit a row of a table or a box of a picture.

/// A function's name whose types have lost their modules: `<Mixed as Sampling>::cos_sin`. A function's own module stays.
pub(super) fn brief(name: &str) -> String {
    let (mut kept, mut depth, mut path) = (String::new(), 0, String::new());
    for character in name.chars() {
        if character.is_alphanumeric() || character == '_' || character == ':' {
            path.push(character);
            continue;
        }
        kept.push_str(last_of(&path, depth > 0));
        path.clear();
        match character {
            '<' => depth += 1,
            '>' => depth -= 1,
            _ => {}
        }
        kept.push(character);
    }
    kept + last_of(&path, depth > 0)
}

fn last_of(path: &str, in_type: bool) -> &str {
    match path.rsplit_once("::") {
        Some((_, last)) if in_type => last,
        _ => path,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn types_lose_their_modules_and_functions_do_not() {
        for (name, expected) in [
            ("fixedmath::root::kernel::upper", "fixedmath::root::kernel::upper"),
            (
                "<tracer::mixed::Mixed as tracer::Sampling>::root_of::{closure#0}",
                "<Mixed as Sampling>::root_of::{closure#0}",
            ),
            ("<&mut a::B as core::ops::Fn>::call", "<&mut B as Fn>::call"),
            ("<[a::B; 3]>::map", "<[B; 3]>::map"),
            ("<u64>::wrapping_mul", "<u64>::wrapping_mul"),
            ("<a::b::{closure#0} as c::D>::e", "<{closure#0} as D>::e"),
            ("__aeabi_uidiv", "__aeabi_uidiv"),
        ] {
            assert_eq!(brief(name), expected);
        }
    }
}
