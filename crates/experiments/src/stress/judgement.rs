use std::fmt;

use freeform_motion::tracker::ObjectResult;
use freeform_riccati::MotionModel;
use nalgebra::Point2;

use super::poses::PoseErrors;
use super::sequence::Truth;

/// Codes of warnings that do not make up for a wrong value: that others are not stated, that single frames were not used, that the values are those
/// at the end, or that there are others (which count where one of them is the true one); and `frames_rejected`, which does not say what it questions.
pub const NOTES: [&str; 8] = [
    "aliases",
    "not_observable",
    "not_known",
    "rotation_not_observable",
    "frame_rejected",
    "more_frames_rejected",
    "frames_rejected",
    "motion_changed",
];

/// Error in standard deviations beyond which a value is wrong.
pub(super) const WRONG: f64 = 4.0;

/// How much nearer to the truth than the stated value an alias must be to have told it.
const NEARER: f64 = 0.1;

/// Something that is stated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Quantity {
    /// Rate of growth of a similarity.
    Sigma,
    /// Angular velocity, of rigid motion and similarities.
    Omega,
    /// a1 to a4 of affine motion.
    A,
    /// Velocity at the origin of the picture, two components.
    B,
    /// Velocity of the middle of the object, two components.
    V,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Sigma, Self::Omega, Self::A, Self::B, Self::V];

    /// Its name in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sigma => "sigma",
            Self::Omega => "omega",
            Self::A => "a",
            Self::B => "b",
            Self::V => "v",
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// What came of one run.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Outcome {
    /// One entry per number that is judged: what it is, and its error in standard deviations, `None` where it is not stated.
    pub(super) numbers: Vec<(Quantity, Option<f64>)>,
    /// Whether a warning questions the values.
    pub(super) warned: bool,
    /// Whether another angular velocity was named beside the stated one, or in its place, which is the true one.
    pub(super) alias_told: bool,
    pub(super) frames: usize,
    pub(super) frames_rejected: usize,
    /// Errors of the poses on the way; `None` where they are not judged.
    pub(super) poses: Option<PoseErrors>,
}

impl Outcome {
    /// Judges the result for an object; `frame_rate` in the unit of time of the result.
    pub(super) fn of(
        result: Option<&ObjectResult>,
        truth: &Truth,
        frame_rate: f64,
        model: MotionModel,
        judges_middle: bool,
    ) -> Self {
        let stated = |index: usize| {
            let parameter = result?.estimate.as_ref()?.parameters().nth(index)?;
            Some((parameter.value?, parameter.standard_deviation.unwrap_or(0.0)))
        };
        let judged = |(index, (quantity, truth)): (usize, (Quantity, f64))| {
            (quantity, stated(index).map(|(value, std)| in_deviations(value - truth, std)))
        };
        let mut numbers: Vec<_> = truth.parameters(model).into_iter().enumerate().map(judged).collect();
        // The parameters of a motion begin with its rates.
        let stated_rates: Option<Vec<f64>> =
            (0..truth.rates(model).len()).map(|index| stated(index).map(|(value, _)| value)).collect();
        if judges_middle {
            let velocity = result.and_then(|result| result.velocity);
            // A stated turn belongs to the point that is stated with the velocity, not quite the middle.
            let truth_at = |point: &Point2<f64>| match &stated_rates {
                Some(_) => truth.b + truth.linear * point.coords,
                None => truth.middle,
            };
            numbers.extend((0..2).map(|i| {
                let stated = velocity.map(|v| (v.velocity[i], v.standard_deviations()[i], truth_at(&v.point)[i]));
                (Quantity::V, stated.map(|(value, std, truth)| in_deviations(value - truth, std)))
            }));
        }
        let warnings = result.map_or(&[][..], |result| &result.warnings);
        let aliases = result.map_or_else(Vec::new, |result| told_aliases(result, frame_rate));
        let true_turn = truth.mean_turn(model);
        let off = |turn: f64| (turn - true_turn).abs();
        let stated_off = stated_rates.map_or(f64::INFINITY, |rates| off(mean_turn(&rates)));
        let tolerance = if stated_off.is_finite() { NEARER * stated_off } else { NEARER * true_turn.abs() };
        Self {
            numbers,
            warned: warnings.iter().any(|warning| !NOTES.contains(&warning.code())),
            alias_told: aliases.into_iter().any(|alias| off(alias) <= tolerance),
            frames: result.map_or(0, |result| result.frames),
            frames_rejected: result.map_or(0, |result| result.frames_rejected),
            poses: None,
        }
    }

    /// With the errors of the poses.
    pub(super) fn with_poses(self, poses: Option<PoseErrors>) -> Self {
        Self { poses, ..self }
    }

