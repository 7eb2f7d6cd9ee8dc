//! What may help where pictures are not traced as they should be.
use freeform_motion::outline_io::{PicturePreview, PictureSettings, TraceError};

use crate::args::{ObjectsChoice, PictureOptions};

/// What may help where no object is found.
pub(crate) fn hint(error: &TraceError, options: &PictureOptions) -> Option<&'static str> {
    match error {
        TraceError::NoRing => Some("try another --ring, --ring-width or --channel"),
        TraceError::TooSmall { .. } => Some("try a smaller --min-area, another --threshold, or --dark"),
        TraceError::FillsPicture | TraceError::VisiblePartStraight { .. } | TraceError::NoObject { .. } => {
            Some("try --dark or --light, or another --threshold")
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
