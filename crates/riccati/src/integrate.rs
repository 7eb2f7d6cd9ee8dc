use nalgebra::{Matrix3, Projective2};

use crate::{error::DynamicsError, exponential::exponential};

pub(crate) const SMALLEST_TOLERANCE: f64 = 1e-14;
pub(crate) const LARGEST_TOLERANCE: f64 = 1e-2;

/// Order of the steps.
const ORDER: i32 = 6;

/// Integrates the flow `T' = A(t) T` of a motion that changes with time, by exponentials of its own (Magnus expansion of
/// order 6 at three Gauss nodes; S. Blanes, F. Casas, J. A. Oteo, J. Ros, The Magnus expansion and some of its
/// applications, 2009), with steps that adapt. Rigid motions stay rigid exactly. For a constant motion use its closed form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlowIntegrator {
    tolerance: f64,
    longest_step: f64,
}

/// The map that a motion makes between two times, and what it took to find it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IntegratedFlow {
    /// Takes a point at the first time to where it is at the last; the last row is exactly `(0, 0, 1)` if that of every
    /// generator is zero.
    pub map: Projective2<f64>,
    /// Steps taken.
    pub steps: usize,
    /// Steps tried and found too long.
    pub rejected_steps: usize,
}

impl FlowIntegrator {
    /// With an error per step of at most `tolerance` in each entry of the step's map, relative to its largest entry where
    /// that is above 1. Between 1e-14 and 1e-2.
    ///
    /// # Errors
    /// A tolerance outside that range.
    pub fn new(tolerance: f64) -> Result<Self, DynamicsError> {
        if !(SMALLEST_TOLERANCE..=LARGEST_TOLERANCE).contains(&tolerance) {
            return Err(DynamicsError::Tolerance { tolerance });
        }
        Ok(Self { tolerance, longest_step: f64::INFINITY })
    }

    /// With no step longer than this many seconds. Without it the first step is the whole interval, whose nine samples can
    /// miss a short event.
    ///
    /// # Errors
    /// A step that is not positive.
    pub fn with_longest_step(self, seconds: f64) -> Result<Self, DynamicsError> {
        if seconds > 0.0 {
            Ok(Self { longest_step: seconds, ..self })
        } else {
            Err(DynamicsError::LongestStep { step: seconds })
        }
    }

    /// The flow from one time to another in seconds, forwards or backwards. `generator` gives A(t), per second.
    ///
    /// # Errors
    /// A generator (or time) that is not finite, or one so rough that no step meets the tolerance.
    pub fn flow(
        &self,
        generator: impl Fn(f64) -> Matrix3<f64>,
        from: f64,
        to: f64,
    ) -> Result<IntegratedFlow, DynamicsError> {
        if let Some(&time) = [from, to].iter().find(|t| !t.is_finite()) {
            return Err(DynamicsError::GeneratorNotFinite { time });
        }
        let mut map = Matrix3::identity();
        let (mut steps, mut rejected_steps) = (0, 0);
        let mut time = from;
        let mut step = to - from;
        while time != to {
            step = step.clamp(-self.longest_step, self.longest_step);
            let remaining = to - time;
            // Two equal steps at the end, never a long one and a sliver.
            if remaining.abs() <= step.abs() {
                step = remaining;
            } else if remaining.abs() < 2.0 * step.abs() {
                step = 0.5 * remaining;
            }
            let next = if step == remaining { to } else { time + step };
            // Even the midpoints of the halves must be different times.
            if time + step / 8.0 == time || !step.is_finite() {
                return Err(DynamicsError::StepTooSmall { time, step });
            }
            let whole = magnus_step(&generator, time, step)?;
            let half = 0.5 * step;
            let halves = magnus_step(&generator, time + half, half)? * magnus_step(&generator, time, half)?;
            let error = (whole - halves).amax() / halves.amax().max(1.0);
            let factor =
                if error > 0.0 { 0.9 * (self.tolerance / error).powf(1.0 / f64::from(ORDER + 1)) } else { 5.0 };
            // A NaN, from a step so long that its exponential overflows, fails this comparison as well.
            if error <= self.tolerance {
                map = halves * map;
                time = next;
                steps += 1;
                step *= factor.clamp(0.2, 5.0);
            } else {
                rejected_steps += 1;
                step *= if factor.is_finite() { factor.clamp(0.2, 0.9) } else { 0.2 };
            }
        }
        Ok(IntegratedFlow { map: Projective2::from_matrix_unchecked(map), steps, rejected_steps })
    }
}

/// One step `expm(Omega)` of length h from t.
fn magnus_step(generator: &impl Fn(f64) -> Matrix3<f64>, t: f64, h: f64) -> Result<Matrix3<f64>, DynamicsError> {
    let sample = |node: f64| {
        let time = t + node * h;
        let a = generator(time);
        if a.iter().all(|e| e.is_finite()) { Ok(a) } else { Err(DynamicsError::GeneratorNotFinite { time }) }
    };
    let commutator = |a: &Matrix3<f64>, b: &Matrix3<f64>| a * b - b * a;
    let root = 15.0_f64.sqrt();
    let (first, middle, last) = (sample(0.5 - root / 10.0)?, sample(0.5)?, sample(0.5 + root / 10.0)?);
    let alpha1 = middle * h;
    let alpha2 = (last - first) * (root * h / 3.0);
    let alpha3 = (last - middle * 2.0 + first) * (10.0 * h / 3.0);
    let c1 = commutator(&alpha1, &alpha2);
    let c2 = commutator(&alpha1, &(alpha3 * 2.0 + c1)) / -60.0;
    let omega = alpha1 + alpha3 / 12.0 + commutator(&(alpha1 * -20.0 - alpha3 + c1), &(alpha2 + c2)) / 240.0;
    Ok(exponential(&omega))
}