    /// Whether a stated value is wrong.
    pub(super) fn is_off(&self) -> bool {
        self.is_off_in(None)
    }

    /// Whether a stated value is wrong: of one quantity, or of any.
    pub(super) fn is_off_in(&self, quantity: Option<Quantity>) -> bool {
        self.of_quantity(quantity).any(|error| error.is_some_and(is_wrong))
    }

    /// Whether a number is not stated: of one quantity, or of any.
    pub(super) fn is_unstated_in(&self, quantity: Option<Quantity>) -> bool {
        self.of_quantity(quantity).any(|error| error.is_none())
    }

    /// Whether nothing was said that would make up for a wrong value.
    pub(super) fn is_silent(&self) -> bool {
        !self.warned && !self.alias_told
    }

    fn of_quantity(&self, quantity: Option<Quantity>) -> impl Iterator<Item = Option<f64>> + '_ {
        self.numbers.iter().filter(move |(q, _)| quantity.is_none_or(|wanted| *q == wanted)).map(|(_, error)| *error)
    }
}

/// Mean angular velocity of all directions, by the rates of a motion: omega, sigma and omega, or a1 to a4.
fn mean_turn(rates: &[f64]) -> f64 {
    match *rates {
        [omega] | [_, omega] => omega,
        [_, a2, a3, _] => 0.5 * (a2 - a3),
        _ => f64::NAN,
    }
}

impl Truth {
    /// The rates of a motion in the order of its family; none of a projective one, which the suite does not have.
    fn rates(&self, model: MotionModel) -> Vec<(Quantity, f64)> {
        match model {
            MotionModel::Rigid => vec![(Quantity::Omega, self.omega)],
            MotionModel::Similarity => vec![(Quantity::Sigma, self.growth), (Quantity::Omega, self.omega)],
            MotionModel::Affine => self.linear.transpose().iter().map(|a| (Quantity::A, *a)).collect(),
            MotionModel::Projective => Vec::new(),
        }
    }

    /// The parameters of a motion in the order of its family.
    fn parameters(&self, model: MotionModel) -> Vec<(Quantity, f64)> {
        self.rates(model).into_iter().chain(self.b.iter().map(|b| (Quantity::B, *b))).collect()
    }

    /// Mean angular velocity of all directions in the picture.
    fn mean_turn(&self, model: MotionModel) -> f64 {
        mean_turn(&self.rates(model).into_iter().map(|(_, rate)| rate).collect::<Vec<f64>>())
    }
}

/// Whether a stated value with this error in deviations is wrong.
fn is_wrong(error: f64) -> bool {
    // Not a number is no right one either.
    error.is_nan() || error.abs() > WRONG
}

/// An error in standard deviations; infinite where something is stated as exact and is not.
fn in_deviations(error: f64, deviation: f64) -> f64 {
    if error == 0.0 { 0.0 } else { error / deviation.max(0.0) }
}

/// The other angular velocities that the result names, in its unit of time.
fn told_aliases(result: &ObjectResult, frame_rate: f64) -> Vec<f64> {
    let rivals = result.ambiguity.iter().flat_map(|ambiguity| &ambiguity.rival_turns);
    // Turns are anticlockwise, omega is clockwise.
    rivals.map(|turn| -turn * frame_rate).chain(result.aliases.iter().copied()).collect()
}

#[cfg(test)]
mod tests {
    use freeform_estimate::{MotionEstimate, PointVelocity};
    use freeform_motion::tracker::Method;
    use freeform_motion::{TracedContours, Warning};
    use freeform_outline_filter::Ambiguity;
    use nalgebra::{Matrix2, Vector2};

    use super::*;

    const TRUTH: Truth = Truth {
        omega: 2.0,
        growth: 0.0,
        linear: Matrix2::new(0.0, 2.0, -2.0, 0.0),
        b: Vector2::new(0.5, 0.0),
        middle: Vector2::new(1.0, 0.0),
    };

    fn result(omega: f64) -> ObjectResult {
        let estimate = MotionEstimate::new(MotionModel::Rigid, &[omega, 0.5, 0.1], Some(&[0.01, 0.1, 0.1]));
        ObjectResult {
            frames: 50,
            frames_rejected: 1,
            estimate: Some(estimate),
            ..ObjectResult::unknown("0", Method::Filter, MotionModel::Rigid)
        }
    }

    fn of(result: Option<&ObjectResult>, truth: &Truth, judges_middle: bool) -> Outcome {
        Outcome::of(result, truth, 30.0, MotionModel::Rigid, judges_middle)
    }

