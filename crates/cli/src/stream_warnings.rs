//! Warnings of the objects of a stream.
use freeform_motion::Warning;
use freeform_motion::tracker::ObjectResult;

use crate::failure::warn;
use crate::handful::{Line, Rest, handful};
use crate::progress::Verbosity;

/// Lines on objects that have left after which no more is said of others: a stream without end has ever more of them.
const OF_OBJECTS_LEFT: usize = 25;

/// Says what `identify` says of results, of each object of a stream when it has left, and of the others in the end.
#[derive(Debug)]
pub(crate) struct StreamWarnings {
    verbosity: Verbosity,
    /// Lines said of objects that have left.
    said: usize,
}

impl StreamWarnings {
    pub(crate) fn new(verbosity: Verbosity) -> Self {
        Self { verbosity, said: 0 }
    }

    /// Says what there is to say of an object that has left.
    pub(crate) fn of_left(&mut self, result: &ObjectResult) {
        if self.verbosity.is_quiet() || self.said > OF_OBJECTS_LEFT {
            return;
        }
        let lines = handful(&[beyond_lines(result.clone())], Rest::Counted);
        self.said += lines.len();
        lines.iter().for_each(Line::print);
        if self.said > OF_OBJECTS_LEFT {
            warn("there may be warnings of more objects that leave: their last lines have them");
        }
    }

    /// Says what there is to say of the objects that are there in the end.
    pub(crate) fn of_present(&self, results: Vec<ObjectResult>) {
        if self.verbosity.is_quiet() {
            return;
        }
        let results: Vec<ObjectResult> = results.into_iter().map(beyond_lines).collect();
        handful(&results, Rest::Counted).iter().for_each(Line::print);
    }
}

/// A result with the warnings that have not been told: frames have their reasons in their lines, and points out of order are told as they come.
fn beyond_lines(mut result: ObjectResult) -> ObjectResult {
    let is_told = |warning: &Warning| {
        matches!(
            warning,
            Warning::FrameRejected(_) | Warning::MoreFramesRejected { .. } | Warning::PointsOutOfOrder { .. }
        )
    };
    result.warnings.retain(|warning| !is_told(warning));
    result
}
