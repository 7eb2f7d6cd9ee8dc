//! What became of a frame.
use freeform_riccati::MAX_PARAMETERS;
use nalgebra::SVector;

use crate::{
    dynamics::CentredDeviations,
    map::NullDirections,
    measurement::NegativeLogLikelihood,
    tuning::usual_agreement::{ALL_OF_IT, FARTHEST_BIT_BY_BIT},
    update::{FrameMeasurement, Gate, PoseInnovation, PoseMeasurement, Rejection},
};

/// Whether a frame is to be compared with what other tracks make of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Comparison {
    Asked,
    NotAsked,
}

/// Why the object may lie elsewhere than where a frame that was taken has found it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Doubt {
    /// More of the points than usual disagree with the outline.
    Points { rise: Rise },
    /// Few of the points agree that tell where the outline lies along some direction, as the ends of a bar do.
    Direction {
        /// The [weakest agreement](crate::measurement::View::weakest_agreement).
        weakest: f64,
        /// How more of all points than usual have come to disagree as well, if they do.
        rise: Option<Rise>,
    },
    /// Some points disagree, and the frame before was not taken: the motion may have changed meanwhile.
    AfterRejected,
    /// A turn that few points or slight levers tell is another than it was to be.
    Turn,
}

/// How more points than usual have come to disagree with the outline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Rise {
    /// In one frame, as where the motion has led elsewhere; also where there were too few frames before to tell.
    AtOnce,
    /// Over some frames, as where the motion lags behind, and as of a part that comes off the outline, such as what the light leaves of an object where
    /// it turns.
    BitByBit,
}

impl Doubt {
    /// Whether the object may be turned by this angle from where it was found, in radians. As far as to another tooth of a gear or another blade no
    /// motion has led bit by bit; but any of them that turns to where a part was missed in the first frame explains a frame better, turned back.
    pub(crate) fn allows_turn(self, angle: f64) -> bool {
        match self {
            Self::Points { rise: Rise::BitByBit } | Self::Direction { rise: None | Some(Rise::BitByBit), .. } => {
                angle.abs() < FARTHEST_BIT_BY_BIT
            }
            Self::Points { .. } | Self::Direction { .. } | Self::AfterRejected | Self::Turn => true,
        }
    }
}

/// What became of a frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Outcome {
    pub(crate) measurement: FrameMeasurement,
    pub(crate) verdict: Result<(), Rejection>,
    pub(crate) innovation: PoseInnovation,
    /// What the frame tells of the pose by itself, if it shows the outline, taken or not.
    pub(crate) pose: Option<PoseMeasurement>,
    /// Standard deviations that the rounding of masks adds to that, about the centroid, normalised.
    pub(crate) rounding: CentredDeviations,
    /// Displacement of the whole outline by the frame, in the body frame.
    pub(crate) shift: SVector<f64, MAX_PARAMETERS>,
    /// What the outline did not show before the frame and shows now that it has grown, in the image: nothing is known along it.
    pub(crate) forgotten: NullDirections,
    /// Why the object may lie elsewhere although the frame was taken.
    pub(crate) doubt: Option<Doubt>,
    /// Of the frame, given the prediction; zero unless asked for.
    pub(crate) likelihood: NegativeLogLikelihood,
}

impl Outcome {
    /// Of a frame that is not taken, and of which no pose is told.
    pub(super) fn unsolved(measurement: FrameMeasurement, gate: &Gate) -> Self {
        Self {
            measurement,
            verdict: gate.verdict(&measurement).and(Err(Rejection::NotFound)),
            innovation: PoseInnovation::default(),
            pose: None,
            rounding: CentredDeviations::zeros(),
            shift: SVector::zeros(),
            forgotten: NullDirections::default(),
            doubt: None,
            likelihood: NegativeLogLikelihood::default(),
        }
    }

    pub(crate) fn is_accepted(&self) -> bool {
        self.verdict.is_ok()
    }

    /// The outcome of a frame that follows one that was not taken.
    pub(crate) fn after_rejected(self) -> Self {
        let is_in_doubt = self.is_accepted() && self.measurement.agreement < ALL_OF_IT;
        Self { doubt: self.doubt.or(is_in_doubt.then_some(Doubt::AfterRejected)), ..self }
    }

    /// The gate by which the frame, of so many points, is judged where another pose shows that it is one of the object; `None` where it was
    /// rejected for something that this says nothing of.
    pub(crate) fn gate_if_vouched_for(&self, gate: Gate, points: usize) -> Option<Gate> {
        match self.verdict {
            Err(Rejection::NoiseTooLarge { .. }) => Some(gate.without_noise()),
            Err(Rejection::Elsewhere { .. }) if self.measurement.agreement >= gate.smallest_agreement => {
                Some(gate.without_noise())
            }
            Err(Rejection::AgreementTooSmall { .. } | Rejection::Elsewhere { .. }) => {
                gate.vouched_for(&self.measurement, points)
            }
            _ => None,
        }
    }
}
