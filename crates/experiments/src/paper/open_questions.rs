//! What the paper leaves open, answered by measurement: tables of final errors and settling times.
use freeform_curve_fit::{FitSettings, Method as FitMethod};
use freeform_identify::{AdaptiveLaw, AdaptiveSettings, PairChoice};
use freeform_motion::PipelineSettings;
use freeform_riccati::MotionModel;
use freeform_sim_camera::{Camera, PaperExperiment, Scene, Settings};
use nalgebra::{Affine2, Matrix3};
use rayon::prelude::*;

use super::Run;
use super::document::{Section, Table};
use super::method::{Method, random_start, start_range_in_words};
use super::outcome::{Outcome, percent, rules};
use super::sequence::{Sequence, paper_settings};
use super::track::Track;
use crate::ExperimentError;

const EXPERIMENTS: [PaperExperiment; 3] =
    [PaperExperiment::FLIGHT_BIRD, PaperExperiment::GLIDER_OF_TEXT, PaperExperiment::CELLULAR_PHONE];

/// One table: every condition with every method.
struct Question {
    name: &'static str,
    title: &'static str,
    caption: String,
    conditions: Vec<Condition>,
    methods: Vec<(String, Method)>,
    /// Whether rejected frames have columns.
    counts_rejected: bool,
}

/// How outlines are taken.
#[derive(Debug, Clone)]
struct Condition {
    /// Empty where there is only one.
    label: String,
    fps: f64,
    noise: f64,
    /// Camera scale f/Z0.
    scale: f64,
    /// Size of the object in the image.
    size: f64,
}

impl Condition {
    fn usual() -> Self {
        let settings = paper_settings(1.0, 0);
        Self {
            label: String::new(),
            fps: settings.fps,
            noise: settings.noise,
            scale: PaperExperiment::SCALE,
            size: 1.0,
        }
    }

    fn sequence(&self, experiment: &PaperExperiment, seconds: f64, seed: u64) -> Result<Sequence, ExperimentError> {
        let camera = Camera::new(self.scale)?;
        let pose = Affine2::from_matrix_unchecked(Matrix3::new_scaling(self.size));
        let scene = Scene::new(experiment.shape, experiment.motion, camera).with_initial_pose(pose);
        Sequence::simulate(scene, Settings { fps: self.fps, noise: self.noise, ..paper_settings(seconds, seed) })
    }
}

fn law(law: AdaptiveLaw, pairs: PairChoice) -> Method {
    Method::law(MotionModel::Rigid, law, pairs, &[])
}

/// The law of the paper at work, and the filter.
fn law_and_filter() -> Vec<(String, Method)> {
    vec![
        ("structured law".to_owned(), law(AdaptiveLaw::Structured, PairChoice::All)),
        ("motion filter".to_owned(), Method::filter(MotionModel::Rigid)),
    ]
}

fn questions() -> Vec<Question> {
    let usual = Condition::usual;
    let noises = [0.0, 0.001, 0.0025, 0.005, 0.01, 0.02, 0.05];
    let rates = [10.0, 20.0, 30.0, 50.0, 100.0, 200.0];
    let scales = [0.02, 0.05, 0.1, 0.2, 0.5];
    vec![
        Question {
            name: "open-noise",
            title: "Noise on image points",
            caption: format!(
                "Standard deviation on each coordinate, for an object of size 1. The paper has {}.",
                PaperExperiment::NOISE
            ),
            conditions: noises.map(|noise| Condition { label: format!("noise {noise}"), noise, ..usual() }).into(),
            methods: law_and_filter(),
            counts_rejected: false,
        },
        Question {
            name: "open-frame-rate",
            title: "Frame rate",
            caption: "Frames per second; every run lasts as long. The paper does not give it.".to_owned(),
            conditions: rates.map(|fps| Condition { label: format!("{fps} frames/s"), fps, ..usual() }).into(),
            methods: law_and_filter(),
            counts_rejected: false,
        },
        Question {
            name: "open-scale",
            title: "Camera scale f/Z0, the object staying as it is in space",
            caption: format!(
                "The object is {} across in space, so that its image grows with f/Z0 while the noise does not. The paper \
                 gives neither.",
                1.0 / PaperExperiment::SCALE
            ),
            conditions: scales
                .map(|scale| Condition {
                    label: format!("f/Z0 {scale}"),
                    scale,
                    size: scale / PaperExperiment::SCALE,
                    ..usual()
                })
                .into(),
            methods: law_and_filter(),
            counts_rejected: false,
        },
        Question {
            name: "open-speed",
            title: "Camera scale f/Z0, the object staying as it is in the image",
            caption: "The image of the object is 1 across whatever the scale, so that only its velocity in the image, \
                      b f/Z0, changes."
                .to_owned(),
            conditions: scales.map(|scale| Condition { label: format!("f/Z0 {scale}"), scale, ..usual() }).into(),
            methods: law_and_filter(),
            counts_rejected: false,
        },
        Question {
            name: "open-pair",
            title: "The line pair",
            caption: "The paper picks one complex conjugate pair and does not say which. Pairs are counted as in the \
                      first frame; the best is that with the best signal against its noise; all are weighted by theirs."
                .to_owned(),
            conditions: vec![usual()],
            methods: pairs(),
            counts_rejected: false,
        },
        Question {
            name: "open-gains",
            title: "Am and Q",
            caption: "The paper's matrices times a factor, for the structured law over all pairs. With \
                      Am' P + P Am = -Q the gain P is Q over twice the size of Am."
                .to_owned(),
            conditions: vec![usual()],
            methods: gains(),
            counts_rejected: false,
        },
        Question {
            name: "open-fit",
            title: "The curve fit",
            caption: format!(
                "3L, GS3L with ridge kappa, and fits that are bounded by construction, for the structured law over all \
                 pairs; level sets at {} RMS radii. Frames whose curve is not bounded are rejected; there is no \
                 estimate where no frame is left or the motion is reported as unobservable.",
                PipelineSettings::default().fit.offset
            ),
            conditions: vec![usual()],
            methods: fits(),
            counts_rejected: true,
        },
    ]
}

