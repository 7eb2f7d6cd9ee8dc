//! Whether pictures are taken for label masks.
use freeform_motion::outline_io::{
    LabelEvidence, LabelInParts, LabelLeftOut, LabelPictures, OriginWarning, PicturePreview,
};

use crate::args::{ObjectsChoice, PictureOptions};
use crate::failure::Failure;

/// What is to be done with pictures that may be label masks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum LabelChoice {
    /// Every label is an object, as the options say or as the pictures do.
    Labels(Option<LabelEvidence>),
    /// They are traced by their grey values, and look as label masks do.
    Maybe(LabelEvidence),
    /// They are traced by their grey values.
    Greys,
}

impl LabelChoice {
    /// What options and pictures say.
    ///
    /// # Errors
    /// Labels are asked for where there are none, or with options that are not for them.
    pub(crate) fn of(options: &PictureOptions, preview: &PicturePreview) -> Result<Self, Failure> {
        let not_for_labels = options.not_for_labels();
        if options.objects == Some(ObjectsChoice::Labels) {
            refuse(&not_for_labels)?;
            return match preview.single_files() {
                Some(_) => Ok(Self::Labels(None)),
                None => Err(refused_stream()),
            };
        }
        let is_open = matches!(options.objects, None | Some(ObjectsChoice::All)) && !options.has_way();
        if !is_open || !not_for_labels.is_empty() {
            return Ok(Self::Greys);
        }
        Ok(match preview.label_evidence() {
            Some(evidence) if evidence.is_convincing() => Self::Labels(Some(evidence)),
            Some(evidence) if evidence.are_on_ground => Self::Maybe(evidence),
            _ => Self::Greys,
        })
    }

    /// What should be known of it.
    pub(crate) fn note(self) -> Option<String> {
        match self {
            Self::Labels(Some(LabelEvidence { labels, .. })) => Some(format!(
                "label masks: every value but 0 is an object, by its number ({labels} in the pictures looked at; --objects labels; --light takes what \
                 is lighter than a threshold instead)"
            )),
            Self::Maybe(LabelEvidence { labels: 1, .. }) => Some(
                "the pictures have a flat area with a border of 255 around it, as label masks with void borders have: --objects labels takes it for an \
                 object that reaches to the middle of its border"
                    .to_owned(),
            ),
            Self::Maybe(LabelEvidence { labels, .. }) => Some(format!(
                "the pictures have flat areas of {labels} values, as label masks have: --objects labels takes each value for an object"
            )),
            Self::Labels(None) | Self::Greys => None,
        }
    }
}

/// What is wrong with the labels of masks read so far, with the codes.
pub(crate) fn label_warnings(labels: &LabelPictures) -> Vec<(OriginWarning, String)> {
    let in_parts = labels.in_parts().map(|LabelInParts { frame, label, largest, next }| {
        let told = format!(
            "frame {frame}, label {label}: the largest part, of {largest} pixels, is taken, and one of {next} pixels is not; give each object \
             a label of its own"
        );
        (OriginWarning::LabelInParts, told)
    });
    let left_out = labels.left_out().map(|LabelLeftOut { frame, label, reason }| {
        let told = format!("frame {frame}, label {label}: no outline, while others have one: {reason}");
        (OriginWarning::LabelLeftOut, told)
    });
    let void = labels
        .void_in()
        .map(|frame| (OriginWarning::VoidBorders, format!("frame {frame}: {}", OriginWarning::VoidBorders)));
    in_parts.into_iter().chain(left_out).chain(void).collect()
}

/// That labels are asked for where pictures are not files of one each.
pub(crate) fn refused_stream() -> Failure {
    Failure::unusable("--objects labels: label masks are read from files of one picture each (PNG, TIFF, BMP)")
}

fn refuse(not_for_labels: &[&str]) -> Result<(), Failure> {
    match not_for_labels {
        [] => Ok(()),
        given => Err(Failure::unusable(format_args!("--objects labels: not with {}", given.join(", ")))),
    }
}
