//! What is varied for the tables of what the paper leaves open: conditions and methods.
use freeform_curve_fit::{FitSettings, Method as FitMethod};
use freeform_identify::{AdaptiveLaw, AdaptiveSettings, PairChoice};
use freeform_motion::PipelineSettings;
use freeform_riccati::MotionModel;
use freeform_sim_camera::{Camera, PaperExperiment, Scene, Settings};
use nalgebra::{Affine2, Matrix3};

use super::method::Method;
use super::sequence::{Sequence, paper_settings};
use crate::ExperimentError;

/// One table: every condition with every method.
pub(super) struct Question {
    pub(super) name: &'static str,
    pub(super) title: &'static str,
    pub(super) caption: String,
    pub(super) conditions: Vec<Condition>,
    pub(super) methods: Vec<(String, Method)>,
    /// Whether rejected frames have columns.
    pub(super) counts_rejected: bool,
}

/// How outlines are taken.
#[derive(Debug, Clone)]
pub(super) struct Condition {
    /// Empty where there is only one.
    pub(super) label: String,
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

    pub(super) fn sequence(
        &self,
        experiment: &PaperExperiment,
        seconds: f64,
        seed: u64,
    ) -> Result<Sequence, ExperimentError> {
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

/// All tables but that of the initial values.
pub(super) fn questions() -> Vec<Question> {
    [of_pictures(), of_camera_scale(), of_laws(), of_identifier()].into_iter().flatten().collect()
}

/// How exact and how frequent the outlines have to be.
fn of_pictures() -> Vec<Question> {
    let usual = Condition::usual;
    let noises = [0.0, 0.001, 0.0025, 0.005, 0.01, 0.02, 0.05];
    let rates = [10.0, 20.0, 30.0, 50.0, 100.0, 200.0];
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
    ]
}

/// What the scale of the camera does, by the size of the object in the image and by its velocity there.
fn of_camera_scale() -> Vec<Question> {
    let usual = Condition::usual;
    let scales = [0.02, 0.05, 0.1, 0.2, 0.5];
    vec![
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
    ]
}

/// Which lines tell the motion, and by which law.
fn of_laws() -> Vec<Question> {
    let usual = Condition::usual;
    vec![
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
            name: "open-laws",
            title: "The four laws",
            caption: format!(
                "Over all pairs: the estimator (21) as printed, with all 36 entries of A, B and C; the structured law; least \
                 squares on the filtered equations (fast law); dynamic regressor extension and mixing on the same (mixing law). On \
                 outlines without noise, whose fitted lines are still not exact, and with the noise of the paper, {}.",
                PaperExperiment::NOISE
            ),
            conditions: [0.0, PaperExperiment::NOISE]
                .map(|noise| Condition { label: format!("noise {noise}"), noise, ..usual() })
                .into(),
            methods: LAWS.map(|(name, kind)| (name.to_owned(), law(kind, PairChoice::All))).into(),
            counts_rejected: false,
        },
    ]
}

/// How the identifier is set, and what curves it is given.
fn of_identifier() -> Vec<Question> {
    let usual = Condition::usual;
    vec![
        Question {
            name: "open-size",
            title: "Size of the object in the identifier",
            caption: "RMS radius of the first outline in the coordinates that the identifier works in, for the structured law. The \
                      gains of the paper belong to objects of about size 1, and the paper gives no size. A larger object drives the \
                      law harder: it converges faster and follows the noise more, so that one that was near leaves the limits \
                      again."
                .to_owned(),
            conditions: vec![usual()],
            methods: sizes(),
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
                 pairs, and GS3L with the best pair alone, as in the paper; level sets at {} RMS radii. Frames whose curve is not bounded are rejected; there is no \
                 estimate where no frame is left or the motion is reported as unobservable.",
                PipelineSettings::default().fit.offset
            ),
            conditions: vec![usual()],
            methods: fits(),
            counts_rejected: true,
        },
    ]
}

