//! The figures and experiments of the paper, one file per family.
mod curves;
mod document;
mod extensions;
mod factors;
mod method;
mod objects;
mod open_questions;
mod outcome;
mod parameters;
mod poses;
mod sequence;
mod traces;
mod track;

use std::fs;
use std::io::Write as _;
use std::path::Path;

use freeform_motion::PipelineSettings;
use freeform_motion::identify::AdaptiveSettings;
use freeform_motion::sim_camera::PaperExperiment;
use nalgebra::Matrix4;
use rayon::prelude::*;

pub(crate) use document::{Drawing, Section, Table};

use super::command_line;
use crate::args::{Part, ReproduceArgs};
use crate::failure::{Failure, plain};
use crate::output::{Sink, WholeFile, write_page};
use crate::progress::Progress;

const PAGE: &str = "index.html";

const PARTS: [Part; 11] = [
    Part::Objects,
    Part::Factors,
    Part::BirdPoses,
    Part::BirdParameters,
    Part::GliderPoses,
    Part::GliderParameters,
    Part::PhonePoses,
    Part::PhoneParameters,
    Part::OpenQuestions,
    Part::Affine,
    Part::Changing,
];

/// What all parts share.
pub(crate) struct Run<'a> {
    /// Length of each experiment.
    pub(crate) seconds: f64,
    pub(crate) seed: u64,
    /// Random initial values tried.
    pub(crate) starts: u32,
    /// Noise sequences that each row of a table is the median of.
    pub(crate) repeats: u32,
    progress: &'a Progress,
}

impl Run<'_> {
    /// One more sequence has been identified, or one more picture drawn.
    pub(crate) fn advance(&self) {
        self.progress.advance();
    }
}

/// One of the paper's experiments and its two figures.
pub(crate) struct PaperFigure {
    pub(crate) poses: &'static str,
    pub(crate) parameters: &'static str,
    pub(crate) poses_heading: &'static str,
    pub(crate) parameters_heading: &'static str,
    pub(crate) experiment: PaperExperiment,
    /// What a caption says of how the paper is read; may be empty.
    pub(crate) reading: &'static str,
    /// What the paper says of the estimates.
    pub(crate) paper_says: &'static str,
    /// Stream of random numbers that its initial values come from.
    pub(crate) stream: u64,
}

impl PaperFigure {
    /// Number of the figure of its parameters in the paper.
    pub(crate) fn number(&self) -> &str {
        number_in(self.parameters)
    }

    /// Number of the figure of its poses in the paper.
    pub(crate) fn poses_number(&self) -> &str {
        number_in(self.poses)
    }
}

/// The number in `fig6-text`.
fn number_in(name: &str) -> &str {
    name.trim_start_matches("fig").split('-').next().unwrap_or(name)
}

const BIRD: [PaperFigure; 1] = [PaperFigure {
    poses: "fig3",
    parameters: "fig4",
    poses_heading: "Fig. 3: a flight bird and its rigid motion",
    parameters_heading: "Fig. 4: the parameters of the flight bird",
    experiment: PaperExperiment::FLIGHT_BIRD,
    reading: "",
    paper_says: "Note that estimated parameters converge to their true values with reasonably small estimation error.",
    stream: 0,
}];

const GLIDER: [PaperFigure; 2] = [
    GLIDER_OF_TEXT,
    PaperFigure {
        poses: "fig5-caption",
        parameters: "fig6-caption",
        experiment: PaperExperiment::GLIDER_OF_CAPTION,
        reading: " The paper gives the glider's b as (0, 4) in the text and as (4, 0) in the caption of Fig. 6, and \
                  nothing decides between them: this is the caption's.",
        stream: 2,
        ..GLIDER_OF_TEXT
    },
];

const GLIDER_OF_TEXT: PaperFigure = PaperFigure {
    poses: "fig5-text",
    parameters: "fig6-text",
    poses_heading: "Fig. 5: a glider and its rigid motion, by the text and by the caption of Fig. 6",
    parameters_heading: "Fig. 6: the parameters of the glider, by the text and by the caption",
    experiment: PaperExperiment::GLIDER_OF_TEXT,
    reading: " The paper gives the glider's b as (0, 4) in the text and as (4, 0) in the caption of Fig. 6, and \
              nothing decides between them: this is the text's.",
    paper_says: "Note again that estimates converge to their true values in a relatively short time interval with a \
                 relatively small estimation error.",
    stream: 1,
};

const PHONE: [PaperFigure; 1] = [PaperFigure {
    poses: "fig7",
    parameters: "fig8",
    poses_heading: "Fig. 7: a cellular phone and its rigid motion",
    parameters_heading: "Fig. 8: the parameters of the cellular phone",
    experiment: PaperExperiment::CELLULAR_PHONE,
    reading: "",
    paper_says: "Notice the quick convergence and small estimation errors.",
    stream: 3,
}];

