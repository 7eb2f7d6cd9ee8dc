//! Names of files as they may be shown.
use std::fmt;

/// Text of others as it may be shown: what is no visible character is written as an escape sequence such as `\\n` or
/// `\\u{202e}`. These are control characters, line breaks of all kinds, marks that change the direction of the text around them,
/// and characters without width.
///
/// ```
/// assert_eq!(freeform_outline_io::readable("a\n\u{1b}[31m\u{202e}b").to_string(), r"a\n\u{1b}[31m\u{202e}b");
/// ```
pub fn readable(text: &str) -> impl fmt::Display + '_ {
    Readable(text)
}

struct Readable<'a>(&'a str);

impl fmt::Display for Readable<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.chars().try_for_each(|character| match is_unreadable(character) {
            true => write!(f, "{}", character.escape_default()),
            false => write!(f, "{character}"),
        })
    }
}

/// The control characters, and those of general category Cf, Zl and Zp that do not belong to a script.
fn is_unreadable(character: char) -> bool {
    character.is_control()
        || matches!(character,
            '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}'
            | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{fffe}' | '\u{ffff}'
            | '\u{e0000}'..='\u{e007f}')
}
