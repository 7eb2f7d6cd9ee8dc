//! A track cut from contours.
use std::sync::Arc;

use freeform_riccati::MotionModel;
use nalgebra::Matrix3;

use super::{
    Track, body_frame::BodyFrame, first_pose::FirstPose, shape_change::EarlyShape, turn_profile::TurnProfile,
    usual_agreement::UsualAgreement,
};
use crate::{
    belief::Belief,
    dynamics::FamilyTests,
    map::{CellsInCommon, Contour, ContourNoise, OutlineMap, Resolution},
    measurement::{Counted, Frame, NoiseModel, Reference, Rounding},
    prediction::ShapeNoise,
    tuning::{
        contour::NORMAL_NOISE,
        map::{FEWEST_CELLS, FEWEST_POINTS},
        update as tuning,
    },
    update::Sensitivity,
};

impl Track {
    /// Takes cells along contours in the body frame, and the loaded points, which were seen in a pose, as their first measurement. `None`
    /// where the contours do not make an outline. Their noise is no less than the rounding of their points.
    pub(super) fn cut(
        model: MotionModel,
        reference: Reference,
        pose: Matrix3<f64>,
        contours: Vec<Contour>,
        rounding: Rounding,
        frame: &mut Frame,
    ) -> Option<Self> {
        let least_noise = rounding.of_point();
        let mut track =
            Self::draft((model, reference), pose, contours, (least_noise, CellsInCommon::NotNeeded), frame)?;
        track.measure_draft(rounding, frame);
        Some(track)
    }

    /// As [`cut`](Self::cut), of noise no less than that given; the loaded points are to be [measured](Self::measure_draft) yet.
    pub(super) fn draft(
        of: (MotionModel, Reference),
        pose: Matrix3<f64>,
        contours: Vec<Contour>,
        (least_noise, in_common): (f64, CellsInCommon),
        frame: &Frame,
    ) -> Option<Self> {
        let mut noise = ContourNoise::of(&contours);
        let mut draft = |mut contours: Vec<Contour>, normal_noise| {
            let (resolution, sigma) =
                Resolution::of(&mut noise, least_noise, (frame.points.len(), in_common), normal_noise);
            noise.hand_on_regressions(&mut contours);
            Self::drafted(of, pose, contours, (resolution, sigma), frame)
        };
        let mut track = draft(contours.clone(), NORMAL_NOISE)?;
        let needed = track.map.normal_noise();
        if needed < NORMAL_NOISE {
            track = draft(contours, needed).unwrap_or(track);
        }
        Some(track)
    }

    /// Takes the loaded points, whose contours its cells were cut to be measured by, as the first measurement of a draft.
    pub(super) fn measure_draft(&mut self, rounding: Rounding, frame: &mut Frame) {
        self.measure_new_cells(frame, 0);
        self.belief.marginal = self.belief.information.marginal();
        self.noise.allow_for_cells(self.map.sagitta(), self.map.spacing());
        self.noise.allow_for_rounding(rounding);
    }

    /// One whose cells have been cut with a resolution, from contours with noise of deviation `sigma`, and not been measured yet.
    fn drafted(
        (model, reference): (MotionModel, Reference),
        pose: Matrix3<f64>,
        contours: Vec<Contour>,
        (resolution, sigma): (Resolution, f64),
        frame: &Frame,
    ) -> Option<Self> {
        let loaded = frame.points.len();
        if loaded < FEWEST_POINTS || !sigma.is_finite() {
            return None;
        }
        let mut belief = Belief::new(model);
        belief.pose = pose;
        let k = belief.parameter_count();
        for i in 0..k {
            belief.information.dense[i][i] = tuning::GAUGE_WEIGHT * loaded as f64;
            belief.information.dense[k + i][k + i] = tuning::MOTION_PRIOR;
        }
        let mut track = Self {
            reference,
            map: Arc::new(OutlineMap::for_contours(resolution)?),
            belief,
            noise: NoiseModel::new(sigma / frame.deviations.typical()),
            shape: ShapeNoise::default(),
            early_shape: EarlyShape::default(),
            usual: UsualAgreement::default(),
            turn_profile: TurnProfile::default(),
            body_frame: BodyFrame::default(),
            sensitivity: Sensitivity::new(),
            family: FamilyTests::default(),
            first_pose: FirstPose::default(),
            frames: 0,
            frames_before_cells: 0,
        };
        if frame.deviations.ratios().is_some() {
            track.noise.counted = Counted::ByDeviation;
        }
        track.add_cells(contours, frame)?;
        (track.map.cells().len() >= FEWEST_CELLS).then_some(track)
    }
}
