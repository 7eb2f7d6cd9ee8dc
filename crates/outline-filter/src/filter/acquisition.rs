//! Finds an object that is known as a map in a frame, without a guess of how it has moved.
use freeform_curve_fit::{FitSettings, Fitter, Outline};
use freeform_decompose::{Decomposition, RelatedPoints};
use freeform_riccati::{MAX_PARAMETERS, MotionModel, map_point, pull_back};
use nalgebra::{Affine2, Matrix3, Point2, Rotation2, SMatrix, SVector, Vector2};

use super::outline_map::OutlineMap;

/// Turns tried over the whole circle.
const TURNS: usize = 24;
/// Points that the search is made with.
const FEW_POINTS: usize = 80;
/// Share of the points, nearest first, that a pose is scored by: the rest may be hidden in the map or wrong.
const TRIMMED: f64 = 0.75;
/// Steps of the search for each start, and of the refinement of the best.
const SEARCH_STEPS: usize = 8;
const REFINEMENT_STEPS: usize = 15;
/// Hypotheses that are refined, and that are handed back at most, with as many of smaller turns.
const REFINED: usize = 5;
const KEPT: usize = 2;
/// Poses whose turns differ by less than this are the same, rad.
const SAME_TURN: f64 = 0.15;
/// A score up to this many times the best is a tie.
const TIE: f64 = 1.25;

/// A pose that fits a frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hypothesis {
    /// Body to image, normalised coordinates.
    pub(crate) pose: Matrix3<f64>,
    /// Trimmed mean distance of the points from the map, normalised.
    score: f64,
    /// Turn from the pose before, rad, anticlockwise where y points up.
    pub(crate) turn: f64,
}

/// Related points of one outline, those of the quartic's two line pairs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Landmarks([Point2<f64>; 2]);

impl Landmarks {
    /// In the image coordinates of the outline.
    pub(crate) fn of(outline: &Outline) -> Option<Self> {
        let fit = Fitter::new(FitSettings::default()).ok()?.fit(outline).ok()?;
        let decomposition = Decomposition::of(fit.working()).ok()?;
        let related = RelatedPoints::of(&decomposition);
        let mut points =
            related.level(4).map(|d| fit.normalisation().centre + fit.normalisation().radius * d.point.coords);
        Some(Self([points.next()?, points.next()?]))
    }

    /// Moved by an affine map of the image.
    pub(crate) fn moved(&self, map: &Affine2<f64>) -> Self {
        Self(self.0.map(|p| map * p))
    }

    fn normalised(&self, map: &OutlineMap) -> [Point2<f64>; 2] {
        self.0.map(|p| Point2::from((p - map.origin) / map.radius))
    }
}

/// Poses that bring the map onto the outline, at most four (eight with a model of more parameters). `landmarks` are the related points of the map in its present
/// pose, and those of the outline.
pub(crate) fn find_pose(map: &mut OutlineMap, outline: &Outline, landmarks: Option<[Landmarks; 2]>) -> Vec<Hypothesis> {
    map.load(outline);
    let points = std::mem::take(&mut map.scratch.points);
    let result = search(map, &points, landmarks);
    map.scratch.points = points;
    result
}

