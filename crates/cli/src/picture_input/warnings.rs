//! What may be wrong with how pictures are read and traced.
use freeform_motion::outline_io::{AfterContact, AmongAlike, OriginWarning, OriginWarnings};
use freeform_motion::significant;
use nalgebra::Vector2;

use super::{ASSUMED_RATE, PictureInput, ShapeInPicture};
use crate::label_choice::label_warnings;

/// Objects that are told to be perhaps others.
const OBJECTS_TOLD: usize = 5;

/// What is made of pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// A table of outlines.
    Outlines,
    /// Motions of objects, which are looked for by their edges while they touch others.
    Motions,
}

impl Purpose {
    /// What objects that may be others mean for it, and what to do.
    const fn after_contact(self) -> &'static str {
        match self {
            Self::Outlines => {
                "'freeform identify' of the pictures themselves looks for its edges meanwhile, so that it may keep its number"
            }
            Self::Motions => {
                "its edges were not found all the while, so that results of two objects may be those of one, or of several together"
            }
        }
    }
}

impl PictureInput {
    /// What is to be said after all have been read: of the labels, or of what the outlines say of the pixels, and of objects that may be others,
    /// with the codes.
    pub(crate) fn closing_remarks(&self, purpose: Purpose) -> Vec<(OriginWarning, String)> {
        let mut remarks = self.label_warnings();
        if remarks.is_empty() {
            remarks.extend(self.warning_of_aspect());
        }
        remarks.extend(self.warnings_of_names(purpose));
        remarks
    }

    /// Which objects may be others, with the codes.
    pub(crate) fn warnings_of_names(&self, purpose: Purpose) -> Vec<(OriginWarning, String)> {
        self.warning_of_contact(purpose).into_iter().chain(self.warning_of_step()).collect()
    }

    /// Which objects have other numbers after they have touched others, with the code.
    fn warning_of_contact(&self, purpose: Purpose) -> Option<(OriginWarning, String)> {
        let each: Vec<String> = self.traced.after_contact().chunk_by(|a, b| a.name == b.name).map(may_be).collect();
        if each.is_empty() {
            return None;
        }
        let (told, others) = each.split_at(each.len().min(OBJECTS_TOLD));
        let others = if others.is_empty() { String::new() } else { format!("; and {} more", others.len()) };
        let message = format!(
            "{}{others}: by itself or with what it touched for long; {}",
            told.join("; "),
            purpose.after_contact()
        );
        Some((OriginWarning::NewAfterContact, message))
    }

    /// That objects alike may have made another step, with the code.
    fn warning_of_step(&self) -> Option<(OriginWarning, String)> {
        let AmongAlike { frame, step, other } = *self.traced.among_alike().first()?;
        let text = |step: Vector2<f64>| {
            // No digits of one coordinate that are lost in the other.
            let digits = |length: f64| significant(if length.abs() < 0.005 * step.norm() { 0.0 } else { length }, 3);
            format!("({}, {})", digits(step.x), digits(step.y))
        };
        let message = format!(
            "objects that look alike were taken to move by {} from frame {} to {frame}, but may have moved by {}, each to the place of a neighbour: their \
             velocities may be wrong, and those of objects that come later; more frames a second tell, or something by which they differ",
            text(step),
            frame.saturating_sub(1),
            text(other)
        );
        Some((OriginWarning::AmongAlike, message))
    }

    /// What the rows of a table of the pictures read so far should say, beyond what was known before the first.
    pub(crate) fn told_so_far(&self) -> OriginWarnings {
        let is_new = !self.traced.after_contact().is_empty();
        let are_alike = !self.traced.among_alike().is_empty();
        let told = [is_new.then_some(OriginWarning::NewAfterContact), are_alike.then_some(OriginWarning::AmongAlike)];
        told.into_iter().flatten().collect()
    }

    /// What is wrong with the labels of masks read so far, with the codes.
    fn label_warnings(&self) -> Vec<(OriginWarning, String)> {
        self.traced.labels().map(label_warnings).unwrap_or_default()
    }

    /// That the pixels have another aspect, as far as the pictures read so far say, with the code.
    pub(crate) fn warning_of_aspect(&self) -> Option<(OriginWarning, String)> {
        let aspect = self.traced.better_pixel_aspect().filter(|_| self.shape == ShapeInPicture::Kept)?;
        let symptom = "the object keeps its shape as it turns only with pixels of another aspect";
        let message = format!(
            "{symptom}: give --pixel-aspect {aspect:.2} (width over height), or the angles are wrong; or the camera looks at it from aside: --rectify"
        );
        Some((OriginWarning::PixelAspect, message))
    }

    /// Why the way of tracing is not to be trusted, with the codes.
    pub(crate) fn tracing_warnings(&self) -> Vec<(OriginWarning, String)> {
        let drawn = self.options.candidates.as_deref();
        self.chosen.iter().flat_map(|chosen| chosen.warnings(drawn)).collect()
    }

    /// What may be wrong with how they are read and traced, with the codes.
    pub(crate) fn origin_warnings(&self) -> Vec<(OriginWarning, String)> {
        let mut warnings = self.tracing_warnings();
        if self.options.fps.is_none() && self.frame_count().is_some_and(|count| count > 1) {
            let message = format!("{ASSUMED_RATE} frames/s assumed, the pictures do not say; give the rate with --fps");
            warnings.push((OriginWarning::RateAssumed, message));
        }
        if self.traced.is_interlaced() {
            let message = format!("{}; deinterlace it, such as with ffmpeg -vf yadif", OriginWarning::Interlaced);
            warnings.push((OriginWarning::Interlaced, message));
        }
        warnings.extend(self.label_warnings());
        warnings
    }
}

/// Which forgotten objects a new one may be.
fn may_be(pairs: &[AfterContact]) -> String {
    let [AfterContact { frame, name, .. }, ..] = pairs else { return String::new() };
    let forgotten: Vec<String> = pairs.iter().map(|pair| pair.forgotten.to_string()).collect();
    format!("object {name}, new in frame {frame}, may be object {}", forgotten.join(" or "))
}
