//! What is found of the points of a frame, by columns: what judges a frame, learns from it and compares poses goes through these.
use freeform_riccati::MAX_PARAMETERS;
use nalgebra::{Point2, Vector2};

use super::{Measurement, NO_CELL};
use crate::vectors::{LANES, Lanes, vectorised};

/// The outline at a cell in the image of one frame, in the order of a vector: the normal, where the line lies along it, and, over that of the
/// noise, the inverse deviation of the points of the cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CellLine(pub(super) Lanes);

impl CellLine {
    /// Of a point without a cell: it has no distance and does not count.
    pub(super) const NONE: Self = Self([0.0; LANES]);

    #[inline(always)]
    pub(crate) fn normal(&self) -> Vector2<f64> {
        Vector2::new(self.0[0], self.0[1])
    }

    /// Where it lies along its normal.
    #[inline(always)]
    pub(crate) fn at(&self) -> f64 {
        self.0[2]
    }
}

/// Where the Jacobians of the points are.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) enum Jacobians {
    /// Written point by point into the measurements of the frame.
    #[default]
    OfPoints,
    /// Those of the feet of the points on the lines of their cells, which change at one rate along each.
    OfCells,
}

/// Jacobians of the residuals of the points of every cell.
#[derive(Debug, Clone, Default)]
pub(crate) struct CellJacobians {
    /// How fast they fall as the offset of the cell grows; of one for none as well.
    pub(crate) by_offsets: Vec<f64>,
    /// By the pose, in two rows of whole vectors.
    pub(crate) rows: Vec<f64>,
}

/// Numbers of the points of a frame, by columns; buffers that are reused from frame to frame.
#[derive(Debug, Clone, Default)]
pub(crate) struct Columns {
    pub(crate) jacobians: Jacobians,
    /// Of the cells; a number beyond all of them for none.
    pub(crate) numbers: Vec<u32>,
    pub(crate) residuals: Vec<f64>,
    pub(crate) weights: Vec<f64>,
    pub(crate) by_offsets: Vec<f64>,
    /// Coordinates along the lines of the cells, where Jacobians are those of cells.
    pub(crate) along: Vec<f64>,
    /// Of every cell, and one for none.
    pub(crate) lines: Vec<CellLine>,
    /// Where the cells themselves lie along the normals of their lines, without their offsets: Jacobians are taken there.
    pub(crate) own_lines: Vec<f64>,
    /// Of every cell, and one for none: what its points add up to, and what a step makes of their residuals.
    pub(crate) sums: Vec<CellSums>,
    pub(crate) moves: Vec<[f64; 2]>,
    pub(crate) of_cells: CellJacobians,
    /// The points in the body frame; in the end the means of their neighbours where they count.
    pub(super) own_places: Vec<Point2<f64>>,
    /// Coordinates in the body frame times weights, and these; a fourth number, which is none, makes it a whole vector.
    pub(super) weighted: Vec<Lanes>,
    /// Rows of the lines of the points.
    pub(super) rows: Vec<Lanes>,
}

/// Sums over the points of a cell, with their weights w, coordinates t along its line, and residuals r.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct CellSums {
    /// Of w, w t, w t^2 and w r.
    pub(crate) moments: Lanes,
    /// Of w t r.
    pub(crate) along: f64,
}

/// A point of the columns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PointOnCell {
    /// Its cell, or a number beyond all cells.
    pub(crate) cell: usize,
    pub(crate) residual: f64,
    pub(crate) by_offset: f64,
    pub(crate) weight: f64,
}

impl Columns {
    /// Number of points.
    pub(crate) fn len(&self) -> usize {
        self.numbers.len()
    }

    /// The points one after the other.
    #[inline(always)]
    pub(crate) fn points(&self) -> impl ExactSizeIterator<Item = PointOnCell> + Clone {
        let of_points = self.numbers.iter().zip(&self.residuals).zip(self.by_offsets.iter().zip(&self.weights));
        of_points.map(
            #[inline(always)]
            |((number, residual), (by_offset, weight))| PointOnCell {
                cell: *number as usize,
                residual: *residual,
                by_offset: *by_offset,
                weight: *weight,
            },
        )
    }

    /// Takes all of measurements, which have the Jacobians.
    pub(crate) fn take(&mut self, measurements: &[Measurement]) {
        self.jacobians = Jacobians::OfPoints;
        self.set_cells(measurements);
        self.residuals.clear();
        self.residuals.extend(measurements.iter().map(|m| m.residual));
        self.by_offsets.clear();
        self.by_offsets.extend(measurements.iter().map(|m| m.by_offset));
    }

    /// Sets the cells to those of measurements, with their weights.
    pub(super) fn set_cells(&mut self, measurements: &[Measurement]) {
        self.numbers.clear();
        self.numbers.extend(measurements.iter().map(|m| if m.cell == NO_CELL { u32::MAX } else { m.cell as u32 }));
        self.weights.clear();
        self.weights.extend(measurements.iter().map(|m| m.weight));
    }

    /// The numbers of the cells, to be changed, and the weights.
    pub(super) fn numbers_and_weights(&mut self) -> (&mut [u32], &[f64]) {
        (&mut self.numbers, &self.weights)
    }

    /// Gives measurements their cells back.
    pub(super) fn hand_cells_back(&self, measurements: &mut [Measurement]) {
        for (measurement, number) in measurements.iter_mut().zip(&self.numbers).filter(|(m, _)| m.cell != NO_CELL) {
            measurement.cell = *number as usize;
        }
    }

    /// Sums up the points of every cell, where Jacobians are those of cells.
    pub(crate) fn sum_up(&mut self) {
        let Self { numbers, residuals, weights, along, lines, sums, .. } = self;
        sums.clear();
        sums.resize(lines.len(), CellSums::default());
        let sums = sums.as_mut_slice();
        vectorised(
            #[inline(always)]
            || {
                let of_points = weights.iter().zip(along.iter().zip(residuals.iter()));
                for (number, (w, (t, r))) in numbers.iter().zip(of_points) {
                    sums[*number as usize].add(*w, *t, *r);
                }
            },
        );
    }
}

impl CellSums {
    /// Adds a point with a weight, a coordinate along the line and a residual.
    #[inline(always)]
    fn add(&mut self, w: f64, t: f64, r: f64) {
        let (mut sum, of_point) = (self.moments, [1.0, t, t * t, r]);
        for i in 0..LANES {
            sum[i] += w * of_point[i];
        }
        self.moments = sum;
        self.along += w * t * r;
    }
}

impl CellLine {
    /// The Jacobian at the foot of a line along this normal, which lies `at` along it, and what comes to it along the line, by the normal
    /// velocities that each parameter of the pose error gives a point.
    #[inline(always)]
    pub(crate) fn jacobian<const K: usize>(
        &self,
        at: f64,
        velocities: impl Fn(&Point2<f64>, &Vector2<f64>) -> [f64; MAX_PARAMETERS],
    ) -> [[f64; K]; 2] {
        let normal = self.normal();
        let foot = Point2::from(at * normal);
        let of_foot = velocities(&foot, &normal);
        let further = velocities(&Point2::new(foot.x - normal.y, foot.y + normal.x), &normal);
        [std::array::from_fn(|i| of_foot[i]), std::array::from_fn(|i| further[i] - of_foot[i])]
    }
}
