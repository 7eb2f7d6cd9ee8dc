//! Monte Carlo of the identification: errors of every method against the Cramer-Rao bound.
//!
//! A [`Study`] simulates many sequences of each shape in each [`Setting`], identifies the motion in each by every [`Method`],
//! and gathers the [`Statistics`]; an [`AcquisitionSetting`] asks only whether the second of two poses is found. The same seed
//! gives the same numbers whatever the number of threads, times aside. [`suite`] holds the settings of docs/accuracy.md.
mod acquisition;
mod estimator;
mod evaluation;
mod report_csv;
mod setting;
mod statistics;
mod study;
pub mod suite;

pub use acquisition::{Acquisition, AcquisitionSetting, Found};
pub use estimator::Method;
pub use evaluation::{Evaluation, MethodResult};
pub use report_csv::write_report_csv;
pub use setting::{PlaneScene, Setting};
pub use statistics::{ParameterStatistics, Statistics};
pub use study::{Report, Study};
