use std::fmt::Write as _;

use crate::figure::{Curve, Look};

use super::curve_marks::{class, crosses, dots, fill, marks};
use super::text::{escape, text_width};

/// Height of a row of the legend, in pixels.
pub(super) const LEGEND_ROW: f64 = 20.0;

/// One legend for the curves of several panels, at a place of some width, and its height. What has one name is one entry.
pub(super) fn shared_legend<'a>(
    curves: impl Iterator<Item = &'a Curve>,
    left: f64,
    top: f64,
    width: f64,
) -> (String, f64) {
    let mut entries: Vec<&Curve> = Vec::new();
    for curve in curves {
        if entries.iter().all(|entry| entry.name != curve.name) {
            entries.push(curve);
        }
    }
    // What all curves are held against comes last, whichever panel has it first.
    entries.sort_by_key(|entry| entry.look == Look::Reference);
    let rows = legend_rows(entries.into_iter(), width);
    let mut svg = String::new();
    for (row, curves) in rows.iter().enumerate() {
        draw_legend_row(&mut svg, curves, left, top + LEGEND_ROW * (row as f64 + 0.5));
    }
    (svg, LEGEND_ROW * rows.len() as f64)
}

/// Entries of a legend, as many to a row as fit into a width.
pub(super) fn legend_rows<'a>(entries: impl Iterator<Item = &'a Curve>, width: f64) -> Vec<Vec<&'a Curve>> {
    let mut rows: Vec<Vec<&Curve>> = Vec::new();
    let mut used = f64::INFINITY;
    for curve in entries {
        let needed = legend_width(curve);
        if used + needed > width {
            rows.push(Vec::new());
            used = 0.0;
        }
        used += needed;
        if let Some(row) = rows.last_mut() {
            row.push(curve);
        }
    }
    rows
}

fn legend_width(curve: &Curve) -> f64 {
    27.0 + text_width(&curve.name) + 16.0
}

pub(super) fn draw_legend_row(svg: &mut String, curves: &[&Curve], mut left: f64, middle: f64) {
    for curve in curves {
        let (class, right) = (class(curve.look), left + 22.0);
        let _ = match curve.look {
            Look::Band | Look::Spans => {
                let (top, fill) = (middle - 4.0, fill(curve.look));
                writeln!(svg, r#"<rect class="{class}"{fill} x="{left:.1}" y="{top:.1}" width="22" height="8"/>"#)
            }
            Look::Dots => writeln!(svg, r#"<path class="{class}" d="{}"/>"#, dots(&[[left + 11.0, middle]])),
            Look::FineDots => {
                let row = [3.0, 7.0, 11.0, 15.0, 19.0].map(|x| [left + x, middle]);
                writeln!(svg, r#"<path class="{class}" d="{}"/>"#, dots(&row))
            }
            Look::Crosses => writeln!(svg, r#"<path class="{class}" d="{}"/>"#, crosses(&[[left + 11.0, middle]])),
            Look::Marks => {
                let line = marks(&[[left + 11.0, middle]], middle + 6.0, middle - 6.0);
                writeln!(svg, r#"<path class="{class}" d="{line}"/>"#)
            }
            Look::Line | Look::Truth | Look::Reference | Look::Faint | Look::Series(_) | Look::Dashed(_) => {
                writeln!(svg, r#"<path class="{class}" d="M{left:.1} {middle:.1}H{right:.1}"/>"#)
            }
        };
        let (text_left, text_top) = (right + 5.0, middle + 4.0);
        let name = escape(&curve.name);
        let _ = writeln!(svg, r#"<text class="tick" x="{text_left:.1}" y="{text_top:.1}">{name}</text>"#);
        left += legend_width(curve);
    }
}

#[cfg(test)]
mod tests {
    use crate::figure::Panel;

    use super::*;

    fn curves(count: usize) -> Vec<Curve> {
        let run = vec![vec![[0.0, 1.0], [1.0, 1.0]]];
        let curve = |k: usize| Curve { name: format!("the value {k}"), look: Look::Dashed(k), runs: run.clone() };
        (0..count).map(curve).collect()
    }

    #[test]
    fn a_legend_takes_as_many_rows_as_it_needs() {
        let curves = curves(5);
        let lengths = |width: f64| legend_rows(curves.iter(), width).iter().map(Vec::len).collect::<Vec<_>>();
        assert_eq!(lengths(10_000.0), [5]);
        assert_eq!(lengths(260.0), [2, 2, 1]);
        assert_eq!(lengths(1.0), [1; 5]);
    }

    #[test]
    fn a_shared_legend_names_each_curve_of_any_panel_once() {
        let mut first = Panel { curves: curves(2), ..Panel::default() };
        first.curves[1].runs.clear();
        let second = Panel { curves: curves(3), ..Panel::default() };
        let panels = [first, second];
        let (svg, _) = shared_legend(panels.iter().flat_map(|panel| &panel.curves), 0.0, 0.0, 1000.0);
        assert_eq!([0, 1, 2].map(|k| svg.matches(&format!("the value {k}")).count()), [1, 1, 1]);
    }
}
