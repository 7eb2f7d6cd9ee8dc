//! The most important warnings of a result: a handful for each object, the rest counted.
use std::collections::BTreeMap;

use freeform_motion::Warning;
use freeform_motion::tracker::ObjectResult;

/// Lines for one object at most.
const OF_OBJECT: usize = 5;

/// Lines for all objects together at most.
const OF_ALL: usize = 25;

/// What is told of results: the causes first, as their warnings come.
pub(crate) fn handful(results: &[ObjectResult]) -> Vec<String> {
    let mut lines = Vec::new();
    let mut objects = results.iter().filter(|result| !result.warnings.is_empty());
    while let Some(result) = objects.next() {
        let of_object = lines_of(&result.warnings);
        if lines.len() + of_object.len() > OF_ALL {
            let others = 1 + objects.count();
            lines.push(format!("there are warnings of {others} more object(s); --json lists them"));
            break;
        }
        lines.extend(of_object.into_iter().map(|line| format!("object {}: {line}", result.object)));
    }
    lines
}

fn lines_of(warnings: &[Warning]) -> Vec<String> {
    let told = if warnings.len() > OF_OBJECT { OF_OBJECT - 1 } else { warnings.len() };
    let (told, rest) = warnings.split_at(told);
    let mut lines: Vec<String> = told.iter().map(ToString::to_string).collect();
    if !rest.is_empty() {
        let mut counts = BTreeMap::new();
        rest.iter().for_each(|warning| *counts.entry(warning.code()).or_insert(0) += 1);
        let counts: Vec<String> = counts.iter().map(|(code, count)| format!("{count} {code}")).collect();
        lines.push(format!("{} more warnings, which --json lists: {}", rest.len(), counts.join(", ")));
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
        assert_eq!(lines_of(&warnings(0)), [""; 0]);
        assert_eq!(lines_of(&warnings(5)).len(), 5);
        let many = lines_of(&warnings(8));
        assert_eq!(many.len(), 5);
        assert_eq!(many[4], "4 more warnings, which --json lists: 1 diverged, 1 lost, 2 restarted");
        assert_eq!(many[0], Warning::Restarted { times: 0 }.to_string());
    }
}
