//! The pose of an object that is followed from frame to frame: affine, for frames that show only a part of it, or projective.
use freeform_curve_fit::{ClosedOutline, Normalisation, OpenArc, OpenOutline, Outline, OutlineError, outward_normals};
use freeform_riccati::{MAX_PARAMETERS, MotionModel};
use nalgebra::{Matrix3, Point2, Projective2, SMatrix, SVector, Vector2};

use crate::regular_map::is_regular;

/// Points of the reference at most; more would not place a part of the outline any better.
const REFERENCE_POINTS: usize = 400;
/// Points of an outline that are placed on the reference at most.
const PLACED_POINTS: usize = 150;
/// Steps of a registration.
const STEPS: usize = 12;
/// A step that moves no point of the object by more than this, in its RMS radii, is the last.
const CONVERGED: f64 = 1e-9;
/// Residuals of so many medians count a quarter; those of points that the reference does not show next to nothing.
const ROBUST_MEDIANS: f64 = 3.0;
/// Smallest scale of the residuals, in RMS radii: below, rounding decides.
const ROUNDING: f64 = 1e-9;
/// Keeps maps that a part of the outline does not tell where they were predicted, per point.
const DAMPING: f64 = 1e-6;
/// Half window of the normals, a fraction of the length of the outline.
const NORMAL_HALF_WINDOW: f64 = 0.02;

/// Where the working coordinates of the last frame were, and the outline in them as it was last seen whole, or first seen.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct FollowedPose {
    /// The family that changes of the pose are in.
    model: MotionModel,
    time: f64,
    image_from_working: Projective2<f64>,
    points: Vec<Point2<f64>>,
    normals: Vec<Vector2<f64>>,
    is_whole: bool,
}

impl FollowedPose {
    /// Takes an outline and its normalisation for the reference.
    pub(crate) fn new(model: MotionModel, time: f64, outline: &Outline, normalisation: &Normalisation) -> Self {
        let image_from_working = normalisation.image_from_working();
        // Normals are found in the image and moved as normals are.
        let map = image_from_working.matrix().fixed_view::<2, 2>(0, 0).transpose();
        let every = outline.point_count().div_ceil(REFERENCE_POINTS);
        let (points, normals) = outline
            .points()
            .zip(outward_normals(outline, NORMAL_HALF_WINDOW))
            .step_by(every)
            .map(|(p, n)| (normalisation.to_working(p), (map * n).try_normalize(0.0).unwrap_or_default()))
            .unzip();
        let image_from_working = nalgebra::convert(image_from_working);
        Self { model, time, image_from_working, points, normals, is_whole: matches!(outline, Outline::Closed(_)) }
    }

    /// Whether it can have come from outlines of an object that is followed in this family.
    #[cfg(feature = "serde")]
    pub(crate) fn is_of(&self, model: MotionModel) -> bool {
        let Self { time, image_from_working, points, normals, .. } = self;
        let coordinates = points.iter().map(|p| p.coords).chain(normals.iter().copied());
        self.model == model
            && time.is_finite()
            && is_regular(image_from_working.matrix())
            && (1..=REFERENCE_POINTS).contains(&points.len())
            && points.len() == normals.len()
            && { coordinates }.all(|v| v.iter().all(|c| c.is_finite()))
    }

    /// Seconds since the last frame.
    pub(crate) fn seconds_until(&self, time: f64) -> f64 {
        time - self.time
    }

    /// The pose at which the points of an outline lie on the reference, by iterated closest points (point to line, robust), from the
    /// better of two guesses: the last pose, and that moved by `flow`.
    pub(crate) fn found(&self, outline: &Outline, flow: &Projective2<f64>) -> Projective2<f64> {
        let guesses = [self.image_from_working, flow * self.image_from_working];
        let misfit = |pose: &Projective2<f64>| self.match_all(pose, outline).1;
        let is_moved = is_regular(guesses[1].matrix()) && misfit(&guesses[1]) < misfit(&guesses[0]);
        let mut pose = guesses[usize::from(is_moved)];
        for _ in 0..STEPS {
            let (matches, median) = self.match_all(&pose, outline);
            let step = correction(self.model, &matches, ROBUST_MEDIANS * median.max(ROUNDING));
            let Some(corrected) = step.and_then(nalgebra::Transform::try_inverse) else { break };
            let next = pose * corrected;
            // Of an outline that has become a line or a point nothing could be followed on.
            if !is_regular(next.matrix()) {
                break;
            }
            pose = next;
            if (corrected.matrix() - Matrix3::identity()).amax() < CONVERGED {
                break;
            }
        }
        pose
    }

