//! The kinds, a file for each class.
pub(super) mod dynamics;
pub(super) mod family;
pub(super) mod noise;
pub(super) mod plain;
pub(super) mod round;
pub(super) mod symmetry;

use super::class::Class;
use super::kind::Kind;
use super::recipe::Recipe;

/// Name, explanation and recipe of each kind of a class.
fn of_class<const N: usize>(class: Class, list: [(&str, &str, Recipe); N]) -> Vec<Kind> {
    list.into_iter().map(|(name, explanation, recipe)| Kind::new(class, name, explanation, recipe)).collect()
}
