use std::fmt::Write as _;

use crate::figure::{Curve, Look, Panel};

use super::curve_marks::{bar, class, crosses, dots, fill, marks, ring, span};
use super::legend::{LEGEND_ROW, draw_legend_row, legend_rows};
use super::text::{escape, text_width};
use super::ticks::Ticks;

/// Most points drawn of one line; of longer ones the lowest and highest of each stretch are.
const POINTS_DRAWN: usize = 3000;

/// What stands beside the legend, in pixels: labels of the y axis and the right margin.
const LEGEND_MARGINS: f64 = 80.0;

/// A panel as it is drawn.
#[derive(Debug, Clone, Copy)]
pub(super) struct PanelSvg<'a>(pub(super) &'a Panel);

/// Where a panel stands in the picture, in pixels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) width: f64,
    pub(super) height: f64,
}

/// A range of values and the pixels it is drawn over.
#[derive(Debug, Clone, Copy)]
struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
    logarithmic: bool,
}

impl Axis {
    fn pixel(&self, value: f64) -> f64 {
        let share = if self.logarithmic {
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        };
        self.from + share * (self.to - self.from)
    }

    fn ticks(&self, count: usize) -> Ticks {
        if self.logarithmic {
            Ticks::of_decades(self.low, self.high, count)
        } else {
            Ticks::within(self.low, self.high, count)
        }
    }

    /// Widens the range to so many values per pixel.
    fn set_density(&mut self, density: f64) {
        let middle = 0.5 * (self.low + self.high);
        let half = 0.5 * density * (self.to - self.from).abs();
        (self.low, self.high) = (middle - half, middle + half);
    }
}

impl<'a> PanelSvg<'a> {
    /// Space above the data, in pixels: title and legend.
    fn margin_top(&self, width: f64, has_legend: bool) -> f64 {
        let rows = if has_legend { self.legend_rows(width - LEGEND_MARGINS).len() } else { 0 };
        LEGEND_ROW * rows as f64 + if self.0.title.is_empty() { 10.0 } else { 28.0 }
    }

    const fn margin_below(&self) -> f64 {
        if self.0.is_bare { 6.0 } else { 42.0 }
    }

    /// The y axis over some pixels, and how many ticks it has room for.
    fn y_axis(&self, from: f64, to: f64) -> (Axis, usize) {
        let (low, high) = self.range(1, 0.06);
        let pixels_per_tick = match (self.0.view, self.0.y_logarithmic) {
            (Some(_), _) => 50.0,
            (None, true) => 28.0,
            (None, false) => 32.0,
        };
        let count = ((from - to) / pixels_per_tick) as usize;
        (Axis { low, high, from, to, logarithmic: self.0.y_logarithmic }, count)
    }

    /// Space that the labels of the y axis need to its left, in pixels, in a panel of some width and height.
    pub(super) fn margin_left(&self, width: f64, height: f64, has_legend: bool) -> f64 {
        if self.0.is_bare {
            return 6.0;
        }
        let (y, count) = self.y_axis(height - self.margin_below(), self.margin_top(width, has_legend));
        let widest = y.ticks(count).labels.iter().map(|label| text_width(label)).fold(0.0, f64::max);
        34.0 + widest
    }

