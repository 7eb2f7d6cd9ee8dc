//! The kinds, a file for each class.
mod dynamics;
mod family;
mod noise;
mod plain;
mod round;
mod symmetry;

use super::class::Class;
use super::kind::Kind;
use super::recipe::Recipe;
use crate::ExperimentError;

/// Name, explanation and recipe of each kind of a class.
fn of_class<const N: usize>(class: Class, list: [(&str, &str, Recipe); N]) -> Vec<Kind> {
    list.into_iter().map(|(name, explanation, recipe)| Kind::new(class, name, explanation, recipe)).collect()
}

/// All kinds, class by class.
#[must_use]
pub fn all_kinds() -> Vec<Kind> {
    let classes = [plain::kinds, noise::kinds, family::kinds, dynamics::kinds, round::kinds, symmetry::kinds];
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
