//! Random problems on which the filter and the reference are compared.
use freeform_riccati::{MAX_PARAMETERS, MotionModel, ParameterVector};
use proptest::prelude::*;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;

use crate::{
    belief::{Arrowhead, Belief, StateMatrix},
    measurement::Measurement,
};

/// Something believed of an object, and chance for all that happens to it.
#[derive(Debug, Clone)]
pub(crate) struct Problem {
    pub(crate) belief: Belief,
    pub(crate) rng: ChaCha8Rng,
}

impl Problem {
    /// Any model, with pose, motion, 3 to 12 cells and what is known of them drawn at random.
    pub(crate) fn any() -> impl Strategy<Value = Self> {
        (0..MotionModel::ALL.len(), 3..13_usize, any::<u64>())
            .prop_map(|(model, cells, seed)| Self::of(MotionModel::ALL[model], cells, seed))
    }

    pub(crate) fn of(model: MotionModel, cells: usize, seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let k = model.parameter_count();
        let mut belief = Belief::new(model);
        belief.motion = random_motion(&mut rng, model);
        belief.pose = model.flow(&random_motion(&mut rng, model)[..k], 1.0).into_inner();
        belief.memory.advance(0.1);
        let Arrowhead { dense, cells: of_cells, .. } = &mut belief.information;
        (0..2 * k).for_each(|i| dense[i][i] = rng.random_range(0.5..2.0));
        of_cells.resize(cells);
        for (own, coupling) in of_cells.iter_mut() {
            *own = rng.random_range(0.2..2.0);
            for _ in 0..rng.random_range(1..4) {
                // What was measured before has come to tell of the motion too.
                let row: Vec<f64> = (0..2 * k).map(|_| rng.random_range(-1.0..1.0)).collect();
                let by_offset = rng.random_range(0.5..1.5);
                for (i, a) in row.iter().enumerate() {
                    row.iter().enumerate().for_each(|(j, b)| dense[i][j] += a * b);
                    coupling[i] += by_offset * a;
                }
                *own += by_offset * by_offset;
            }
        }
        belief.offsets = (0..cells).map(|_| rng.random_range(-0.1..0.1)).collect();
        belief.marginal = belief.information.marginal();
        Self { belief, rng }
    }

    /// A covariance of pose and motion of any rank.
    pub(crate) fn covariance(&mut self) -> StateMatrix {
        let size = 2 * self.belief.parameter_count();
        let mut covariance = StateMatrix::zeros();
        for _ in 0..self.rng.random_range(1..=size) {
            let direction: Vec<f64> = (0..size).map(|_| self.rng.random_range(-0.5..0.5)).collect();
            for (i, a) in direction.iter().enumerate() {
                direction.iter().enumerate().for_each(|(j, b)| covariance[(i, j)] += a * b);
            }
        }
        covariance
    }

    /// Seconds of a step.
    pub(crate) fn seconds(&mut self) -> f64 {
        self.rng.random_range(0.01..0.5)
    }
}

/// So many measurements, each of one of the cells numbered by `cells`, with residuals of the size of the noise.
pub(crate) fn random_measurements(
    rng: &mut ChaCha8Rng,
    k: usize,
    cells: std::ops::Range<usize>,
    count: usize,
) -> Vec<Measurement> {
    let draw = |_| {
        let mut jacobian = [0.0; MAX_PARAMETERS];
        jacobian[..k].iter_mut().for_each(|entry| *entry = rng.random_range(-1.0..1.0));
        Measurement {
            cell: rng.random_range(cells.clone()),
            residual: rng.random_range(-1.0..1.0),
            by_offset: rng.random_range(0.5..1.5),
            jacobian,
            weight: rng.random_range(0.1..1.0),
        }
    };
    (0..count).map(draw).collect()
}

fn random_motion(rng: &mut ChaCha8Rng, model: MotionModel) -> ParameterVector {
    let mut motion = [0.0; MAX_PARAMETERS];
    motion[..model.parameter_count()].iter_mut().for_each(|entry| *entry = rng.random_range(-1.0..1.0));
    // A strong perspective would take points through infinity.
    motion[6..].iter_mut().for_each(|c| *c *= 0.2);
    motion
}
