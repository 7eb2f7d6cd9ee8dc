use freeform_curve_fit::{MAX_COEFFICIENTS, Outline};
use nalgebra::{Matrix3, Point2};

use super::{
    curve_step::{CurveRejection, CurveStep},
    frame_update::{PoseMatrix, Trial},
    level_sums::LevelSums,
    score_covariance::ScoreCovariance,
    settings::CurveFilterSettings,
    state_information::{Linearised, MAX_STATE, StateInformation},
};
use crate::{
    estimate::MAX_PARAMETERS,
    filter::{FALSE_START, FilterError, GIVEN_UP, LARGEST_INNOVATION, Phase, ProcessNoise},
    group_logarithm::logarithm,
    motion_algebra::{Coordinates, columns, coordinates},
};

/// Fits of the first frame, after which few points change sides between those that count and those that do not.
const FIRST_FITS: usize = 6;
/// Weight of the rotation-invariant ridge on the coefficients of the first frame: next to nothing, for outlines that do not
/// determine them all.
const RIDGE: f64 = 1e-9;
/// Information on the motion that makes the first equations solvable: next to nothing.
const MOTION_PRIOR: f64 = 1e-9;
/// How much more of a frame than usual may lie off the curve, as a share of what usually lies on it.
const LARGEST_MISFIT: f64 = 0.2;
/// A frame with the largest innovation of the motion filter goes on as before if points moved by no more than this share of the level-set
/// offset, in the root mean square.
const LARGEST_SURPRISE: f64 = 0.5;

/// Identifies the motion of one object from its outlines by one implicit polynomial that all frames share: no pairing of points
/// or lines, no roots, constant memory and time per frame.
///
/// The state is the coefficients `a` of the curve, its pose, and the motion. A frame's points are mapped back to the body frame,
/// where its 3L problem `min |M a - d|^2` enters through `G = M'M` and `h = M'd` alone; an error of the pose changes the
/// coefficients by their lift, `a <- a + sum L_j a` (`freeform_riccati::Lift`). The second frame is found by trying turns, from the third
/// on curve, pose and motion are estimated together. In exact points and those with noise alone it comes near the Cramer-Rao
/// bound; where arcs are hidden or points are wrong, [`MotionFilter`](crate::MotionFilter) does better.
///
/// ```
/// use freeform_curve_fit::Outline;
/// use freeform_identify::{CurveFilterSettings, WholeCurveFilter};
/// use nalgebra::{Point2, Rotation2};
///
/// // An egg that goes round the origin anticlockwise at 0.5 rad/s.
/// let egg = |i: i32| {
///     let t = std::f64::consts::TAU * f64::from(i) / 300.0;
///     Point2::new(1.0 + 0.5 * t.cos() + 0.05 * (2.0 * t).cos(), 0.35 * t.sin())
/// };
/// let mut filter = WholeCurveFilter::new(CurveFilterSettings::default())?;
/// for frame in 0..10 {
///     let time = f64::from(frame) / 30.0;
///     let pose = Rotation2::new(0.5 * time);
///     let outline = Outline::closed((0..300).map(|i| pose * egg(i)).collect())?;
///     assert!(filter.step(time, &outline)?.accepted);
/// }
/// let estimate = filter.estimate().expect("ten good frames");
/// assert!((estimate.values()[0] + 0.5).abs() < 0.001);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct WholeCurveFilter {
    pub(super) settings: CurveFilterSettings,
    pub(super) phase: Phase,
    pub(super) origin: Point2<f64>,
    pub(super) radius: f64,
    /// Body frame, the image of the first frame, to image; both normalised.
    pub(super) pose: Matrix3<f64>,
    pub(super) motion: Coordinates,
    pub(super) coefficients: [f64; MAX_COEFFICIENTS],
    pub(super) information: StateInformation,
    pub(super) certainty: ScoreCovariance,
    pub(super) sums: LevelSums,
    /// Projection onto the directions of the pose that the curve shows, in the body frame.
    pub(super) seen: PoseMatrix,
    pub(super) usual_misfit: f64,
    pub(super) usual_square: f64,
    last_time: f64,
    pub(super) state_time: f64,
    /// Seconds predicted over since the motion was last unknown.
    pub(super) span: f64,
    /// Frames used since the curve was begun.
    pub(super) frames: usize,
    pub(super) accepted: usize,
    pub(super) rejected: usize,
    rejected_in_a_row: usize,
    pub(super) restarts: usize,
}