fn search(map: &OutlineMap, points: &[Point2<f64>], landmarks: Option<[Landmarks; 2]>) -> Vec<Hypothesis> {
    let stride = (points.len() / FEW_POINTS).max(1);
    let few: Vec<_> = points.iter().step_by(stride).copied().collect();
    let count = map.cells.len() as f64;
    let body_centre = map.cells.iter().map(|c| map_point(&map.pose, &c.centre).coords / count).sum::<Vector2<f64>>();
    let centre = points.iter().map(|p| p.coords / points.len() as f64).sum::<Vector2<f64>>();
    // Of turns that make no difference the least is taken.
    let turns = if map.turn_is_unseen() { 1 } else { TURNS };
    let mut starts: Vec<_> = (0..turns)
        .map(|i| turn_between(std::f64::consts::TAU * i as f64 / TURNS as f64, &body_centre, &centre))
        .collect();
    if turns > 1 {
        starts.push(Matrix3::identity());
    }
    if let Some([before, after]) = landmarks.filter(|_| turns > 1) {
        let ([a, b], [c, d]) = (before.normalised(map), after.normalised(map));
        for (c, d) in [(c, d), (d, c)] {
            let (from, to) = (b - a, d - c);
            let turn = from.perp(&to).atan2(from.dot(&to));
            let middle = |p: Point2<f64>, q: Point2<f64>| 0.5 * (p.coords + q.coords);
            starts.push(turn_between(turn, &middle(a, b), &middle(c, d)));
        }
    }
    let found: Vec<Hypothesis> =
        starts.iter().map(|start| refined(map, &few, MotionModel::Rigid, &(start * map.pose), SEARCH_STEPS)).collect();
    let mut best = Vec::new();
    for hypothesis in found.into_iter().filter(|h| h.score.is_finite()) {
        match best.iter_mut().find(|other| same(other, &hypothesis)) {
            Some(other) if other.score > hypothesis.score => *other = hypothesis,
            Some(_) => {}
            None => best.push(hypothesis),
        }
    }
    keep(&mut best, REFINED);
    best = best.iter().map(|h| refined(map, points, MotionModel::Rigid, &h.pose, REFINEMENT_STEPS)).collect();
    best.retain(|h| h.score.is_finite());
    keep(&mut best, KEPT);
    if map.model != MotionModel::Rigid {
        // More parameters start from fewer. They may also lead astray where arcs are missing, so that the rigid poses stay.
        let more = best.clone().into_iter().map(|hypothesis| {
            let models = MotionModel::ALL.into_iter().filter(|m| *m > MotionModel::Rigid && *m <= map.model);
            models.fold(hypothesis, |h, model| refined(map, points, model, &h.pose, REFINEMENT_STEPS))
        });
        best.extend(more);
        best.retain(|h| h.score.is_finite());
    }
    for hypothesis in &mut best {
        // A start between middles slides along what the frame shows more of.
        hypothesis.pose = map.without_unseen(&hypothesis.pose);
        hypothesis.turn = turn_of(&hypothesis.pose, map);
    }
    best
}

/// Keeps the best, so many, and as many of the smallest turns that are hardly worse: a symmetric outline has any number of equals.
fn keep(list: &mut Vec<Hypothesis>, count: usize) {
    list.sort_by(|a, b| a.score.total_cmp(&b.score));
    let Some(limit) = list.first().map(|h| TIE * h.score) else { return };
    let rest = list.split_off(count.min(list.len()));
    let mut ties: Vec<_> = rest.into_iter().filter(|h| h.score <= limit).collect();
    ties.sort_by(|a, b| a.turn.abs().total_cmp(&b.turn.abs()));
    ties.truncate(count);
    list.append(&mut ties);
}

