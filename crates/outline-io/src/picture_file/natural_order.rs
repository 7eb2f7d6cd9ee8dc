//! File names in the order that people count in.
use std::cmp::Ordering;
use std::iter::Peekable;
use std::path::{Path, PathBuf};
use std::str::Chars;

/// Order of file names as people count: runs of digits compare as numbers, so that `frame-9` comes before `frame-10`.
/// Names that differ only in leading zeros are ordered by those.
pub(crate) fn natural_order(a: &str, b: &str) -> Ordering {
    let (mut left, mut right) = (a.chars().peekable(), b.chars().peekable());
    loop {
        let order = match (left.peek(), right.peek()) {
            (None, None) => return a.cmp(b),
            (Some(x), Some(y)) if x.is_ascii_digit() && y.is_ascii_digit() => {
                let (x, y) = (digits(&mut left), digits(&mut right));
                x.len().cmp(&y.len()).then_with(|| x.cmp(&y))
            }
            _ => left.next().cmp(&right.next()),
        };
        if order.is_ne() {
            return order;
        }
    }
}

/// The first two files that follow each other against the numbers in their names, such as `m10.png` and `m2.png`, where a shell has sorted them
/// letter by letter; `None` where there are none, or where all run backwards. Only names in one folder that differ in nothing but numbers are
/// compared.
///
/// ```
/// use std::path::{Path, PathBuf};
///
/// use freeform_outline_io::out_of_number_order;
///
/// let files = ["m1.png", "m10.png", "m2.png"].map(PathBuf::from);
/// assert_eq!(out_of_number_order(&files), Some([Path::new("m10.png"), Path::new("m2.png")]));
/// ```
#[must_use]
pub fn out_of_number_order(files: &[PathBuf]) -> Option<[&Path; 2]> {
    let orders = || files.windows(2).filter_map(|pair| Some((number_order(&pair[0], &pair[1])?, pair)));
    let run_backwards = orders().all(|(order, _)| order.is_gt());
    let (_, pair) = orders().find(|(order, _)| order.is_gt()).filter(|_| !run_backwards)?;
    Some([&pair[0], &pair[1]])
}

/// Order of two files by the numbers in their names; `None` where they differ in anything else.
fn number_order(a: &Path, b: &Path) -> Option<Ordering> {
    let [left, right] = [a.file_name()?.to_str()?, b.file_name()?.to_str()?];
    let is_alike = a.parent() == b.parent() && without_digits(left) == without_digits(right);
    is_alike.then(|| natural_order(left, right))
}

/// A name with every run of digits as one sign.
fn without_digits(name: &str) -> String {
    let mut kept = String::new();
    for character in name.chars().map(|character| if character.is_ascii_digit() { '0' } else { character }) {
        if !(character == '0' && kept.ends_with('0')) {
            kept.push(character);
        }
    }
    kept
}

/// Takes a run of digits without its leading zeros.
fn digits(characters: &mut Peekable<Chars<'_>>) -> String {
    let mut run = String::new();
    while let Some(digit) = characters.next_if(char::is_ascii_digit) {
        if !(run.is_empty() && digit == '0') {
            run.push(digit);
        }
    }
    run
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn numbers_in_names_count_as_numbers() {
        let mut names = ["f10.png", "f9.png", "f009.png", "F1.png", "f1-2.png", "f1-10.png", "g.png", "f.png"];
        names.sort_by(|a, b| natural_order(a, b));
        assert_eq!(names, ["F1.png", "f.png", "f1-2.png", "f1-10.png", "f009.png", "f9.png", "f10.png", "g.png"]);
    }

    #[test]
    fn files_that_a_shell_has_sorted_are_out_of_order_and_those_sorted_by_number_or_reversed_or_alike_in_nothing_are_not()
     {
        let found = |names: &[&str]| {
            let files: Vec<PathBuf> = names.iter().map(PathBuf::from).collect();
            out_of_number_order(&files).map(|pair| pair.map(|path| path.display().to_string()))
        };
        assert_eq!(found(&["a/m0", "a/m1", "a/m10", "a/m11", "a/m2"]), Some(["a/m11", "a/m2"].map(str::to_owned)));
        assert_eq!(found(&["3.png", "1.png", "2.png"]), Some(["3.png", "1.png"].map(str::to_owned)));
        for names in [
            &["m1", "m2", "m10"][..],
            &["m01", "m02", "m10"],
            &["m3", "m2", "m1"],
            &["a/m1", "a/m2", "b/m1"],
            &["left2", "right1"],
            &["b", "a"],
            &["m1"],
            &[],
        ] {
            assert_eq!(found(names), None, "{names:?}");
        }
    }

    proptest! {
        #[test]
        fn it_is_a_total_order(names in prop::collection::vec("[ab0-2]{0,5}", 3)) {
            let order = |i: usize, j: usize| natural_order(&names[i], &names[j]);
            prop_assert_eq!(order(0, 1), order(1, 0).reverse());
            prop_assert_eq!(order(0, 1).is_eq(), names[0] == names[1]);
            if order(0, 1).is_le() && order(1, 2).is_le() {
                prop_assert!(order(0, 2).is_le());
            }
        }
    }
}
