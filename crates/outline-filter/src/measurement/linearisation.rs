//! The distance of a point from its cell, its Jacobian, and its weight, point by point: the plain way. Most frames take
//! [`View::measure_side_by_side`], which finds the same of all points together.
use freeform_riccati::{MAX_PARAMETERS, ParameterVector, map_point, pull_back};
use nalgebra::{Matrix3, Point2, Vector2};

use super::{Counted, NO_CELL, Pass, PointDeviations, View};
use crate::{
    map::{NullDirection, median},
    tuning::measurement as tuning,
};

/// What becomes of one point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Measurement {
    /// Its cell, or [`NO_CELL`].
    pub(crate) cell: usize,
    /// Distance from the outline along its normal in the image, normalised.
    pub(crate) residual: f64,
    /// How fast the residual falls as the offset grows.
    pub(crate) by_offset: f64,
    /// How fast the residual falls as the pose error grows.
    pub(crate) jacobian: ParameterVector,
    /// Information in units of the noise.
    pub(crate) weight: f64,
}

impl Measurement {
    pub(crate) const NOTHING: Self =
        Self { cell: NO_CELL, residual: 0.0, by_offset: 0.0, jacobian: [0.0; MAX_PARAMETERS], weight: 0.0 };
}

impl View<'_> {
    /// Distance `z = n . (g^-1 p - c) - d` of an image point from the outline on the normal of its cell, brought to image lengths.
    /// Returns the normal of the outline in the image.
    pub(super) fn distance(
        &self,
        measurement: &mut Measurement,
        p: &Point2<f64>,
        inverse: &Matrix3<f64>,
        shifts: &[f64],
    ) -> Vector2<f64> {
        let number = measurement.cell;
        if number == NO_CELL {
            (measurement.residual, measurement.by_offset) = (0.0, 0.0);
            return Vector2::zeros();
        }
        let cell = &self.map.cells()[number];
        let q = map_point(inverse, p);
        let z = cell.normal.dot(&(q - cell.centre)) - self.belief.offsets[number] - shifts[number];
        // A unit step along the image normal moves the body point by |D' n| along n.
        let pulled = pull_back(inverse, p, &q, &cell.normal);
        measurement.by_offset = 1.0 / pulled.norm();
        measurement.residual = z * measurement.by_offset;
        pulled * measurement.by_offset
    }

    /// The Jacobian of the distance: the normal velocity that each parameter of the pose error gives the foot of the point on the line through
    /// its cell. The noise of the point itself would bias motions that grow or shear, and so would that of the offset, from frames before.
    #[inline]
    pub(super) fn linearise(
        &self,
        measurement: &mut Measurement,
        p: &Point2<f64>,
        normal: &Vector2<f64>,
        shifts: &[f64],
        null: &[NullDirection],
    ) {
        if measurement.cell == NO_CELL {
            measurement.jacobian = [0.0; MAX_PARAMETERS];
            return;
        }
        let number = measurement.cell;
        let from_cell = measurement.residual + (self.belief.offsets[number] + shifts[number]) * measurement.by_offset;
        let foot = p - from_cell * normal;
        measurement.jacobian = self.belief.model.normal_velocities(&foot, normal);
        null.iter().for_each(|direction| direction.project_out(&mut measurement.jacobian));
    }

    /// Tukey's weights, over the variances that the points state.
    pub(super) fn weigh(
        &self,
        measurements: &mut [Measurement],
        values: &mut Vec<f64>,
        deviations: &PointDeviations,
        pass: Pass,
    ) {
        let ratios = deviations.ratios();
        if ratios.is_none() && self.noise.counted == Counted::Alike {
            self.weigh_by(measurements, values, (|_| 1.0, |_, _| 1.0), pass);
            return;
        }
        let (ratio, widest) = (|i: usize| ratios.map_or(1.0, |ratios| ratios[i]), deviations.widest());
        // A cell that only points which count for little have told of may lie far off: then good points do too.
        let own = self.belief.information.cells.own();
        let expected = |i: usize, m: &Measurement| {
            let known = own.get(m.cell).copied().filter(|own| *own > 0.0).unwrap_or(f64::INFINITY);
            (ratio(i).min(widest).powi(2) + m.by_offset * m.by_offset / known).sqrt()
        };
        self.weigh_by(measurements, values, (ratio, expected), pass);
    }

    /// As [`weigh`](Self::weigh). `ratio` is the deviation of a point, `expected` that of its residual, with what is not known of its cell; both are
    /// in deviations of a good point.
    #[inline(always)]
    fn weigh_by(
        &self,
        measurements: &mut [Measurement],
        values: &mut Vec<f64>,
        (ratio, expected): (impl Fn(usize) -> f64, impl Fn(usize, &Measurement) -> f64),
        pass: Pass,
    ) {
        let noise = self.noise;
        let limit = tuning::FULL_WEIGHT * noise.sigma;
        let near = measurements.iter().enumerate().filter(|(i, m)| m.residual.abs() < limit * expected(*i, m)).count();
        let (mut scale, mut share) = (noise.sigma, 1.0);
        if (near as f64) < tuning::NEAR_ENOUGH * measurements.len() as f64 {
            values.clear();
            let known = measurements.iter().enumerate().filter(|(_, m)| m.cell != NO_CELL);
            values.extend(known.map(|(i, m)| m.residual.abs() / expected(i, m)));
            (scale, share) = self.scale_of_wide_frame(values, pass);
        }
        let scale = 1.0 / scale;
        for (i, measurement) in measurements.iter_mut().enumerate() {
            if measurement.cell == NO_CELL {
                measurement.weight = 0.0;
                continue;
            }
            let variance = noise.inflation(measurement.cell);
            let residual = if variance > 1.0 { measurement.residual / variance.sqrt() } else { measurement.residual };
            let ratio = ratio(i);
            let size = residual.abs() * scale / expected(i, measurement);
            let excess = (size - tuning::FULL_WEIGHT) / (tuning::NO_WEIGHT - tuning::FULL_WEIGHT);
            measurement.weight = match excess {
                e if e <= 0.0 => 1.0,
                e if e < 1.0 => (1.0 - e * e).powi(2),
                _ => 0.0,
            } * share
                / (variance * ratio * ratio);
        }
    }

    /// The deviation that points are weighted by, and what they count for, where too few of the residuals, whose sizes are given, are small.
    pub(super) fn scale_of_wide_frame(&self, sizes: &mut [f64], pass: Pass) -> (f64, f64) {
        let noise = self.noise;
        let scale = noise.sigma.max(tuning::MEDIAN_TO_DEVIATION * median(sizes).unwrap_or(0.0));
        match pass {
            Pass::First => (scale, 1.0),
            // A frame with more noise than most counts for less. A prediction that is off by more than the noise, though, must not lose the
            // points it has to be corrected by.
            Pass::Again => {
                let scale = scale.min(noise.tolerated());
                (scale, (noise.sigma / scale).powi(2))
            }
        }
    }
}
