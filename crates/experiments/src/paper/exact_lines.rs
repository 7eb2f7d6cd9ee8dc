//! Lines that move exactly with an object of the paper, and what a law does over them: error of its estimator and Lyapunov function.
use freeform_curve_fit::{Fitter, Normalisation};
use freeform_decompose::{Decomposition, Line};
use freeform_estimate::MotionEstimate;
use freeform_identify::{AdaptiveIdentifier, AdaptiveLaw, AdaptiveSettings, PairChoice, plant_matrices};
use freeform_motion::{PipelineError, PipelineSettings};
use freeform_riccati::{AffineMotion, MotionModel, line_flow};
use freeform_sim_camera::{PaperExperiment, SequenceLength, Settings};
use nalgebra::{Matrix3, SMatrix};

use super::sequence::{Sequence, paper_settings};
use crate::ExperimentError;

/// The lines of an object in the coordinates of the identifier, and how they move.
pub(super) struct ExactLines {
    start: Vec<Line>,
    truth: MotionEstimate,
}

/// What a law is doing at a time.
#[derive(Debug, Clone, Copy)]
pub(super) struct LawState {
    /// In seconds.
    pub(super) time: f64,
    /// Norm of e = Xh - X, or of the error of the filtered regression.
    pub(super) error: f64,
    /// The Lyapunov function, of the laws that have one.
    pub(super) lyapunov: Option<f64>,
    /// The 36 numbers, of the law as printed.
    pub(super) matrices: Option<SMatrix<f64, 4, 9>>,
}

impl ExactLines {
    /// The lines of the first outline without noise, fitted as those that the motion is identified from, with this RMS radius of the
    /// outline.
    pub(super) fn of(experiment: &PaperExperiment, size: f64) -> Result<Self, ExperimentError> {
        let scene = experiment.scene(PaperExperiment::SCALE)?;
        let in_image = scene.camera().scale().generator_in_image(&AffineMotion::from(experiment.motion).generator());
        let settings = Settings { noise: 0.0, length: SequenceLength::Frames(1), ..paper_settings(1.0, 0) };
        let frame = Sequence::simulate(scene, settings)?.frames.pop();
        let (_, outline) = frame.ok_or(ExperimentError::NoOutline { object: experiment.title })?;
        let fit = Fitter::new(PipelineSettings::default().fit)?.fit(&outline)?;
        let &Normalisation { centre, radius, .. } = fit.normalisation();
        let identifier_from_image = Normalisation::similarity(centre, radius / size).image_from_working().inverse();
        let identifier_from_working = identifier_from_image * fit.normalisation().image_from_working();
        let decomposition = Decomposition::of(fit.working())?.moved(&identifier_from_working)?;
        let model = MotionModel::Rigid;
        let parameters = &model.parameters_of(&in_image)[..model.parameter_count()];
        let truth = MotionEstimate::new(model, parameters, None).in_coordinates(&identifier_from_image);
        Ok(Self { start: decomposition.conjugate_pairs(4).copied().collect(), truth })
    }

    fn generator(&self) -> Matrix3<f64> {
        self.truth.generator()
    }

    /// The 36 numbers of the true motion.
    pub(super) fn true_matrices(&self) -> SMatrix<f64, 4, 9> {
        let g = self.generator();
        let [a1, a2, b1] = [0, 1, 2].map(|column| g[(0, column)]);
        let [a3, a4, b2] = [0, 1, 2].map(|column| g[(1, column)]);
        plant_matrices(&AffineMotion { a1, a2, a3, a4, b1, b2 })
    }

    /// Runs a law over the first pair from zero, with so many seconds between frames, and shows its state after every frame but the first.
    pub(super) fn run(
        &self,
        law: AdaptiveLaw,
        interval: f64,
        frames: usize,
        mut show: impl FnMut(LawState),
    ) -> Result<(), ExperimentError> {
        let settings = AdaptiveSettings { law, pairs: PairChoice::Given(0), ..AdaptiveSettings::default() };
        let mut identifier = AdaptiveIdentifier::new(settings).map_err(PipelineError::from)?;
        let (generator, true_matrices) = (self.generator(), self.true_matrices());
        for frame in 0..frames {
            let time = interval * frame as f64;
            let moved = self.start.iter().map(|line| line_flow(&generator, line, time).map(|(moved, _)| moved));
            let lines = moved.collect::<Result<Vec<_>, _>>().map_err(PipelineError::from)?;
            identifier.step(time, &lines).map_err(PipelineError::from)?;
            let (Some(diagnostics), Some(found)) = (identifier.diagnostics(), identifier.estimate()) else { continue };
            let matrices = identifier.matrices();
            let parameter_error = match law {
                AdaptiveLaw::Printed => matrices.map(|matrices| (matrices - true_matrices).norm_squared()),
                AdaptiveLaw::Structured => {
                    Some(found.values().iter().zip(self.truth.values()).map(|(a, b)| (a - b).powi(2)).sum())
                }
                AdaptiveLaw::FilteredLeastSquares | AdaptiveLaw::RegressorMixing => None,
            };
            let lyapunov = parameter_error.map(|square: f64| diagnostics.energy + square);
            show(LawState { time, error: diagnostics.error, lyapunov, matrices });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lines of an object at its size in the identifier are those of the object at another size, further out.
    #[test]
    fn the_size_in_the_identifier_scales_the_lines_and_leaves_their_slopes() {
        let [small, large] = [0.5, 1.0].map(|size| ExactLines::of(&PaperExperiment::FLIGHT_BIRD, size).expect("lines"));
        assert_eq!(small.start.len(), 2);
        for (small, large) in small.start.iter().zip(&large.start) {
            assert!(
                (small.l - large.l).norm() < 1e-9 && (2.0 * small.k - large.k).norm() < 1e-9,
                "{small:?} {large:?}"
            );
        }
        let [slow, fast] = [&small, &large].map(|lines| lines.truth.values().to_vec());
        assert!((slow[0] - fast[0]).abs() < 1e-12 && (2.0 * slow[1] - fast[1]).abs() < 1e-12, "{slow:?} {fast:?}");
    }
}
