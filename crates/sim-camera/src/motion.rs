use std::{fmt, sync::Arc};

use freeform_riccati::{
    AffineMotion, DynamicsError, FlowIntegrator, PinholeCamera, PlaneMotion, ProjectiveMotion, RigidMotion,
};
use nalgebra::{Matrix3, Projective2};

use crate::error::SimulationError;
use crate::trajectory::{Dynamics, Trajectory};

/// Longest step of the integrator for a varying motion, in seconds: changes shorter than that can be missed.
const LONGEST_STEP: f64 = 1.0 / 64.0;

/// Largest error of a step of the integrator, relative to the largest entry of its map.
const TOLERANCE: f64 = 1e-13;

type Generator = dyn Fn(f64) -> ProjectiveMotion + Send + Sync;

/// How the object moves in its plane, from time 0 on: an affine or projective motion, constant or changing with time.
#[derive(Clone)]
pub struct Motion {
    kind: Kind,
}

#[derive(Clone)]
enum Kind {
    Constant(ProjectiveMotion),
    /// Start of each phase in seconds, from 0 and increasing, and its motion.
    Piecewise(Vec<(f64, ProjectiveMotion)>),
    Trajectory(Trajectory),
    Plane(PlaneMotion, PinholeCamera),
    Varying(Arc<Generator>),
}

impl Motion {
    /// A constant motion.
    #[must_use]
    pub fn constant(motion: impl Into<ProjectiveMotion>) -> Self {
        Self { kind: Kind::Constant(motion.into()) }
    }

    /// Phases of constant motion, each given by its start in seconds and lasting until the next one; the last has no end.
    ///
    /// # Errors
    /// No phase, a first one that does not start at 0, starts that do not increase.
    pub fn piecewise<M: Into<ProjectiveMotion>>(phases: Vec<(f64, M)>) -> Result<Self, SimulationError> {
        let phases: Vec<(f64, ProjectiveMotion)> =
            phases.into_iter().map(|(start, motion)| (start, motion.into())).collect();
        if phases.first().is_none_or(|(start, _)| *start != 0.0) {
            return Err(SimulationError::NoFirstPhase);
        }
        let increases = |i: usize| phases[i].0.is_finite() && phases[i].0 > phases[i - 1].0;
        if let Some(index) = (1..phases.len()).find(|&i| !increases(i)) {
            return Err(SimulationError::PhaseOrder { index, start: phases[index].0 });
        }
        Ok(Self { kind: Kind::Piecewise(phases) })
    }

    /// That of a plane in space as a perspective camera sees it, in lengths of the picture. Its generator changes with the normal.
    #[must_use]
    pub fn of_plane(motion: PlaneMotion, camera: PinholeCamera) -> Self {
        Self { kind: Kind::Plane(motion, camera) }
    }

    /// A motion that is a smooth function of the time in seconds. Its flow is integrated by a [`FlowIntegrator`] to 1e-13
    /// in every step, in steps of at most 1/64 s.
    pub fn varying<M: Into<ProjectiveMotion>>(generator: impl Fn(f64) -> M + Send + Sync + 'static) -> Self {
        Self { kind: Kind::Varying(Arc::new(move |time| generator(time).into())) }
    }

    /// The motion in space of a plane that a perspective camera sees; `None` of a motion of the picture.
    #[must_use]
    pub fn plane(&self) -> Option<PlaneMotion> {
        match self.kind {
            Kind::Plane(plane, _) => Some(plane),
            _ => None,
        }
    }

    /// Whether the motion is known to be the same at all times.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        match &self.kind {
            Kind::Constant(_) => true,
            Kind::Trajectory(trajectory) => trajectory.dynamics() == Dynamics::Generator,
            Kind::Piecewise(phases) => phases.len() == 1,
            Kind::Plane(..) | Kind::Varying(_) => false,
        }
    }

    /// The motion at a time in seconds.
    #[must_use]
    pub fn at(&self, time: f64) -> ProjectiveMotion {
        match &self.kind {
            Kind::Constant(motion) => *motion,
            Kind::Piecewise(phases) => phases[phases.partition_point(|(start, _)| *start <= time).max(1) - 1].1,
            Kind::Trajectory(trajectory) => trajectory.motion(time).into(),
            Kind::Plane(plane, camera) => {
                ProjectiveMotion::of_generator(&camera.in_picture(&plane.after(time).generator()))
            }
            Kind::Varying(generator) => generator(time),
        }
    }

    /// The map of the plane that the motion makes between two times in seconds, the second not before the first. All NaN
    /// where [`try_flow`](Self::try_flow) has an error.
    #[must_use]
    pub fn flow(&self, from: f64, to: f64) -> Projective2<f64> {
        self.try_flow(from, to).unwrap_or_else(|_| Projective2::from_matrix_unchecked(Matrix3::repeat(f64::NAN)))
    }

    /// As `flow`, but an error if the motion cannot be integrated. The map may contain numbers that are not finite: a constant
    /// motion can carry the plane beyond the range of numbers.
    ///
    /// # Errors
    /// A varying motion that is not finite at some time between the two, or too rough to be integrated.
    pub fn try_flow(&self, from: f64, to: f64) -> Result<Projective2<f64>, DynamicsError> {
        Ok(match &self.kind {
            Kind::Constant(motion) => motion.flow(to - from),
            Kind::Piecewise(phases) => {
                let ends = phases.iter().skip(1).map(|(start, _)| *start).chain([f64::INFINITY]);
                let spans = phases.iter().zip(ends).map(|((start, m), end)| (start.max(from), end.min(to), m));
                let steps = spans.filter(|(start, end, _)| start < end).map(|(start, end, m)| m.flow(end - start));
                steps.fold(Projective2::identity(), |flow, step| step * flow)
            }
            Kind::Trajectory(trajectory) => match trajectory.dynamics() {
                Dynamics::Generator => nalgebra::convert(trajectory.motion(0.0).flow(to - from)),
                _ => nalgebra::convert(trajectory.pose(to) * trajectory.pose(from).inverse()),
            },
            Kind::Plane(plane, camera) => {
                let flow = plane.after(from).flow(to - from);
                Projective2::from_matrix_unchecked(camera.in_picture(flow.matrix()))
            }
            Kind::Varying(generator) => {
                let integrator = FlowIntegrator::new(TOLERANCE)?.with_longest_step(LONGEST_STEP)?;
                integrator.flow(|time| generator(time).generator(), from, to)?.map
            }
        })
    }
}

impl From<ProjectiveMotion> for Motion {
    fn from(motion: ProjectiveMotion) -> Self {
        Self::constant(motion)
    }
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

impl From<Trajectory> for Motion {
    fn from(trajectory: Trajectory) -> Self {
        Self { kind: Kind::Trajectory(trajectory) }
    }
}

impl fmt::Debug for Motion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.kind {
            Kind::Constant(motion) => f.debug_tuple("Constant").field(motion).finish(),
            Kind::Piecewise(phases) => f.debug_tuple("Piecewise").field(phases).finish(),
            Kind::Trajectory(trajectory) => trajectory.fmt(f),
            Kind::Plane(plane, camera) => f.debug_tuple("Plane").field(plane).field(camera).finish(),
            Kind::Varying(_) => f.write_str("Varying(..)"),
        }
    }
}