    /// The panel as SVG elements, with its legend or without, the data beginning so many pixels from its left edge.
    pub(super) fn render(&self, place: Place, margin_left: f64, has_legend: bool) -> String {
        let rows = if has_legend { self.legend_rows(place.width - LEGEND_MARGINS) } else { Vec::new() };
        let bottom = place.top + place.height - self.margin_below();
        let top = place.top + self.margin_top(place.width, has_legend);
        let left = place.left + margin_left;
        let right = place.left + place.width - if self.0.is_bare { 6.0 } else { 16.0 };
        let (mut y, y_count) = self.y_axis(bottom, top);
        let (low, high) = self.range(0, 0.0);
        let mut x = Axis { low, high, from: left, to: right, logarithmic: false };
        if self.0.view.is_some() {
            let density = |axis: &Axis| (axis.high - axis.low) / (axis.to - axis.from).abs();
            let density = density(&x).max(density(&y));
            x.set_density(density);
            y.set_density(density);
        }

        let mut svg = String::new();
        if !self.0.is_bare {
            let y_ticks = y.ticks(y_count);
            let x_ticks = x.ticks(((right - left) / 60.0) as usize);
            self.draw_frame(&mut svg, (&x, &x_ticks), (&y, &y_ticks));
        }
        let (width, height) = (right - left, bottom - top);
        let frame = format!(r#"x="{left:.1}" y="{top:.1}" width="{width:.1}" height="{height:.1}""#);
        let is_cut = self.0.view.is_some() || self.0.y_limits.is_some();
        if is_cut {
            let _ = writeln!(svg, r#"<svg {frame} viewBox="{left:.1} {top:.1} {width:.1} {height:.1}">"#);
        }
        for curve in &self.0.curves {
            draw_curve(&mut svg, curve, &x, &y);
        }
        if is_cut {
            svg.push_str("</svg>\n");
        }
        let title_top = place.top + 17.0;
        let _ =
            writeln!(svg, r#"<text class="title" x="{left:.1}" y="{title_top:.1}">{}</text>"#, escape(&self.0.title));
        if !self.0.is_bare {
            // Over the data, so that a line along the edge does not hide it.
            let _ = writeln!(svg, r#"<rect class="axis" {frame}/>"#);
            self.draw_labels(
                &mut svg,
                [0.5 * (left + right), bottom + 35.0],
                [place.left + 14.0, 0.5 * (top + bottom)],
            );
        }
        for (row, curves) in rows.iter().enumerate() {
            draw_legend_row(&mut svg, curves, left, place.top + 36.0 + LEGEND_ROW * row as f64);
        }
        svg
    }

    fn draw_labels(&self, svg: &mut String, [x_left, x_top]: [f64; 2], [y_left, y_top]: [f64; 2]) {
        let (x_label, y_label) = (escape(&self.0.x_label), escape(&self.0.y_label));
        let _ = writeln!(svg, r#"<text class="label" x="{x_left:.1}" y="{x_top:.1}">{x_label}</text>"#);
        let turned = format!("translate({y_left:.1} {y_top:.1}) rotate(-90)");
        let _ = writeln!(svg, r#"<text class="label" transform="{turned}">{y_label}</text>"#);
    }

    pub(super) fn legend(self) -> impl Iterator<Item = &'a Curve> {
        self.0.curves.iter().filter(|curve| !curve.name.is_empty() && curve.runs.iter().any(|run| !run.is_empty()))
    }

    /// The entries of the legend, as many to a row as fit into a width.
    fn legend_rows(&self, width: f64) -> Vec<Vec<&'a Curve>> {
        legend_rows(self.legend(), width)
    }

    /// Range of all finite values on an axis, widened by a share of itself.
    fn range(&self, axis: usize, margin: f64) -> (f64, f64) {
        if let Some([low, high]) = self.0.view {
            return (low[axis], high[axis]);
        }
        if let (Some([low, high]), 1) = (self.0.y_limits, axis) {
            return (low, high);
        }
        let is_logarithmic = axis == 1 && self.0.y_logarithmic;
        let drawn = self.0.curves.iter().filter(|curve| axis == 0 || !matches!(curve.look, Look::Marks | Look::Spans));
        let points = drawn.flat_map(|curve| curve.runs.iter().flatten());
        let ends = [self.0.x_from, self.0.x_to].into_iter().flatten().filter(|_| axis == 0);
        let values = points.map(|point| point[axis]).chain(ends).filter(|value| value.is_finite());
        let values = values.filter(|value| !is_logarithmic || *value > 0.0);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        if low > high {
            return if is_logarithmic { (0.1, 1.0) } else { (0.0, 1.0) };
        }
        if is_logarithmic {
            let room = (high / low).powf(margin).max(1.2);
            return (low / room, high * room);
        }
        // Room for at least a few units of the last digit that a tick shows.
        let smallest = 1e-6 * low.abs().max(high.abs());
        let half = (0.5 * (high - low)).max(smallest).max(1e-12) * (1.0 + 2.0 * margin);
        let middle = 0.5 * low + 0.5 * high;
        (middle - half, middle + half)
    }

    fn draw_frame(&self, svg: &mut String, (x, x_ticks): (&Axis, &Ticks), (y, y_ticks): (&Axis, &Ticks)) {
        for (value, label) in x_ticks.positions.iter().zip(&x_ticks.labels) {
            let (at, from, to, text) = (x.pixel(*value), y.from, y.to, y.from + 16.0);
            let _ = writeln!(svg, r#"<path class="grid" d="M{at:.1} {from:.1}V{to:.1}"/>"#);
            let _ = writeln!(svg, r#"<text class="tick middle" x="{at:.1}" y="{text:.1}">{label}</text>"#);
        }
        for (value, label) in y_ticks.positions.iter().zip(&y_ticks.labels) {
            let (at, from, to) = (y.pixel(*value), x.from, x.to);
            let (text_left, text_top) = (x.from - 6.0, at + 4.0);
            let _ = writeln!(svg, r#"<path class="grid" d="M{from:.1} {at:.1}H{to:.1}"/>"#);
            let _ = writeln!(svg, r#"<text class="tick end" x="{text_left:.1}" y="{text_top:.1}">{label}</text>"#);
        }
    }
}

fn draw_curve(svg: &mut String, curve: &Curve, x: &Axis, y: &Axis) {
    let mut path = String::new();
    for run in &curve.runs {
        let has_no_height = curve.look == Look::Spans;
        let can_be_drawn = |[x, y_value]: &&[f64; 2]| {
            x.is_finite() && (has_no_height || y_value.is_finite() && !(y.logarithmic && *y_value <= 0.0))
        };
        let finite = run.iter().filter(can_be_drawn);
        let pixels: Vec<[f64; 2]> = finite.map(|point| [x.pixel(point[0]), y.pixel(point[1])]).collect();
        path.push_str(&match curve.look {
            Look::Line | Look::Truth | Look::Reference | Look::Faint | Look::Series(_) | Look::Dashed(_) => {
                // A line of one point has no length, and would not be seen.
                if let [point] = pixels[..] { ring(point) } else { connected(&thinned(&pixels), "") }
            }
            Look::Band if pixels.len() == 2 => bar(pixels[0], pixels[1]),
            // Its lower edge, then its upper one backwards.
            Look::Band => {
                let (lower, upper) = pixels.split_at(pixels.len() / 2);
                connected(&[thinned(lower), thinned(upper)].concat(), "Z")
            }
            Look::Dots | Look::FineDots => dots(&pixels),
            Look::Crosses => crosses(&pixels),
            Look::Marks => marks(&pixels, y.from, y.to),
            Look::Spans => span(&pixels, y.from, y.to),
        });
    }
    if !path.is_empty() {
        let _ = writeln!(svg, r#"<path class="{}"{} d="{path}"/>"#, class(curve.look), fill(curve.look));
    }
}

fn connected(pixels: &[[f64; 2]], end: &str) -> String {
    let mut path = String::new();
    for (index, [x, y]) in pixels.iter().enumerate() {
        let _ = write!(path, "{}{x:.2} {y:.2}", if index == 0 { "M" } else { "L" });
    }
    path + end
}

/// At most [`POINTS_DRAWN`] points that look the same: the lowest and the highest of every stretch.
fn thinned(pixels: &[[f64; 2]]) -> Vec<[f64; 2]> {
    if pixels.len() <= POINTS_DRAWN {
        return pixels.to_vec();
    }
    let stretch = pixels.len().div_ceil(POINTS_DRAWN / 2);
    let extremes = pixels.chunks(stretch).flat_map(|chunk| {
        let indices = || 0..chunk.len();
        let low = indices().min_by(|&i, &j| chunk[i][1].total_cmp(&chunk[j][1])).unwrap_or(0);
        let high = indices().max_by(|&i, &j| chunk[i][1].total_cmp(&chunk[j][1])).unwrap_or(0);
        [chunk[low.min(high)], chunk[low.max(high)]]
    });
    extremes.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn panel(values: &[f64]) -> Panel {
        let line = |value: &f64| Curve {
            name: format!("the value {value}"),
            look: Look::Dashed(1),
            runs: vec![vec![[0.0, *value], [1.0, *value]]],
        };
        Panel { curves: values.iter().map(line).collect(), ..Panel::default() }
    }

    #[test]
    fn a_value_without_neighbours_and_its_band_are_seen() {
        let axis = |from, to| Axis { low: 0.0, high: 2.0, from, to, logarithmic: false };
        let curve = Curve { name: String::new(), look: Look::Line, runs: vec![vec![[1.0, 1.0]]] };
        let mut svg = String::new();
        draw_curve(&mut svg, &curve, &axis(0.0, 100.0), &axis(100.0, 0.0));
        assert!(svg.contains("M47.50 50.00a2.5 2.5 0 1 0 5 0a2.5 2.5 0 1 0 -5 0\""), "{svg}");
        let band = Curve { name: String::new(), look: Look::Band, runs: vec![vec![[1.0, 0.5], [1.0, 1.5]]] };
        draw_curve(&mut svg, &band, &axis(0.0, 100.0), &axis(100.0, 0.0));
        assert!(svg.contains("M48.00 75.00H52.00V25.00H48.00Z"), "{svg}");
    }

    #[test]
    fn spans_are_as_high_as_the_panel_whatever_their_values_and_the_axis_knows_nothing_of_them() {
        let axis = |from, to, logarithmic| Axis { low: 0.5, high: 2.5, from, to, logarithmic };
        let spans = Curve { name: "none".to_owned(), look: Look::Spans, runs: vec![vec![[1.0, 0.0], [2.0, 0.0]]] };
        let mut svg = String::new();
        draw_curve(&mut svg, &spans, &axis(0.0, 100.0, false), &axis(100.0, 0.0, true));
        assert!(
            svg.contains("class=\"spans\" fill=\"#777\" fill-opacity=\".16\" d=\"M25.00 100.00H75.00V0.00H25.00Z\""),
            "{svg}"
        );
        let mut with_line = panel(&[3.0, 4.0]);
        let before = PanelSvg(&with_line).range(1, 0.06);
        with_line.curves.push(spans);
        assert_eq!(PanelSvg(&with_line).range(1, 0.06), before);
        assert_eq!(PanelSvg(&with_line).range(0, 0.0), (0.0, 2.0));
    }

    #[test]
    fn a_true_value_beyond_the_data_is_within_the_axis() {
        let (low, high) = PanelSvg(&panel(&[0.0, 1.0, -7.0])).range(1, 0.06);
        assert!(low < -7.0 && high > 1.0);
        let logarithmic = Panel { y_logarithmic: true, ..panel(&[0.0, -3.0, 0.01, 100.0]) };
        let (low, high) = PanelSvg(&logarithmic).range(1, 0.06);
        assert!(low > 0.001 && low < 0.01 && high > 100.0, "what is not above 0 takes no part: {low} {high}");
    }
}
