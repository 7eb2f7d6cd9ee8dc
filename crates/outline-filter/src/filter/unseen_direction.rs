//! Directions of the pose that an outline does not show, such as the turning of a circle about its centre.
use freeform_riccati::{MAX_PARAMETERS, ParameterKind, ParameterVector, turn_rate};
use nalgebra::{Matrix3, Point2, SMatrix, SVector, Vector2};

use super::{acquisition::motion_between, outline_map::OutlineMap};

/// Eigenvalue of the lever arms, in squares of the RMS radius, below which a direction of the pose cannot be seen.
const DEGENERATE: f64 = 0.003;
/// Times what the errors of the normals would make of the levers in a direction that is not seen: that, and some more.
const EXPLAINED: f64 = 2.0;
/// Standard deviation of a normal's direction that cells are far enough apart for, rad...
const CHORD_NOISE: f64 = 0.035;
/// ...but no further than one of so many parts of all.
const FEWEST_PARTS: usize = 16;
/// Variance that stands for any direction: the mean squared sine.
const ANY_DIRECTION: f64 = 0.5;
/// Points of a window over which a quadratic is fitted, for each that its middle is worth.
const QUADRATIC: f64 = 2.25;
/// Steps to the least of the motions that look alike.
const LEAST_STEPS: usize = 3;
/// Share of the largest part of a direction, lengths in RMS radii, from which on a parameter takes part in it.
const TAKES_PART: f64 = 0.01;

/// Turn, in rad, of a unit step in a direction that counts as turning.
const HOLDS_TURN: f64 = 0.3;

/// A direction of the pose that the outline does not show, in the image: rows of measurements lose `(h . direction) dual`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Unseen {
    pub(crate) direction: ParameterVector,
    pub(crate) dual: ParameterVector,
}

impl Unseen {
    /// Takes the direction off a row of the measurement.
    pub(crate) fn take_off(&self, row: &mut ParameterVector) {
        let along: f64 = row.iter().zip(&self.direction).map(|(a, b)| a * b).sum();
        row.iter_mut().zip(&self.dual).for_each(|(r, d)| *r -= along * d);
    }
}

impl OutlineMap {
    /// Takes it that the turn about the object's centre cannot be seen.
    pub(crate) fn hide_turn(&mut self) {
        let k = self.information.k;
        let turn = Matrix3::new(0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        let size = self.model.parameters_of(&turn)[..k].iter().map(|c| c * c).sum::<f64>().sqrt();
        let Some(inverse) = self.body_frame.try_inverse() else { return };
        if !self.turn_is_unseen() {
            self.turn_is_hidden = true;
            self.unseen_in_body.push(self.model.parameters_of(&(self.body_frame * turn / size * inverse)));
        }
    }

    /// Takes that back.
    pub(crate) fn show_turn(&mut self) {
        if std::mem::take(&mut self.turn_is_hidden) {
            self.unseen_in_body.pop();
        }
    }

    /// Whether a direction that cannot be seen holds a turn.
    pub(crate) fn turn_is_unseen(&self) -> bool {
        let Some(inverse) = self.body_frame.try_inverse() else { return false };
        self.unseen_in_body.iter().any(|direction| {
            let generator = self.model.generator(&direction[..self.information.k]);
            let centred = inverse * generator * self.body_frame;
            turn_rate(&centred).abs() > HOLDS_TURN
        })
    }

    /// Directions of the pose that the cells do not show, from their lever arms about their mean.
    pub(crate) fn find_unseen_directions(&mut self) {
        let count = self.cells.len() as f64;
        let centroid = Point2::from(self.cells.iter().map(|c| c.centre.coords / count).sum::<Vector2<f64>>());
        let spread = self.cells.iter().map(|c| (c.centre - centroid).norm_squared() / count).sum::<f64>().sqrt();
        let mut levers = SMatrix::<f64, MAX_PARAMETERS, MAX_PARAMETERS>::identity();
        levers.view_mut((0, 0), (self.information.k, self.information.k)).fill(0.0);
        // What errors of the normals alone would make of the levers.
        let mut levers_of_noise = SMatrix::<f64, MAX_PARAMETERS, MAX_PARAMETERS>::zeros();
        for (number, cell) in self.cells.iter().enumerate() {
            let (normal, variance) = self.normal_by_neighbours(number);
            let p = Point2::from((cell.centre - centroid) / spread);
            let velocities = |along| SVector::from(self.model.normal_velocities(&p, along));
            let (across, along) = (velocities(&normal), velocities(&Vector2::new(-normal.y, normal.x)));
            levers += across * across.transpose() / count;
            levers_of_noise += variance / count * along * along.transpose();
        }
        let eigen = levers.symmetric_eigen();
        let to_body = Matrix3::new(spread, 0.0, centroid.x, 0.0, spread, centroid.y, 0.0, 0.0, 1.0);
        self.unseen_in_body.clear();
        for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
            let of_noise = (vector.transpose() * levers_of_noise * vector)[(0, 0)];
            if *value < DEGENERATE.max(EXPLAINED * of_noise) {
                let generator = self.model.generator(&vector.as_slice()[..self.information.k]);
                let Some(inverse) = to_body.try_inverse() else { continue };
                self.unseen_in_body.push(self.model.parameters_of(&(to_body * generator * inverse)));
            }
        }
        self.body_frame = to_body;
        self.turn_is_hidden = false;
    }