impl Part {
    /// How often it advances the progress.
    fn steps(self, args: &ReproduceArgs) -> u64 {
        match self {
            Self::Objects => 10,
            Self::Factors | Self::BirdPoses | Self::PhonePoses => 1,
            Self::GliderPoses => 2,
            Self::BirdParameters | Self::PhoneParameters => parameters::RUNS,
            Self::GliderParameters => 2 * parameters::RUNS,
            Self::OpenQuestions => open_questions::run_count(args.starts, args.repeats),
            Self::Affine => extensions::AFFINE_RUNS,
            Self::Changing => extensions::CHANGING_RUNS,
        }
    }

    fn make(self, run: &Run) -> Result<Section, Failure> {
        match self {
            Self::Objects => objects::section(run),
            Self::Factors => factors::section(run),
            Self::BirdPoses => poses::section(run, &BIRD),
            Self::BirdParameters => parameters::section(run, &BIRD),
            Self::GliderPoses => poses::section(run, &GLIDER),
            Self::GliderParameters => parameters::section(run, &GLIDER),
            Self::PhonePoses => poses::section(run, &PHONE),
            Self::PhoneParameters => parameters::section(run, &PHONE),
            Self::OpenQuestions => open_questions::section(run),
            Self::Affine => extensions::affine(run),
            Self::Changing => extensions::changing(run),
        }
    }
}

/// Makes the figures and tables asked for and the page that shows them.
pub(crate) fn run(args: &ReproduceArgs) -> Result<(), Failure> {
    let folder = &args.out;
    fs::create_dir_all(folder)
        .map_err(|error| Failure::unusable(format_args!("{}: {}", folder.display(), plain(&error))))?;
    let parts: Vec<Part> = PARTS.into_iter().filter(|part| args.only.is_empty() || args.only.contains(part)).collect();
    let progress = Progress::of_runs(parts.iter().map(|part| part.steps(args)).sum());
    let run =
        Run { seconds: args.seconds, seed: args.seed, starts: args.starts, repeats: args.repeats, progress: &progress };
    let mut sections = parts.par_iter().map(|part| part.make(&run)).collect::<Result<Vec<_>, _>>()?;
    drop(progress);
    let findings: Vec<_> = sections.iter_mut().flat_map(|section| std::mem::take(&mut section.findings)).collect();
    if !findings.is_empty() {
        let tables = vec![parameters::findings_table(findings)];
        sections.insert(0, Section { heading: "Results in short".to_owned(), tables, ..Section::default() });
    }
    sections.iter().try_for_each(|section| section.write_files(folder))?;
    let page = write_page(
        "Motion identification of planar free-form objects, reproduced",
        INTRODUCTION,
        &sections,
        &settings(args),
        &command_line(),
    );
    WholeFile::write(&folder.join(PAGE), &page)?;
    print(&sections, folder)
}

const INTRODUCTION: &str = "The figures and experiments of M. Unel and B. K. Ghosh, Motion identification of planar \
    free-form objects, made anew from simulated outlines, and beside them what the paper leaves open or only announces. \
    Every figure stands beside this page as SVG, and the numbers behind it as CSV.";

fn settings(args: &ReproduceArgs) -> Vec<(&'static str, String)> {
    let pipeline = PipelineSettings::default();
    let AdaptiveSettings { stability, definite, .. } = &pipeline.identify;
    let diagonal = |matrix: &Matrix4<f64>| {
        let entries = matrix.diagonal();
        format!("diag({})", entries.iter().map(f64::to_string).collect::<Vec<_>>().join(", "))
    };
    vec![
        ("Length of each experiment", format!("{} s", args.seconds)),
        ("Frames per second", sequence::FPS.to_string()),
        ("Points on each outline", format!("{}, drawn anew in every frame", sequence::POINTS)),
        ("Noise on each coordinate", format!("{}, as in the paper", PaperExperiment::NOISE)),
        ("Camera scale f/Z0", PaperExperiment::SCALE.to_string()),
        ("Size of each object", format!("1 in the image, {} in space", 1.0 / PaperExperiment::SCALE)),
        ("Curve identified from", format!("quartic by {}", method::fit_in_words(&pipeline.fit))),
        ("Am and Q", format!("{} and {}, as in the paper", diagonal(stability), diagonal(definite))),
        ("Random initial values", format!("{} each, drawn {}", args.starts, method::start_range_in_words())),
        ("Noise sequences per row", args.repeats.to_string()),
        ("Seed", args.seed.to_string()),
    ]
}

fn print(sections: &[Section], folder: &Path) -> Result<(), Failure> {
    let mut sink = Sink::stdout();
    let written = sections
        .iter()
        .flat_map(|section| &section.tables)
        .try_for_each(|table| writeln!(sink, "{}\n{}", table.title, table.text()));
    let written = written.and_then(|()| {
        let drawings: usize = sections.iter().map(|section| section.drawings.len()).sum();
        writeln!(
            sink,
            "{drawings} figure(s) with their numbers, and the page that shows them: {}",
            folder.join(PAGE).display()
        )
    });
    written.map_err(|error| sink.failure(&error))?;
    sink.finish()
}
