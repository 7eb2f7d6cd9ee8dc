use std::time::Instant;

use freeform_estimate::{MotionEstimate, PlaneEstimate};
use freeform_sim_camera::Shape;
use nalgebra::{Point2, Projective2};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::estimator::{Estimator, Method};
use super::setting::{PlaneScene, Setting};
use super::statistics::{Cell, Outcome, ParameterError, Statistics};
use crate::ExperimentError;

/// Where an estimate takes the outline further astray than this share of its root mean square radius, the run is lost.
const ASTRAY: f64 = 0.25;
/// Places of the outline that this is judged by.
const PLACES: usize = 64;

/// How much is to be done for one setting.
pub(super) struct Effort<'a> {
    pub(super) shapes: &'a [Shape],
    pub(super) methods: &'a [Method],
    pub(super) runs: usize,
    pub(super) seed: u64,
    /// Called after every run.
    pub(super) progress: &'a (dyn Fn() + Sync),
}

impl Effort<'_> {
    /// Carries out every run of every shape, given by its position, over the cores. What comes back is in the order of the shapes, then of the runs,
    /// whatever the number of threads.
    pub(super) fn run_all<T: Send>(
        &self,
        run: impl Fn(usize, u64) -> Result<T, ExperimentError> + Sync,
    ) -> Result<Vec<Vec<T>>, ExperimentError> {
        let jobs = self.shapes.len() * self.runs;
        let results = (0..jobs).into_par_iter().map(|job| {
            let (shape, number) = (job / self.runs, job % self.runs);
            let result = run(shape, seed_of_run(self.seed, shape, number));
            (self.progress)();
            result
        });
        let mut results = results.collect::<Result<Vec<T>, ExperimentError>>()?.into_iter();
        Ok(self.shapes.iter().map(|_| results.by_ref().take(self.runs).collect()).collect())
    }
}

/// What was found in one setting.
#[derive(Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Evaluation {
    /// Where the runs were made.
    pub setting: Setting,
    /// What each method found.
    pub methods: Vec<MethodResult<Statistics>>,
}

/// What one method found.
#[derive(Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MethodResult<T> {
    /// The method.
    pub method: Method,
    /// For each shape, in the order of the study.
    pub shapes: Vec<T>,
    /// Over all shapes.
    pub pooled: T,
}

impl<T> MethodResult<T> {
    /// What was found of each shape under its name, then of all together under `pooled`, where there are several.
    pub fn by_shape<'a>(&'a self, names: &'a [String], pooled: &'a str) -> impl Iterator<Item = (&'a str, &'a T)> {
        let all = (names.len() > 1).then_some((pooled, &self.pooled));
        names.iter().map(String::as_str).zip(&self.shapes).chain(all)
    }
}

/// All runs of one setting.
pub(super) fn evaluate(setting: &Setting, effort: &Effort<'_>) -> Result<Evaluation, ExperimentError> {
    let bounds: Vec<Vec<Option<f64>>> =
        effort.shapes.par_iter().map(|shape| setting.bound(shape)).collect::<Result<_, _>>()?;
    let outcomes = effort.run_all(|index, seed| {
        let observable = bounds[index].iter().all(Option::is_some);
        run(setting, effort.methods, &effort.shapes[index], observable, seed)
    })?;
    let methods = effort.methods.iter().enumerate().map(|(index, &method)| {
        let of_method = |runs: &Vec<Vec<Outcome>>| runs.iter().map(|outcomes| outcomes[index].clone()).collect();
        let cells: Vec<Cell> = bounds
            .iter()
            .zip(&outcomes)
            .map(|(bounds, runs)| Cell { bounds: bounds.clone(), outcomes: of_method(runs) })
            .collect();
        let shapes = cells.iter().map(|cell| Statistics::of(std::slice::from_ref(cell))).collect();
        MethodResult { method, shapes, pooled: Statistics::of(&cells) }
    });
    Ok(Evaluation { setting: setting.clone(), methods: methods.collect() })
}

