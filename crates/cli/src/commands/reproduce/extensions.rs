//! Beyond the paper: affine motion, which it announces, and motion that changes slowly.
use std::f64::consts::{FRAC_PI_2, TAU};

use freeform_motion::identify::{AdaptiveLaw, PairChoice, ProcessNoise};
use freeform_motion::riccati::{AffineMotion, MotionModel, RigidMotion};
use freeform_motion::sim_camera::{BuiltInShape, Camera, Motion, PaperExperiment, Scene};

use super::Run;
use super::curves::curve;
use super::document::{Drawing, Section, Table};
use super::experiment::{Method, Outcome, Sequence, Track, paper_settings};
use super::traces::{colour_of, error_figure, parameter, parameter_curves, track_data, true_values};
use crate::failure::Failure;
use crate::plot::{Figure, Look, Panel};

/// Runs of each of the two experiments.
pub(crate) const RUNS: u64 = 4;

/// A turn that is faster one way round, with a slow growth and a slow shrinking; b as the flight bird's. In space.
const AFFINE: AffineMotion = AffineMotion { a1: 0.05, a2: 1.2, a3: -1.7, a4: -0.08, b1: -3.0, b2: 4.0 };

/// The flight bird's motion, all of it swinging about its constant value within this many seconds.
const SWING_SECONDS: f64 = 15.0;

/// Process noise that lets the filter follow: per square root of a second.
const PROCESS_NOISE: ProcessNoise = ProcessNoise { rates: 0.2, velocities: 0.05 };

fn bird(run: &Run, motion: Motion) -> Result<Sequence, Failure> {
    let camera = Camera::new(PaperExperiment::SCALE).map_err(Failure::unusable)?;
    Sequence::simulate(Scene::new(BuiltInShape::Bird, motion, camera), paper_settings(run.seconds, run.seed))
}

fn tracks<'a>(run: &Run, methods: &[(&'a str, Method)], sequence: &Sequence) -> Result<Vec<(&'a str, Track)>, Failure> {
    let track = |(name, method): &(&'a str, Method)| {
        let track = Track::by(method, sequence)?;
        run.advance();
        Ok((*name, track))
    };
    methods.iter().map(track).collect()
}

fn outcomes(name: &str, title: &str, caption: &str, tracks: &[(&str, Track)], sequence: &Sequence) -> Table {
    let row = |(method, track): &(&str, Track)| {
        let rejected = format!("{}", track.frames_rejected);
        std::iter::once((*method).to_owned()).chain(Outcome::of(track, sequence).cells()).chain([rejected]).collect()
    };
    Table {
        name: name.to_owned(),
        title: title.to_owned(),
        caption: caption.to_owned(),
        rows: tracks.iter().map(row).collect(),
        ..Table::of_data(&["method", "rates error %", "b error %", "settled s", "frames rejected"])
    }
}

