use crate::error::RecogniseError;

/// Settings of a [`Recogniser`](crate::Recogniser).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RecogniseSettings {
    /// How well an outline is known at best, in radii of the disc that has its inertia: tracing, pixels and corners cut by the spacing of the
    /// points leave differences that are no noise. In (0, 0.1].
    pub tracing: f64,
    /// Probability before anything is seen that an object is none of the known ones. In (0, 1).
    pub unknown: f64,
}

impl Default for RecogniseSettings {
    fn default() -> Self {
        Self { tracing: 0.005, unknown: 0.5 }
    }
}

impl RecogniseSettings {
    pub(crate) fn check(&self) -> Result<(), RecogniseError> {
        let refuse = |name, value, range| Err(RecogniseError::Setting { name, value, range });
        if !(self.tracing > 0.0 && self.tracing <= 0.1) {
            return refuse("tracing", self.tracing, "(0, 0.1]");
        }
        if !(self.unknown > 0.0 && self.unknown < 1.0) {
            return refuse("unknown", self.unknown, "(0, 1)");
        }
        Ok(())
    }
}