impl WholeCurveFilter {
    /// A filter that waits for its first frame.
    ///
    /// # Errors
    /// A setting outside its range.
    pub fn new(settings: CurveFilterSettings) -> Result<Self, FilterError> {
        settings.check()?;
        let k = settings.model.parameter_count();
        Ok(Self {
            settings,
            phase: Phase::Waiting,
            origin: Point2::origin(),
            radius: 1.0,
            pose: Matrix3::identity(),
            motion: [0.0; MAX_PARAMETERS],
            coefficients: [0.0; MAX_COEFFICIENTS],
            information: StateInformation::new(settings.degree.coefficient_count(), k),
            certainty: ScoreCovariance::new(k, settings.offset, MOTION_PRIOR),
            sums: LevelSums::new(settings.degree, settings.offset, settings.normal_half_window),
            seen: PoseMatrix::identity(),
            usual_misfit: 0.0,
            usual_square: 0.0,
            last_time: f64::NEG_INFINITY,
            state_time: 0.0,
            span: 0.0,
            frames: 0,
            accepted: 0,
            rejected: 0,
            rejected_in_a_row: 0,
            restarts: 0,
        })
    }

    /// Takes the outline seen at a time in seconds.
    ///
    /// # Errors
    /// A time that is not finite or not after the last one; a first outline with fewer points than its polynomial has coefficients.
    /// The filter stays as it was.
    pub fn step(&mut self, time: f64, outline: &Outline) -> Result<CurveStep, FilterError> {
        if !time.is_finite() || time <= self.last_time {
            return Err(FilterError::TimeNotIncreasing { previous: self.last_time, time });
        }
        if self.phase == Phase::Waiting {
            let (found, needed) = (outline.point_count(), self.settings.degree.coefficient_count());
            if found < needed || self.start(time, outline).is_none() {
                return Err(FilterError::TooFewPoints { found, needed });
            }
            self.accepted += 1;
            return Ok(CurveStep {
                time,
                phase: self.phase,
                accepted: true,
                misfit: self.usual_misfit,
                innovation: 0.0,
                iterations: 1,
                rejection: None,
            });
        }
        self.last_time = time;
        self.sums.load(outline, &self.origin, self.radius);
        let step = match self.phase {
            Phase::Tracking => self.track(time, outline),
            _ => self.acquire(time, outline),
        };
        if step.accepted {
            self.accepted += 1;
            self.frames += 1;
            self.rejected_in_a_row = 0;
        } else {
            self.rejected += 1;
            self.rejected_in_a_row += 1;
            self.fall_back(time, outline);
        }
        let rejection = (!step.accepted).then(|| CurveRejection::of(&step));
        Ok(CurveStep { phase: self.phase, rejection, ..step })
    }

