use std::fmt;

use super::{map_update::MapUpdate, motion_change::SUDDEN, settings::FilterSettings};

/// Why a [`MotionFilter`](crate::MotionFilter) has not used a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rejection {
    /// Too few of its points lie on the outline known.
    AgreementTooSmall {
        /// Share of the points that do, in [0, 1].
        agreement: f64,
        /// Share needed, [`FilterSettings::smallest_agreement`].
        smallest: f64,
    },
    /// The outline is there, but not where the motion of the frames before has it.
    InnovationTooLarge {
        /// Squared innovation of the pose, as in [`MapUpdate::innovation`].
        innovation: f64,
        /// Largest that is taken to go on.
        largest: f64,
    },
    /// The outline is there, but its points scatter about it more than those of other frames.
    NoiseTooLarge {
        /// Standard deviation of this frame's noise, image lengths.
        noise: f64,
    },
    /// No pose was found that could be measured.
    NotFound,
}

impl Rejection {
    /// Of a frame that was not accepted, by what it said of the map.
    pub(crate) fn of(update: Option<&MapUpdate>, settings: &FilterSettings) -> Self {
        let smallest = settings.smallest_agreement;
        let largest = SUDDEN * settings.model.parameter_count() as f64;
        match update {
            Some(&MapUpdate { agreement, .. }) if agreement < smallest => {
                Self::AgreementTooSmall { agreement, smallest }
            }
            Some(&MapUpdate { innovation, .. }) if innovation > largest => {
                Self::InnovationTooLarge { innovation, largest }
            }
            Some(&MapUpdate { noise: Some(noise), .. }) => Self::NoiseTooLarge { noise },
            Some(_) | None => Self::NotFound,
        }
    }
}

impl fmt::Display for Rejection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::AgreementTooSmall { agreement, .. } => {
                write!(f, "does not fit the object, {:.0} % of the points lie on its outline", 100.0 * agreement)
            }
            Self::InnovationTooLarge { innovation, .. } => {
                write!(f, "does not go on from the frames before it, squared innovation {innovation:.0}")
            }
            Self::NoiseTooLarge { noise } => {
                let decimals = (1.0 - noise.log10().floor()).max(0.0) as usize;
                write!(
                    f,
                    "its points scatter by {noise:.decimals$} about the outline known, more than those of other frames"
                )
            }
            Self::NotFound => f.write_str("the object was not found"),
        }
    }
}
