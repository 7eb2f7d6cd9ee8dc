//! The figures and experiments of M. Unel and B. K. Ghosh, *Motion identification of planar free-form objects*, made anew from
//! simulated outlines, and measurements of what the paper leaves open: one module per family.
//!
//! A [`Reproduction`] makes [`Section`]s: figures as panels of curves, tables, and with each the words that say what it shows and
//! how it was made, since most of them are numbers of the experiment. Nothing is drawn and nothing is laid out here.
mod curves;
mod document;
mod exact_lines;
mod extensions;
mod factors;
mod lyapunov;
mod method;
mod objects;
mod open_questions;
mod outcome;
mod paper_figure;
mod parameters;
mod part;
mod poses;
mod questions;
mod relative_error;
mod sequence;
mod traces;
mod track;

use freeform_identify::AdaptiveSettings;
use freeform_motion::PipelineSettings;
use freeform_sim_camera::PaperExperiment;
use nalgebra::Matrix4;
use rayon::prelude::*;

pub use document::Section;
pub use freeform_drawing::page::{Drawing, Table};
pub use part::Part;

use crate::ExperimentError;

/// What is to be reproduced, and how much of it.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Reproduction {
    /// The figures and tables, in the order of the page.
    pub parts: Vec<Part>,
    /// Length of each experiment, seconds, at least 1.
    pub seconds: f64,
    /// Random initial values tried for each experiment and law, at least 1.
    pub starts: u32,
    /// Noise sequences that each row of a table is the median of, at least 1.
    pub repeats: u32,
    /// All random numbers follow from it.
    pub seed: u64,
}

impl Default for Reproduction {
    fn default() -> Self {
        Self { parts: Part::ALL.into(), seconds: 30.0, starts: 50, repeats: 3, seed: 1 }
    }
}

/// What all parts share.
struct Run<'a> {
    /// Length of each experiment.
    seconds: f64,
    seed: u64,
    /// Random initial values tried.
    starts: u32,
    /// Noise sequences that each row of a table is the median of.
    repeats: u32,
    progress: &'a (dyn Fn() + Sync),
}

impl Run<'_> {
    /// One more sequence has been identified, or one more picture made.
    fn advance(&self) {
        (self.progress)();
    }
}

impl Reproduction {
    /// How often [`run`](Self::run) calls its `progress`.
    #[must_use]
    pub fn step_count(&self) -> u64 {
        self.parts.iter().map(|part| part.steps(self.starts, self.repeats)).sum()
    }

    /// Makes all parts, over the threads of the present rayon pool. `progress` is called after each sequence identified and each
    /// picture made, from any of them. Where parameters are identified, a section with the final errors of all comes first.
    ///
    /// # Errors
    /// What the simulator or an identifier refuses, or a figure whose outline has no curve or no lines.
    pub fn run(&self, progress: &(dyn Fn() + Sync)) -> Result<Vec<Section>, ExperimentError> {
        let &Self { seconds, seed, starts, repeats, .. } = self;
        let run = Run { seconds, seed, starts, repeats, progress };
        let mut sections = self.parts.par_iter().map(|part| part.make(&run)).collect::<Result<Vec<_>, _>>()?;
        let findings: Vec<_> = sections.iter_mut().flat_map(|section| std::mem::take(&mut section.findings)).collect();
        if !findings.is_empty() {
            let tables = vec![parameters::findings_table(findings)];
            sections.insert(0, Section { heading: "Results in short".to_owned(), tables, ..Section::default() });
        }
        Ok(sections)
    }

    /// What all experiments have in common: names and values in words.
    #[must_use]
    pub fn settings(&self) -> Vec<(&'static str, String)> {
        let pipeline = PipelineSettings::default();
        let AdaptiveSettings { stability, definite, .. } = &pipeline.identify;
        let diagonal = |matrix: &Matrix4<f64>| {
            let entries = matrix.diagonal();
            format!("diag({})", entries.iter().map(f64::to_string).collect::<Vec<_>>().join(", "))
        };
        vec![
            ("Length of each experiment", format!("{} s", self.seconds)),
            ("Frames per second", sequence::FPS.to_string()),
            ("Points on each outline", format!("{}, drawn anew in every frame", sequence::POINTS)),
            ("Noise on each coordinate", format!("{}, as in the paper", PaperExperiment::NOISE)),
            ("Camera scale f/Z0", PaperExperiment::SCALE.to_string()),
            ("Size of each object", format!("1 in the image, {} in space", 1.0 / PaperExperiment::SCALE)),
            ("Curve identified from", format!("quartic by {}", method::fit_in_words(&pipeline.fit))),
            ("Am and Q", format!("{} and {}, as in the paper", diagonal(stability), diagonal(definite))),
            ("Random initial values", format!("{} each, drawn {}", self.starts, method::start_range_in_words())),
            ("Noise sequences per row", self.repeats.to_string()),
            ("Seed", self.seed.to_string()),
        ]
    }
}