pub(crate) fn affine(run: &Run) -> Result<Section, Failure> {
    let sequence = bird(run, AFFINE.into())?;
    let law = |law, pairs| Method::law(MotionModel::Affine, law, pairs, &[]);
    let methods = [
        ("36 numbers as printed", law(AdaptiveLaw::Printed, PairChoice::All)),
        ("structured law", law(AdaptiveLaw::Structured, PairChoice::All)),
        ("fast law", law(AdaptiveLaw::FilteredLeastSquares, PairChoice::All)),
        ("motion filter", Method::filter(MotionModel::Affine, ProcessNoise::default())),
    ];
    let tracks = tracks(run, &methods, &sequence)?;
    let panel = |method: usize, range: std::ops::Range<usize>, y_label: &str| {
        let (name, track) = &tracks[method];
        Panel {
            title: format!("By the {name}"),
            x_label: "time (s)".to_owned(),
            y_label: y_label.to_owned(),
            curves: parameter_curves(MotionModel::Affine, range, track, &sequence),
            x_from: Some(0.0),
            x_to: Some(run.seconds),
            ..Panel::default()
        }
    };
    let panels = [1, 3]
        .into_iter()
        .flat_map(|method| [panel(method, 0..4, "a1, a2, a3, a4 (1/s)"), panel(method, 4..6, "b1, b2 (lengths/s)")]);
    let AffineMotion { a1, a2, a3, a4, b1, b2 } = AFFINE;
    let parameters = Drawing {
        name: "affine".to_owned(),
        caption: format!(
            "The flight bird's outline under the affine motion a = ({a1}, {a2}; {a3}, {a4}), b = ({b1}, {b2}) in space, \
             identified with six parameters by the structured law over all pairs (above) and by the motion filter (below), from zero. \
             The law keeps a bias: a 3L fit is not affine-equivariant, since offsets along the normals do not move \
             affinely, so that the lines of the fitted quartic do not move exactly as the outline does."
        ),
        data: track_data(MotionModel::Affine, &tracks, &sequence),
        figure: Figure { panels: panels.collect(), columns: 2, panel_size: [460.0, 320.0], ..Figure::default() },
    };
    let errors = Drawing {
        name: "affine-laws".to_owned(),
        caption: "Relative errors of the same experiment by every method: that of the matrix a (Frobenius norm) and \
                  that of b."
            .to_owned(),
        data: track_data(MotionModel::Affine, &tracks, &sequence),
        figure: error_figure("affine motion", ["a error (%)", "b error (%)"], &tracks, &sequence),
    };
    let caption = "Errors over the last tenth of the run; settled: a stays within 5 % and b within 10 % of the truth.";
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
    RigidMotion { omega: FRAC_PI_2 * (1.0 + 0.3 * phase.sin()), b1: -3.0 + phase.sin(), b2: 4.0 + phase.cos() }.into()
}

pub(crate) fn changing(run: &Run) -> Result<Section, Failure> {
    let model = MotionModel::Rigid;
    let sequence = bird(run, Motion::varying(swinging))?;
    let methods = [
        ("structured law", Method::law(model, AdaptiveLaw::Structured, PairChoice::All, &[])),
        ("fast law", Method::law(model, AdaptiveLaw::FilteredLeastSquares, PairChoice::All, &[])),
        ("motion filter with process noise", Method::filter(model, PROCESS_NOISE)),
        ("motion filter for constant motion", Method::filter(model, ProcessNoise::default())),
    ];
    let tracks = tracks(run, &methods, &sequence)?;
    let panels = model.parameter_names().iter().zip(model.units()).enumerate().map(|(k, (name, unit))| {
        let found = tracks[..3].iter().map(|(method, track)| {
            let points = track.points.iter().filter_map(|(time, motion)| Some([*time, parameter(model, motion, k)?]));
            curve(method, Look::Series(colour_of(method)), vec![points.collect()])
        });
        let truth = curve("true value", Look::Dashed(0), vec![true_values(model, &sequence, k)]);
        Panel {
            x_label: "time (s)".to_owned(),
            y_label: format!("{name} ({})", unit.replace("1/s", "lengths/s")),
            curves: found.chain([truth]).collect(),
            x_from: Some(0.0),
            x_to: Some(run.seconds),
            ..Panel::default()
        }
    });
    let drawing = Drawing {
        name: "changing".to_owned(),
        caption: format!(
            "The flight bird with a motion that swings within {SWING_SECONDS} s: omega = pi/2 (1 + 0.3 sin), \
             b = (-3 + sin, 4 + cos). The structured law follows with a lag of seconds. The fast law forgets at \
             0.05/s, so that it averages over 20 s. The motion filter follows where it is told how fast the motion may \
             change (process noise {} per square root of a second for omega, {} image lengths per second for b).",
            PROCESS_NOISE.rates, PROCESS_NOISE.velocities
        ),
        data: track_data(model, &tracks, &sequence),
        figure: Figure {
            title: "A flight bird whose motion changes".to_owned(),
            shares_legend: true,
            panels: panels.collect(),
            columns: 1,
            panel_size: [720.0, 250.0],
        },
    };
    let caption = "Errors over the last tenth of the run, relative to the motion at each moment. A filter for constant \
                   motion gives up the object and begins anew whenever the motion has changed too much.";
    let table = outcomes("changing-errors", "Changing motion: final errors", caption, &tracks, &sequence);
    Ok(Section {
        heading: "A motion that changes slowly".to_owned(),
        text: String::new(),
        drawings: vec![drawing],
        tables: vec![table],
        findings: Vec::new(),
    })
}
