//! Beyond the paper: affine motion, which it announces, and motion that changes slowly.
use std::f64::consts::TAU;

use freeform_estimate::ProcessNoise;
use freeform_identify::{AdaptiveLaw, PairChoice};
use freeform_outline_filter::FilterSettings;
use freeform_riccati::{AffineMotion, MotionModel, RigidMotion};
use freeform_sim_camera::{BuiltInShape, Camera, Motion, PaperExperiment, Scene};

use super::Run;
use super::curves::curve;
use super::document::Section;
use super::method::Method;
use super::outcome::{Outcome, outcomes_in_words, rules};
use super::sequence::{Sequence, paper_settings};
use super::traces::{
    ERROR_LIMITS, error_figure, errors_data, estimates_data, look_of, parameter_curves, smoothing_in_words, stretches,
    times, true_values, values,
};
use super::track::Track;
use crate::ExperimentError;
use crate::figure::{Figure, Look, Panel};
use freeform_drawing::page::{Drawing, Table};

/// Runs of the experiment with affine motion.
pub(super) const AFFINE_RUNS: u64 = 5;

/// Runs of the experiment with changing motion.
pub(super) const CHANGING_RUNS: u64 = 5;

/// A turn that is faster one way round, with a slow growth and a slow shrinking; b as the flight bird's. In space.
const AFFINE: AffineMotion = AffineMotion { a1: 0.05, a2: 1.2, a3: -1.7, a4: -0.08, b1: -3.0, b2: 4.0 };

/// The flight bird's motion, all of it swinging about its constant value within this many seconds.
const SWING_SECONDS: f64 = 15.0;

/// Ends of the axis of relative errors, in percent, where the motion changes.
const CHANGING_LIMITS: [f64; 2] = [0.1, 100.0];

/// Share of omega that it swings by to each side.
const OMEGA_SWING: f64 = 0.3;

/// What b1 and b2 swing by to each side, in space lengths per second.
const B_SWING: f64 = 1.0;

/// Process noise that lets the filter follow: per square root of a second.
const PROCESS_NOISE: ProcessNoise = ProcessNoise { rates: 0.2, velocities: 0.05 };

fn bird(run: &Run, motion: Motion) -> Result<Sequence, ExperimentError> {
    let camera = Camera::new(PaperExperiment::SCALE)?;
    Sequence::simulate(Scene::new(BuiltInShape::Bird, motion, camera), paper_settings(run.seconds, run.seed))
}

