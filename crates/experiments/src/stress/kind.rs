use super::class::Class;
use super::kinds;
use super::recipe::Recipe;
use crate::ExperimentError;

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

/// All kinds, class by class.
#[must_use]
pub fn all_kinds() -> Vec<Kind> {
    let classes = [
        kinds::plain::kinds,
        kinds::noise::kinds,
        kinds::family::kinds,
        kinds::dynamics::kinds,
        kinds::round::kinds,
        kinds::symmetry::kinds,
    ];
    classes.into_iter().flat_map(|kinds| kinds()).collect()
}

/// The kinds whose class and name, as in `noise/camera shake`, contain a text; all for an empty one.
///
/// # Errors
/// There is none.
pub fn kinds_containing(text: &str) -> Result<Vec<Kind>, ExperimentError> {
    let kinds: Vec<Kind> = all_kinds().into_iter().filter(|kind| kind.path().contains(text)).collect();
    if kinds.is_empty() { Err(ExperimentError::NoSuchKind { text: text.to_owned() }) } else { Ok(kinds) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_at_least_eighty_kinds_with_names_of_their_own_and_every_class_has_some() {
        let all = all_kinds();
        assert!(all.len() >= 80, "{}", all.len());
        for (index, kind) in all.iter().enumerate() {
            assert!(all[..index].iter().all(|other| other.path() != kind.path()), "{}", kind.path());
            assert!(kind.explanation.len() > 10 && !kind.explanation.ends_with('.'), "{}", kind.path());
        }
        for class in Class::ALL {
            assert!(all.iter().filter(|kind| kind.class == class).count() >= 10, "{class}");
        }
    }

    #[test]
    fn kinds_are_chosen_by_class_or_name() {
        let round = kinds_containing("round/").expect("some");
        assert!(round.iter().all(|kind| kind.class == Class::Round));
        assert!(kinds_containing("white").expect("some").len() > 1);
        let message = kinds_containing("nonsense").expect_err("none").to_string();
        assert!(message.contains("nonsense") && message.contains("symmetry"), "{message}");
    }
}