fn pairs() -> Vec<(String, Method)> {
    let choices = [
        ("first pair", PairChoice::Given(0)),
        ("second pair", PairChoice::Given(1)),
        ("best pair", PairChoice::Best),
        ("all pairs", PairChoice::All),
    ];
    let laws = [
        ("36 numbers", AdaptiveLaw::Printed),
        ("structured law", AdaptiveLaw::Structured),
        ("fast law", AdaptiveLaw::FilteredLeastSquares),
    ];
    let all = laws.iter().flat_map(|(name, kind)| {
        choices.iter().map(move |(choice, pairs)| (format!("{name}, {choice}"), law(*kind, *pairs)))
    });
    all.collect()
}

fn gains() -> Vec<(String, Method)> {
    let factors = [0.1, 0.3, 1.0, 3.0, 10.0];
    let scaled = |label: String, am: f64, q: f64| {
        let usual = AdaptiveSettings::default();
        let identify = AdaptiveSettings { stability: usual.stability * am, definite: usual.definite * q, ..usual };
        (label, Method::Adaptive(Box::new(PipelineSettings { identify, ..PipelineSettings::default() })))
    };
    let both = factors.map(|factor| scaled(format!("Am and Q x {factor}"), factor, factor));
    let am = factors.map(|factor| scaled(format!("Am x {factor}"), factor, 1.0));
    let q = factors.map(|factor| scaled(format!("Q x {factor}"), 1.0, factor));
    am.into_iter().chain(q).chain(both).collect()
}

fn fits() -> Vec<(String, Method)> {
    let kappas = [1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0];
    let bounded = [(0.02, 0.0), (0.1, 0.0), (0.5, 0.0), (0.02, 0.03), (0.5, 0.03)];
    let fitted = |label: String, method: FitMethod| {
        let usual = PipelineSettings::default();
        let fit = FitSettings { method, ..usual.fit };
        (label, Method::Adaptive(Box::new(PipelineSettings { fit, ..usual })))
    };
    let mut fits = vec![fitted("3L".to_owned(), FitMethod::ThreeLevel)];
    fits.extend(kappas.map(|ridge_weight| {
        fitted(format!("GS3L, kappa {ridge_weight:e}"), FitMethod::GloballyStabilised { ridge_weight })
    }));
    fits.extend(bounded.map(|(margin, ridge_weight)| {
        let label = format!("bounded, margin {margin}, ridge {ridge_weight}");
        fitted(label, FitMethod::Bounded { margin, ridge_weight })
    }));
    fits
}

/// Laws tried from random initial values.
const STARTED: [(&str, AdaptiveLaw, PairChoice); 4] = [
    ("36 numbers, best pair", AdaptiveLaw::Printed, PairChoice::Best),
    ("structured law, best pair", AdaptiveLaw::Structured, PairChoice::Best),
    ("structured law, all pairs", AdaptiveLaw::Structured, PairChoice::All),
    ("fast law, all pairs", AdaptiveLaw::FilteredLeastSquares, PairChoice::All),
];

/// Sequences identified for all tables.
pub(super) fn run_count(starts: u32, repeats: u32) -> u64 {
    let cells: usize = questions().iter().map(|question| question.conditions.len() * question.methods.len()).sum();
    let (cells, started) = (cells as u64 * u64::from(repeats), STARTED.len() as u64 * u64::from(starts));
    EXPERIMENTS.len() as u64 * (cells + started)
}

