use super::document::Section;
use super::paper_figure::{BIRD, GLIDER, PHONE};
use super::{Run, extensions, factors, lyapunov, objects, open_questions, parameters, poses};
use crate::ExperimentError;

/// A figure of the paper, or what goes beyond it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Part {
    /// Fig. 1: the ten objects and their quartics.
    Objects,
    /// Fig. 2: the boomerang and its line factors.
    Factors,
    /// Fig. 3: the flight bird along its motion.
    BirdPoses,
    /// Fig. 4: the flight bird's estimated parameters.
    BirdParameters,
    /// Fig. 5: the glider along its motion, by text and by caption.
    GliderPoses,
    /// Fig. 6: the glider's estimated parameters, by text and by caption.
    GliderParameters,
    /// Fig. 7: the cellular phone along its motion.
    PhonePoses,
    /// Fig. 8: the cellular phone's estimated parameters.
    PhoneParameters,
    /// Error of the estimator, Lyapunov function and the 36 numbers over lines that move exactly.
    Lyapunov,
    /// Tables of what the paper leaves open: noise, frame rate, scale, line pair, laws, size, gains, curve fit, initial values.
    OpenQuestions,
    /// Affine motion, which the paper announces.
    Affine,
    /// A motion that changes slowly.
    Changing,
}

impl Part {
    /// All of them, in the order of the page.
    pub const ALL: [Self; 12] = [
        Self::Objects,
        Self::Factors,
        Self::BirdPoses,
        Self::BirdParameters,
        Self::GliderPoses,
        Self::GliderParameters,
        Self::PhonePoses,
        Self::PhoneParameters,
        Self::Lyapunov,
        Self::OpenQuestions,
        Self::Affine,
        Self::Changing,
    ];

    /// The number of its figure in the paper, or a word.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Objects => "1",
            Self::Factors => "2",
            Self::BirdPoses => "3",
            Self::BirdParameters => "4",
            Self::GliderPoses => "5",
            Self::GliderParameters => "6",
            Self::PhonePoses => "7",
            Self::PhoneParameters => "8",
            Self::Lyapunov => "lyapunov",
            Self::OpenQuestions => "open",
            Self::Affine => "affine",
            Self::Changing => "changing",
        }
    }

    /// What it shows, in a line.
    #[must_use]
    pub const fn description(self) -> &'static str {
        match self {
            Self::Objects => "The ten objects and their quartics",
            Self::Factors => "The boomerang and its line factors",
            Self::BirdPoses => "The flight bird along its motion",
            Self::BirdParameters => "The flight bird's estimated parameters",
            Self::GliderPoses => "The glider along its motion, by text and by caption",
            Self::GliderParameters => "The glider's estimated parameters, by text and by caption",
            Self::PhonePoses => "The cellular phone along its motion",
            Self::PhoneParameters => "The cellular phone's estimated parameters",
            Self::Lyapunov => "Error of the estimator and Lyapunov function over exact lines",
            Self::OpenQuestions => "Tables of what the paper leaves open",
            Self::Affine => "Affine motion, six parameters",
            Self::Changing => "A motion that changes slowly",
        }
    }

    /// How often it advances the progress.
    pub(super) fn steps(self, starts: u32, repeats: u32) -> u64 {
        match self {
            Self::Objects => 10,
            Self::Factors | Self::BirdPoses | Self::PhonePoses => 1,
            Self::GliderPoses => 2,
            Self::BirdParameters | Self::PhoneParameters => parameters::RUNS,
            Self::GliderParameters => 2 * parameters::RUNS,
            Self::Lyapunov => lyapunov::RUNS,
            Self::OpenQuestions => open_questions::run_count(starts, repeats),
            Self::Affine => extensions::AFFINE_RUNS,
            Self::Changing => extensions::CHANGING_RUNS,
        }
    }

    pub(super) fn make(self, run: &Run) -> Result<Section, ExperimentError> {
        match self {
            Self::Objects => objects::section(run),
            Self::Factors => factors::section(run),
            Self::BirdPoses => poses::section(run, &BIRD),
            Self::BirdParameters => parameters::section(run, &BIRD),
            Self::GliderPoses => poses::section(run, &GLIDER),
            Self::GliderParameters => parameters::section(run, &GLIDER),
            Self::PhonePoses => poses::section(run, &PHONE),
            Self::PhoneParameters => parameters::section(run, &PHONE),
            Self::Lyapunov => lyapunov::section(run),
            Self::OpenQuestions => open_questions::section(run),
            Self::Affine => extensions::affine(run),
            Self::Changing => extensions::changing(run),
        }
    }
}
