//! Where results come from, as far as their warnings depend on it.
use freeform_motion::PictureTracing;
use freeform_motion::tracker::ObjectResult;

/// What is known of how the outlines of all objects of an input were found.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ResultOrigin {
    pub(crate) tracing: PictureTracing,
    pub(crate) naming: Naming,
}

/// Whether outlines of one name are of one thing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Naming {
    /// They are.
    Certain,
    /// They may be of several.
    InDoubt,
}

impl ResultOrigin {
    /// A result with the warnings and the advice that its origin calls for.
    pub(crate) fn told(self, result: ObjectResult) -> ObjectResult {
        let result = result.traced_by(self.tracing);
        match self.naming {
            Naming::Certain => result,
            Naming::InDoubt => result.of_doubtful_outlines(),
        }
    }
}
