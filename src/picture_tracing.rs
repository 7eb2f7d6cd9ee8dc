//! How pictures were traced, which decides what warnings of their outlines can advise.

/// How the outlines of objects were found in pictures, as far as it is known.
///
/// ```
/// use freeform_motion::{PictureTracing, TracedContours, TracedGround, Warning};
/// use freeform_motion::{riccati::MotionModel, tracker::{Method, ObjectResult}};
///
/// let warnings = vec![Warning::NotObservable { parameters: vec!["omega"], contours: TracedContours::default() }];
/// let disc = ObjectResult { warnings, ..ObjectResult::unknown("disc", Method::Filter, MotionModel::Rigid) };
/// let tracing = PictureTracing { ground: TracedGround::GreyValues, contours: TracedContours::BoundaryAlone };
/// assert!(disc.traced_by(tracing).warnings[0].to_string().contains("--contours all"));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PictureTracing {
    /// What told the objects from the ground.
    pub ground: TracedGround,
    /// Which contours of an object were traced.
    pub contours: TracedContours,
}

/// What told objects from the ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TracedGround {
    /// Nothing that a background would take the place of: tables, masks, and rings.
    #[default]
    Unknown,
    /// Grey values, without a picture of the ground.
    GreyValues,
    /// The difference from a background.
    Background,
}

/// Which contours of an object were traced.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TracedContours {
    /// All that are known of.
    #[default]
    AllKnown,
    /// The boundary alone, though there may be holes and marks within.
    BoundaryAlone,
}
