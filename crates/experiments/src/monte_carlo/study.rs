use freeform_sim_camera::Shape;

use super::acquisition::{self, Acquisition, AcquisitionSetting};
use super::estimator::Method;
use super::evaluation::{self, Effort, Evaluation};
use super::setting::Setting;
use crate::ExperimentError;

/// What is to be simulated and identified.
#[derive(Debug, Clone)]
pub struct Study {
    /// The objects, each in every setting.
    pub shapes: Vec<Shape>,
    /// Sequences in which the motion is identified.
    pub settings: Vec<Setting>,
    /// Pairs of frames of which the second pose is found.
    pub acquisitions: Vec<AcquisitionSetting>,
    /// The methods, which all see the same sequences.
    pub methods: Vec<Method>,
    /// Sequences of each shape and setting, at least 1.
    pub runs: usize,
    /// Pairs of frames of each shape and acquisition, at least 1.
    pub acquisition_runs: usize,
    /// Everything random follows from it.
    pub seed: u64,
}

/// What was found by all runs of a [`Study`].
#[derive(Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Report {
    /// Names of the shapes.
    pub shapes: Vec<String>,
    /// Sequences of each shape and setting.
    pub runs: usize,
    /// What everything random followed from.
    pub seed: u64,
    /// One for each setting.
    pub evaluations: Vec<Evaluation>,
    /// One for each acquisition.
    pub acquisitions: Vec<Acquisition>,
}

impl Study {
    /// Whether everything can be simulated.
    ///
    /// # Errors
    /// The first that the simulator refuses.
    pub fn check(&self) -> Result<(), ExperimentError> {
        self.shapes.iter().try_for_each(|shape| {
            self.settings.iter().try_for_each(|setting| setting.simulator(shape, 0).map(drop))?;
            self.acquisitions.iter().try_for_each(|setting| setting.check(shape))
        })
    }

    /// Runs in all: how often [`run`](Self::run) calls its `progress`.
    #[must_use]
    pub fn run_count(&self) -> usize {
        self.shapes.len() * (self.settings.len() * self.runs + self.acquisitions.len() * self.acquisition_runs)
    }

    /// Carries out every run, over the threads of the present rayon pool. `progress` is called after each, from any of them.
    ///
    /// # Errors
    /// What the simulator or a method refuses.
    pub fn run(&self, progress: &(dyn Fn() + Sync)) -> Result<Report, ExperimentError> {
        let effort = |runs| Effort { shapes: &self.shapes, methods: &self.methods, runs, seed: self.seed, progress };
        let evaluations = self.settings.iter().map(|setting| evaluation::evaluate(setting, &effort(self.runs)));
        let evaluations = evaluations.collect::<Result<_, _>>()?;
        let acquisitions =
            self.acquisitions.iter().map(|setting| acquisition::evaluate(setting, &effort(self.acquisition_runs)));
        let shapes = self.shapes.iter().map(|shape| shape.name().to_owned()).collect();
        let acquisitions = acquisitions.collect::<Result<_, _>>()?;
        Ok(Report { shapes, runs: self.runs, seed: self.seed, evaluations, acquisitions })
    }
}

impl Report {
    /// Whether motions were to be identified, and nothing else, and every run of every method was lost.
    #[must_use]
    pub fn is_all_lost(&self) -> bool {
        let all_lost = |evaluation: &Evaluation| evaluation.methods.iter().all(|m| m.pooled.lost == m.pooled.runs);
        !self.evaluations.is_empty() && self.acquisitions.is_empty() && self.evaluations.iter().all(all_lost)
    }
}
