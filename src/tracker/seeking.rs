//! Frames in which an object is not found as a whole, but some of its edges are, near where it is expected.
use freeform_curve_fit::Outline;
use freeform_outline_filter::{ExpectedOutline, Rejection};
use freeform_outline_io::OutlineFrame;

use super::{Tracker, identifier::Identifier, object::TrackedObject, observation::Observation};
use crate::rejection::RejectionCause;

impl Tracker {
    /// The outline of an object where it is expected at a time in seconds, not before its last frame. `None` unless it is tracked by the
    /// motion filter, in the coordinates of its outlines (without a rectification), and does not rest in a file
    /// (`keep_states_in`, feature `serde`).
    #[must_use]
    pub fn expected_outline(&self, object: &str, time: f64) -> Option<ExpectedOutline> {
        self.objects.positions.get(object).and_then(|position| self.objects.list[*position].expected_outline(time))
    }

    /// Takes an outline as [`push`](Self::push) does. If it does not show the object as it is known, as where it touches another one, `seek` is
    /// asked for arcs near where the object is expected. They are taken in place of the outline if they show it, and returned with the
    /// observation.
    pub fn push_or_seek(
        &mut self,
        frame: &OutlineFrame,
        seek: impl FnOnce(&ExpectedOutline) -> Option<Outline>,
    ) -> (Observation, Option<OutlineFrame>) {
        let object = self.object(&frame.object);
        // Copied only where it may be needed: what follows pictures, which take far longer to be traced.
        let before = object.may_be_sought().then(|| object.clone());
        let observation = object.push(frame);
        if !observation.rejection.as_ref().is_some_and(|rejection| is_of_another_shape(&rejection.cause)) {
            return (observation, None);
        }
        let found = before.and_then(|mut before| {
            let arcs = seek(&before.expected_outline(frame.time)?)?;
            let sought = before.seek(frame.frame, frame.time, arcs)?;
            Some((before, sought))
        });
        match found {
            Some((with_arcs, (observation, arcs))) => {
                *object = with_arcs;
                (observation, Some(arcs))
            }
            None => (observation, None),
        }
    }

    /// Asks `seek` for arcs of an object near where it is expected in a frame that has no outline of it, and takes them if they show it.
    /// `None`, and nothing changed, where they do not, and where the object rests in a file.
    pub fn seek(
        &mut self,
        object: &str,
        frame: u64,
        time: f64,
        seek: impl FnOnce(&ExpectedOutline) -> Option<Outline>,
    ) -> Option<(Observation, OutlineFrame)> {
        let position = *self.objects.positions.get(object)?;
        let known = &mut self.objects.list[position];
        let arcs = seek(&known.expected_outline(time)?)?;
        let mut tried = known.clone();
        let found = tried.seek(frame, time, arcs)?;
        *known = tried;
        Some(found)
    }
}

impl TrackedObject {
    fn may_be_sought(&self) -> bool {
        matches!(self.identifier, Identifier::Filter(_)) && self.rectification.is_none()
    }

    fn expected_outline(&self, time: f64) -> Option<ExpectedOutline> {
        match &self.identifier {
            Identifier::Filter(object) if self.may_be_sought() => object.filter.expected_outline(time),
            _ => None,
        }
    }

    /// Takes arcs in place of an outline; `None`, and an object that is of no use, where they do not show it.
    fn seek(&mut self, frame: u64, time: f64, arcs: Outline) -> Option<(Observation, OutlineFrame)> {
        let arcs = OutlineFrame { frame, time, object: self.name.clone(), outline: arcs };
        let observation = self.push(&arcs);
        observation.is_accepted().then_some((observation, arcs))
    }
}

/// Whether something else was seen than the object, or more. An object that moves otherwise than expected was seen whole.
fn is_of_another_shape(cause: &RejectionCause) -> bool {
    use Rejection::{AgreementTooSmall, NoiseTooLarge, NotFound};
    matches!(cause, RejectionCause::NotAccepted(AgreementTooSmall { .. } | NoiseTooLarge { .. } | NotFound))
}
