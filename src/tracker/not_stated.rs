use freeform_estimate::ParameterEstimate;
use freeform_outline_filter::{Ambiguity, PlaneAmbiguity};

use super::{family::MotionFamily, observation::Observation, result::ObjectResult};
use crate::Warning;

/// Why a value is not stated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NotStated {
    /// Several turns, or motions of a plane, explain the outlines.
    Ambiguous,
    /// The outlines do not show it.
    Unobservable,
    /// The outlines show it, but it is not known well enough, or no longer.
    Unknown,
}

impl NotStated {
    /// The word that stands in its place: `ambiguous`, `unobservable` or `unknown`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ambiguous => "ambiguous",
            Self::Unobservable => "unobservable",
            Self::Unknown => "unknown",
        }
    }

    /// Names and words of the values of a row that are not stated, as tables have them in one cell: `omega ambiguous; b1 ambiguous`.
    ///
    /// ```
    /// use freeform_motion::tracker::NotStated;
    ///
    /// assert_eq!(NotStated::cell([("omega", NotStated::Ambiguous), ("v1", NotStated::Unknown)]), "omega ambiguous; v1 unknown");
    /// assert_eq!(NotStated::cell([]), "");
    /// ```
    #[must_use]
    pub fn cell<'a>(unstated: impl IntoIterator<Item = (&'a str, Self)>) -> String {
        let each: Vec<String> =
            unstated.into_iter().map(|(name, reason)| format!("{name} {}", reason.name())).collect();
        each.join("; ")
    }

    const fn of(is_ambiguous: bool, is_hidden: bool) -> Self {
        match (is_ambiguous, is_hidden) {
            (true, _) => Self::Ambiguous,
            (_, true) => Self::Unobservable,
            _ => Self::Unknown,
        }
    }
}

/// Whether a parameter has a value.
fn is_stated(found: Option<&[ParameterEstimate]>, name: &str) -> bool {
    found.is_some_and(|found| found.iter().any(|p| p.name == name && p.value.is_some()))
}

/// Whether turns, or motions of a plane, leave a parameter open.
fn is_ambiguous(turns: Option<&Ambiguity>, planes: Option<&PlaneAmbiguity>, name: &str) -> bool {
    turns.is_some_and(|turns| turns.parameters.contains(&name))
        || planes.is_some_and(|planes| planes.parameters.contains(&name))
}

/// The parameters of a family that have no value, in order, each with why.
fn unstated(
    family: MotionFamily,
    found: Option<&[ParameterEstimate]>,
    why: impl Fn(&str) -> NotStated,
) -> Vec<(&'static str, NotStated)> {
    let names = family.parameter_names().iter().copied();
    names.filter(|name| !is_stated(found, name)).map(|name| (name, why(name))).collect()
}

impl ObjectResult {
    /// Why a parameter is not stated, or `normal`, that of a plane; `None` where it is. Of the velocity of the middle ask
    /// [`velocity_not_stated`](Self::velocity_not_stated).
    ///
    /// ```
    /// use freeform_motion::{riccati::MotionModel, tracker::{Method, NotStated, ObjectResult}};
    ///
    /// let nothing = ObjectResult::unknown("left", Method::Filter, MotionModel::Rigid);
    /// assert_eq!(nothing.not_stated("omega"), Some(NotStated::Unknown));
    /// ```
    #[must_use]
    pub fn not_stated(&self, name: &str) -> Option<NotStated> {
        let is_stated = match name {
            "normal" => self.plane.as_ref().is_some_and(|plane| plane.normal().is_some()),
            _ => is_stated(self.parameters().as_deref(), name),
        };
        (!is_stated).then(|| self.why_unstated(name))
    }

    /// The parameters of the motion that are not stated, in order, each with why.
    ///
    /// ```
    /// use freeform_motion::{riccati::MotionModel, tracker::{Method, NotStated, ObjectResult}};
    ///
    /// let nothing = ObjectResult::unknown("left", Method::Filter, MotionModel::Rigid);
    /// assert_eq!(nothing.unstated(), ["omega", "b1", "b2"].map(|name| (name, NotStated::Unknown)));
    /// ```
    #[must_use]
    pub fn unstated(&self) -> Vec<(&'static str, NotStated)> {
        unstated(self.motion, self.parameters().as_deref(), |name| self.why_unstated(name))
    }

    /// Of a value that is not stated.
    fn why_unstated(&self, name: &str) -> NotStated {
        let is_hidden = self.warnings.iter().any(|warning| match warning {
            Warning::NotObservable { parameters, .. }
            | Warning::RotationNotObservable { parameters }
            | Warning::PlaneHardlyMoves { parameters } => parameters.contains(&name),
            _ => false,
        });
        NotStated::of(is_ambiguous(self.ambiguity.as_ref(), self.plane_ambiguity.as_deref(), name), is_hidden)
    }

    /// Why the velocity of the middle is not stated; `None` where it is. Most outlines show it, but among turns that they leave open it is not known
    /// either.
    #[must_use]
    pub fn velocity_not_stated(&self) -> Option<NotStated> {
        self.velocity.is_none().then(|| NotStated::of(self.ambiguity.is_some(), self.hides_velocity))
    }
}

impl Observation {
    /// As [`ObjectResult::not_stated`], as known after the frame.
    #[must_use]
    pub fn not_stated(&self, name: &str) -> Option<NotStated> {
        (!is_stated(self.parameters().as_deref(), name)).then(|| self.why_unstated(name))
    }

    /// As [`ObjectResult::unstated`], of a family of motions, as known after the frame.
    #[must_use]
    pub fn unstated(&self, family: impl Into<MotionFamily>) -> Vec<(&'static str, NotStated)> {
        unstated(family.into(), self.parameters().as_deref(), |name| self.why_unstated(name))
    }

    /// Of a parameter that is not stated.
    fn why_unstated(&self, name: &str) -> NotStated {
        let is_hidden = self.hidden.contains(&name);
        NotStated::of(is_ambiguous(self.ambiguity.as_ref(), self.plane_ambiguity.as_deref(), name), is_hidden)
    }

    /// As [`ObjectResult::velocity_not_stated`], as known after the frame.
    #[must_use]
    pub fn velocity_not_stated(&self) -> Option<NotStated> {
        self.velocity.is_none().then(|| NotStated::of(self.ambiguity.is_some(), self.hides_velocity))
    }

    /// Why a number of the pose is not stated, of those that are not, as known after the frame.
    #[must_use]
    pub fn pose_not_stated(&self) -> NotStated {
        // Not even where it is.
        self.present_state().map_or(NotStated::Unknown, |_| self.turn_not_stated())
    }

    /// Why an angle or matrix of the pose is not stated where it is not.
    pub(super) fn turn_not_stated(&self) -> NotStated {
        NotStated::of(self.ambiguity.is_some(), !self.hidden.is_empty())
    }
}
