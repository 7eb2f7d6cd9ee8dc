//! Whether a frame shows the outline that is known, larger or smaller.
use freeform_riccati::MotionModel;
use nalgebra::{Matrix3, Matrix4, Point2, Vector2, Vector4};

use super::Track;
use crate::{
    map::OutlineMap,
    measurement::{Frame, weighted_median},
    tuning::{family, measurement::MEDIAN_TO_DEVIATION, noise::LARGEST, update as tuning},
    update::{FrameMeasurement, Gate, Rejection, without_leverage},
};

/// A point of a frame whose cell is known: how fast its residual changes as the outline grows about its middle, shifts and turns, the residual, its
/// weight, its deviation over that of a good one, and what its own share of what is known of its cell makes of its squared residual.
#[derive(Debug, Clone, Copy)]
struct Point {
    by_change: Vector4<f64>,
    residual: f64,
    weight: f64,
    ratio: f64,
    factor: f64,
}

impl Track {
    /// The verdict of a gate on a solved frame whose points scatter too much about the outline: it is taken where they do not once the outline has
    /// grown or shrunk about its middle, as that of an object does that comes nearer. What is left beside growth must be no more than the gate lets
    /// through. The noise of the frame stays what it is without growth, so that what is learnt from it is known by as much less.
    ///
    /// Frames of an object that grows by little in each would be rejected one and all otherwise, as each is compared with those before it; and what
    /// is rejected shows to no test that the outlines grow. This holds for the first frames, until such a test tells growth where there is some.
    pub(super) fn verdict_if_grown(
        &self,
        (gate, measurement): (&Gate, &FrameMeasurement),
        (frame, pose): (&Frame, &Matrix3<f64>),
        verdict: Result<(), Rejection>,
    ) -> Result<(), Rejection> {
        let Err(Rejection::NoiseTooLarge { noise }) = verdict else { return verdict };
        let radius = self.reference.radius;
        // Where enough frames have been taken to tell growth, what is known of it is allowed for; a frame that is grown by itself is a bad one.
        let may_grow = self.frames < family::MAP_KNOWN + family::FEWEST_FRAMES;
        let is_little = measurement.of_good_points(noise) <= LARGEST * radius;
        if self.model() != MotionModel::Rigid || !is_little || !may_grow {
            return verdict;
        }
        let Some(left) = noise_beside_growth(frame, (&self.map, pose)) else { return verdict };
        let noise = Some(left * radius * frame.deviations.typical());
        self.verdict(gate, &FrameMeasurement { noise, ..*measurement }).or(verdict)
    }
}

/// Deviation of the noise of a good point of a solved frame, normalised, beside a growth of the outline about its middle, with what shift and turn
/// go with it. `None` where the points do not tell them apart.
fn noise_beside_growth(frame: &Frame, at: (&OutlineMap, &Matrix3<f64>)) -> Option<f64> {
    let points = points_of(frame, at);
    if tuning::ONE_IN_TELLS * points.len() <= frame.columns.len() {
        return None;
    }
    let mut change = Vector4::zeros();
    for _ in 0..tuning::GROWTH_ITERATIONS {
        let spread = noise_of(&points, &change)?;
        let (mut information, mut right) = (Matrix4::zeros(), Vector4::zeros());
        for point in &points {
            let left = point.residual - point.by_change.dot(&change);
            // Cauchy's weights: points that do not belong to the outline do not pull.
            let size = left / (tuning::GROWTH_CAUCHY * spread * point.ratio);
            let weight = point.weight / (1.0 + size * size);
            information += weight * point.by_change * point.by_change.transpose();
            right += weight * left * point.by_change;
        }
        change += information.cholesky()?.solve(&right);
    }
    noise_of(&points, &change)
}

/// Those that tell of the noise.
fn points_of(frame: &Frame, (map, pose): (&OutlineMap, &Matrix3<f64>)) -> Vec<Point> {
    let Frame { points, columns, cells_with_frame, deviations, .. } = frame;
    let (own, turn) = (cells_with_frame.own(), pose.fixed_view::<2, 2>(0, 0));
    let ratios = deviations.ratios();
    let told = columns.points().enumerate().filter_map(|(i, m)| {
        let (factor, is_told) = without_leverage(m.weight, m.by_offset, *own.get(m.cell)?);
        is_told.then_some((i, m, factor))
    });
    let count = told.clone().count().max(1) as f64;
    let middle = Point2::from(told.clone().map(|(i, ..)| points[i].coords).sum::<Vector2<f64>>() / count);
    told.map(|(i, m, factor)| {
        let (normal, from_middle) = (turn * map.cells()[m.cell].normal, points[i] - middle);
        let by_change = Vector4::new(normal.dot(&from_middle), normal.x, normal.y, normal.perp(&from_middle));
        let ratio = ratios.map_or(1.0, |ratios| ratios[i]);
        Point { by_change, residual: m.residual, weight: m.weight, ratio, factor }
    })
    .collect()
}

/// Robust deviation of what a change leaves of the residuals.
fn noise_of(points: &[Point], change: &Vector4<f64>) -> Option<f64> {
    let left = |point: &Point| (point.residual - point.by_change.dot(change)).abs();
    let mut sizes: Vec<_> =
        points.iter().map(|p| (left(p) * p.factor.sqrt() / p.ratio, (p.ratio * p.ratio).recip())).collect();
    weighted_median(&mut sizes).map(|middle| MEDIAN_TO_DEVIATION * middle)
}
