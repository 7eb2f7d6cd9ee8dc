//! Text in SVG.

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
            other if other.is_control() && other != '\n' && other != '\t' => escaped.push('\u{fffd}'),
            other => escaped.push(other),
        }
    }
    escaped
}
