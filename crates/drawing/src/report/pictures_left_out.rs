//! Pictures without an outline, as a report lists them.
use std::ffi::OsStr;
use std::fmt::Write as _;
use std::path::Path;

use freeform_motion::tracker::FrameRanges;

use crate::plot::escape;

/// Number of lines with reasons.
const REASONS_TOLD: usize = 10;

/// Pictures without an outline: by their numbers, a line for each reason in a file. However many they are, they take a bounded room.
///
/// ```
/// use freeform_drawing::PicturesLeftOut;
///
/// let mut left_out = PicturesLeftOut::default();
/// (0..5000).for_each(|frame| left_out.take(frame, "film.gif", "no object"));
/// assert_eq!(left_out.count(), 5000);
/// ```
#[derive(Debug, Clone, Default)]
pub struct PicturesLeftOut {
    lines: Vec<Line>,
    /// Those of reasons beyond the first ones.
    others: FrameRanges,
    other_count: u64,
}

/// Pictures of a file that have no outline for the same reason.
#[derive(Debug, Clone)]
struct Line {
    /// Name of the file, with its folders.
    file: String,
    /// Without the name and the number.
    reason: String,
    frames: FrameRanges,
    count: u64,
}

impl PicturesLeftOut {
    /// Adds the picture of a number that is not less than those before it, by the name of its file, with its folders. The reason is without the name
    /// and the number.
    pub fn take(&mut self, frame: u64, file: &str, reason: &str) {
        let known = self.lines.iter().position(|line| line.file == file && line.reason == reason);
        let line = match known {
            None if self.lines.len() == REASONS_TOLD => {
                self.others.add(frame);
                self.other_count += 1;
                return;
            }
            None => {
                let [file, reason] = [file, reason].map(str::to_owned);
                self.lines.push(Line { file, reason, frames: FrameRanges::default(), count: 0 });
                self.lines.len() - 1
            }
            Some(line) => line,
        };
        self.lines[line].frames.add(frame);
        self.lines[line].count += 1;
    }

    /// How many there are.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.lines.iter().map(|line| line.count).sum::<u64>() + self.other_count
    }

    /// Writes the list, if there are any. A file is named once, by the last part of its name.
    pub(super) fn write(&self, body: &mut String) {
        let count = self.count();
        if count == 0 {
            return;
        }
        let _ = writeln!(body, "<h2>Pictures without an outline: {count}</h2>\n<ul>");
        let mut last_file = None;
        for Line { file, reason, frames, count } in &self.lines {
            body.push_str("<li>");
            if last_file.replace(file) != Some(file) {
                let name = Path::new(file).file_name().map_or_else(|| file.as_str().into(), OsStr::to_string_lossy);
                let _ = write!(body, "{}: ", escape(&name));
            }
            let plural = if *count == 1 { "" } else { "s" };
            let _ = writeln!(body, "frame{plural} {frames}: {}</li>", escape(reason));
        }
        if self.other_count > 0 {
            let _ = writeln!(body, "<li>{} more: {}</li>", self.other_count, self.others);
        }
        body.push_str("</ul>\n");
    }
}