fn tracks<'a>(
    run: &Run,
    methods: &[(&'a str, Method)],
    sequence: &Sequence,
) -> Result<Vec<(&'a str, Track)>, ExperimentError> {
    let track = |(name, method): &(&'a str, Method)| {
        let track = Track::by(method, sequence)?;
        run.advance();
        Ok((*name, track))
    };
    methods.iter().map(track).collect()
}

fn outcomes(name: &str, title: &str, caption: String, tracks: &[(&str, Track)], sequence: &Sequence) -> Table {
    let row = |(method, track): &(&str, Track)| {
        let counts = [track.frames_rejected, track.frames_lost()].map(|count| count.to_string());
        std::iter::once((*method).to_owned()).chain(Outcome::of(track, sequence).cells()).chain(counts).collect()
    };
    Table {
        name: name.to_owned(),
        title: title.to_owned(),
        caption,
        rows: tracks.iter().map(row).collect(),
        ..Table::of_data(&["method", "rates error %", "b error %", "settled s", "frames rejected", "without estimate"])
    }
}

/// What the last column of the tables counts.
const LOST: &str = "Without estimate: frames after the first estimate in which the method gives none, or reports a parameter as unobservable.";

/// The six parameters by two of the methods.
fn affine_parameters(run: &Run, tracks: &[(&str, Track)], sequence: &Sequence) -> Drawing {
    let panel = |method: usize, range: std::ops::Range<usize>, y_label: &str| {
        let (name, track) = &tracks[method];
        Panel {
            title: format!("By the {name}"),
            x_label: "time (s)".to_owned(),
            y_label: y_label.to_owned(),
            curves: parameter_curves(MotionModel::Affine, range, track, sequence),
            x_from: Some(0.0),
            x_to: Some(run.seconds),
            ..Panel::default()
        }
    };
    let shown = [1, 3];
    let panels = shown
        .into_iter()
        .flat_map(|method| [panel(method, 0..4, "a1, a2, a3, a4 (1/s)"), panel(method, 4..6, "b1, b2 (lengths/s)")]);
    let AffineMotion { a1, a2, a3, a4, b1, b2 } = AFFINE;
    Drawing {
        name: "affine".to_owned(),
        caption: format!(
            "The flight bird's outline under the affine motion a = ({a1}, {a2}; {a3}, {a4}), b = ({b1}, {b2}) in space, \
             identified with six parameters by the structured law over all pairs (above) and by the motion filter (below), from zero. \
             Outlines are fitted in affine-normalised coordinates, since a 3L fit is not affine-equivariant otherwise: offsets \
             along the normals do not move affinely."
        ),
        data: estimates_data(MotionModel::Affine, shown.map(|method| &tracks[method]), sequence),
        figure: Figure {
            title: "The flight bird's outline in affine motion".to_owned(),
            shares_legend: true,
            panels: panels.collect(),
            columns: 2,
            panel_size: [460.0, 300.0],
        },
    }
}

pub(super) fn affine(run: &Run) -> Result<Section, ExperimentError> {
    let sequence = bird(run, AFFINE.into())?;
    let law = |law, pairs| Method::law(MotionModel::Affine, law, pairs, &[]);
    let methods = [
        ("36 numbers as printed", law(AdaptiveLaw::Printed, PairChoice::All)),
        ("structured law", law(AdaptiveLaw::Structured, PairChoice::All)),
        ("fast law", law(AdaptiveLaw::FilteredLeastSquares, PairChoice::All)),
        ("motion filter", Method::filter(MotionModel::Affine)),
    ];
    let tracks = tracks(run, &methods, &sequence)?;
    let parameters = affine_parameters(run, &tracks, &sequence);
    let errors = Drawing {
        name: "affine-laws".to_owned(),
        caption: format!(
            "Relative errors of the same experiment by every method: that of the matrix a (Frobenius norm) and that of b. At the end: {}. {}",
            outcomes_in_words(&tracks, &sequence),
            smoothing_in_words(ERROR_LIMITS)
        ),
        data: errors_data(&tracks, &sequence),
        figure: error_figure("affine motion", ["a error (%)", "b error (%)"], ERROR_LIMITS, &tracks, &sequence),
    };
    let caption = format!("{} {LOST}", rules("a"));
    let table = outcomes("affine-errors", "Affine motion: final errors", caption, &tracks, &sequence);
    Ok(Section {
        heading: "Affine motion".to_owned(),
        text: "The paper closes with affine motion as work in progress. The laws carry over as they stand: the \
               regressor has six columns in place of three."
            .to_owned(),
        drawings: vec![parameters, errors],
        tables: vec![table],
        findings: Vec::new(),
    })
}

/// The motion at a time in seconds.
fn swinging(time: f64) -> AffineMotion {
    let phase = TAU * time / SWING_SECONDS;
    let RigidMotion { omega, b1, b2 } = PaperExperiment::FLIGHT_BIRD.motion;
    RigidMotion {
        omega: omega * (1.0 + OMEGA_SWING * phase.sin()),
        b1: b1 + B_SWING * phase.sin(),
        b2: b2 + B_SWING * phase.cos(),
    }
    .into()
}

/// The estimates of several methods where the motion changes.
fn changing_estimates(run: &Run, shown: &[(&str, Track)], sequence: &Sequence) -> Drawing {
    let model = MotionModel::Rigid;
    let RigidMotion { omega, b1, b2 } = PaperExperiment::FLIGHT_BIRD.motion;
    let total = sequence.frames.len();
    let lost: Vec<_> =
        shown.iter().map(|(name, track)| format!("{} of {total} frames of the {name}", track.frames_lost())).collect();
    let panels = model.parameter_names().iter().zip(model.units()).enumerate().map(|(k, (name, unit))| {
        let found = shown
            .iter()
            .map(|(method, track)| curve(method, look_of(method), stretches(&times(track), &values(model, track, k))));
        let truth = curve("true values", Look::Reference, vec![true_values(model, sequence, k)]);
        Panel {
            x_label: "time (s)".to_owned(),
            y_label: format!("{name} ({})", unit.replace("1/s", "lengths/s")),
            curves: found.chain([truth]).collect(),
            x_from: Some(0.0),
            x_to: Some(run.seconds),
            ..Panel::default()
        }
    });
    Drawing {
        name: "changing".to_owned(),
        caption: format!(
            "The flight bird with a motion that swings within {SWING_SECONDS} s: omega = {omega:.4} (1 + {OMEGA_SWING} sin), \
             b = ({b1} + {B_SWING} sin, {b2} + {B_SWING} cos) in space. The structured law follows with a lag of seconds; the fast law forgets \
             so slowly that it averages over most of a swing. The motion filter has to see from its innovations that the motion \
             changes, or is told how fast it may (process noise {} per square root of a second for omega, {} image lengths per \
             second for b). A curve is broken where its method gives no estimate or \
             reports a parameter as unobservable: in {}.",
            PROCESS_NOISE.rates,
            PROCESS_NOISE.velocities,
            lost.join(", ")
        ),
        data: estimates_data(model, shown, sequence),
        figure: Figure {
            title: "A flight bird whose motion changes".to_owned(),
            shares_legend: true,
            panels: panels.collect(),
            columns: 1,
            panel_size: [720.0, 250.0],
        },
    }
}

pub(super) fn changing(run: &Run) -> Result<Section, ExperimentError> {
    let model = MotionModel::Rigid;
    let sequence = bird(run, Motion::varying(swinging))?;
    let constant = FilterSettings { model, adaptive: false, ..FilterSettings::default() };
    let methods = [
        ("structured law", Method::law(model, AdaptiveLaw::Structured, PairChoice::All, &[])),
        ("fast law", Method::law(model, AdaptiveLaw::FilteredLeastSquares, PairChoice::All, &[])),
        ("motion filter", Method::filter(model)),
        ("motion filter, changes told", Method::Filter(FilterSettings { process_noise: PROCESS_NOISE, ..constant })),
        ("motion filter, held constant", Method::Filter(constant)),
    ];
    let tracks = tracks(run, &methods, &sequence)?;
    // The filter that begins anew again and again would hide the others.
    let shown = &tracks[..4];
    let estimates = changing_estimates(run, shown, &sequence);
    let errors = Drawing {
        name: "changing-laws".to_owned(),
        caption: format!(
            "Relative errors of the same experiment, against the motion at each moment. Held constant: the filter is told that \
             nothing changes, loses the object whenever the motion has changed too much, and begins anew. At the end: {}. {}",
            outcomes_in_words(&tracks, &sequence),
            smoothing_in_words(CHANGING_LIMITS)
        ),
        data: errors_data(&tracks, &sequence),
        figure: error_figure(
            "changing motion",
            ["omega error (%)", "b error (%)"],
            CHANGING_LIMITS,
            &tracks,
            &sequence,
        ),
    };
    let caption = format!("Relative to the motion at each moment. {} {LOST}", rules("omega"));
    let table = outcomes("changing-errors", "Changing motion: final errors", caption, &tracks, &sequence);
    Ok(Section {
        heading: "A motion that changes slowly".to_owned(),
        text: String::new(),
        drawings: vec![estimates, errors],
        tables: vec![table],
        findings: Vec::new(),
    })
}
