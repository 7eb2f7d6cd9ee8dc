//! What the paper leaves open, answered by measurement: tables of final errors and settling times.
use freeform_identify::{AdaptiveLaw, PairChoice};
use freeform_riccati::MotionModel;
use freeform_sim_camera::PaperExperiment;
use rayon::prelude::*;

use super::Run;
use super::document::Section;
use super::method::{Method, random_start, start_range_in_words};
use super::outcome::{Outcome, percent, rules};
use super::questions::{Condition, Question, questions};
use super::sequence::Sequence;
use super::track::Track;
use crate::ExperimentError;
use freeform_drawing::page::Table;

const EXPERIMENTS: [PaperExperiment; 3] =
    [PaperExperiment::FLIGHT_BIRD, PaperExperiment::GLIDER_OF_TEXT, PaperExperiment::CELLULAR_PHONE];

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