    /// Fits the curve to a first frame, again and again without the points that lie far off it.
    fn start(&mut self, time: f64, outline: &Outline) -> Option<()> {
        let (n, k) = (self.settings.degree.coefficient_count(), self.settings.model.parameter_count());
        let (origin, radius) = (outline.centroid(), outline.rms_radius());
        self.sums.load(outline, &origin, radius);
        let identity = Matrix3::identity();
        self.sums.measure(outline, &identity, None);
        let ridge = self.sums.ridge();
        let mut coefficients = [0.0; MAX_COEFFICIENTS];
        let mut information = StateInformation::new(n, k);
        (0..n).for_each(|i| information.add_to_diagonal(i, RIDGE * ridge[i]));
        (n..n + 2 * k).for_each(|i| information.add_to_diagonal(i, MOTION_PRIOR));
        let blind = Linearised { slopes: [[0.0; MAX_COEFFICIENTS]; MAX_PARAMETERS], pose: [[0.0; 8]; 8] };
        for pass in 0..FIRST_FITS {
            if pass > 0 {
                // All points once, to see how far off they usually are.
                self.sums.measure(outline, &identity, Some((&coefficients, f64::INFINITY)));
                let usual = self.sums.usual_square();
                self.sums.measure(outline, &identity, Some((&coefficients, usual)));
            }
            let scores = (&self.sums.projection[..n], &[0.0; MAX_PARAMETERS]);
            let solution = information.solve(&self.sums.gram, &blind, scores, &[0.0; MAX_STATE])?;
            coefficients[..n].copy_from_slice(&solution[..n]);
        }
        self.sums.measure(outline, &identity, Some((&coefficients, self.sums.mean_square)));
        (self.origin, self.radius) = (origin, radius);
        self.pose = identity;
        self.motion = [0.0; MAX_PARAMETERS];
        self.coefficients = coefficients;
        self.certainty = ScoreCovariance::new(k, self.settings.offset, MOTION_PRIOR);
        self.seen = PoseMatrix::identity();
        self.find_seen_directions(&self.linearised(self.settings.model, &coefficients).information);
        let frame = self.linearised(self.settings.model, &coefficients);
        // Pose and curve can move together: a frame's worth of information on the first pose settles which does.
        let gauge = (0..k).map(|i| frame.information.pose[i][i]).sum::<f64>() / k as f64;
        (n..n + k).for_each(|i| information.add_to_diagonal(i, gauge));
        let scores = (&frame.score[..n], &frame.pose_score);
        information.solve(&self.sums.gram, &frame.information, scores, &[0.0; MAX_STATE])?;
        information.keep();
        self.information = information;
        self.certainty.take_noise(self.sums.noise());
        self.certainty.update(&frame.information.pose, self.sums.count as f64, None);
        (self.usual_misfit, self.usual_square) = (self.sums.misfit, self.sums.mean_square);
        (self.last_time, self.state_time, self.span) = (time, time, 0.0);
        (self.frames, self.rejected_in_a_row) = (1, 0);
        self.phase = Phase::Acquiring;
        Some(())
    }

    /// After a rejected frame: look elsewhere, or begin again.
    fn fall_back(&mut self, time: f64, outline: &Outline) {
        let in_a_row = self.rejected_in_a_row;
        let give_up = match self.phase {
            Phase::Acquiring => in_a_row >= FALSE_START,
            _ => in_a_row >= GIVEN_UP,
        };
        let enough = outline.point_count() >= self.settings.degree.coefficient_count();
        if give_up && enough && self.start(time, outline).is_some() {
            self.restarts += 1;
        } else if self.phase == Phase::Tracking && in_a_row >= self.settings.patience {
            self.phase = Phase::Lost;
        }
    }

    /// Predicts and measures.
    fn track(&mut self, time: f64, outline: &Outline) -> CurveStep {
        self.predict(time);
        let trial = self.try_frame(outline, self.pose, self.motion);
        self.judge(time, trial)
    }

    /// Takes a frame in if it goes with the curve and the motion.
    fn judge(&mut self, time: f64, trial: Option<Trial>) -> CurveStep {
        let misfit = self.sums.misfit;
        let (phase, rejection) = (self.phase, None);
        let Some(trial) = trial else {
            let (innovation, iterations) = (f64::INFINITY, 0);
            return CurveStep { time, phase, accepted: false, misfit, innovation, iterations, rejection };
        };
        let goes_on = trial.innovation <= LARGEST_INNOVATION || trial.surprise <= LARGEST_SURPRISE;
        let accepted = self.fits(misfit) && goes_on;
        let (innovation, iterations) = (trial.innovation, trial.iterations);
        if accepted {
            self.take(&trial, true);
        }
        CurveStep { time, phase, accepted, misfit, innovation, iterations, rejection }
    }

    fn fits(&self, misfit: f64) -> bool {
        misfit <= self.usual_misfit + LARGEST_MISFIT * (1.0 - self.usual_misfit)
    }