    /// Normal of the outline at a cell, and the variance of its direction in rad squared, by the cells some way before and after it. Where
    /// cells err together this does not, as their own normals do: a circle would have its middle beside where it is.
    fn normal_by_neighbours(&self, number: usize) -> (Vector2<f64>, f64) {
        // Of the value of a quadratic in the middle of its window.
        let window = (2 * self.half_window + 1) as f64;
        let noise = self.sigma * (QUADRATIC / window).sqrt();
        let steps = (noise / (std::f64::consts::SQRT_2 * CHORD_NOISE * self.spacing)).ceil() as usize;
        let steps = steps.clamp(1, (self.cells.len() / FEWEST_PARTS).max(1));
        let [before, after] = [0, 1].map(|side| {
            let (mut last, mut here) = (number, self.cells[number].neighbours[side]);
            for _ in 1..steps {
                // Links may point either way.
                let [a, b] = self.cells[here].neighbours;
                let next = if a == last { b } else { a };
                if a == here || b == here {
                    break;
                }
                (last, here) = (here, next);
            }
            self.cells[here].centre
        });
        let chord = after - before;
        match chord.try_normalize(1e-12) {
            Some(along) => {
                (Vector2::new(along.y, -along.x), (2.0 * noise * noise / chord.norm_squared()).min(ANY_DIRECTION))
            }
            None => (self.cells[number].normal, ANY_DIRECTION),
        }
    }

    /// The same in the image, for the pose given.
    pub(crate) fn unseen_in_image(&self, pose: &Matrix3<f64>) -> Vec<Unseen> {
        if self.unseen_in_body.is_empty() {
            return Vec::new();
        }
        let k = self.information.k;
        let Some(inverse) = pose.try_inverse() else { return Vec::new() };
        let (ad, ad_inverse) = (self.model.adjoint(pose, &inverse), self.model.adjoint(&inverse, pose));
        // Duals in centred coordinates, where the directions are orthonormal.
        let to_body = self.body_frame;
        let Some(from_body) = to_body.try_inverse() else { return Vec::new() };
        let centring = self.model.adjoint(&from_body, &to_body);
        let list = self.unseen_in_body.iter().map(|u| {
            let mut direction = [0.0; MAX_PARAMETERS];
            let mut centred = [0.0; MAX_PARAMETERS];
            for i in 0..k {
                direction[i] = (0..k).map(|j| ad[i][j] * u[j]).sum();
                centred[i] = (0..k).map(|j| centring[i][j] * u[j]).sum();
            }
            let mut in_body = [0.0; MAX_PARAMETERS];
            let mut dual = [0.0; MAX_PARAMETERS];
            for j in 0..k {
                in_body[j] = (0..k).map(|i| centred[i] * centring[i][j]).sum();
            }
            for j in 0..k {
                dual[j] = (0..k).map(|i| in_body[i] * ad_inverse[i][j]).sum();
            }
            Unseen { direction, dual }
        });
        list.collect()
    }

    /// Of all poses that differ from one by what the outline does not show, the one that moves the least from the map's own.
    pub(crate) fn without_unseen(&self, pose: &Matrix3<f64>) -> Matrix3<f64> {
        let k = self.information.k;
        let mut pose = *pose;
        let inverses = (self.pose.try_inverse(), self.body_frame.try_inverse());
        let (Some(to_body), Some(to_centred)) = inverses else { return pose };
        for direction in &self.unseen_in_body {
            let generator = self.model.generator(&direction[..k]);
            let centred = self.model.parameters_of(&(to_centred * generator * self.body_frame));
            for _ in 0..LEAST_STEPS {
                let change = to_centred * to_body * pose * self.body_frame;
                let Some(step) = motion_between(self.model, &change, 1.0) else { break };
                let along: f64 = step.iter().zip(&centred).map(|(a, b)| a * b).sum();
                pose *= self.model.flow(&direction[..k], -along).into_inner();
            }
        }
        pose
    }

    /// Parameters, in image units, that take part in a motion which the outline does not show. The velocity at the origin of the image is
    /// one of them wherever the middle of a turn that is not seen is not there.
    pub(crate) fn blind_parameters(&self) -> [bool; MAX_PARAMETERS] {
        let mut blind = [false; MAX_PARAMETERS];
        let to_image = self.to_image();
        let Some(inverse) = to_image.try_inverse() else { return blind };
        let k = self.information.k;
        for unseen in self.unseen_in_image(&self.pose) {
            let generator = to_image * self.model.generator(&unseen.direction[..k]) * inverse;
            let direction = self.model.parameters_of(&generator);
            // In units of the object, so that lengths and angles compare.
            let sizes = direction.iter().zip(self.model.parameter_kinds()).map(|(entry, kind)| match kind {
                ParameterKind::Rate => entry.abs(),
                ParameterKind::Velocity => entry.abs() / self.radius,
                ParameterKind::Perspective => entry.abs() * self.radius,
            });
            let sizes: Vec<f64> = sizes.collect();
            let largest = sizes.iter().copied().fold(0.0, f64::max);
            for (blind, size) in blind.iter_mut().zip(sizes) {
                *blind |= size > TAKES_PART * largest;
            }
        }
        blind
    }
}
