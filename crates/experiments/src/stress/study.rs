use freeform_motion::outline_io::{DEFAULT_OBJECT, OutlineFrame};
use freeform_motion::tracker::{Method, Trajectory};
use freeform_motion::{Tracker, TrackerSettings};
use freeform_riccati::MotionModel;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::class::Class;
use super::judgement::Outcome;
use super::kind::Kind;
use super::poses::PoseErrors;
use super::sequence::Sequence;
use super::summary::Summary;
use crate::ExperimentError;

/// Kinds of sequences, and how many of each are made.
#[derive(Debug, Clone)]
pub struct StressStudy {
    /// The kinds.
    pub kinds: Vec<Kind>,
    /// The family of motions that is asked for: rigid, similarity or affine. The motions of a kind become those of the family by a picture that grows
    /// or shrinks, and a plane that is seen aslant. Constant generators stay constant: the picture grows about the point that they leave
    /// where it is. Other motions, and what is at rest, grow about the origin.
    pub model: MotionModel,
    /// Sequences of each kind, at least 1.
    pub runs: usize,
    /// Frames after which what is stated is judged, taken to be 2 at least; longer than a sequence means all of it; `None` for whole sequences.
    pub frames: Option<usize>,
    /// Everything random follows from it.
    pub seed: u64,
}

/// What came of a [`StressStudy`].
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct StressReport {
    /// The family of motions that was asked for.
    pub model: MotionModel,
    /// Sequences of each kind.
    pub runs: usize,
    /// Frames after which what is stated was judged; `None` for whole sequences.
    pub frames: Option<usize>,
    /// What everything random followed from.
    pub seed: u64,
    /// One for each kind, in the order of the study.
    pub kinds: Vec<KindReport>,
    /// All runs of each class that has some.
    pub classes: Vec<(Class, Summary)>,
    /// All runs.
    pub overall: Summary,
}

/// What came of one kind.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct KindReport {
    /// The kind.
    pub kind: Kind,
    /// Its runs.
    pub summary: Summary,
}

impl StressStudy {
    /// Twenty whole sequences of each kind, rigid motion, seed 0.
    #[must_use]
    pub const fn new(kinds: Vec<Kind>) -> Self {
        Self { kinds, model: MotionModel::Rigid, runs: 20, frames: None, seed: 0 }
    }

    /// Runs in all: how often [`run`](Self::run) calls its `progress`.
    #[must_use]
    pub fn run_count(&self) -> usize {
        self.kinds.len() * self.runs
    }

    /// Carries out every run, over the threads of the present rayon pool. `progress` is called after each, from any of them. The same
    /// seed gives the same report whatever the number of threads, and a kind the same figures whatever other kinds there are.
    ///
    /// # Errors
    /// What the simulator or the tracker refuses, and projective motion.
    pub fn run(&self, progress: &(dyn Fn() + Sync)) -> Result<StressReport, ExperimentError> {
        let frames = self.frames.map(|frames| frames.max(2));
        let outcomes = (0..self.run_count()).into_par_iter().map(|job| {
            let outcome = self.run_one(&self.kinds[job / self.runs], frames, job % self.runs);
            progress();
            outcome
        });
        let outcomes = outcomes.collect::<Result<Vec<Outcome>, ExperimentError>>()?;
        let by_kind: Vec<(&Kind, &[Outcome])> = self.kinds.iter().zip(outcomes.chunks(self.runs.max(1))).collect();
        let of_class = |class: Class| {
            let mut outcomes =
                by_kind.iter().filter(|(kind, _)| kind.class == class).flat_map(|(_, runs)| *runs).peekable();
            outcomes.peek()?;
            Some((class, Summary::of(outcomes)))
        };
        Ok(StressReport {
            model: self.model,
            runs: self.runs,
            frames,
            seed: self.seed,
            kinds: by_kind
                .iter()
                .map(|(kind, runs)| KindReport { kind: (*kind).clone(), summary: Summary::of(runs.iter()) })
                .collect(),
            classes: Class::ALL.into_iter().filter_map(of_class).collect(),
            overall: Summary::of(outcomes.iter()),
        })
    }

