//! Which cell each point of a frame belongs to.
use freeform_riccati::{is_affine, map_point};
use nalgebra::{Matrix3, Point2};

use super::{Counted, Frame, Jacobians, Lies, Measurement, NoiseModel, hidden::hide_points_of_pieces};
use crate::{
    belief::Belief,
    map::{NullDirection, OutlineMap},
    tuning::measurement as tuning,
};

/// In place of the number of a cell: none.
pub(crate) const NO_CELL: usize = usize::MAX;

/// Whether a frame is looked at for the first time, in a pose that may be off, or again, with weights known from before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Pass {
    First,
    Again,
}

/// All that a frame is measured against.
#[derive(Debug, Clone, Copy)]
pub(crate) struct View<'a> {
    pub(crate) map: &'a OutlineMap,
    pub(crate) belief: &'a Belief,
    pub(crate) noise: &'a NoiseModel,
}

impl View<'_> {
    /// The cell of every point and the linearised distance from it in a pose, with robust weights and null directions projected out.
    ///
    /// A point belongs to the cell that it was seen of, not to the nearest: noise along the outline moves a point out of a bend, so
    /// that its distance from the nearest cell is too large by about `curvature sigma^2 / 2`, which thousands of points add up.
    /// The mean of its neighbours along the contour has little of that noise, and its nearest cell is taken.
    pub(crate) fn measure(&self, frame: &mut Frame, pose: &Matrix3<f64>, null: &[NullDirection], pass: Pass) {
        self.measure_by_columns(frame, pose, null, pass);
        if frame.columns.jacobians == Jacobians::OfCells {
            self.write_measurements(frame, null);
        }
    }

    /// As [`measure`](Self::measure), with the Jacobians of cells in place of measurements point by point where those say all.
    pub(crate) fn measure_by_columns(
        &self,
        frame: &mut Frame,
        pose: &Matrix3<f64>,
        null: &[NullDirection],
        pass: Pass,
    ) {
        let inverse = pose.try_inverse().unwrap_or_else(Matrix3::identity);
        let half_window = self.half_window_of_places(pose, frame);
        let counts_alike = frame.deviations.ratios().is_none() && self.noise.counted == Counted::Alike;
        if counts_alike && is_affine(&inverse) {
            self.measure_side_by_side(frame, &inverse, half_window, pass);
            if !null.is_empty() {
                self.write_measurements(frame, null);
            }
        } else {
            self.measure_one_by_one(frame, &inverse, half_window, null, pass);
        }
    }

    /// The plain way, one point after the other, for all maps and weights. Most frames go
    /// [side by side](Self::measure_side_by_side); a test compares the two.
    pub(crate) fn measure_one_by_one(
        &self,
        frame: &mut Frame,
        inverse: &Matrix3<f64>,
        half_window: usize,
        null: &[NullDirection],
        pass: Pass,
    ) {
        let Frame { points, measurements, values, shifts, pieces, places, deviations, columns, .. } = frame;
        measurements.resize(points.len(), Measurement::NOTHING);
        match pass {
            Pass::First => measurements.fill(Measurement::NOTHING),
            Pass::Again => measurements.iter_mut().zip(&columns.weights).for_each(|(m, weight)| m.weight = *weight),
        }
        places.clear();
        let in_body = |p: &Point2<f64>| map_point(inverse, p);
        if half_window == 0 {
            places.extend(points.iter().map(in_body));
        } else {
            if pass == Pass::First {
                // What the points count with in the means.
                places.extend(points.iter().map(in_body));
                self.associate(measurements, |i, _| places[i]);
                places.clear();
                for (measurement, p) in measurements.iter_mut().zip(points.iter()) {
                    self.distance(measurement, p, inverse, shifts);
                }
                self.weigh(measurements, values, deviations, pass);
            }
            for piece in pieces.iter() {
                let range = piece.range();
                let (points, measurements) = (&points[range.clone()], &measurements[range]);
                let weighted = |i: usize| {
                    let (p, weight) = (&points[i], measurements[i].weight);
                    [weight * p.x, weight * p.y, weight, 0.0]
                };
                let take = |i: usize, mean: Option<Point2<f64>>| places.push(in_body(&mean.unwrap_or(points[i])));
                mean_of_neighbours(points.len(), weighted, piece.closed, half_window, take);
            }
        }
        // The means where the points count, the points where they do not.
        self.associate(measurements, |i, m| if m.weight > 0.0 { places[i] } else { in_body(&points[i]) });
        columns.set_cells(measurements);
        self.keep_to_sides(columns.numbers_and_weights(), pieces, places, half_window);
        columns.hand_cells_back(measurements);
        for (measurement, p) in measurements.iter_mut().zip(points.iter()) {
            let normal = self.distance(measurement, p, inverse, shifts);
            self.linearise(measurement, p, &normal, shifts, null);
        }
        self.weigh(measurements, values, deviations, pass);
        if self.map.has_ends() {
            // Hidden arcs show nothing of the outline: their points have no cells.
            let lies = |list: &[Measurement], i: usize| Lies::of(list[i].cell == NO_CELL, list[i].weight > 0.0);
            hide_points_of_pieces(measurements.as_mut_slice(), pieces, lies, |list, i| list[i] = Measurement::NOTHING);
        }
        columns.take(measurements);
    }

    /// Points on either side whose mean says which cell a point belongs to: enough for the noise to be small against a cell, and few
    /// against the outline.
    pub(crate) fn half_window_of_places(&self, pose: &Matrix3<f64>, frame: &Frame) -> usize {
        let scale = pose.fixed_view::<2, 2>(0, 0).determinant().abs().sqrt();
        let noise = self.noise.sigma * frame.deviations.typical();
        let needed = (noise / (scale * self.map.spacing() * tuning::PLACE_NOISE)).powi(2);
        let most = frame.points.len() as f64 * tuning::WIDEST_WINDOW;
        (0.5 * (needed.min(most) - 1.0)).round().max(0.0) as usize
    }

    /// The cells of points, by places in the body frame.
    fn associate(&self, measurements: &mut [Measurement], place: impl Fn(usize, &Measurement) -> Point2<f64>) {
        let map = self.map;
        // A first look at all of them waits for none; which way to go from there cannot be foreseen.
        for (i, measurement) in measurements.iter_mut().enumerate() {
            measurement.cell = map.near(&place(i, measurement)).unwrap_or(NO_CELL);
        }
        for (i, measurement) in measurements.iter_mut().enumerate() {
            if measurement.cell != NO_CELL {
                let q = place(i, measurement);
                let number = map.nearest_from(measurement.cell, &q);
                measurement.cell = if map.is_beyond_end(number, &q) { NO_CELL } else { number };
            }
        }
    }
}

