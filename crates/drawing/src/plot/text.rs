//! Text in SVG.
use freeform_motion::outline_io::readable;

/// About the width of a text at the size of tick labels, in pixels. Fonts differ: it is that of wide ones.
pub(crate) fn text_width(text: &str) -> f64 {
    let width = |character: char| match character {
        'i' | 'j' | 'l' | 'I' | ' ' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' => 3.6,
        'f' | 'r' | 't' | '(' | ')' | '[' | ']' | '-' | '/' => 4.8,
        'm' | 'w' | 'M' | 'W' | '%' => 11.0,
        character if character.is_uppercase() => 8.6,
        _ => 7.2,
    };
    text.chars().map(width).sum()
}

/// Text as it stands in SVG and HTML.
pub(crate) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            '\n' | '\t' => escaped.push(character),
            // XML has no control characters, and two others not.
            other => escaped.push_str(&readable(other.encode_utf8(&mut [0; 4])).to_string()),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::escape;

    #[test]
    fn every_character_is_text_that_xml_allows() {
        for character in '\0'..=char::MAX {
            let escaped = escape(&character.to_string());
            let is_allowed =
                |c: char| matches!(c, '\t' | '\n' | ' '..='\u{d7ff}' | '\u{e000}'..='\u{fffd}' | '\u{10000}'..);
            assert!(escaped.chars().all(|c| is_allowed(c) && !"<>\"'".contains(c)), "{character:?}: {escaped}");
            assert!(!escaped.contains('&') || escaped.ends_with(';'));
        }
        assert_eq!(escape("a\u{202e}b\u{1b}[0m"), r"a\u{202e}b\u{1b}[0m");
    }
}
