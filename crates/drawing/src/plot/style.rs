use crate::figure::{Figure, Panel};

use super::legend::shared_legend;
use super::panel::{PanelSvg, Place};
use super::text::escape;

/// Colours and lines on white paper. All can be told apart by everyone (Okabe and Ito, 2008; the last three
/// somewhat darker, for thin lines).
const PAPER: &str = "\
.paper{fill:#fff}\
text{font-family:Helvetica,Arial,'DejaVu Sans',sans-serif;font-size:12px;fill:#222}\
.title{font-size:14px;font-weight:bold}\
.label,.middle{text-anchor:middle}.label{font-size:13px}.end{text-anchor:end}\
.axis{fill:none;stroke:#222;stroke-width:1}\
.grid{fill:none;stroke:#ddd;stroke-width:1}\
.line{fill:none;stroke:#0072b2;stroke-width:1.6;stroke-linejoin:round}\
.truth{fill:none;stroke:#d55e00;stroke-width:1.6;stroke-dasharray:7 4}\
.reference{fill:none;stroke:#222;stroke-width:1.1;stroke-dasharray:6 4}\
.band{fill:#0072b2;fill-opacity:.2;stroke:none}\
.dots{fill:none;stroke:#777;stroke-width:2.6;stroke-linecap:round}\
.fine{stroke-width:1.8}\
.crosses{fill:none;stroke:#d55e00;stroke-width:2}\
.faint{fill:none;stroke:#aaa;stroke-width:1.2}\
.s{fill:none;stroke-width:1.6;stroke-linejoin:round}.d{stroke-dasharray:7 4}\
.s0{stroke:#0072b2}.s1{stroke:#d55e00}.s2{stroke:#009e73}.s3{stroke:#b3589a}.s4{stroke:#c98a00}.s5{stroke:#3fa4de}";

/// A figure as SVG.
///
/// ```
/// use freeform_drawing::Svg;
/// use freeform_drawing::figure::{Curve, Figure, Look, Panel};
///
/// let runs = vec![(0..100).map(|k| [0.1 * f64::from(k), (0.1 * f64::from(k)).sin()]).collect()];
/// let curves = vec![Curve { name: "sin t".to_owned(), look: Look::Line, runs }];
/// let panels = vec![Panel { x_label: "t".to_owned(), curves, ..Panel::default() }];
/// let figure = Figure { panels, columns: 1, panel_size: [400.0, 250.0], ..Figure::default() };
/// assert_eq!(Svg(&figure).size(), [400.0, 250.0]);
/// assert!(Svg(&figure).file().contains("sin t"));
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Svg<'a>(pub &'a Figure);

impl Svg<'_> {
    /// The figure as a file of its own, on white paper.
    #[must_use]
    pub fn file(&self) -> String {
        let ([width, height], content) = (self.size(), self.content());
        format!(
            r#"<?xml version="1.0" encoding="UTF-8"?>
<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}">
<style>{PAPER}</style>
<rect class="paper" width="{width}" height="{height}"/>
{content}</svg>
"#
        )
    }

    /// The figure as an SVG element to stand in a page, which gives it its colours.
    #[must_use]
    pub fn element(&self) -> String {
        let ([width, height], content) = (self.size(), self.content());
        let first = self.0.panels.first().map_or("", |panel| &panel.title);
        let title = escape(if self.0.title.is_empty() { first } else { &self.0.title });
        format!(r#"<svg viewBox="0 0 {width} {height}" role="img" aria-label="{title}">{content}</svg>"#)
    }

    /// Width and height in pixels.
    #[must_use]
    pub fn size(&self) -> [f64; 2] {
        let rows = self.0.panels.len().div_ceil(self.0.columns.max(1));
        [self.width(), self.head().1 + self.0.panel_size[1] * rows as f64]
    }

    fn width(&self) -> f64 {
        self.0.panel_size[0] * self.0.columns.clamp(1, self.0.panels.len().max(1)) as f64
    }

    /// Title and legend over all panels, and their height.
    fn head(&self) -> (String, f64) {
        const LEFT: f64 = 14.0;
        let (mut svg, mut height) = (String::new(), 0.0);
        if !self.0.title.is_empty() {
            svg = format!(r#"<text class="title" x="{LEFT}" y="20">{}</text>"#, escape(&self.0.title));
            height = 28.0;
        }
        if self.0.shares_legend {
            let (legend, legend_height) = shared_legend(
                self.0.panels.iter().map(PanelSvg).flat_map(PanelSvg::legend),
                LEFT,
                height,
                self.width() - 2.0 * LEFT,
            );
            svg.push_str(&legend);
            height += legend_height + 6.0;
        }
        (svg, height)
    }

    fn content(&self) -> String {
        let [width, height] = self.0.panel_size;
        let columns = self.0.columns.max(1);
        let (head, head_height) = self.head();
        let place = |k: usize| {
            let (column, row) = ((k % columns) as f64, (k / columns) as f64);
            Place { left: column * width, top: head_height + row * height, width, height }
        };
        let has_legend = !self.0.shares_legend;
        // The data of panels below one another begins at the same place.
        let margin = |k: usize| {
            let of_column = self.0.panels.iter().skip(k % columns).step_by(columns);
            of_column.map(|panel| PanelSvg(panel).margin_left(width, height, has_legend)).fold(0.0, f64::max)
        };
        let panels =
            self.0.panels.iter().enumerate().map(|(k, panel)| PanelSvg(panel).render(place(k), margin(k), has_legend));
        head + &panels.collect::<String>()
    }
}

/// One panel as an SVG element to stand in a page, which gives it its colours.
pub(crate) fn panel_svg(panel: &Panel, width: f64, height: f64) -> String {
    let panels = vec![panel.clone()];
    Svg(&Figure { panels, columns: 1, panel_size: [width, height], ..Figure::default() }).element()
}

/// Panels below one another as a file of their own, on white paper.
pub(crate) fn stacked_svg(panels: &[Panel], width: f64, panel_height: f64) -> String {
    Svg(&Figure { panels: panels.to_vec(), columns: 1, panel_size: [width, panel_height], ..Figure::default() }).file()
}

#[cfg(test)]
mod tests {
    use crate::figure::{Curve, Look};

    use super::*;

    #[test]
    fn the_data_of_panels_below_one_another_begin_at_the_same_place() {
        let panel = |high: f64| {
            let curves =
                vec![Curve { name: "a".to_owned(), look: Look::Line, runs: vec![vec![[0.0, 0.0], [1.0, high]]] }];
            Panel { curves, ..Panel::default() }
        };
        let panels = vec![panel(1.0), panel(1.0), panel(10_000.0), panel(1.0)];
        let figure = Figure { panels, columns: 2, panel_size: [300.0, 200.0], ..Figure::default() };
        let svg = Svg(&figure).file();
        let lefts: Vec<&str> =
            svg.split(r#"<rect class="axis" x=""#).skip(1).filter_map(|rest| rest.split('"').next()).collect();
        assert_eq!(lefts.len(), 4);
        assert_eq!((lefts[0], lefts[1]), (lefts[2], lefts[3]));
        let margin = |high: f64| PanelSvg(&panel(high)).margin_left(300.0, 200.0, true);
        assert_ne!(margin(1.0), margin(10_000.0));
    }
}