/// Mean of the neighbours of every point along a piece of the contour, the point itself included; none where they count for nothing.
/// `weighted` are the coordinates of the points times their weights, and these; a fourth number is not looked at.
#[inline(always)]
pub(super) fn mean_of_neighbours(
    count: usize,
    weighted: impl Fn(usize) -> [f64; 4],
    closed: bool,
    half_window: usize,
    mut take: impl FnMut(usize, Option<Point2<f64>>),
) {
    let w = half_window.min((count - 1) / 2);
    // Less than two rounds on, where a remainder would be most of the work.
    let at = |i: usize| weighted(if i < count { i } else { i - count });
    let mut sum = [0.0; 4];
    let change = |sum: &mut [f64; 4], more: [f64; 4], less: [f64; 4]| {
        for c in 0..3 {
            sum[c] += more[c] - less[c];
        }
    };
    let none = [0.0; 4];
    if closed {
        // The window of the first point reaches back over the end.
        (count - w..=count + w).for_each(|i| change(&mut sum, at(i), none));
    } else {
        change(&mut sum, at(0), none);
    }
    for i in 0..count {
        if i > 0 && closed {
            change(&mut sum, at(i + w), at(i + count - w - 1));
        } else if i > 0 {
            // Symmetric windows, narrower towards the ends: a lopsided mean lies off along the contour.
            let (before, now) = (w.min(i - 1).min(count - i), w.min(i).min(count - 1 - i));
            if now > before {
                change(&mut sum, at(2 * i - 1), none);
                change(&mut sum, at(2 * i), none);
            } else if now < before {
                change(&mut sum, none, at(i - 1 - before));
                change(&mut sum, none, at(i - before));
            } else {
                change(&mut sum, at(i + now), at(i - 1 - before));
            }
        }
        let [x, y, weight, _] = sum;
        take(i, (weight > tuning::LEAST_WEIGHT).then(|| Point2::new(x * (1.0 / weight), y * (1.0 / weight))));
    }
}
