//! Finds a known curve in a frame without a guess: turns over the whole circle, then refinement of the pose.
use freeform_curve_fit::{MAX_COEFFICIENTS, Outline};
use freeform_riccati::{MotionModel, Transport};
use nalgebra::{Matrix3, Rotation2, SMatrix, SVector};

use super::filter::WholeCurveFilter;

/// Turns tried over the whole circle.
const TURNS: usize = 72;
/// Local minima over the turns that are refined.
const REFINED: usize = 5;
/// Steps of refinement.
const STEPS: usize = 10;
/// Mean square of the polynomial's values that the refinement reckons with: points far off must still count.
const FAR: f64 = 1.0;
/// A misfit up to this many times the best is a tie, which the smaller turn wins.
const TIE: f64 = 1.25;

impl WholeCurveFilter {
    /// The pose that brings the curve onto the loaded outline by a turn and a shift, and its misfit.
    pub(super) fn find_pose(&mut self, outline: &Outline) -> Option<(Matrix3<f64>, f64)> {
        let degree = self.settings.degree;
        let n = degree.coefficient_count();
        let centre = self.sums.centroid();
        let back = Matrix3::new_translation(&-centre.coords);
        self.sums.measure(outline, &back, None);
        // As it stands now, about the image of its own origin.
        let at = crate::motion_algebra::map_point(&self.pose, &nalgebra::Point2::origin());
        let standing = Matrix3::new_translation(&-at.coords) * self.pose;
        let mut costs = [f64::INFINITY; TURNS];
        let mut moved = [0.0; MAX_COEFFICIENTS];
        let start = |i: usize| {
            let turn = std::f64::consts::TAU * i as f64 / TURNS as f64;
            Rotation2::new(turn).to_homogeneous() * standing
        };
        for (i, cost) in costs.iter_mut().enumerate() {
            let transport = Transport::from_inverse(degree, &start(i).try_inverse()?);
            transport.apply(&self.coefficients[..n], &mut moved[..n]);
            let columns = self.sums.gram.chunks_exact(n);
            *cost = columns
                .zip(&moved)
                .zip(&self.sums.projection)
                .map(|((column, a), h)| {
                    let along: f64 = column.iter().zip(&moved).map(|(g, b)| g * b).sum();
                    a * (along - 2.0 * h)
                })
                .sum();
        }
        let is_minimum =
            |i: &usize| costs[*i] <= costs[(*i + 1) % TURNS] && costs[*i] < costs[(*i + TURNS - 1) % TURNS];
        let mut minima: Vec<usize> = (0..TURNS).filter(is_minimum).collect();
        minima.sort_by(|a, b| costs[*a].total_cmp(&costs[*b]));
        minima.truncate(REFINED);
        let turn = |i: usize| i.min(TURNS - i);
        let mut found: Vec<(usize, Matrix3<f64>, f64)> = Vec::new();
        for i in minima {
            let pose = Matrix3::new_translation(&centre.coords) * start(i);
            if let Some((pose, misfit)) = self.refined(outline, pose) {
                found.push((turn(i), pose, misfit));
            }
        }
        let best = found.iter().map(|(.., misfit)| *misfit).fold(f64::INFINITY, f64::min);
        let ties = found.into_iter().filter(|(.., misfit)| *misfit <= TIE * best);
        ties.min_by_key(|(turn, ..)| *turn).map(|(_, pose, misfit)| (pose, misfit))
    }

    /// Gauss-Newton steps of a rigid pose, the curve being as it is.
    fn refined(&mut self, outline: &Outline, mut pose: Matrix3<f64>) -> Option<(Matrix3<f64>, f64)> {
        let n = self.settings.degree.coefficient_count();
        for _ in 0..STEPS {
            let known = (&self.coefficients[..n], FAR);
            self.sums.measure(outline, &pose.try_inverse()?, Some(known));
            let linear = self.linearised(MotionModel::Rigid, &self.coefficients);
            let s = SMatrix::<f64, 3, 3>::from_fn(|i, j| linear.information.pose[i][j]);
            let ridge = SMatrix::<f64, 3, 3>::identity() * (1e-9 * s.trace());
            let score = SVector::<f64, 3>::from_fn(|i, _| linear.pose_score[i]);
            let step = (s + ridge).cholesky()?.solve(&score);
            pose *= MotionModel::Rigid.flow(step.as_slice(), 1.0).into_inner();
            if step.norm() < 1e-4 {
                break;
            }
        }
        let known = (&self.coefficients[..n], FAR);
        self.sums.measure(outline, &pose.try_inverse()?, Some(known));
        self.sums.misfit.is_finite().then_some((pose, self.sums.misfit))
    }
}