/// What the laws are called in the tables.
const LAWS: [(&str, AdaptiveLaw); 4] = [
    ("36 numbers", AdaptiveLaw::Printed),
    ("structured law", AdaptiveLaw::Structured),
    ("fast law", AdaptiveLaw::FilteredLeastSquares),
    ("mixing law", AdaptiveLaw::RegressorMixing),
];

/// One pair, as in the paper, and all.
const ONE_OR_ALL: [(&str, PairChoice); 2] = [("best pair", PairChoice::Best), ("all pairs", PairChoice::All)];

/// The structured law with the object of several sizes in the identifier.
fn sizes() -> Vec<(String, Method)> {
    let sizes = [0.35, 0.6, 1.0, 1.5, 2.0];
    let all = ONE_OR_ALL.iter().flat_map(|(choice, pairs)| {
        sizes.map(|size| (format!("RMS {size}, {choice}"), law(AdaptiveLaw::Structured, *pairs).with_size(size)))
    });
    all.collect()
}

fn pairs() -> Vec<(String, Method)> {
    let choices = [
        ("first pair", PairChoice::Given(0)),
        ("second pair", PairChoice::Given(1)),
        ("best pair", PairChoice::Best),
        ("all pairs", PairChoice::All),
    ];
    let all = LAWS.iter().flat_map(|(name, kind)| {
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
    let fitted = |label: String, method: FitMethod, pairs: PairChoice| {
        let usual = PipelineSettings::default();
        let identify = AdaptiveSettings { pairs, ..usual.identify };
        let settings = PipelineSettings { fit: FitSettings { method, ..usual.fit }, identify, ..usual };
        (label, Method::Adaptive(Box::new(settings)))
    };
    let gs3l = |choice: &str, pairs: PairChoice| {
        kappas.map(|ridge_weight| {
            let label = format!("GS3L, kappa {ridge_weight:e}{choice}");
            fitted(label, FitMethod::GloballyStabilised { ridge_weight }, pairs)
        })
    };
    let mut fits = vec![fitted("3L".to_owned(), FitMethod::ThreeLevel, PairChoice::All)];
    fits.extend(gs3l("", PairChoice::All));
    // As the paper has it: its fit [21] with one pair.
    fits.extend(gs3l(", best pair", PairChoice::Best));
    fits.extend(bounded.map(|(margin, ridge_weight)| {
        let label = format!("bounded, margin {margin}, ridge {ridge_weight}");
        fitted(label, FitMethod::Bounded { margin, ridge_weight }, PairChoice::All)
    }));
    fits
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The names of the rows of one table.
    fn rows(name: &str) -> Vec<String> {
        let question = questions().into_iter().find(|question| question.name == name).expect("a table");
        question.methods.into_iter().map(|(label, _)| label).collect()
    }

    #[test]
    fn sizes_laws_and_the_fit_of_the_paper_have_rows_with_one_pair_and_with_all() {
        let sizes = rows("open-size");
        assert!(sizes.contains(&"RMS 0.6, best pair".to_owned()) && sizes.contains(&"RMS 1.5, all pairs".to_owned()));
        assert_eq!(rows("open-laws"), ["36 numbers", "structured law", "fast law", "mixing law"]);
        assert!(rows("open-fit").contains(&"GS3L, kappa 1e-2, best pair".to_owned()));
    }

    #[test]
    fn a_table_and_its_rows_have_names_of_their_own() {
        let questions = questions();
        for (k, question) in questions.iter().enumerate() {
            assert!(questions[k + 1..].iter().all(|other| other.name != question.name), "{}", question.name);
            let labels: Vec<_> = question.methods.iter().map(|(label, _)| label).collect();
            assert!((0..labels.len()).all(|i| !labels[i + 1..].contains(&labels[i])), "{labels:?}");
        }
    }

    #[test]
    fn a_size_reaches_the_identifier() {
        let sizes: Vec<f64> = sizes()
            .into_iter()
            .map(|(_, method)| match method {
                Method::Adaptive(settings) => settings.size,
                Method::Filter(_) => f64::NAN,
            })
            .collect();
        assert_eq!(sizes[..5], sizes[5..]);
        assert!(sizes[..5].windows(2).all(|two| two[0] < two[1]), "{sizes:?}");
    }
}