    /// The arcs of an outline at a pose, joined by the parts of the reference that they leave out. `None` where the reference is not
    /// whole itself, or the arcs do not run along it one way round.
    pub(crate) fn completed(&self, arcs: &OpenOutline, pose: &Projective2<f64>) -> Option<ClosedOutline> {
        if !self.is_whole {
            return None;
        }
        let (count, working_from_image) = (self.points.len(), pose.try_inverse()?);
        let place = |p: &Point2<f64>| self.nearest_index(&(working_from_image * p));
        // Places go up or down along all arcs alike.
        let ascent = |arc: &[Point2<f64>]| {
            let places: Vec<usize> = arc.iter().map(place).collect();
            let step = |w: &[usize]| (w[1] + count - w[0]) % count;
            let forward = places.windows(2).filter(|w| (1..count / 2).contains(&step(w))).count();
            let backward = places.windows(2).filter(|w| step(w) > count / 2).count();
            (forward, backward)
        };
        let (forward, backward) =
            arcs.arcs().iter().map(|arc| ascent(arc.points())).fold((0, 0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
        if forward.min(backward) * 3 > forward.max(backward) {
            return None;
        }
        let mut joined = Vec::with_capacity(count + 1);
        let next_arcs = arcs.arcs().iter().cycle().skip(1);
        for (arc, next) in arcs.arcs().iter().zip(next_arcs) {
            joined.extend_from_slice(arc.points());
            let [from, to] = [arc.points().last()?, next.points().first()?].map(place);
            let hidden = if forward > backward { to + count - from } else { from + count - to } % count;
            let at = |k: usize| if forward > backward { from + k } else { from + count - k } % count;
            // Ends that nearly meet may lie the wrong way round.
            let hidden = if hidden * 20 > count * 19 { 0 } else { hidden };
            joined.extend((1..hidden).map(|k| pose * self.points[at(k)]));
        }
        ClosedOutline::new(joined).ok()
    }

    /// Remembers where the object was.
    pub(crate) fn at(&mut self, time: f64, image_from_working: Projective2<f64>) {
        (self.time, self.image_from_working) = (time, image_from_working);
    }

    /// Points of an outline in working coordinates with the normal of the nearest point of the reference and the distance from the
    /// line through that; and the median distance.
    fn match_all(&self, pose: &Projective2<f64>, outline: &Outline) -> (Vec<Match>, f64) {
        // A motion that shrinks the object to nothing over a long gap fits no outline.
        let Some(working_from_image) = pose.try_inverse() else { return (Vec::new(), f64::INFINITY) };
        let every = outline.point_count().div_ceil(PLACED_POINTS);
        let matches: Vec<Match> =
            outline.points().step_by(every).map(|p| self.nearest(working_from_image * p)).collect();
        let mut distances: Vec<f64> = matches.iter().map(|m| m.distance.abs()).collect();
        let middle = distances.len() / 2;
        let median = *distances.select_nth_unstable_by(middle, f64::total_cmp).1;
        (matches, median)
    }

    fn nearest(&self, point: Point2<f64>) -> Match {
        let index = self.nearest_index(&point);
        let normal = self.normals[index];
        Match { point, normal, distance: normal.dot(&(point - self.points[index])) }
    }

    fn nearest_index(&self, point: &Point2<f64>) -> usize {
        let distances = self.points.iter().map(|reference| (reference - point).norm_squared());
        distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(index, _)| index)
    }
}

/// A point and how far it is from the line that it is on in the reference.
struct Match {
    point: Point2<f64>,
    normal: Vector2<f64>,
    distance: f64,
}

/// The map near the identity that brings the points onto their lines, by weighted least squares.
fn correction(model: MotionModel, matches: &[Match], scale: f64) -> Option<Projective2<f64>> {
    type Normal = SMatrix<f64, MAX_PARAMETERS, MAX_PARAMETERS>;
    let mut information = Normal::identity() * (DAMPING * matches.len() as f64);
    let mut right = SVector::<f64, MAX_PARAMETERS>::zeros();
    for Match { point, normal, distance } in matches {
        let weight = (1.0 + (distance / scale).powi(2)).powi(-2);
        let row = SVector::from(model.normal_velocities(point, normal));
        information += weight * row * row.transpose();
        right -= weight * distance * row;
    }
    let d = information.cholesky()?.solve(&right);
    let generator = model.generator(&d.as_slice()[..model.parameter_count()]);
    Some(Projective2::from_matrix_unchecked(Matrix3::identity() + generator))
}

/// An outline in the coordinates that a pose takes to the image.
pub(crate) fn in_working(outline: &Outline, pose: &Projective2<f64>) -> Result<Outline, OutlineError> {
    let working_from_image = pose.inverse();
    let moved = |points: &[Point2<f64>]| points.iter().map(|p| working_from_image * p).collect();
    Ok(match outline {
        Outline::Closed(closed) => Outline::Closed(closed.mapped(|p| working_from_image * p)?),
        Outline::Open(arcs) => {
            let arcs = arcs.arcs().iter().map(|arc| OpenArc::new(moved(arc.points())));
            Outline::Open(OpenOutline::in_sequence(arcs.collect::<Result<_, _>>()?)?)
        }
    })
}
