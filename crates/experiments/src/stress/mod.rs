//! Sequences that are not what an estimator expects: whether a number that is stated is right, or said to be doubtful.
//!
//! A [`Kind`] is a way to make sequences, such as "a shadow on one side of the picture". [`all_kinds`] has those of docs/honesty.md in six
//! [`Class`]es. A [`StressStudy`] makes runs of each, follows the object by a [`Tracker`](freeform_motion::Tracker) with default settings,
//! in rigid, similarity or affine motion, and holds the values at the last frame against the truth then. The [`Summary`] of a kind tells how often a stated value was more than
//! four standard deviations off without a word, how often nothing was stated, and how often the 95 % intervals held.
//!
//! ```
//! use freeform_experiments::stress::{StressStudy, kinds_containing};
//!
//! let study = StressStudy { runs: 2, ..StressStudy::new(kinds_containing("plain/white noise of 0.5 %")?) };
//! let report = study.run(&|| ())?;
//! assert_eq!(report.overall.runs, 2);
//! # Ok::<(), freeform_experiments::ExperimentError>(())
//! ```
mod body;
mod class;
mod course;
mod fault;
mod fields;
mod judgement;
mod kind;
mod kinds;
mod poses;
mod recipe;
mod rigid_poses;
mod sequence;
mod stretch;
mod study;
mod summary;
mod view;

pub use class::Class;
pub use judgement::{NOTES, Quantity};
pub use kind::Kind;
pub use kinds::{all_kinds, kinds_containing};
pub use study::{KindReport, StressReport, StressStudy};
pub use summary::{PoseSummary, QuantitySummary, Summary};