pub(super) fn section(run: &Run) -> Result<Section, ExperimentError> {
    let questions = questions();
    let mut tables: Vec<_> = questions.par_iter().map(|question| question.table(run)).collect::<Result<_, _>>()?;
    tables.push(initial_values(run)?);
    Ok(Section {
        heading: "What the paper leaves open".to_owned(),
        text: format!(
            "Where nothing else is said: the structured law over all pairs, from zero, with the settings below. Each row \
             is the median over {} noise sequences, and each number is the median by itself: for each experiment the errors of omega \
             and of b in percent and the settling time in seconds. {}",
            run.repeats,
            rules("omega")
        ),
        drawings: Vec::new(),
        tables,
        findings: Vec::new(),
    })
}

/// Heads of a table with three or four columns for each experiment.
fn heads(first: &str, counts_rejected: bool) -> Vec<String> {
    let columns = EXPERIMENTS.iter().flat_map(|experiment| {
        let name = experiment.shape.name();
        let rejected = counts_rejected.then(|| format!("{name} rejected %"));
        [format!("{name} omega %"), format!("{name} b %"), format!("{name} settled s")].into_iter().chain(rejected)
    });
    std::iter::once(first.to_owned()).chain(columns).collect()
}

impl Question {
    fn table(&self, run: &Run) -> Result<Table, ExperimentError> {
        let mut table = Table {
            name: self.name.to_owned(),
            title: self.title.to_owned(),
            caption: self.caption.clone(),
            heads: heads("setting", self.counts_rejected),
            ..Table::default()
        };
        for condition in &self.conditions {
            let columns = EXPERIMENTS.par_iter().map(|experiment| self.medians(run, condition, experiment));
            let columns: Vec<Vec<Outcome>> = columns.collect::<Result<_, _>>()?;
            for (index, (method, _)) in self.methods.iter().enumerate() {
                let label =
                    if condition.label.is_empty() { method.clone() } else { format!("{}, {method}", condition.label) };
                let cells = columns.iter().flat_map(|column| {
                    let rejected = self.counts_rejected.then(|| percent(column[index].rejected));
                    column[index].cells().into_iter().chain(rejected)
                });
                table.rows.push(std::iter::once(label).chain(cells).collect());
            }
        }
        Ok(table)
    }

    /// What each method comes to in one condition.
    fn medians(
        &self,
        run: &Run,
        condition: &Condition,
        experiment: &PaperExperiment,
    ) -> Result<Vec<Outcome>, ExperimentError> {
        let repeats = (0..u64::from(run.repeats)).into_par_iter().map(|repeat| {
            let sequence = condition.sequence(experiment, run.seconds, run.seed + repeat)?;
            let outcomes = self.methods.par_iter().map(|(_, method)| {
                let outcome = Outcome::of(&Track::by(method, &sequence)?, &sequence);
                run.advance();
                Ok(outcome)
            });
            outcomes.collect::<Result<Vec<_>, ExperimentError>>()
        });
        let repeats: Vec<Vec<Outcome>> = repeats.collect::<Result<_, _>>()?;
        let of_method = |index: usize| repeats.iter().map(|outcomes| outcomes[index]).collect::<Vec<_>>();
        Ok((0..self.methods.len()).map(|index| Outcome::quantile(&of_method(index), 0.5)).collect())
    }
}

/// Median and worst over random initial values.
fn initial_values(run: &Run) -> Result<Table, ExperimentError> {
    let columns = EXPERIMENTS.par_iter().map(|experiment| {
        let sequence = Sequence::of_paper(experiment, run.seconds, run.seed)?;
        let of_law = STARTED.par_iter().map(|(_, kind, pairs)| {
            let outcomes = (0..u64::from(run.starts)).into_par_iter().map(|index| {
                let method = Method::law(MotionModel::Rigid, *kind, *pairs, &random_start(run.seed, index));
                let outcome = Outcome::of(&Track::by(&method, &sequence)?, &sequence);
                run.advance();
                Ok(outcome)
            });
            outcomes.collect::<Result<Vec<_>, ExperimentError>>()
        });
        of_law.collect::<Result<Vec<_>, ExperimentError>>()
    });
    let columns: Vec<Vec<Vec<Outcome>>> = columns.collect::<Result<_, _>>()?;
    let mut table = Table {
        name: "open-initial-values".to_owned(),
        title: format!("Initial values: median and worst of {}", run.starts),
        caption: format!(
            "Drawn at random as the paper does ({}), all on the same outlines. Each number is the median or the worst by \
             itself. The 36 numbers start from the matrices of the motion drawn.",
            start_range_in_words()
        ),
        heads: heads("law", false),
        ..Table::default()
    };
    for (index, (name, ..)) in STARTED.iter().enumerate() {
        for (kind, share) in [("median", 0.5), ("worst", 1.0)] {
            let cells = columns.iter().flat_map(|column| Outcome::quantile(&column[index], share).cells());
            table.rows.push(std::iter::once(format!("{name}: {kind}")).chain(cells).collect());
        }
    }
    Ok(table)
}
