//! Recognises flat objects by their outlines, under any affine map of the image.
//!
//! Every outline is moved by its area moments to where it has the inertia of a disc, which leaves a turn and a reflection open, and
//! a quartic is fitted to it there. A [`Recogniser`] compares it with the outlines that it has learnt in three steps:
//!
//! 1. the affine invariants of the curves, by their Mahalanobis distance with the covariances that the noise of the points gives them;
//! 2. an alignment by the related points of both curves, three points fixing an affine map, and by the turn in which the
//!    contours correlate best where those points say nothing (a symmetric outline has them in one place);
//! 3. a check of the whole outline: how far both lie from each other under that map, against what noise accounts for.
//!
//! [`Evidence`] adds up the frames of one object and gives the most probable name, or none.
//!
//! ```
//! use freeform_recognise::{Evidence, RecogniseSettings, Recogniser};
//! use freeform_sim_camera::BuiltInShape;
//! use freeform_curve_fit::Outline;
//! use nalgebra::{Affine2, Matrix3};
//!
//! let outline = |shape: BuiltInShape| Outline::closed(shape.shape().sample(400, 0.0));
//! let mut recogniser = Recogniser::new(RecogniseSettings::default())?;
//! for shape in [BuiltInShape::Plane, BuiltInShape::Phone, BuiltInShape::Hat] {
//!     recogniser.learn(shape.name(), &outline(shape)?)?;
//! }
//! let map = Affine2::from_matrix_unchecked(Matrix3::new(0.9, 0.5, 3.0, -0.3, 1.2, 1.0, 0.0, 0.0, 1.0));
//! let mut evidence = Evidence::new();
//! evidence.add(&recogniser.compare(&outline(BuiltInShape::Phone)?.moved(&map)?)?);
//! let recognition = evidence.recognition(recogniser.settings()).expect("one frame");
//! assert_eq!(recognition.known, Some(1));
//! assert!(recognition.probability > 0.99);
//! assert!((recognition.candidates[0].map.expect("compared").matrix() - map.matrix()).amax() < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
mod alignment;
mod comparison;
mod error;
mod evidence;
mod object_evidence;
mod recogniser;
mod settings;
mod signature;

pub use comparison::{Comparison, OutlineFit};
pub use error::RecogniseError;
pub use evidence::{Candidate, Evidence, Recognition};
pub use object_evidence::{EvidenceByObject, ObjectEvidence};
pub use recogniser::Recogniser;
pub use settings::RecogniseSettings;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
