//! The least-squares leading form that is nowhere below a floor on the unit circle, by an active-set method: Newton steps on
//! the directions where the form touches the floor.
//!
//! Over the coefficients c of the form the problem is `min |W c - w|^2 / 2` with `phi(t)' c >= floor` for all directions t,
//! `phi = (cos^n, cos^(n-1) sin, ..., sin^n)`. At the solution finitely many constraints are active, at most n/2:
//! `W' (W c - w) = sum m_k phi(t_k)`, with multipliers `m_k >= 0`, the value `phi(t_k)' c = floor` and, as that is a minimum,
//! the slope `phi'(t_k)' c = 0`. These equations in t and m are solved by Newton's method.
use nalgebra::{Const, DimMin, SMatrix, SVector};

use crate::{
    leading_form::{CircleRange, CircleSamples, turned_by},
    least_squares::TriangularSystem,
};

/// Half the degree of an octic.
const MAX_ACTIVE: usize = 4;
/// How often a constraint may be added to the active set or dropped from it.
const MAX_ROUNDS: usize = 8;
const MAX_ITERATIONS: usize = 20;
/// Radians by which an active direction may turn in one iteration.
const LARGEST_TURN: f64 = 0.2;
/// Radians: active directions that turn by less in an iteration have converged, as the next turn would be the square of it.
const CONVERGED: f64 = 1e-9;
/// Radians: closer active directions are one direction, or about to become one, and their equations are nearly singular.
const CLOSEST: f64 = 0.02;
/// Fraction of the floor by which the form may stay under it, through rounding.
const TOLERANCE: f64 = 1e-11;

/// The problem in the coordinates `W c`, where distances are plain.
pub(crate) struct ActiveSetProblem<const FORM: usize> {
    /// `W^-1`, upper triangular.
    unwhiten: SMatrix<f64, FORM, FORM>,
    /// The unconstrained solution w.
    target: SVector<f64, FORM>,
    floor: f64,
}

/// Directions where the form touches the floor, and their multipliers.
#[derive(Clone, Copy)]
struct ActiveSet {
    count: usize,
    directions: [[f64; 2]; MAX_ACTIVE],
    multipliers: [f64; MAX_ACTIVE],
}

impl<const FORM: usize> ActiveSetProblem<FORM> {
    /// For the leading form that starts at coefficient `first`.
    pub(crate) fn new(system: &TriangularSystem, first: usize, floor: f64) -> Self {
        let mut unwhiten = SMatrix::<f64, FORM, FORM>::zeros();
        for column in 0..FORM {
            unwhiten[(column, column)] = 1.0 / system.upper(first + column, first + column);
            for row in (0..column).rev() {
                let sum: f64 =
                    (row + 1..=column).map(|k| system.upper(first + row, first + k) * unwhiten[(k, column)]).sum();
                unwhiten[(row, column)] = -sum * unwhiten[(row, row)];
            }
        }
        Self { unwhiten, target: SVector::from_fn(|i, _| system.right()[first + i]), floor }
    }

    /// The form and its range; `None` if the iteration does not end in a point that is certainly the solution.
    pub(crate) fn solve(&self) -> Option<([f64; FORM], CircleRange)> {
        let mut active = self.first_active_set();
        for _ in 0..MAX_ROUNDS {
            let solution = self.touch(&mut active)?;
            if active.drop_negative() {
                continue;
            }
            let form: [f64; FORM] = (self.unwhiten * solution).into();
            let samples = CircleSamples::of(&form);
            let lowest = samples.minima(&form).min_by(|a, b| a.value.total_cmp(&b.value))?;
            if lowest.value >= self.floor * (1.0 - TOLERANCE) {
                return Some((form, samples.range_above(lowest.value)));
            }
            active.add(lowest.direction)?;
        }
        None
    }

    /// The single constraint that moves the form furthest from the unconstrained solution.
    fn first_active_set(&self) -> ActiveSet {
        let unconstrained: [f64; FORM] = (self.unwhiten * self.target).into();
        let force = |direction: [f64; 2], value: f64| {
            let missing = (self.floor - value).max(0.0);
            missing * missing / self.whitened(&powers(direction)).norm_squared()
        };
        let samples = CircleSamples::of(&unconstrained);
        let mut best = ([1.0, 0.0], 0.0);
        for sample in samples.iter() {
            let force = force(sample.direction, sample.value);
            if force > best.1 {
                best = (sample.direction, force);
            }
        }
        let mut active = ActiveSet { count: 1, directions: [best.0; MAX_ACTIVE], multipliers: [0.0; MAX_ACTIVE] };
        let first = self.whitened(&powers(best.0));
        active.multipliers[0] = (self.floor - first.dot(&self.target)) / first.norm_squared();
        active
    }

    /// Turns the active directions until the form touches the floor there; returns the form in whitened coordinates.
    fn touch(&self, active: &mut ActiveSet) -> Option<SVector<f64, FORM>> {
        match active.count {
            1 => self.newton::<1, 2>(active),
            2 => self.newton::<2, 4>(active),
            3 => self.newton::<3, 6>(active),
            _ => self.newton::<4, 8>(active),
        }
    }