    /// Goes on as predicted if that fits, searches for the object otherwise.
    fn acquire(&mut self, time: f64, outline: &Outline) -> CurveStep {
        let model = self.settings.model;
        if self.phase == Phase::Lost {
            let before = (self.information.clone(), self.certainty.clone(), self.pose, self.state_time, self.span);
            let step = self.track(time, outline);
            if step.accepted {
                self.phase = Phase::Tracking;
                return step;
            }
            (self.information, self.certainty, self.pose, self.state_time, self.span) = before;
        }
        let lost = CurveStep {
            time,
            phase: self.phase,
            accepted: false,
            misfit: self.sums.misfit,
            innovation: 0.0,
            iterations: 0,
            rejection: None,
        };
        let Some((found, misfit)) = self.find_pose(outline) else { return lost };
        let lost = CurveStep { misfit, ..lost };
        if self.phase == Phase::Lost {
            // Where it is now says nothing of how it moves now.
            if !self.fits(misfit) {
                return lost;
            }
            self.pose = found;
            self.information.forget_motion(MOTION_PRIOR);
            self.certainty.forget_motion();
            (self.state_time, self.span) = (time, 0.0);
            let Some(trial) = self.try_frame(outline, found, self.motion) else { return lost };
            self.take(&trial, false);
            self.phase = Phase::Acquiring;
            return CurveStep { accepted: true, misfit: self.sums.misfit, iterations: trial.iterations, ..lost };
        }
        let change = self.pose.try_inverse().and_then(|inverse| logarithm(&(found * inverse)));
        let Some(change) = change else { return lost };
        let before = (self.information.clone(), self.certainty.clone(), self.pose, self.motion, self.state_time);
        self.motion = coordinates(model, &(change / (time - self.state_time)));
        self.predict(time);
        let trial = self.try_frame(outline, self.pose, self.motion);
        let misfit = self.sums.misfit;
        if let Some(trial) = trial.filter(|_| self.fits(misfit)) {
            self.take(&trial, false);
            self.phase = Phase::Tracking;
            return CurveStep { accepted: true, misfit, iterations: trial.iterations, ..lost };
        }
        (self.information, self.certainty, self.pose, self.motion, self.state_time) = before;
        self.span = 0.0;
        CurveStep { misfit, ..lost }
    }

    /// Moves the state on to a time.
    fn predict(&mut self, time: f64) {
        let (model, k) = (self.settings.model, self.settings.model.parameter_count());
        let seconds = time - self.state_time;
        let flow = model.flow(&self.motion[..k], seconds).into_inner();
        let pose = flow * self.pose;
        let Some(inverse) = pose.try_inverse().filter(|m| m.iter().all(|e| e.is_finite())) else { return };
        // An error of the motion, seen from the body.
        let sensitivities = model.flow_sensitivities(&self.motion[..k], seconds);
        let by_motion = columns(model, sensitivities.into_iter().map(|v| inverse * v * pose));
        self.pose = pose;
        self.information.predict(&by_motion);
        let noise = &self.settings.process_noise;
        let changing = noise.rates > 0.0 || noise.velocities > 0.0;
        let variances = self.process_variances(seconds);
        self.certainty.predict(&by_motion, changing.then_some(&variances));
        if changing && self.certainty.ratio > 0.0 {
            let ratio = self.certainty.ratio;
            self.information.add_process_noise(&variances.map(|v| v / ratio));
        }
        self.state_time = time;
        self.span += seconds;
    }

    /// Variances by which the motion, in normalised coordinates, changes at random.
    fn process_variances(&self, seconds: f64) -> Coordinates {
        let ProcessNoise { rates, velocities } = self.settings.process_noise;
        let mut variances = [0.0; MAX_PARAMETERS];
        for (variance, name) in variances.iter_mut().zip(self.settings.model.parameter_names()) {
            let deviation = match name.as_bytes()[0] {
                b'b' => velocities / self.radius,
                b'c' => rates * self.radius,
                _ => rates,
            };
            *variance = deviation * deviation * seconds;
        }
        variances
    }
}
