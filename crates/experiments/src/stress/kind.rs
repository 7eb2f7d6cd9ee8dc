use super::class::Class;
use super::recipe::Recipe;

/// A way to make sequences.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Kind {
    /// What is unusual about them.
    pub class: Class,
    /// What reports call it; no other kind of its class has this name.
    pub name: String,
    /// What it is, in a line.
    pub explanation: String,
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) recipe: Recipe,
}

impl Kind {
    pub(super) fn new(class: Class, name: impl Into<String>, explanation: impl Into<String>, recipe: Recipe) -> Self {
        Self { class, name: name.into(), explanation: explanation.into(), recipe }
    }

    /// Class and name, as in `noise/camera shake`: no other kind has it.
    #[must_use]
    pub fn path(&self) -> String {
        format!("{}/{}", self.class, self.name)
    }

    /// Whether the velocity of the middle is judged as well as omega and b.
    pub(super) fn judges_middle(&self) -> bool {
        self.class == Class::Round
    }
}
