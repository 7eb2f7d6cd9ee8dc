use freeform_curve_fit::{Outline, PixelGrid};
use nalgebra::Point2;

use crate::error::SimulationError;

/// Most pixels of one mask.
const MOST_PIXELS: usize = 1 << 28;

/// A grey picture of an object: 255 inside, 0 outside, the covered share of the pixel along the outline.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mask {
    /// Number of columns.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
    /// Grey values row by row from the top, `width * height` of them.
    pub grey: Vec<u8>,
}

impl Mask {
    /// The picture of the polygon through all points of the outline in order; gaps are closed by straight lines. The
    /// covered share of every pixel is exact where the polygon does not cross itself. The picture has `[width, height]`
    /// pixels, which lie in the plane of the outline as the grid says.
    ///
    /// # Errors
    /// No pixel or more than 2^28; a grid that leads to no finite place in the picture.
    pub fn of_outline(
        outline: &Outline,
        [width, height]: [usize; 2],
        grid: &PixelGrid,
    ) -> Result<Self, SimulationError> {
        if width == 0 || height == 0 || width.checked_mul(height).is_none_or(|pixels| pixels > MOST_PIXELS) {
            return Err(SimulationError::MaskSize { width, height, limit: MOST_PIXELS });
        }
        let in_pixels = |p: &Point2<f64>| Point2::from(grid.to_pixels(p));
        // Each contour of a closed outline by itself; open arcs one after the other.
        let polygons: Vec<Vec<Point2<f64>>> = match outline {
            Outline::Closed(_) => outline.pieces().map(|piece| piece.points.iter().map(in_pixels).collect()).collect(),
            Outline::Open(_) => vec![outline.points().map(in_pixels).collect()],
        };
        if let Some(&value) = polygons.iter().flatten().flat_map(|p| &p.coords).find(|value| !value.is_finite()) {
            return Err(SimulationError::OutOfRange { setting: "place in the mask", value, range: "finite" });
        }
        let accumulator = Accumulator::of_polygons(polygons.iter().map(Vec::as_slice), [width, height]);
        Ok(Self { width, height, grey: accumulator.grey() })
    }

    /// The binary picture: 255 where at least half of the pixel is covered, else 0.
    #[must_use]
    pub fn binary(&self) -> Self {
        let grey = self.grey.iter().map(|&g| if g >= 128 { 255 } else { 0 }).collect();
        Self { grey, ..*self }
    }
}

/// Signed-area accumulation (R. Levien, font-rs, 2016): every edge leaves in each row the change of coverage that it
/// makes from column to column; the running sum along the row is the coverage.
struct Accumulator {
    width: usize,
    height: usize,
    /// One more column than the picture, for what the last one hands on.
    changes: Vec<f64>,
}

impl Accumulator {
    fn new(width: usize, height: usize) -> Self {
        Self { width, height, changes: vec![0.0; (width + 1) * height] }
    }

    /// Closed polygons in `[column, row]` of the picture.
    fn of_polygons<'a>(polygons: impl Iterator<Item = &'a [Point2<f64>]>, [width, height]: [usize; 2]) -> Self {
        let mut accumulator = Self::new(width, height);
        for polygon in polygons {
            for (from, to) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
                accumulator.add_edge(*from, *to);
            }
        }
        accumulator
    }

    fn add_edge(&mut self, from: Point2<f64>, to: Point2<f64>) {
        let (top, bottom, sign) = if from.y < to.y { (from, to, 1.0) } else { (to, from, -1.0) };
        let (start, end) = (top.y.max(0.0), bottom.y.min(self.height as f64));
        let slope = (bottom.x - top.x) / (bottom.y - top.y);
        let x_at = |y: f64| (top.x + (y - top.y) * slope).clamp(top.x.min(bottom.x), top.x.max(bottom.x));
        let mut y = start;
        while y < end {
            let row = (y as usize).min(self.height - 1);
            let next = (row as f64 + 1.0).min(end);
            self.add_within_row(row, x_at(y), x_at(next), sign * (next - y));
            y = next;
        }
    }

    /// Adds an edge inside one row that covers the signed height `rise`; left of the picture it acts on the first
    /// column, right of it on none.
    fn add_within_row(&mut self, row: usize, x0: f64, x1: f64, rise: f64) {
        let (left, right) = (x0.min(x1), x0.max(x1));
        let width = self.width as f64;
        let changes = &mut self.changes[row * (self.width + 1)..(row + 1) * (self.width + 1)];
        if right <= 0.0 {
            changes[0] += rise;
            return;
        }
        if left >= width {
            return;
        }
        let per_length = rise / (right - left);
        if left < 0.0 {
            changes[0] -= left * per_length;
        }
        let (left, right) = (left.max(0.0), right.min(width));
        for column in left as usize..(right.ceil() as usize).max(left as usize + 1) {
            let cell = column as f64;
            let (a, b) = (left.max(cell), right.min(cell + 1.0));
            let share = if per_length.is_finite() { (b - a) * per_length } else { rise };
            let middle = 0.5 * (a + b) - cell;
            changes[column] += share * (1.0 - middle);
            changes[column + 1] += share * middle;
        }
    }

    fn grey(&self) -> Vec<u8> {
        self.coverage().map(|coverage| (255.0 * coverage).round() as u8).collect()
    }

    /// The covered share of every pixel, row by row.
    fn coverage(&self) -> impl Iterator<Item = f64> {
        let rows = self.changes.chunks_exact(self.width + 1);
        rows.flat_map(|row| {
            row[..self.width].iter().scan(0.0, |coverage: &mut f64, change| {
                *coverage += change;
                Some(coverage.abs().min(1.0))
            })
        })
    }
}

/// The share of every pixel that lies within closed polygons in `[column, row]` of the picture; holes run the other way round.
pub(crate) fn covered_shares<'a>(polygons: impl Iterator<Item = &'a [Point2<f64>]>, size: [usize; 2]) -> Vec<f64> {
    Accumulator::of_polygons(polygons, size).coverage().collect()
}
