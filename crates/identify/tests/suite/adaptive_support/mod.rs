//! Line pairs that move exactly.
use freeform_decompose::{Line, from_rotation_chart};
use freeform_identify::{AdaptiveIdentifier, AdaptiveSettings};
use freeform_riccati::{MotionModel, line_flow};
use nalgebra::Complex;

/// The paper's flight bird in the image, f/Z0 = 0.1.
pub(crate) const RIGID: [f64; 3] = [std::f64::consts::FRAC_PI_2, -0.3, 0.4];

/// Growth at 1 % a second while it turns.
pub(crate) const SIMILARITY: [f64; 4] = [0.01, 1.2, -0.3, 0.4];

/// A bounded affine motion.
pub(crate) const AFFINE: [f64; 6] = [0.05, 1.2, -1.7, -0.05, -0.3, 0.4];

/// A bounded projective motion: its generator has imaginary eigenvalues and 0.
pub(crate) const PROJECTIVE: [f64; 8] = [0.05, 1.2, -1.7, -0.05, -0.3, 0.4, -0.098, 0.093];

/// Two pairs that tell of rotation about as well as those of a bird.
pub(crate) fn starting_lines() -> [Line; 2] {
    let line = |w: (f64, f64), k: (f64, f64)| Line {
        l: from_rotation_chart(Complex::from_polar(w.0, w.1)),
        k: Complex::new(k.0, k.1),
    };
    [line((0.5, 0.4), (0.1, -0.2)), line((0.4, -2.2), (-0.15, 0.1))]
}

/// Times from 0 on, so many per second.
pub(crate) fn even_times(seconds: f64, fps: f64) -> Vec<f64> {
    (0..=(seconds * fps) as usize).map(|frame| frame as f64 / fps).collect()
}

/// Shows the lines of a constant motion at times from 0 on, as if they came `delay` later.
pub(crate) fn run(identifier: &mut AdaptiveIdentifier, start: &[Line], motion: &[f64], times: &[f64], delay: f64) {
    let model = MotionModel::ALL.into_iter().find(|m| m.parameter_count() == motion.len()).expect("a model");
    let generator = model.generator(motion);
    for time in times {
        let lines: Vec<Line> =
            start.iter().map(|line| line_flow(&generator, line, *time).expect("complex lines stay").0).collect();
        identifier.step(time + delay, &lines).expect("a good frame");
    }
}

/// What an identifier holds after the lines at these times.
pub(crate) fn parameters_after(settings: &AdaptiveSettings, motion: &[f64], times: &[f64]) -> Vec<f64> {
    let mut identifier = AdaptiveIdentifier::new(settings.clone()).expect("settings");
    run(&mut identifier, &starting_lines(), motion, times, 0.0);
    identifier.estimate().expect("an estimate").values().to_vec()
}
