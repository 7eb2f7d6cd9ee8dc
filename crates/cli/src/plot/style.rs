use super::panel::{Panel, Place};

/// Mean width of a character at the size of tick labels, in pixels.
pub(crate) const CHARACTER_WIDTH: f64 = 6.5;

/// Colours and lines on white paper. Blue and vermilion can be told apart by everyone (Okabe and Ito, 2008).
const PAPER: &str = "\
.paper{fill:#fff}\
text{font-family:Helvetica,Arial,'DejaVu Sans',sans-serif;font-size:12px;fill:#222}\
.title{font-size:14px;font-weight:bold}\
.label,.middle{text-anchor:middle}.label{font-size:13px}.end{text-anchor:end}\
.axis{fill:none;stroke:#222;stroke-width:1}\
.grid{fill:none;stroke:#ddd;stroke-width:1}\
.line{fill:none;stroke:#0072b2;stroke-width:1.6;stroke-linejoin:round}\
.truth{fill:none;stroke:#d55e00;stroke-width:1.6;stroke-dasharray:7 4}\
.band{fill:#0072b2;fill-opacity:.2;stroke:none}\
.dots{fill:none;stroke:#777;stroke-width:2.6;stroke-linecap:round}\
.crosses{fill:none;stroke:#d55e00;stroke-width:2}";

/// One panel as an SVG element to stand in a page, which gives it its colours.
pub(crate) fn panel_svg(panel: &Panel, width: f64, height: f64) -> String {
    let place = Place { left: 0.0, top: 0.0, width, height };
    let title = escape(&panel.title);
    format!(r#"<svg viewBox="0 0 {width} {height}" role="img" aria-label="{title}">{}</svg>"#, panel.render(place))
}

/// Panels below one another as a file of their own, on white paper.
pub(crate) fn stacked_svg(panels: &[Panel], width: f64, panel_height: f64) -> String {
    let height = panel_height * panels.len() as f64;
    let places =
        (0..panels.len()).map(|k| Place { left: 0.0, top: k as f64 * panel_height, width, height: panel_height });
    let content: String = panels.iter().zip(places).map(|(panel, place)| panel.render(place)).collect();
    format!(
        r#"<?xml version="1.0" encoding="UTF-8"?>
<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}">
<style>{PAPER}</style>
<rect class="paper" width="{width}" height="{height}"/>
{content}</svg>
"#
    )
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