fn same(a: &Hypothesis, b: &Hypothesis) -> bool {
    let turn = (a.turn - b.turn + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
    turn.abs() < SAME_TURN && (a.pose - b.pose).norm() < 0.5
}

/// The turn that takes one point to another.
fn turn_between(angle: f64, from: &Vector2<f64>, to: &Vector2<f64>) -> Matrix3<f64> {
    let rotation = Rotation2::new(angle);
    let shift = to - rotation * from;
    let mut map = rotation.to_homogeneous();
    (map[(0, 2)], map[(1, 2)]) = (shift.x, shift.y);
    map
}

/// Point-to-line steps with Tukey weights at a scale that shrinks with the residuals.
fn refined(
    map: &OutlineMap,
    points: &[Point2<f64>],
    model: MotionModel,
    start: &Matrix3<f64>,
    steps: usize,
) -> Hypothesis {
    let k = model.parameter_count();
    let mut pose = *start;
    let mut distances = Vec::with_capacity(points.len());
    let mut rows: Vec<(f64, [f64; MAX_PARAMETERS])> = Vec::with_capacity(points.len());
    for step in 0..=steps {
        let Some(inverse) = pose.try_inverse() else { break };
        let unseen = map.unseen_in_image(&pose);
        distances.clear();
        rows.clear();
        for p in points {
            let q = map_point(&inverse, p);
            let Some(number) = map.nearest_cell(&q) else { continue };
            let cell = &map.cells[number];
            let from = q - (cell.centre + cell.offset * cell.normal);
            distances.push(from.norm());
            let pulled = pull_back(&inverse, p, &q, &cell.normal);
            let slope = 1.0 / pulled.norm();
            let residual = cell.normal.dot(&from) * slope;
            let normal = pulled * slope;
            let mut row = model.normal_velocities(&(p - residual * normal), &normal);
            if model == map.model {
                unseen.iter().for_each(|unseen| unseen.take_off(&mut row));
            }
            rows.push((residual, row));
        }
        if step == steps {
            break;
        }
        let mut sizes: Vec<f64> = rows.iter().map(|(r, _)| r.abs()).collect();
        let scale = 4.685 * 1.4826 * super::contour::median(&mut sizes).unwrap_or(0.0).max(map.sigma);
        let mut gram = SMatrix::<f64, MAX_PARAMETERS, MAX_PARAMETERS>::identity() * 1e-6;
        let mut right = SVector::<f64, MAX_PARAMETERS>::zeros();
        for (residual, row) in &rows {
            let u = residual / scale;
            if u.abs() < 1.0 {
                let weight = (1.0 - u * u).powi(2);
                let row = SVector::from(*row);
                gram += weight * row * row.transpose();
                right += weight * *residual * row;
            }
        }
        let Some(factor) = gram.cholesky() else { break };
        let x = factor.solve(&right);
        let next = model.flow(&x.as_slice()[..k], 1.0).into_inner() * pose;
        if !next.iter().all(|e| e.is_finite()) || next.determinant().abs() < 1e-6 {
            break;
        }
        pose = next;
    }
    distances.sort_unstable_by(f64::total_cmp);
    let kept = ((TRIMMED * distances.len() as f64) as usize).max(1).min(distances.len());
    let score = if distances.is_empty() { f64::INFINITY } else { distances[..kept].iter().sum::<f64>() / kept as f64 };
    let turn = turn_of(&pose, map);
    Hypothesis { pose, score, turn }
}

/// Turn of a pose from the one that the map is in.
fn turn_of(pose: &Matrix3<f64>, map: &OutlineMap) -> f64 {
    let step = map.pose.try_inverse().map_or_else(Matrix3::identity, |inverse| pose * inverse);
    (step[(1, 0)] - step[(0, 1)]).atan2(step[(0, 0)] + step[(1, 1)])
}

/// The constant motion that makes `change` in `seconds`, from the turn of less than half a circle: by Newton's method on the flow,
/// from the closed form of a similarity.
pub(crate) fn motion_between(model: MotionModel, change: &Matrix3<f64>, seconds: f64) -> Option<[f64; MAX_PARAMETERS]> {
    let k = model.parameter_count();
    let (c, s) = (change[(0, 0)] + change[(1, 1)], change[(1, 0)] - change[(0, 1)]);
    let mut start = Matrix3::zeros();
    let omega = -s.atan2(c) / seconds;
    (start[(0, 1)], start[(1, 0)]) = (omega, -omega);
    let mut theta = model.parameters_of(&start);
    for _ in 0..12 {
        let flow = model.flow(&theta[..k], seconds).into_inner();
        let rest = change / change[(2, 2)] * flow.try_inverse()?;
        let error = model.parameters_of(&(rest / rest[(2, 2)] - Matrix3::identity()));
        let by_motion = model.parameter_columns(model.flow_sensitivities(&theta[..k], seconds).into_iter());
        let matrix = SMatrix::<f64, MAX_PARAMETERS, MAX_PARAMETERS>::from_fn(|i, j| {
            if i < k && j < k { by_motion[i][j] } else { f64::from(u8::from(i == j)) }
        });
        let step = matrix.lu().solve(&SVector::from(error))?;
        (0..k).for_each(|i| theta[i] += step[i]);
        if !theta.iter().all(|e| e.is_finite()) {
            return None;
        }
        if step.norm() * seconds < 1e-13 {
            break;
        }
    }
    Some(theta)
}