    /// One sequence, followed by a tracker with default settings.
    fn run_one(&self, kind: &Kind, frames: Option<usize>, number: usize) -> Result<Outcome, ExperimentError> {
        let recipe = &kind.recipe;
        let count = frames.map_or(recipe.frames, |frames| frames.min(recipe.frames));
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed ^ hash(&kind.path()));
        rng.set_stream(number as u64);
        let sequence = Sequence::new(recipe, self.model, &mut rng)?;
        let (truth, true_poses) = (sequence.truth(count - 1), sequence.poses());
        let mut trajectory = Trajectory::default();
        let mut tracker = Tracker::new(TrackerSettings::new(Method::Filter, self.model))?;
        for seen in sequence.frames(count, &mut rng) {
            let frame = seen.index as u64;
            let object = DEFAULT_OBJECT.to_owned();
            trajectory.take(&match seen.outline {
                Some(outline) => tracker.push(&OutlineFrame { frame, time: seen.time, object, outline }),
                None => tracker.reject(&object, frame, format!("frame {frame} has no outline")),
            });
        }
        let frame_rate = recipe.fps / recipe.time_unit;
        let poses = true_poses.map(|truth| PoseErrors::of(&trajectory, &truth));
        let outcome = Outcome::of(tracker.results().first(), &truth, frame_rate, self.model, kind.judges_middle());
        Ok(outcome.with_poses(poses))
    }
}

/// A number that stands for a text, the same on every machine (FNV-1a, 64 bits).
fn hash(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stress::{Quantity, kinds_containing};

    fn study(text: &str) -> StressStudy {
        StressStudy::new(kinds_containing(text).expect("some"))
    }

    fn report(text: &str, seed: u64) -> StressReport {
        StressStudy { runs: 2, seed, ..study(text) }.run(&|| ()).expect("a report")
    }

    #[test]
    fn what_the_filter_assumes_is_stated_and_right() {
        let report = report("plain/8 frames", 1);
        assert_eq!(
            (report.overall.runs, report.overall.silent_wrong, report.overall.unstated),
            (2, Some(0.0), Some(0.0))
        );
        assert_eq!(report.classes.len(), 1);
        let quantities: Vec<Quantity> = report.overall.quantities.iter().map(|of| of.quantity).collect();
        assert_eq!(quantities, [Quantity::Omega, Quantity::B]);
    }

    /// Two turns explain it, and the angle of no pose is stated.
    const AMBIGUOUS: (&str, f64) = ("symmetry/gear of 8 teeth, 0.45 of a pitch", 1.0);

    #[test]
    fn poses_on_the_way_are_judged_where_they_are_rigid_and_those_of_symmetric_bodies_but_for_their_symmetry() {
        for (kind, unstated) in [("plain/8 frames", 0.0), ("symmetry/gear of 8 teeth, 0.2 of a pitch", 0.0), AMBIGUOUS]
        {
            let poses = report(kind, 1).overall.poses.expect("poses");
            assert_eq!((poses.off, poses.turn_unstated), (Some(0.0), Some(unstated)), "{kind}");
            // Of angles there are none where none is stated.
            assert_eq!(poses.turn_coverage.is_some(), unstated == 0.0, "{kind}");
            let held = [poses.turn_coverage.unwrap_or(1.0), poses.place_coverage.expect("some")];
            assert!(held.iter().all(|share| *share > 0.7), "{kind}: {held:?}");
        }
        assert_eq!(report("noise/camera shake", 1).overall.poses, None);
        let growing = StressStudy { runs: 1, model: MotionModel::Similarity, ..study("plain/8 frames") };
        assert_eq!(growing.run(&|| ()).expect("a report").overall.poses, None);
    }

    #[test]
    fn a_disc_states_no_turn_and_the_velocity_of_its_middle() {
        let report = report("round/disc rolling to rest", 1);
        let [omega, _, v] = &report.overall.quantities[..] else { panic!("{report:?}") };
        assert_eq!((omega.unstated, v.unstated), (Some(1.0), Some(0.0)));
    }

    #[test]
    fn a_kind_has_the_same_figures_whatever_other_kinds_there_are() {
        let alone = report("plain/3 frames", 5);
        let among_others = report("frames", 5);
        let same = among_others.kinds.iter().find(|of| of.kind.name == "3 frames").expect("the kind");
        assert_eq!(same.summary, alone.kinds[0].summary);
        let classes: Vec<Class> = among_others.classes.iter().map(|(class, _)| *class).collect();
        assert_eq!(classes, [Class::Plain, Class::Dynamics]);
        assert_eq!(among_others.overall.runs, 2 * among_others.kinds.len());
    }
}
