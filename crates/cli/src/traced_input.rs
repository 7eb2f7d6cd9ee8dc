//! Pictures as they are traced: by their grey values, or label by label.
use freeform_motion::outline_io::{
    AfterContact, AmongAlike, LabelPictures, PictureError, PictureSequence, TraceSettings, TracedPicture,
    TracedPictures, TracingSummary,
};

/// The pictures of an input, one after the other.
pub(crate) enum Traced {
    /// Objects are told from the ground by grey values, and keep the numbers that they are given.
    Greys(Box<TracedPictures<PictureSequence>>),
    /// Every label of a mask is an object.
    Labels(Box<LabelPictures>),
}

impl Traced {
    pub(crate) fn tracing_at_once(self, pictures: usize) -> Self {
        match self {
            Self::Greys(traced) => Self::Greys(Box::new(traced.tracing_at_once(pictures))),
            Self::Labels(_) => self,
        }
    }

    /// Number of pictures, where it is known.
    pub(crate) fn frame_count(&self) -> Option<u64> {
        match self {
            Self::Greys(traced) => traced.source().frame_count(),
            Self::Labels(labels) => Some(labels.frame_count()),
        }
    }

    /// Whether the pictures are of a video that says that it is interlaced.
    pub(crate) fn is_interlaced(&self) -> bool {
        matches!(self, Self::Greys(traced) if traced.source().is_interlaced())
    }

    pub(crate) fn trace(&self) -> &TraceSettings {
        match self {
            Self::Greys(traced) => traced.trace(),
            Self::Labels(labels) => labels.trace(),
        }
    }

    pub(crate) fn summary(&self) -> TracingSummary {
        match self {
            Self::Greys(traced) => traced.summary(),
            Self::Labels(labels) => labels.summary(),
        }
    }

    pub(crate) fn better_pixel_aspect(&self) -> Option<f64> {
        match self {
            Self::Greys(traced) => traced.better_pixel_aspect(),
            Self::Labels(_) => None,
        }
    }

    /// The objects so far that may be others which were forgotten while they touched something.
    pub(crate) fn after_contact(&self) -> &[AfterContact] {
        match self {
            Self::Greys(traced) => traced.after_contact(),
            Self::Labels(_) => &[],
        }
    }

    /// Steps so far that objects alike may have made otherwise.
    pub(crate) fn among_alike(&self) -> &[AmongAlike] {
        match self {
            Self::Greys(traced) => traced.among_alike(),
            Self::Labels(_) => &[],
        }
    }

    /// Marks an object as present in a picture in which it was not traced; labels keep their names by themselves.
    pub(crate) fn keep(&mut self, object: &str, frame: u64) {
        if let Self::Greys(traced) = self {
            traced.keep(object, frame);
        }
    }

    /// The masks, where every label is an object.
    pub(crate) fn labels(&self) -> Option<&LabelPictures> {
        match self {
            Self::Greys(_) => None,
            Self::Labels(labels) => Some(labels),
        }
    }
}

impl Iterator for Traced {
    type Item = Result<TracedPicture, PictureError>;

    fn next(&mut self) -> Option<Self::Item> {
        match self {
            Self::Greys(traced) => traced.next(),
            Self::Labels(labels) => labels.next(),
        }
    }
}
