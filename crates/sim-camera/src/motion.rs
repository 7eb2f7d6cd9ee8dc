use std::{fmt, sync::Arc};

use freeform_riccati::{AffineMotion, RigidMotion};
use nalgebra::{Affine2, Matrix3};

use crate::error::SimulationError;

/// Longest step of the integrator for a varying motion, in seconds.
const LONGEST_STEP: f64 = 1.0 / 512.0;

type Generator = dyn Fn(f64) -> AffineMotion + Send + Sync;

/// How the object moves in its plane, from time 0 on: an affine motion, constant or changing with time.
#[derive(Clone)]
pub struct Motion {
    kind: Kind,
}

#[derive(Clone)]
enum Kind {
    Constant(AffineMotion),
    /// Start of each phase in seconds, from 0 and increasing, and its motion.
    Piecewise(Vec<(f64, AffineMotion)>),
    Varying(Arc<Generator>),
}

impl Motion {
    /// The same motion all the time.
    #[must_use]
    pub fn constant(motion: impl Into<AffineMotion>) -> Self {
        Self { kind: Kind::Constant(motion.into()) }
    }

    /// Phases of constant motion, each given by its start in seconds and lasting until the next one; the last has no end.
    ///
    /// # Errors
    /// No phase, a first one that does not start at 0, starts that do not increase.
    pub fn piecewise(phases: Vec<(f64, AffineMotion)>) -> Result<Self, SimulationError> {
        if phases.first().is_none_or(|(start, _)| *start != 0.0) {
            return Err(SimulationError::NoFirstPhase);
        }
        let increases = |i: usize| phases[i].0.is_finite() && phases[i].0 > phases[i - 1].0;
        if let Some(index) = (1..phases.len()).find(|&i| !increases(i)) {
            return Err(SimulationError::PhaseOrder { index, start: phases[index].0 });
        }
        Ok(Self { kind: Kind::Piecewise(phases) })
    }

    /// A motion that is a smooth function of the time in seconds. Its flow is integrated by the Magnus method of fourth
    /// order in steps of at most 1/512 s.
    pub fn varying(generator: impl Fn(f64) -> AffineMotion + Send + Sync + 'static) -> Self {
        Self { kind: Kind::Varying(Arc::new(generator)) }
    }

    /// The motion at a time in seconds.
    #[must_use]
    pub fn at(&self, time: f64) -> AffineMotion {
        match &self.kind {
            Kind::Constant(motion) => *motion,
            Kind::Piecewise(phases) => phases[phases.partition_point(|(start, _)| *start <= time).max(1) - 1].1,
            Kind::Varying(generator) => generator(time),
        }
    }

    /// The map of the plane that the motion makes between two times in seconds, the second not before the first.
    #[must_use]
    pub fn flow(&self, from: f64, to: f64) -> Affine2<f64> {
        match &self.kind {
            Kind::Constant(motion) => motion.flow(to - from),
            Kind::Piecewise(phases) => {
                let ends = phases.iter().skip(1).map(|(start, _)| *start).chain([f64::INFINITY]);
                let spans = phases.iter().zip(ends).map(|((start, m), end)| (start.max(from), end.min(to), m));
                let steps = spans.filter(|(start, end, _)| start < end).map(|(start, end, m)| m.flow(end - start));
                steps.fold(Affine2::identity(), |flow, step| step * flow)
            }
            Kind::Varying(generator) => {
                let steps = ((to - from) / LONGEST_STEP).ceil().max(1.0);
                let step = (to - from) / steps;
                let matrices =
                    (0..steps as usize).map(|k| magnus_step(generator.as_ref(), from + k as f64 * step, step));
                Affine2::from_matrix_unchecked(matrices.fold(Matrix3::identity(), |flow, m| m * flow))
            }
        }
    }
}

/// `expm(h/2 (A1 + A2) + sqrt3/12 h^2 [A2, A1])` with A at the two Gauss points of the step
/// (Iserles, Munthe-Kaas, Norsett, Zanna, Lie-group methods, 2000).
fn magnus_step(generator: &Generator, start: f64, h: f64) -> Matrix3<f64> {
    let offset = 3.0_f64.sqrt() / 6.0;
    let first = generator(start + (0.5 - offset) * h).generator();
    let second = generator(start + (0.5 + offset) * h).generator();
    let commutator = second * first - first * second;
    (0.5 * h * (first + second) + 0.5 * offset * h * h * commutator).exp()
}

impl From<AffineMotion> for Motion {
    fn from(motion: AffineMotion) -> Self {
        Self::constant(motion)
    }
}

impl From<RigidMotion> for Motion {
    fn from(motion: RigidMotion) -> Self {
        Self::constant(motion)
    }
}

impl fmt::Debug for Motion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.kind {
            Kind::Constant(motion) => f.debug_tuple("Constant").field(motion).finish(),
            Kind::Piecewise(phases) => f.debug_tuple("Piecewise").field(phases).finish(),
            Kind::Varying(_) => f.write_str("Varying(..)"),
        }
    }
}
