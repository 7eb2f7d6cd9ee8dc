use std::fmt::Write as _;

use super::style::{CHARACTER_WIDTH, escape};
use super::ticks::Ticks;

/// Most points drawn of one line; of longer ones the lowest and highest of each stretch are.
const POINTS_DRAWN: usize = 3000;

/// What a curve looks like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Look {
    /// A solid line.
    Line,
    /// A dashed line for what is known to be true.
    Truth,
    /// A filled area.
    Band,
    /// Small dots.
    Dots,
    /// Crosses.
    Crosses,
}

impl Look {
    const fn class(self) -> &'static str {
        match self {
            Self::Line => "line",
            Self::Truth => "truth",
            Self::Band => "band",
            Self::Dots => "dots",
            Self::Crosses => "crosses",
        }
    }
}

/// Points of one meaning, in one or more connected runs.
#[derive(Debug, Clone)]
pub(crate) struct Curve {
    /// Stands in the legend, unless it is empty.
    pub(crate) name: String,
    pub(crate) look: Look,
    pub(crate) runs: Vec<Vec<[f64; 2]>>,
}

/// One pair of axes.
#[derive(Debug, Clone)]
pub(crate) struct Panel {
    pub(crate) title: String,
    pub(crate) x_label: String,
    pub(crate) y_label: String,
    pub(crate) curves: Vec<Curve>,
    /// Where the x axis begins, if before all curves.
    pub(crate) x_from: Option<f64>,
    /// Whether a length is drawn the same along both axes.
    pub(crate) equal_scales: bool,
}

/// Where a panel stands in the picture, in pixels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
}

/// A range of values and the pixels it is drawn over.
#[derive(Debug, Clone, Copy)]
struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Axis {
    fn pixel(&self, value: f64) -> f64 {
        self.from + (value - self.low) / (self.high - self.low) * (self.to - self.from)
    }

    /// Widens the range to so many values per pixel.
    fn set_density(&mut self, density: f64) {
        let middle = 0.5 * (self.low + self.high);
        let half = 0.5 * density * (self.to - self.from).abs();
        (self.low, self.high) = (middle - half, middle + half);
    }
}