    /// Newton's method for COUNT active directions, in UNKNOWNS = 2 COUNT turns and multipliers.
    fn newton<const COUNT: usize, const UNKNOWNS: usize>(&self, active: &mut ActiveSet) -> Option<SVector<f64, FORM>>
    where
        Const<UNKNOWNS>: DimMin<Const<UNKNOWNS>, Output = Const<UNKNOWNS>>,
    {
        for _ in 0..MAX_ITERATIONS {
            // phi, phi' and phi'' at each active direction, whitened.
            let touched: [[SVector<f64, FORM>; 3]; COUNT] = std::array::from_fn(|k| {
                let phi = powers(active.directions[k]);
                let slope = derivative(&phi);
                [self.whitened(&phi), self.whitened(&slope), self.whitened(&derivative(&slope))]
            });
            let forces = touched.iter().zip(&active.multipliers).map(|([phi, ..], m)| phi * *m);
            let solution = forces.fold(self.target, |sum, force| sum + force);
            let mut jacobian = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::zeros();
            let mut residual = SVector::<f64, UNKNOWNS>::zeros();
            for (k, [phi, slope, curvature]) in touched.iter().enumerate() {
                residual[k] = phi.dot(&solution) - self.floor;
                residual[COUNT + k] = slope.dot(&solution);
                jacobian[(k, k)] = residual[COUNT + k];
                jacobian[(COUNT + k, k)] = curvature.dot(&solution);
                for (j, [other, other_slope, _]) in touched.iter().enumerate() {
                    let multiplier = active.multipliers[j];
                    jacobian[(k, j)] += multiplier * phi.dot(other_slope);
                    jacobian[(COUNT + k, j)] += multiplier * slope.dot(other_slope);
                    jacobian[(k, COUNT + j)] = phi.dot(other);
                    jacobian[(COUNT + k, COUNT + j)] = slope.dot(other);
                }
            }
            let step = jacobian.lu().solve(&residual)?;
            let turn = step.fixed_rows::<COUNT>(0).amax();
            if !turn.is_finite() {
                return None;
            }
            let length = (LARGEST_TURN / turn).min(1.0);
            for k in 0..COUNT {
                active.directions[k] = turned_by(active.directions[k], -length * step[k]);
                active.multipliers[k] -= length * step[COUNT + k];
            }
            if turn < CONVERGED {
                // What this last step changes is the square of it.
                let correction = touched
                    .iter()
                    .enumerate()
                    .map(|(k, [phi, slope, _])| -(phi * step[COUNT + k] + slope * (active.multipliers[k] * step[k])));
                return Some(correction.fold(solution, |sum, change| sum + change));
            }
        }
        None
    }

    /// `W^-T phi`.
    fn whitened(&self, phi: &SVector<f64, FORM>) -> SVector<f64, FORM> {
        let mut whitened = SVector::<f64, FORM>::zeros();
        for column in 0..FORM {
            whitened[column] = (0..=column).map(|row| self.unwhiten[(row, column)] * phi[row]).sum();
        }
        whitened
    }
}

impl ActiveSet {
    /// Drops the constraint with the most negative multiplier, if there is one.
    fn drop_negative(&mut self) -> bool {
        let multipliers = self.multipliers[..self.count].iter().enumerate();
        let Some((worst, &multiplier)) = multipliers.min_by(|a, b| a.1.total_cmp(b.1)) else { return false };
        if multiplier >= 0.0 || self.count == 1 {
            return false;
        }
        self.count -= 1;
        self.directions.copy_within(worst + 1.., worst);
        self.multipliers.copy_within(worst + 1.., worst);
        true
    }

    /// Adds a direction with multiplier 0; `None` if it is too near another one or the set is full.
    fn add(&mut self, direction: [f64; 2]) -> Option<()> {
        let [x, y] = direction;
        let is_near = |other: &[f64; 2]| (x * other[1] - y * other[0]).abs() < CLOSEST;
        if self.count == MAX_ACTIVE || self.directions[..self.count].iter().any(is_near) {
            return None;
        }
        self.directions[self.count] = direction;
        self.multipliers[self.count] = 0.0;
        self.count += 1;
        Some(())
    }
}

/// `phi = (cos^n, cos^(n-1) sin, ..., sin^n)`.
fn powers<const FORM: usize>([cos, sin]: [f64; 2]) -> SVector<f64, FORM> {
    let mut phi = SVector::<f64, FORM>::repeat(1.0);
    for j in 1..FORM {
        phi[j] = phi[j - 1] * sin;
    }
    let mut power = 1.0;
    for j in (0..FORM).rev() {
        phi[j] *= power;
        power *= cos;
    }
    phi
}

/// Derivative by the angle of a combination of the powers: `(cos^i sin^j)' = j cos^(i+1) sin^(j-1) - i cos^(i-1) sin^(j+1)`.
fn derivative<const FORM: usize>(phi: &SVector<f64, FORM>) -> SVector<f64, FORM> {
    SVector::from_fn(|j, _| {
        let i = FORM - 1 - j;
        let before = if j > 0 { j as f64 * phi[j - 1] } else { 0.0 };
        let after = if i > 0 { i as f64 * phi[j + 1] } else { 0.0 };
        before - after
    })
}
