//! What the program that found outlines had to say of them.
use std::fmt;

use crate::choice::TracingWarning;

/// What a user should know of how outlines were found: what the program that found them said, which goes with them in the column `warning` of a
/// table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OriginWarning {
    /// [`TracingWarning::Doubtful`].
    TracingDoubtful,
    /// [`TracingWarning::MovesBesideRest`].
    MovesBesideRest,
    /// [`TracingWarning::MovesBeside`].
    MovesBeside,
    /// Nothing tells the rate of the frames, so that one was assumed.
    RateAssumed,
    /// Every second line of the pictures is of another moment.
    Interlaced,
    /// The pictures were taken in another order than their numbers have.
    FilesOutOfOrder,
    /// A label is in several parts of about the same size, of which the largest is taken.
    LabelInParts,
    /// A label has no outline in a picture in which others have one.
    LabelLeftOut,
    /// Borders of labels are marked as void, so that nobody knows where in them the objects end.
    VoidBorders,
    /// The outlines keep their shape as they turn only if pixels are not as high as wide.
    PixelAspect,
    /// An object may be another one, which touched something before and was forgotten: [`AfterContact`](crate::AfterContact).
    NewAfterContact,
    /// Objects that look alike may have moved by another step, as if each were a neighbour: [`AmongAlike`](crate::AmongAlike).
    AmongAlike,
}

impl OriginWarning {
    /// All of them, what makes outlines worthless first.
    pub const ALL: [Self; 12] = [
        Self::TracingDoubtful,
        Self::MovesBesideRest,
        Self::MovesBeside,
        Self::FilesOutOfOrder,
        Self::LabelInParts,
        Self::NewAfterContact,
        Self::AmongAlike,
        Self::LabelLeftOut,
        Self::PixelAspect,
        Self::RateAssumed,
        Self::Interlaced,
        Self::VoidBorders,
    ];

    /// A short name that stays the same.
    #[must_use]
    pub const fn code(self) -> &'static str {
        match self {
            Self::TracingDoubtful => "tracing_doubtful",
            Self::MovesBesideRest => "moves_beside_rest",
            Self::MovesBeside => "moves_beside",
            Self::RateAssumed => "rate_assumed",
            Self::Interlaced => "interlaced",
            Self::FilesOutOfOrder => "files_out_of_order",
            Self::LabelInParts => "label_in_parts",
            Self::LabelLeftOut => "label_left_out",
            Self::VoidBorders => "void_borders",
            Self::PixelAspect => "pixel_aspect",
            Self::NewAfterContact => "new_after_contact",
            Self::AmongAlike => "among_alike",
        }
    }

    /// Its place in saved sets: the variants are numbered in the order in which they are declared, so a new one is declared last.
    const fn bit(self) -> u16 {
        1 << self as u8
    }
}

impl fmt::Display for OriginWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::TracingDoubtful => {
                "no way of tracing tells an object from the ground beyond doubt: values may be those of something else"
            }
            Self::MovesBesideRest => "what is traced rests, and something else changes",
            Self::MovesBeside => "something else than what is traced moves",
            Self::RateAssumed => {
                "the rate of the frames was assumed, as nothing tells it: velocities are right at that rate only"
            }
            Self::Interlaced => {
                "the video is interlaced: every second line is of another moment, which frays the edges of what moves"
            }
            Self::FilesOutOfOrder => "the pictures were taken in another order than their numbers have",
            Self::LabelInParts => {
                "a label is in several parts, of which the largest is taken: another may be the largest in another picture"
            }
            Self::LabelLeftOut => "a label has no outline in a picture in which others have one",
            Self::VoidBorders => {
                "borders of objects are marked as void (255): outlines are laid along their middle, as nobody knows where in them the objects end"
            }
            Self::PixelAspect => {
                "the object keeps its shape as it turns only with pixels of another aspect, with which its angles are others"
            }
            Self::NewAfterContact => {
                "an object may be one that was forgotten while it touched something: results of two objects may be those of one"
            }
            Self::AmongAlike => {
                "objects that look alike may each have been taken for a neighbour: their velocities may be wrong"
            }
        })
    }
}

impl From<TracingWarning> for OriginWarning {
    fn from(warning: TracingWarning) -> Self {
        match warning {
            TracingWarning::Doubtful => Self::TracingDoubtful,
            TracingWarning::MovesBesideRest { .. } => Self::MovesBesideRest,
            TracingWarning::MovesBeside { .. } => Self::MovesBeside,
        }
    }
}

/// A set of [`OriginWarning`]s. As text, and in the column `warning`, it is their codes with spaces between.
///
/// ```
/// use freeform_outline_io::{OriginWarning, OriginWarnings};
///
/// let of_a_row = OriginWarnings::of_text("tracing_doubtful, and what another program says");
/// assert!(of_a_row.iter().eq([OriginWarning::TracingDoubtful]));
/// assert_eq!(of_a_row.to_string(), "tracing_doubtful");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "u16"))]
pub struct OriginWarnings(u16);

#[cfg(feature = "serde")]
impl From<u16> for OriginWarnings {
    /// From the bits as they are saved, one for each variant of [`OriginWarning`] in the order of their declaration. Others are left out: they
    /// would be neither none nor any.
    fn from(bits: u16) -> Self {
        let known = OriginWarning::ALL.into_iter().collect::<Self>();
        Self(bits & known.0)
    }
}

impl OriginWarnings {
    /// None at all.
    pub const NONE: Self = Self(0);

    /// Those whose codes are words of a text. Other words say nothing, as another program may have a column of this name.
    #[must_use]
    pub fn of_text(text: &str) -> Self {
        let words = text.split(|character: char| !(character.is_ascii_alphanumeric() || character == '_'));
        words.filter_map(|word| OriginWarning::ALL.into_iter().find(|warning| warning.code() == word)).collect()
    }

    /// Whether there is none.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Whether a warning is among them.
    #[must_use]
    pub const fn contains(self, warning: OriginWarning) -> bool {
        self.0 & warning.bit() != 0
    }

    /// Those of both.
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Those that are not among others.
    #[must_use]
    pub const fn without(self, others: Self) -> Self {
        Self(self.0 & !others.0)
    }

    /// The warnings, in the order of [`OriginWarning::ALL`].
    pub fn iter(self) -> impl Iterator<Item = OriginWarning> {
        OriginWarning::ALL.into_iter().filter(move |warning| self.contains(*warning))
    }
}

impl FromIterator<OriginWarning> for OriginWarnings {
    fn from_iter<I: IntoIterator<Item = OriginWarning>>(warnings: I) -> Self {
        Self(warnings.into_iter().fold(0, |bits, warning| bits | warning.bit()))
    }
}

impl fmt::Display for OriginWarnings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.iter().enumerate().try_for_each(|(index, warning)| {
            let separator = if index == 0 { "" } else { " " };
            write!(f, "{separator}{}", warning.code())
        })
    }
}