impl Panel {
    /// The panel as SVG elements.
    pub(crate) fn render(&self, place: Place) -> String {
        let margin_top = if self.legend().next().is_some() { 48.0 } else { 28.0 };
        let (bottom, top) = (place.top + place.height - 42.0, place.top + margin_top);
        let right = place.left + place.width - 16.0;
        let (low, high) = self.range(1, 0.06);
        let mut y = Axis { low, high, from: bottom, to: top };
        let y_count = ((bottom - top) / if self.equal_scales { 60.0 } else { 32.0 }) as usize;
        let y_ticks = Ticks::within(y.low, y.high, y_count);
        let widest = y_ticks.labels.iter().map(String::len).max().unwrap_or(0);
        let left = place.left + 34.0 + CHARACTER_WIDTH * widest as f64;
        let (low, high) = self.range(0, if self.equal_scales { 0.06 } else { 0.0 });
        let mut x = Axis { low, high, from: left, to: right };
        if self.equal_scales {
            let density = |axis: &Axis| (axis.high - axis.low) / (axis.to - axis.from).abs();
            let density = density(&x).max(density(&y));
            x.set_density(density);
            y.set_density(density);
        }
        let y_ticks = if self.equal_scales { Ticks::within(y.low, y.high, y_count) } else { y_ticks };
        let x_ticks = Ticks::within(x.low, x.high, ((right - left) / 60.0) as usize);

        let mut svg = String::new();
        self.draw_frame(&mut svg, (&x, &x_ticks), (&y, &y_ticks));
        for curve in &self.curves {
            draw_curve(&mut svg, curve, &x, &y);
        }
        // Over the data, so that a line along the edge does not hide it.
        let (width, height) = (right - left, bottom - top);
        let _ =
            writeln!(svg, r#"<rect class="axis" x="{left:.1}" y="{top:.1}" width="{width:.1}" height="{height:.1}"/>"#);
        let (middle_x, middle_y) = (0.5 * (left + right), 0.5 * (top + bottom));
        let title_top = place.top + 17.0;
        let _ = writeln!(svg, r#"<text class="title" x="{left:.1}" y="{title_top:.1}">{}</text>"#, escape(&self.title));
        let label_bottom = bottom + 35.0;
        let x_label = escape(&self.x_label);
        let _ = writeln!(svg, r#"<text class="label" x="{middle_x:.1}" y="{label_bottom:.1}">{x_label}</text>"#);
        let label_left = place.left + 14.0;
        let y_label = escape(&self.y_label);
        let _ = writeln!(
            svg,
            r#"<text class="label" transform="translate({label_left:.1} {middle_y:.1}) rotate(-90)">{y_label}</text>"#
        );
        self.draw_legend(&mut svg, left, place.top + 36.0);
        svg
    }

    fn legend(&self) -> impl Iterator<Item = &Curve> {
        self.curves.iter().filter(|curve| !curve.name.is_empty() && curve.runs.iter().any(|run| !run.is_empty()))
    }

    /// Range of all finite values on an axis, widened by a share of itself.
    fn range(&self, axis: usize, margin: f64) -> (f64, f64) {
        let points = self.curves.iter().flat_map(|curve| curve.runs.iter().flatten());
        let start = self.x_from.filter(|_| axis == 0);
        let values = points.map(|point| point[axis]).chain(start).filter(|value| value.is_finite());
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        if low > high {
            return (0.0, 1.0);
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

    fn draw_legend(&self, svg: &mut String, mut left: f64, middle: f64) {
        for curve in self.legend() {
            let (class, right) = (curve.look.class(), left + 22.0);
            let _ = match curve.look {
                Look::Line | Look::Truth => {
                    writeln!(svg, r#"<path class="{class}" d="M{left:.1} {middle:.1}H{right:.1}"/>"#)
                }
                Look::Band => {
                    let top = middle - 4.0;
                    writeln!(svg, r#"<rect class="{class}" x="{left:.1}" y="{top:.1}" width="22" height="8"/>"#)
                }
                Look::Dots => writeln!(svg, r#"<path class="{class}" d="{}"/>"#, dots(&[[left + 11.0, middle]])),
                Look::Crosses => writeln!(svg, r#"<path class="{class}" d="{}"/>"#, crosses(&[[left + 11.0, middle]])),
            };
            let (text_left, text_top) = (right + 5.0, middle + 4.0);
            let name = escape(&curve.name);
            let _ = writeln!(svg, r#"<text class="tick" x="{text_left:.1}" y="{text_top:.1}">{name}</text>"#);
            left = text_left + CHARACTER_WIDTH * curve.name.chars().count() as f64 + 16.0;
        }
    }
}

fn draw_curve(svg: &mut String, curve: &Curve, x: &Axis, y: &Axis) {
    let mut path = String::new();
    for run in &curve.runs {
        let finite = run.iter().filter(|point| point.iter().all(|value| value.is_finite()));
        let pixels: Vec<[f64; 2]> = finite.map(|point| [x.pixel(point[0]), y.pixel(point[1])]).collect();
        path.push_str(&match curve.look {
            Look::Line | Look::Truth => connected(&thinned(&pixels), ""),
            Look::Band => connected(&pixels, "Z"),
            Look::Dots => dots(&pixels),
            Look::Crosses => crosses(&pixels),
        });
    }
    if !path.is_empty() {
        let _ = writeln!(svg, r#"<path class="{}" d="{path}"/>"#, curve.look.class());
    }
}

fn connected(pixels: &[[f64; 2]], end: &str) -> String {
    let mut path = String::new();
    for (index, [x, y]) in pixels.iter().enumerate() {
        let _ = write!(path, "{}{x:.2} {y:.2}", if index == 0 { "M" } else { "L" });
    }
    path + end
}

fn dots(pixels: &[[f64; 2]]) -> String {
    // Lines of no length with round ends.
    pixels.iter().map(|[x, y]| format!("M{x:.2} {y:.2}h0")).collect()
}

fn crosses(pixels: &[[f64; 2]]) -> String {
    pixels.iter().map(|[x, y]| format!("M{:.2} {:.2}l8 8m0 -8l-8 8", x - 4.0, y - 4.0)).collect()
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