    fn judged(result: &ObjectResult) -> Outcome {
        of(Some(result), &TRUTH, false)
    }

    #[test]
    fn a_value_is_wrong_beyond_four_deviations_and_silent_without_a_word() {
        assert!(!judged(&result(2.039)).is_off());
        let off = judged(&result(2.041));
        assert!(
            off.is_off()
                && off.is_silent()
                && off.is_off_in(Some(Quantity::Omega))
                && !off.is_off_in(Some(Quantity::B))
        );
        assert_eq!((off.frames, off.frames_rejected), (50, 1));
        assert!(judged(&result(f64::NAN)).is_off());
    }

    #[test]
    fn notes_do_not_make_up_for_a_wrong_value_and_warnings_do() {
        let with = |warning| judged(&ObjectResult { warnings: vec![warning], ..result(3.0) });
        for note in [
            Warning::MotionChanged { dynamics: None },
            Warning::NotObservable { parameters: vec!["b1"], contours: TracedContours::default() },
            Warning::NotKnown { parameters: vec!["b1"] },
            Warning::FramesRejected { rejected: 20, frames: 50 },
        ] {
            assert!(with(note).is_silent());
        }
        assert!(
            !with(Warning::Lost { last_known: None }).is_silent() && !with(Warning::Restarted { times: 1 }).is_silent()
        );
    }

    #[test]
    fn an_alias_is_told_where_it_is_the_truth() {
        let with = |turn: f64| {
            let ambiguity = Ambiguity { turn: 0.1, rival_turns: vec![turn], parameters: vec!["omega"] };
            judged(&ObjectResult { ambiguity: Some(ambiguity), ..result(-3.0) })
        };
        // Clockwise is positive in omega and negative in turns.
        assert!(with(-2.0 / 30.0).alias_told);
        assert!(!with(2.0 / 30.0).alias_told);
    }

    #[test]
    fn the_parameters_of_a_family_are_judged_in_their_order_and_its_aliases_by_the_mean_turn() {
        let truth = Truth { growth: 0.1, linear: Matrix2::new(0.1, 3.0, -1.0, 0.2), ..TRUTH };
        let names = |model| truth.parameters(model).into_iter().map(|(_, value)| value).collect::<Vec<f64>>();
        assert_eq!(names(MotionModel::Similarity), [0.1, 2.0, 0.5, 0.0]);
        assert_eq!(names(MotionModel::Affine), [0.1, 3.0, -1.0, 0.2, 0.5, 0.0]);
        let turns = [MotionModel::Rigid, MotionModel::Similarity, MotionModel::Affine].map(|m| truth.mean_turn(m));
        assert_eq!(turns, [2.0; 3]);
    }

    #[test]
    fn what_is_not_stated_is_not_wrong() {
        let mut none = result(99.0);
        none.estimate = none.estimate.map(|estimate| estimate.with_unobservable(0));
        let outcome = judged(&none);
        assert!(!outcome.is_off() && outcome.is_unstated_in(None) && !outcome.is_unstated_in(Some(Quantity::B)));
        let nothing = of(None, &TRUTH, true);
        assert_eq!(nothing.numbers.len(), 5);
        assert!(nothing.numbers.iter().all(|(_, error)| error.is_none()) && !nothing.is_off());
    }

    #[test]
    fn the_velocity_is_held_against_that_of_its_point_if_the_turn_is_stated_and_else_of_the_middle() {
        let point = Point2::new(0.0, 0.25);
        let velocity =
            |x: f64| PointVelocity { point, velocity: Vector2::new(x, 0.0), covariance: Matrix2::identity() * 1e-6 };
        let off = |x: f64, omega_is_stated: bool| {
            let mut result = ObjectResult { velocity: Some(velocity(x)), ..result(2.0) };
            if !omega_is_stated {
                result.estimate = result.estimate.map(|estimate| estimate.with_unobservable(0));
            }
            of(Some(&result), &TRUTH, true).is_off_in(Some(Quantity::V))
        };
        assert!(!off(1.0, true) && !off(1.0, false));
        let truth_there = 0.5 + 2.0 * 0.25;
        assert_eq!(truth_there, 1.0);
        let elsewhere = Truth { middle: Vector2::new(0.9, 0.0), ..TRUTH };
        let result = ObjectResult { velocity: Some(velocity(1.0)), ..result(2.0) };
        assert!(!of(Some(&result), &elsewhere, true).is_off_in(Some(Quantity::V)));
        let unknown =
            ObjectResult { estimate: result.estimate.map(|estimate| estimate.with_unobservable(0)), ..result };
        assert!(of(Some(&unknown), &elsewhere, true).is_off_in(Some(Quantity::V)));
    }
}
