//! The stages from outline to motion.
use freeform_motion::{
    Pipeline, PipelineSettings,
    curve_fit::{Degree, FitSettings, Fitter, Method},
    decompose::{AffineInvariants, Correspondence, Decomposition, RelatedPoints},
    estimate::ProcessNoise,
    identify::{AdaptiveLaw, AdaptiveSettings, PairChoice},
    outline_filter::{FilterSettings, MotionFilter},
    riccati::MotionModel,
};

use super::finite::{assert_covariance, assert_finite};
use super::hostile_input::HostileInput;

/// Frames of one sequence, so that a check takes milliseconds.
const MOST_FRAMES: usize = 24;

/// Any points: an error, or a finite curve whose lines, if it has any, are finite, multiply out to it and move with it.
pub(crate) fn fit_and_decomposition(bytes: &[u8]) {
    let mut input = HostileInput::new(bytes);
    let choice = input.byte();
    let degree = Degree::ALL[usize::from(choice & 3)];
    let bounded = choice & 0b1100 == 0;
    let method = match choice >> 2 & 3 {
        0 => Method::Bounded { margin: 0.5, ridge_weight: 0.03 },
        1 => Method::ThreeLevel,
        2 => Method::GloballyStabilised { ridge_weight: 1e-3 },
        _ => Method::Bounded { margin: 0.02, ridge_weight: 0.0 },
    };
    let mut fitter = Fitter::new(FitSettings { degree, method, ..FitSettings::default() }).expect("settings");
    let mut before: Option<Decomposition> = None;
    for _ in 0..MOST_FRAMES {
        if input.is_empty() {
            return;
        }
        let Some(outline) = input.next_outline() else { continue };
        let Ok(fit) = fitter.fit(&outline) else { continue };
        let d = *fit.diagnostics();
        assert!(fit.working().coefficients().iter().all(|a| a.is_finite()), "{fit:?}");
        assert!(d.geometric_residual.is_finite() && d.algebraic_residual.is_finite(), "{d:?}");
        assert!(d.boundedness_margin.is_finite() && !d.condition.is_nan(), "{d:?}");
        assert!(!bounded || fit.is_bounded(), "{d:?}");
        let Ok(lines) = Decomposition::of(fit.working()) else { continue };
        assert_decomposition(&lines);
        let size = fit.working().coefficients().iter().fold(0.0_f64, |m, a| m.max(a.abs()));
        for (a, b) in fit.working().coefficients().iter().zip(lines.expand().coefficients()) {
            // A condition number of 1e10 leaves 6 digits.
            assert!((a - b).abs() <= 1e-5 * size, "{a} came back as {b}");
        }
        if let Ok(moved) = lines.moved(&fit.normalisation().image_from_working()) {
            assert_decomposition(&moved);
        }
        if let Some(before) = &before
            && let Ok(matching) = Correspondence::between(before, &lines, 1.0)
        {
            let mut order = matching.permutation().to_vec();
            order.sort_unstable();
            assert!(order.iter().copied().eq(0..order.len()), "{matching:?}");
        }
        before = Some(lines);
    }
}

fn assert_decomposition(lines: &Decomposition) {
    for level in lines.levels() {
        assert!(lines.level(level).iter().all(|line| line.l.is_finite() && line.k.is_finite()), "{lines:?}");
    }
    assert!(lines.alpha().is_finite() && lines.beta().is_finite(), "{lines:?}");
    let points = RelatedPoints::of(lines);
    for related in points.as_slice() {
        assert!(related.point.coords.iter().all(|c| c.is_finite()) && related.value.is_finite(), "{related:?}");
    }
    if let Some(invariants) = AffineInvariants::of(lines) {
        assert!(invariants.values().iter().all(|v| v.is_finite()), "{invariants:?}");
    }
}

/// Any sequence of outlines through fit, decomposition, matching and an adaptive law.
pub(crate) fn adaptive_identifier(bytes: &[u8]) {
    let mut input = HostileInput::new(bytes);
    let choice = input.byte();
    let law = [AdaptiveLaw::Structured, AdaptiveLaw::Printed, AdaptiveLaw::FilteredLeastSquares];
    let pairs = [PairChoice::All, PairChoice::Best, PairChoice::Given(0)];
    let identify = AdaptiveSettings {
        law: law[usize::from(choice) % 3],
        pairs: pairs[usize::from(choice) / 3 % 3],
        model: [MotionModel::Rigid, MotionModel::Affine][usize::from(choice >> 7)],
        ..AdaptiveSettings::default()
    };
    let Ok(mut pipeline) = Pipeline::new(PipelineSettings { identify, ..PipelineSettings::default() }) else { return };
    for _ in 0..MOST_FRAMES {
        if input.is_empty() {
            return;
        }
        let time = input.next_time();
        let Some(outline) = input.next_outline() else { continue };
        let before = pipeline.identifier().estimate();
        let result = pipeline.push(time, &outline);
        let after = pipeline.estimate();
        if let Some(estimate) = &after {
            assert_finite(estimate);
        }
        match result {
            Ok(result) => assert_eq!(result.estimate, after),
            Err(_) => assert_eq!(pipeline.identifier().estimate(), before, "a rejected frame changed the motion"),
        }
    }
    #[cfg(feature = "serde")]
    super::states::assert_adaptive_restorable(pipeline.identifier());
}

/// Any sequence of outlines through the motion filter.
pub(crate) fn motion_filter(bytes: &[u8]) {
    let mut input = HostileInput::new(bytes);
    let choice = input.byte();
    let drift = if choice & 4 == 0 { 0.0 } else { 0.1 };
    let settings = FilterSettings {
        model: MotionModel::ALL[usize::from(choice) % MotionModel::ALL.len()],
        process_noise: ProcessNoise { rates: drift, velocities: drift },
        ..FilterSettings::default()
    };
    let mut filter = MotionFilter::new(settings).expect("settings");
    for _ in 0..MOST_FRAMES {
        if input.is_empty() {
            return;
        }
        let time = input.next_time();
        let Some(outline) = input.next_outline() else { continue };
        let seen = (filter.frames_accepted(), filter.frames_rejected());
        let Ok(step) = filter.step(time, &outline) else {
            assert_eq!(seen, (filter.frames_accepted(), filter.frames_rejected()), "an error changed the filter");
            continue;
        };
        assert_eq!(step.phase, filter.phase());
        if let Some(estimate) = filter.estimate() {
            assert_finite(&estimate);
        }
        assert_covariance(&filter);
        assert!(filter.pose().expect("a frame has been taken").matrix().iter().all(|e| e.is_finite()));
        assert!(filter.noise().is_some_and(f64::is_finite));
        assert!(filter.outline_points().all(|p| p.coords.iter().all(|c| c.is_finite())));
    }
    #[cfg(feature = "serde")]
    super::states::assert_restorable(&filter);
}
