//! Pictures that gave no outline.
use freeform_drawing::PicturesLeftOut;
use freeform_motion::tracker::FrameRanges;

use crate::seen::{Missing, MissingKind};

/// Pictures kept with their reasons.
const PICTURES_KEPT: usize = 1000;

/// The pictures left out so far, with their reasons.
#[derive(Debug, Default)]
pub(crate) struct LeftOut {
    /// Number and reason of the first of them.
    pub(crate) pictures: Vec<(u64, String)>,
    /// All of them, as a report lists them.
    pub(crate) listed: PicturesLeftOut,
    /// How many of all could be read.
    pub(crate) readable: u64,
}

impl LeftOut {
    pub(crate) fn take(&mut self, missing: &Missing) {
        self.readable += u64::from(missing.seen_in.is_some());
        self.listed.take(missing.frame, &missing.file, missing.bare_reason());
        if self.pictures.len() < PICTURES_KEPT {
            self.pictures.push((missing.frame, missing.reason.clone()));
        }
    }
}

/// Warnings of pictures left out: the first of a kind at once, the others in the end, together.
#[derive(Debug, Default)]
pub(crate) struct MissingWarnings {
    kinds: Vec<SameKind>,
}

#[derive(Debug)]
struct SameKind {
    kind: MissingKind,
    /// Reason of the second picture, printed in full if there is no third.
    second: Option<String>,
    count: u64,
    /// All but the first.
    others: FrameRanges,
}

impl MissingWarnings {
    /// Takes a picture. Returns the warning to print now, if any.
    pub(crate) fn take(&mut self, missing: &Missing) -> Option<String> {
        let Some(same) = self.kinds.iter_mut().find(|same| same.kind == missing.kind) else {
            let (kind, others) = (missing.kind, FrameRanges::default());
            self.kinds.push(SameKind { kind, second: None, count: 1, others });
            return Some(missing.advice());
        };
        same.count += 1;
        same.others.add(missing.frame);
        same.second.get_or_insert_with(|| missing.reason.clone());
        None
    }

    /// The warnings to print at the end.
    pub(crate) fn finish(self) -> impl Iterator<Item = String> {
        self.kinds.into_iter().filter_map(|same| match same.count {
            0 | 1 => None,
            2 => same.second,
            count => Some(format!("{} more pictures left out for the same reason: {}", count - 1, same.others)),
        })
    }
}

#[cfg(test)]
mod tests {
    use std::io::{Error, ErrorKind};

    use freeform_motion::outline_io::{PictureErrorKind, TraceError};

    use super::*;

    fn missing(frame: u64, error: TraceError) -> Missing {
        let reason = format!("frame {frame}: {error}");
        let (file, hint, kind) = (String::new(), Some("look elsewhere"), MissingKind::from(&error));
        Missing { frame, file, reason, hint, kind, seen_in: None }
    }

    #[test]
    fn the_first_of_a_kind_is_told_at_once_and_the_others_together() {
        let mut warnings = MissingWarnings::default();
        let small = |pixels| TraceError::TooSmall { pixels, needed: 64 };
        let told = [(0, TraceError::NoRing), (1, small(3)), (2, small(4)), (4, TraceError::NoRing), (5, small(5))]
            .map(|(frame, error)| warnings.take(&missing(frame, error)));
        let first = "frame 0: no object: no closed ring stands out from the ground; look elsewhere";
        assert_eq!(told[0].as_deref(), Some(first));
        assert!(told[1].is_some() && told[2..].iter().all(Option::is_none));
        let later: Vec<String> = warnings.finish().collect();
        assert_eq!(later[0], "frame 4: no object: no closed ring stands out from the ground");
        assert_eq!(later[1], "2 more pictures left out for the same reason: 2, 5");
    }

    #[test]
    fn all_pictures_are_counted_and_the_reasons_of_the_first_are_kept() {
        let mut left_out = LeftOut::default();
        let at = |frame, reason: &str| Missing {
            file: "a/film.gif".to_owned(),
            reason: format!("a/film.gif: {reason}"),
            ..missing(frame, TraceError::NoRing)
        };
        (0..1500).for_each(|frame| left_out.take(&at(frame, &format!("frame {frame}: no ring"))));
        assert_eq!((left_out.listed.count(), left_out.pictures.len()), (1500, 1000));
        assert_eq!(left_out.pictures[4], (4, "a/film.gif: frame 4: no ring".to_owned()));
    }

    #[test]
    fn different_answers_of_the_system_are_different_reasons() {
        let mut warnings = MissingWarnings::default();
        let told = [ErrorKind::NotFound, ErrorKind::PermissionDenied, ErrorKind::NotFound].map(|kind| {
            let error = PictureErrorKind::from(Error::from(kind));
            let (reason, kind) = (error.to_string(), MissingKind::from(&error));
            warnings.take(&Missing { frame: 0, file: String::new(), reason, hint: None, kind, seen_in: None })
        });
        assert!(told[0].is_some() && told[1].is_some() && told[2].is_none());
    }
}