/// One sequence, seen by every method. Where a parameter cannot be observed no estimate is astray: nothing says where it should go.
fn run(
    setting: &Setting,
    methods: &[Method],
    shape: &Shape,
    observable: bool,
    seed: u64,
) -> Result<Vec<Outcome>, ExperimentError> {
    let simulator = setting.simulator(shape, seed)?;
    let started: Vec<Estimator> = methods.iter().map(|method| estimator(setting, *method)).collect::<Result<_, _>>()?;
    let mut at_work: Vec<(Estimator, Outcome)> = started.into_iter().map(|e| (e, Outcome::default())).collect();
    for frame in simulator.frames() {
        for (estimator, outcome) in &mut at_work {
            let start = Instant::now();
            let used = estimator.push(frame.time, &frame.outline);
            outcome.seconds += start.elapsed().as_secs_f64();
            outcome.frames += 1;
            outcome.rejected += usize::from(!used);
        }
    }
    let finished = at_work.into_iter().map(|(estimator, mut outcome)| {
        let start = Instant::now();
        let (estimate, plane) = (estimator.estimate(), estimator.plane());
        outcome.seconds += start.elapsed().as_secs_f64();
        let of_plane = plane.filter(|e| !(observable && is_plane_astray(setting, shape, e)));
        outcome.errors = estimate
            .filter(|e| !(observable && is_astray(setting, shape, e)))
            .map(|e| errors(setting, &e))
            .or_else(|| of_plane.map(|e| errors_of_plane(setting, &e)));
        outcome
    });
    Ok(finished.collect())
}

/// A method that has seen nothing yet, for what is to be identified.
fn estimator(setting: &Setting, method: Method) -> Result<Estimator, ExperimentError> {
    match &setting.plane {
        Some(plane) => Estimator::of_plane(method, plane.camera),
        None => Estimator::new(method, setting.model),
    }
}

fn errors_of_plane(setting: &Setting, estimate: &PlaneEstimate) -> Vec<Option<ParameterError>> {
    let (values, covariance) = (estimate.motion().parameters(), estimate.covariance());
    let error = |index: usize, truth: f64| ParameterError {
        error: values[index] - truth,
        deviation: Some(covariance[(index, index)].max(0.0).sqrt()),
    };
    let truth = setting.truth().into_iter().enumerate();
    truth.map(|(index, truth)| estimate.known()[index].then(|| error(index, truth))).collect()
}

/// As [`is_astray`], of a plane in space.
fn is_plane_astray(setting: &Setting, shape: &Shape, estimate: &PlaneEstimate) -> bool {
    let Some(plane) = setting.plane.as_ref().filter(|_| estimate.known().iter().all(|known| *known)) else {
        return false;
    };
    let found = PlaneScene { motion: *estimate.motion(), ..*plane };
    let found = Setting { plane: Some(found), ..setting.clone() };
    let duration = setting.duration();
    let start = setting.scene(shape).true_pose(0.0);
    let places: Vec<_> = shape.sample(PLACES, 0.0).iter().map(|p| start * p).collect();
    leads_astray(&places, &setting.flow(duration), &found.flow(duration))
}

fn errors(setting: &Setting, estimate: &MotionEstimate) -> Vec<Option<ParameterError>> {
    let error = |truth: f64, value: f64, deviation| ParameterError { error: value - truth, deviation };
    let found = estimate.parameters().zip(setting.truth());
    found.map(|(p, truth)| p.value.map(|value| error(truth, value, p.standard_deviation))).collect()
}

/// Whether the estimate takes the outline elsewhere than it really goes, over the time of the sequence. An estimate of which a
/// parameter is unknown is not judged.
fn is_astray(setting: &Setting, shape: &Shape, estimate: &MotionEstimate) -> bool {
    if estimate.parameters().any(|p| p.value.is_none()) {
        return false;
    }
    let duration = setting.duration();
    let (truth, found) = (setting.motion.flow(duration), setting.model.flow(estimate.values(), duration));
    leads_astray(&shape.sample(PLACES, 0.0), &truth, &found)
}

/// Whether a map leads places elsewhere than the true one.
fn leads_astray(places: &[Point2<f64>], truth: &Projective2<f64>, found: &Projective2<f64>) -> bool {
    let moved: Vec<_> = places.iter().map(|p| truth * p).collect();
    let off: f64 = places.iter().zip(&moved).map(|(p, truth)| (found.transform_point(p) - truth).norm_squared()).sum();
    let centre = moved.iter().map(|p| p.coords / PLACES as f64).sum::<nalgebra::Vector2<f64>>();
    let radius: f64 = moved.iter().map(|p| (p.coords - centre).norm_squared()).sum();
    off.is_nan() || off > ASTRAY * ASTRAY * radius
}

/// Independent of the number of shapes and runs, so that more of either leave the others as they were.
fn seed_of_run(seed: u64, shape: usize, run: usize) -> u64 {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(((shape as u64) << 32) | run as u64);
    rng.random()
}
