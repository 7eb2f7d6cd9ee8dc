//! What may help where pictures are not traced as they should be.
use freeform_motion::outline_io::{PicturePreview, PictureSettings, TraceError};

use crate::args::{ObjectsChoice, PictureOptions};

/// What may help where no object is found.
pub(crate) fn hint(error: &TraceError, options: &PictureOptions) -> Option<&'static str> {
    match error {
        TraceError::NoRing => Some("try another --ring, --ring-width or --channel"),
        TraceError::TooSmall { .. } if options.dark => {
            Some("try a smaller --min-area, another --threshold, or --light")
        }
        TraceError::TooSmall { .. } => Some("try a smaller --min-area, another --threshold, or --dark"),
        TraceError::FillsPicture | TraceError::VisiblePartStraight { .. } | TraceError::NoObject { .. } => {
            Some(match (options.light, options.dark) {
                (_, true) => "try --light, or another --threshold",
                (true, false) => "try --dark, or another --threshold",
                (false, false) => "try --dark or --light, or another --threshold",
            })
        }
        TraceError::NoContrast { .. } if options.background.is_some() => {
            Some("try another --background, --threshold or --channel")
        }
        TraceError::NoContrast { .. } if options.dark => {
            Some("try --threshold, --light, --background median, --ring or --channel")
        }
        TraceError::NoContrast { .. } => Some("try --threshold, --dark, --background median, --ring or --channel"),
        _ => None,
    }
}

/// What finds bodies of drawn pictures that one threshold leaves out, if it does.
pub(crate) fn missed_bodies(
    preview: &PicturePreview,
    settings: &PictureSettings,
    options: &PictureOptions,
) -> Option<String> {
    let is_by_threshold = options.background.is_none() && options.ring.is_none() && options.margins.is_none();
    let is_one_asked_for = matches!(options.objects, Some(ObjectsChoice::Largest | ObjectsChoice::Nearest));
    if !is_by_threshold || is_one_asked_for {
        return None;
    }
    let level = preview.level_of_missed(&settings.trace, options.channel().channel())?;
    Some(format!(
        "bodies of other grey values are not followed: --background surface --threshold {level} --objects all finds what differs from the ground"
    ))
}

#[cfg(test)]
mod tests {
    use clap::Parser as _;

    use super::*;

    #[derive(clap::Parser)]
    struct Given {
        #[command(flatten)]
        pictures: PictureOptions,
    }

    #[test]
    fn a_side_of_the_ground_that_was_given_is_not_among_what_may_help() {
        for error in [TraceError::FillsPicture, TraceError::TooSmall { pixels: 9, needed: 64 }] {
            for (given, other) in [("--dark", "--light"), ("--light", "--dark")] {
                let Given { pictures } = Given::parse_from(["", given]);
                let told = hint(&error, &pictures).expect("something may help");
                assert!(told.contains(other) && !told.contains(given), "{given}: {told}");
            }
        }
    }
}
