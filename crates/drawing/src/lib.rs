//! Pictures of identified motion, without the program: figures as SVG, outlines drawn on the pictures that they come from, and pages that need
//! nothing but themselves. Nothing is read or written here but what callers hand over: every drawing is a text, a picture, or goes to a sink.
//!
//! - [`write_report`]: a report of what a tracker found, with a player of the frames; [`Histories`] collects what it shows, frame by frame
//! - [`parameter_figure`], [`fit_figure`]: parameters over time, outlines with their fitted curves
//! - [`figure`], [`Svg`]: figures as panels of curves, and what draws them
//! - [`ObservedOverlay`], [`Overlay`]: outlines, curves and motion on pictures; [`GifAnimation`], [`Y4mVideo`] and [`marked_png`] encode these
//! - [`candidate_sheet`]: what each way of tracing finds in pictures
//! - [`page`]: a page of figures and tables
//!
//! ```
//! use freeform_drawing::{CurveFitter, Findings, Histories, MeaningOfB, Purpose, Report, write_report};
//! use freeform_motion::curve_fit::Degree;
//! use freeform_motion::outline_io::{DEFAULT_OBJECT, OutlineFrame};
//! use freeform_motion::sim_camera::{PaperExperiment, SequenceLength, Settings, Simulator};
//! use freeform_motion::{Tracker, TrackerSettings};
//!
//! let settings = Settings { length: SequenceLength::Frames(20), ..Settings::default() };
//! let simulator = Simulator::new(PaperExperiment::FLIGHT_BIRD.scene(0.1)?, settings)?;
//! let mut tracker = Tracker::new(TrackerSettings::default())?;
//! let mut histories = Histories::new(Purpose::Report(None), CurveFitter::new(Degree::Quartic, false)?);
//! for seen in simulator.frames() {
//!     let (object, outline) = (DEFAULT_OBJECT.to_owned(), seen.outline);
//!     let frame = OutlineFrame { frame: seen.index as u64, time: seen.time, object, outline };
//!     histories.take(&tracker.push(&frame), Some(&frame));
//! }
//! histories.close();
//! let results = tracker.results();
//! let report = Report {
//!     title: "A bird".to_owned(),
//!     meaning_of_b: MeaningOfB::in_coordinates(None),
//!     findings: vec![Findings { results: &results, histories: &histories }],
//!     ..Report::default()
//! };
//! let mut page = Vec::new();
//! write_report(&mut page, &report)?;
//! assert!(String::from_utf8(page)?.contains("Angular velocity omega"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
mod candidate_sheet;
mod error;
pub mod figure;
mod history;
mod overlay;
pub mod page;
mod plot;
mod report;

pub use candidate_sheet::candidate_sheet;
pub use error::DrawingError;
pub use history::{CurveFitter, Histories, OBJECTS_PLAYED, Purpose};
pub use overlay::{Drawn, DrawnPicture, GifAnimation, ObservedOverlay, Overlay, Y4mVideo, is_marked_png, marked_png};
pub use plot::Svg;
pub use report::{
    Findings, MeaningOfB, PARAMETER_COLUMNS, PicturesLeftOut, Report, fit_figure, meaning_of_v, parameter_figure,
    parameter_rows, write_report,
};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
