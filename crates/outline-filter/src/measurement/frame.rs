use freeform_curve_fit::Outline;
use freeform_riccati::map_point;
use nalgebra::{Matrix3, Point2};

use super::{Columns, Measurement, PointDeviations};
use crate::{belief::OffsetInformation, map::Contour, vectors::vectorised};

/// The coordinates that all is normalised by: centred on the first outline and divided by its RMS radius, and the unit of time.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Reference {
    /// Image coordinates.
    pub(crate) origin: Point2<f64>,
    /// Image lengths.
    pub(crate) radius: f64,
    /// Seconds. A power of two, so that nothing is rounded by it.
    pub(crate) time_unit: f64,
    /// Standard deviation that good points state of themselves, image lengths; infinite where none have stated any.
    pub(crate) stated: f64,
}

impl Reference {
    /// Of an outline, with a unit of time of one second, before its points are asked what they state.
    pub(crate) fn of(outline: &Outline) -> Self {
        Self { origin: outline.centroid(), radius: outline.rms_radius(), time_unit: 1.0, stated: f64::INFINITY }
    }

    /// Units of time in a second: what a rate by the unit is multiplied by to be one by the second.
    pub(crate) fn per_second(&self) -> f64 {
        1.0 / self.time_unit
    }

    /// Normalised coordinates to image coordinates.
    pub(crate) fn to_image(self) -> Matrix3<f64> {
        Matrix3::new(self.radius, 0.0, self.origin.x, 0.0, self.radius, self.origin.y, 0.0, 0.0, 1.0)
    }
}

/// A connected run of points.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Piece {
    start: usize,
    count: usize,
    pub(crate) closed: bool,
}

impl Piece {
    pub(crate) fn range(&self) -> std::ops::Range<usize> {
        self.start..self.start + self.count
    }
}

/// Adds the points of a piece, normalised, if none of them repeats the one before it, nor the last the first of a closed piece; whether they
/// have been added. Most outlines have no such points, and are looked at side by side.
fn push_distinct(
    points: &mut Vec<Point2<f64>>,
    (piece, closed): (&[Point2<f64>], bool),
    origin: Point2<f64>,
    scale: f64,
) -> bool {
    let start = points.len();
    let repeated = vectorised(
        #[inline(always)]
        || {
            points.extend(piece.iter().map(
                #[inline(always)]
                |p| Point2::new((p.x - origin.x) * scale, (p.y - origin.y) * scale),
            ));
            let taken = &points[start..];
            let mut repeated = 0_u64;
            for (p, next) in taken.iter().zip(taken.iter().skip(1)) {
                repeated |= u64::from((p.x == next.x) & (p.y == next.y));
            }
            repeated
        },
    );
    let ends_meet = closed && piece.len() > 1 && points[start] == points[points.len() - 1];
    if repeated != 0 || ends_meet {
        points.truncate(start);
        return false;
    }
    true
}

/// The points of one frame and what is found of them; buffers that are reused from frame to frame.
#[derive(Debug, Clone, Default)]
pub(crate) struct Frame {
    /// In normalised coordinates.
    pub(crate) points: Vec<Point2<f64>>,
    /// Pieces of the contour that the points make.
    pub(crate) pieces: Vec<Piece>,
    /// Means of neighbouring points in the body frame, which say where along the outline they lie.
    pub(crate) places: Vec<Point2<f64>>,
    pub(crate) measurements: Vec<Measurement>,
    /// Corrections of the offsets that are being tried.
    pub(crate) shifts: Vec<f64>,
    /// Information on the offsets with the frame: of a frame that was solved, until it is committed; room for it otherwise.
    pub(crate) cells_with_frame: OffsetInformation,
    /// Right-hand sides of the offsets.
    pub(crate) right: Vec<f64>,
    /// For whatever needs a list of numbers.
    pub(crate) values: Vec<f64>,
    /// For numbers with weights.
    pub(crate) weighted: Vec<(f64, f64)>,
    /// What the points state of themselves.
    pub(crate) deviations: PointDeviations,
    /// What is found of the points, by columns.
    pub(crate) columns: Columns,
}

impl Frame {
    /// Of measurements alone, for so many cells.
    #[cfg(test)]
    pub(crate) fn of_measurements(measurements: Vec<Measurement>, cells: usize) -> Self {
        let mut frame = Self { measurements, ..Self::default() };
        frame.columns.take(&frame.measurements);
        frame.clear_shifts(cells);
        frame
    }

    /// Takes the points of an outline. One that repeats the point before it is no second measurement.
    pub(crate) fn load(&mut self, outline: &Outline, reference: Reference) {
        let (origin, scale) = (reference.origin, 1.0 / reference.radius);
        let Self { points, pieces, deviations, .. } = self;
        points.clear();
        pieces.clear();
        deviations.clear();
        let mut stated = outline.deviations();
        for piece in outline.pieces() {
            let start = points.len();
            if stated.is_none() && push_distinct(points, (piece.points, piece.closed), origin, scale) {
                pieces.push(Piece { start, count: piece.points.len(), closed: piece.closed });
                continue;
            }
            points.reserve(piece.points.len());
            let mut last = None;
            for p in piece.points {
                let p = Point2::from((p - origin) * scale);
                let stated = stated.as_mut().and_then(Iterator::next);
                if last != Some(p) {
                    points.push(p);
                    stated.into_iter().for_each(|stated| deviations.push(stated));
                }
                last = Some(p);
            }
            while piece.closed && points.len() > start + 1 && points.last() == Some(&points[start]) {
                points.pop();
                deviations.pop();
            }
            pieces.push(Piece { start, count: points.len() - start, closed: piece.closed });
        }
        deviations.compare(&reference);
    }

    /// Leaves at most about so many of the points.
    pub(crate) fn thin_out(&mut self, count: usize) {
        let stride = self.points.len().div_ceil(count).max(1);
        let ranges = self.pieces.iter().map(Piece::range);
        self.deviations.keep(ranges.flat_map(|range| range.step_by(stride)));
        let mut kept = 0;
        for piece in &mut self.pieces {
            let start = kept;
            for i in piece.range().step_by(stride) {
                self.points[kept] = self.points[i];
                kept += 1;
            }
            (piece.start, piece.count) = (start, kept - start);
        }
        self.points.truncate(kept);
    }

    /// No corrections of the offsets of so many cells.
    pub(crate) fn clear_shifts(&mut self, cells: usize) {
        self.shifts.clear();
        self.shifts.resize(cells, 0.0);
    }

    /// The pieces as contours in the body frame, for a pose.
    pub(crate) fn contours(&self, pose: &Matrix3<f64>) -> Vec<Contour> {
        let inverse = pose.try_inverse().unwrap_or_else(Matrix3::identity);
        let in_body = |piece: &Piece| self.points[piece.range()].iter().map(|p| map_point(&inverse, p)).collect();
        self.pieces.iter().map(|piece| Contour::new(in_body(piece), piece.closed)).collect()
    }
}
