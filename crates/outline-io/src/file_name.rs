use std::fmt;

/// Writes a file's name. It may hold line breaks; a message must stay one line.
pub(crate) fn write_name(f: &mut fmt::Formatter<'_>, name: &str) -> fmt::Result {
    name.chars().try_for_each(|character| match character.is_control() {
        true => write!(f, "{}", character.escape_default()),
        false => write!(f, "{character}"),
    })
}
