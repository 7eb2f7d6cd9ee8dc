//! The most important warnings of a result: a handful for each object, the rest counted.
use std::collections::BTreeMap;

use freeform_motion::Warning;
use freeform_motion::tracker::ObjectResult;

use crate::failure::{warn, warn_of};

/// Lines for one object at most.
const OF_OBJECT: usize = 5;

/// Lines for all objects together at most.
const OF_ALL: usize = 25;

/// A line of what is told of results.
#[derive(Debug, PartialEq)]
pub(crate) struct Line {
    /// Of the warning that it is, if it is one.
    code: Option<&'static str>,
    message: String,
}

impl Line {
    fn without_code(message: String) -> Self {
        Self { code: None, message }
    }

    /// Prints it on standard error.
    pub(crate) fn print(&self) {
        match self.code {
            Some(code) => warn_of(code, &self.message),
            None => warn(&self.message),
        }
    }
}

/// Where the warnings stand that are not told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Rest {
    /// In the document of the results.
    ListedByJson,
    /// Nowhere but in the last line of an object that has left.
    Counted,
}

/// What is told of results: the causes first, as their warnings come.
pub(crate) fn handful(results: &[ObjectResult], rest: Rest) -> Vec<Line> {
    let mut lines = Vec::new();
    let mut objects = results.iter().filter(|result| !result.warnings.is_empty());
    while let Some(result) = objects.next() {
        let of_object = lines_of(&result.warnings, rest);
        if lines.len() + of_object.len() > OF_ALL {
            let others = 1 + objects.count();
            let listed = match rest {
                Rest::ListedByJson => "; --json lists them",
                Rest::Counted => "",
            };
            lines.push(Line::without_code(format!("there are warnings of {others} more object(s){listed}")));
            break;
        }
        let of_object = of_object.into_iter();
        lines.extend(
            of_object.map(|line| Line { message: format!("object {}: {}", result.object, line.message), ..line }),
        );
    }
    lines
}

fn lines_of(warnings: &[Warning], rest: Rest) -> Vec<Line> {
    let told = if warnings.len() > OF_OBJECT { OF_OBJECT - 1 } else { warnings.len() };
    let (told, untold) = warnings.split_at(told);
    let of_warning = |warning: &Warning| Line { code: Some(warning.code()), message: warning.to_string() };
    let mut lines: Vec<Line> = told.iter().map(of_warning).collect();
    if !untold.is_empty() {
        let mut counts = BTreeMap::new();
        untold.iter().for_each(|warning| *counts.entry(warning.code()).or_insert(0) += 1);
        let counts: Vec<String> = counts.iter().map(|(code, count)| format!("{count} {code}")).collect();
        let listed = match rest {
            Rest::ListedByJson => ", which --json lists",
            Rest::Counted => "",
        };
        let others = format!("{} more warnings{listed}: {}", untold.len(), counts.join(", "));
        lines.push(Line::without_code(others));
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_many_warnings_the_first_are_told_and_the_others_counted_by_their_codes() {
        let warnings = |count: usize| -> Vec<Warning> {
            let restarted = (0..count.saturating_sub(2)).map(|times| Warning::Restarted { times });
            restarted.chain([Warning::Lost { last_known: None }, Warning::Diverged]).take(count).collect()
        };
        assert!(lines_of(&warnings(0), Rest::ListedByJson).is_empty());
        assert_eq!(lines_of(&warnings(5), Rest::ListedByJson).len(), 5);
        let many = lines_of(&warnings(8), Rest::ListedByJson);
        assert_eq!(many.len(), 5);
        let others = "4 more warnings, which --json lists: 1 diverged, 1 lost, 2 restarted";
        assert_eq!(many[4], Line::without_code(others.to_owned()));
        let first = Warning::Restarted { times: 0 };
        assert_eq!(many[0], Line { code: Some("restarted"), message: first.to_string() });
    }
}
