//! The Cramer-Rao bound of what was found: of its motion, its outline, its noise and the points that its frames show.
use freeform_motion::Warning;
use freeform_motion::estimate::{BoundaryPoint, CramerRaoBound, MotionEstimate};
use freeform_motion::outline_filter::Dynamics;
use freeform_motion::riccati::CameraScale;
use freeform_motion::tracker::ObjectResult;
use nalgebra::{Point2, Vector2};

use crate::history::{KnownInFrame, Playback, PlayedFrame};

/// A time in seconds and the smallest standard deviations from the frames up to then, one for each parameter that they tell of.
pub(crate) type BoundAt = (f64, Vec<Option<f64>>);

/// Why there is no bound.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NoBound {
    /// A parameter is not stated.
    NotStated,
    /// The motion is no constant one.
    MotionChanges,
    /// Too few frames with an outline and a noise.
    TooFewFrames,
}

impl NoBound {
    /// The reason as a clause.
    pub(crate) const fn reason(self) -> &'static str {
        match self {
            Self::NotStated => "not all parameters of the motion are stated",
            Self::MotionChanges => "it is that of a constant motion, and this one changes",
            Self::TooFewFrames => "too few frames show the outline",
        }
    }
}

/// The bound of the motion that was found, frame by frame, in the units of the result. It begins anew where the object was begun anew.
pub(crate) fn bound_found(
    result: &ObjectResult,
    playback: &Playback,
    scale: Option<CameraScale>,
) -> Result<Vec<BoundAt>, NoBound> {
    // Of a plane in space the bound is another, and is not drawn.
    let model = result.motion.model().ok_or(NoBound::NotStated)?;
    let generator = result.estimate.and_then(|estimate| estimate.known_generator()).ok_or(NoBound::NotStated)?;
    let is_constant = result.dynamics.is_none_or(|weights| weights.most_probable() == Dynamics::Generator);
    if !is_constant || result.warnings.iter().any(|warning| matches!(warning, Warning::MotionChanged { .. })) {
        return Err(NoBound::MotionChanges);
    }
    let in_image = scale.unwrap_or_default().generator_in_image(&generator);
    let values = model.parameters_of(&in_image);
    let values = &values[..model.parameter_count()];
    let mut list = Vec::new();
    // With its segment and the time that it begins at.
    let mut bound: Option<(usize, f64, CramerRaoBound)> = None;
    for frame in playback.frames().iter().map(|kept| &kept.value) {
        let Some(Usable { time, noise, known }) = usable(frame) else { continue };
        let begun = bound.take().filter(|(segment, ..)| *segment == frame.segment);
        let new = || CramerRaoBound::new(model, values).ok().map(|bound| (frame.segment, time, bound));
        let Some((segment, start, mut so_far)) = begun.or_else(new) else { return Err(NoBound::NotStated) };
        let points = boundary_points(known);
        let weight = (frame.point_count * playback.every()) as f64 / points.len().max(1) as f64;
        if so_far.add_frame(time - start, points, noise, weight).is_ok()
            && let Ok(covariance) = so_far.covariance()
        {
            let deviations: Vec<Option<f64>> = covariance.standard_deviations().collect();
            let numbers: Vec<f64> = deviations.iter().map(|std| std.unwrap_or(0.0)).collect();
            let estimate = MotionEstimate::new(model, values, Some(&numbers));
            let estimate = scale.map_or(estimate, |scale| estimate.in_space(scale));
            let in_units = estimate.parameters().map(|p| p.standard_deviation.filter(|std| *std > 0.0));
            list.push((time, in_units.zip(&deviations).map(|(std, known)| std.filter(|_| known.is_some())).collect()));
        }
        bound = Some((segment, start, so_far));
    }
    if list.len() > 1 { Ok(list) } else { Err(NoBound::TooFewFrames) }
}

struct Usable<'a> {
    time: f64,
    noise: f64,
    known: &'a KnownInFrame,
}

/// A frame that was used, with what is known of its outline and noise.
fn usable(frame: &PlayedFrame) -> Option<Usable<'_>> {
    let known = frame.known.as_ref().filter(|_| frame.rejection.is_none())?;
    let noise = frame.noise.filter(|noise| noise.is_finite() && *noise > 0.0)?;
    Some(Usable { time: frame.time?, noise, known })
}

/// The points of the known outline that a frame shows, with normals by their neighbours.
fn boundary_points(known: &KnownInFrame) -> Vec<BoundaryPoint> {
    let mut list = Vec::new();
    for (points, closed, seen) in known.placed() {
        let count = points.len();
        let neighbours = |i: usize| -> [usize; 2] {
            match closed {
                true => [(i + count - 1) % count, (i + 1) % count],
                false => [i.saturating_sub(1), (i + 1).min(count - 1)],
            }
        };
        for (i, point) in points.iter().enumerate().filter(|(i, _)| seen[*i]) {
            let [before, after]: [Point2<f64>; 2] = neighbours(i).map(|j| points[j]);
            let along: Vector2<f64> = after - before;
            if let Some(along) = along.try_normalize(0.0) {
                list.push(BoundaryPoint { point: *point, normal: Vector2::new(-along.y, along.x) });
            }
        }
    }
    list
}
