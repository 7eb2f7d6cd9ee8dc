use freeform_motion::estimate::{ParameterEstimate, PlaneEstimate, PointVelocity};
use freeform_motion::riccati::{ParameterKind, PlaneMotion};
use freeform_motion::tracker::{MotionFamily, NotStated, ObjectResult, VELOCITY_NAMES};
use freeform_motion::{Truth, significant, with_deviation};

use super::meaning_of_b::MeaningOfB;

/// Heads of the columns of [`parameter_rows`]; the last two only where the truth is known.
pub const PARAMETER_COLUMNS: [&str; 6] = ["parameter", "value", "std", "unit", "truth", "error"];

/// Share of a value and its standard deviation below which the truth is 0: far above the rounding of a product, far below what an error shows.
const ROUNDING: f64 = 1e-9;

/// Largest error, as a multiple of the truth, that is given as a share of it: of a truth near 0 the share says nothing.
const LARGEST_SHARE: f64 = 10.0;

/// The parameters of an object as text, one row each, and the velocity of its middle where the method gives one.
#[must_use]
pub fn parameter_rows(result: &ObjectResult, truth: Option<&Truth>, b: &MeaningOfB) -> Vec<Vec<String>> {
    let model = result.motion;
    let truth = truth.and_then(|truth| Some((truth, truth.parameters_in(model)?)));
    let found = result.parameters().unwrap_or_default();
    let names = model.parameter_names().iter().zip(model.units()).zip(model.parameter_kinds());
    let mut rows: Vec<Vec<String>> = names
        .enumerate()
        .map(|(index, ((name, unit), kind))| {
            let parameter = found.get(index);
            let unknown = parameter.map_or("-", |_| in_place_of_value(result, name));
            let unit = b.unit_of(*kind, unit);
            let known = parameter.and_then(|p| Some((p.value?, p.standard_deviation)));
            row([name, unknown, unit], known, truth.as_ref().map(|(_, values)| values[index]))
        })
        .collect();
    if result.motion == MotionFamily::Plane {
        rows.extend(normal_rows(result, truth.as_ref().and_then(|(truth, _)| truth.plane)));
    }
    if result.velocity.is_some() || (result.has_velocity() && result.parameters().is_some()) {
        rows.extend(velocity_rows(result, truth.as_ref().map(|(truth, _)| *truth), &found, b.short_unit.in_table()));
    }
    rows
}

/// The velocity of the middle, two rows.
fn velocity_rows(
    result: &ObjectResult,
    truth: Option<&Truth>,
    found: &[ParameterEstimate],
    unit: &str,
) -> Vec<Vec<String>> {
    // Without a known turn the velocity is that of the centre of symmetry, such as the centre of a circle. The estimated
    // middle is only near that centre, and the true velocity differs between the two by the turn times their distance.
    let kinds = result.motion.parameter_kinds().iter();
    let turn_is_known = kinds.zip(found).all(|(kind, p)| *kind == ParameterKind::Velocity || p.value.is_some());
    let true_velocity = match (truth, &result.velocity) {
        (Some(truth), Some(velocity)) if turn_is_known => Some(truth.velocity_at(&velocity.point)),
        (Some(truth), _) => truth.middle_velocity,
        (None, _) => None,
    };
    let unknown = result.velocity_not_stated().map_or("-", NotStated::name);
    let rows = VELOCITY_NAMES.iter().enumerate().map(|(i, name)| {
        let known = result.velocity.as_ref().map(|v| (v.velocity[i], Some(v.standard_deviations()[i])));
        let mut row = row([name, unknown, unit], known, true_velocity.map(|truth| truth[i]));
        if truth.is_some() && true_velocity.is_none() {
            row.extend(["-", "-"].map(str::to_owned));
        }
        row
    });
    rows.collect()
}

/// What stands in place of a value that is not stated.
fn in_place_of_value(result: &ObjectResult, name: &str) -> &'static str {
    result.not_stated(name).map_or("-", NotStated::name)
}

/// The normal of a plane at the first frame, two rows; its z is 1.
fn normal_rows(result: &ObjectResult, truth: Option<PlaneMotion>) -> [Vec<String>; 2] {
    let normal = result.plane.as_deref().and_then(PlaneEstimate::normal);
    let unknown = result.plane.as_ref().map_or("-", |_| in_place_of_value(result, "normal"));
    [("normal x", 0), ("normal y", 1)].map(|(name, i)| {
        let known = normal.map(|normal| (normal.value[i], Some(normal.covariance[(i, i)].max(0.0).sqrt())));
        row([name, unknown, "1"], known, truth.map(|truth| truth.normal[i]))
    })
}

/// One row: a value with its standard deviation, or why there is none, and the truth if it is known.
fn row([name, unknown, unit]: [&str; 3], known: Option<(f64, Option<f64>)>, truth: Option<f64>) -> Vec<String> {
    let none = || "-".to_owned();
    let [value, deviation] = match known {
        Some((value, Some(deviation))) => with_deviation(value, deviation),
        Some((value, None)) => [significant(value, 6), none()],
        None => [unknown.to_owned(), none()],
    };
    let mut row = vec![name.to_owned(), value, deviation, unit.to_owned()];
    if let Some(truth) = truth {
        let truth = known.map_or(truth, |(value, deviation)| without_rounding(truth, value, deviation));
        row.push(significant(truth, 6));
        row.push(known.map_or_else(none, |(value, _)| error_text(value, truth)));
    }
    row
}

/// A truth that is told from 0 by no more than the rounding of its computation is 0.
fn without_rounding(truth: f64, value: f64, deviation: Option<f64>) -> f64 {
    let size = value.abs().max(deviation.unwrap_or(0.0));
    if truth.abs() < ROUNDING * size { 0.0 } else { truth }
}

/// The difference from the truth, with its share of the truth where that tells anything.
fn error_text(value: f64, truth: f64) -> String {
    let difference = significant(value - truth, 2);
    if (value - truth).abs() > LARGEST_SHARE * truth.abs() || truth == 0.0 {
        return difference;
    }
    format!("{difference} ({} %)", significant(100.0 * ((value - truth) / truth).abs(), 2))
}

/// What v is in a table, on one line.
#[must_use]
pub fn meaning_of_v(velocity: &PointVelocity) -> String {
    let [x, y] = [0, 1].map(|i| significant(velocity.point[i], 4));
    format!("v: velocity of the object's middle, at ({x}, {y}), in the unit of b")
}

#[cfg(test)]
mod tests {
    use freeform_motion::estimate::{MotionEstimate, PointVelocity};
    use freeform_motion::outline_filter::Ambiguity;
    use freeform_motion::riccati::{MotionModel, RigidMotion};
    use freeform_motion::tracker::Method;
    use nalgebra::{Matrix2, Point2, Vector2};

    use super::*;

    #[test]
    fn beside_the_velocity_of_an_object_without_an_observable_turn_stands_that_of_its_true_middle_or_none() {
        let estimate = MotionEstimate::new(MotionModel::Rigid, &[0.0, 0.3, 0.4], Some(&[0.1, 0.01, 0.01]));
        let velocity = PointVelocity {
            point: Point2::new(0.001, 0.0),
            velocity: Vector2::new(0.3, 0.4),
            covariance: Matrix2::identity() * 1e-6,
        };
        let result = |estimate| ObjectResult {
            frames: 30,
            estimate: Some(estimate),
            velocity: Some(velocity),
            ..ObjectResult::unknown("0", Method::Filter, MotionModel::Rigid)
        };
        let motion = RigidMotion { omega: 1.5, b1: 0.3, b2: 0.4 };
        let truth = Truth::from(motion);
        let rows_beside =
            |estimate, truth| parameter_rows(&result(estimate), Some(truth), &MeaningOfB::in_coordinates(None));
        let rows = |estimate| rows_beside(estimate, &truth);
        let truth_of_v1 = |rows: &[Vec<String>]| rows[3][4..].to_vec();
        assert_eq!(truth_of_v1(&rows(estimate.with_unobservable(0))), ["-", "-"]);
        assert_eq!(truth_of_v1(&rows(estimate))[0], "0.300000");
        // That of the true middle may be told, which the point of the estimate is not quite.
        let truth = Truth { middle_velocity: Some([0.3125, 0.4]), ..truth };
        assert_eq!(truth_of_v1(&rows_beside(estimate.with_unobservable(0), &truth))[0], "0.312500");
        assert_eq!(truth_of_v1(&rows_beside(estimate, &truth))[0], "0.300000");
    }

    #[test]
    fn a_truth_of_0_but_for_rounding_is_0_and_an_error_many_times_the_truth_is_no_percentage() {
        let cells = |known, truth| row(["v1", "-", "px/s"], Some(known), Some(truth))[4..].to_vec();
        assert_eq!(cells((-0.000_29, Some(0.000_37)), 1.77e-16), ["0", "-0.00029"]);
        assert_eq!(cells((0.0, Some(0.000_37)), -4.7e-17), ["0", "0"]);
        assert_eq!(cells((0.5, Some(0.1)), 0.001), ["0.00100000", "0.50"]);
        assert_eq!(cells((0.5, Some(0.1)), 0.4), ["0.400000", "0.10 (25 %)"]);
        assert_eq!(cells((1e-12, Some(1e-13)), 2e-12), ["2.00000e-12", "-1.0e-12 (50 %)"]);
    }

    #[test]
    fn a_velocity_that_is_not_stated_has_the_reason_in_its_place() {
        let estimate = MotionEstimate::new(MotionModel::Rigid, &[0.0, 0.3, 0.4], Some(&[0.1, 0.01, 0.01]));
        let unknown =
            ObjectResult { estimate: Some(estimate), ..ObjectResult::unknown("0", Method::Filter, MotionModel::Rigid) };
        let ambiguity = Ambiguity { turn: 0.3, rival_turns: vec![-0.3], parameters: vec!["omega"] };
        let ambiguous = ObjectResult { ambiguity: Some(ambiguity), ..unknown.clone() };
        let adaptive = ObjectResult { method: Method::Adaptive, ..unknown.clone() };
        let b = MeaningOfB::in_pictures(false, 1.0, 1.0, None);
        for (result, word) in [(unknown, "unknown"), (ambiguous, "ambiguous")] {
            let rows = parameter_rows(&result, None, &b);
            assert_eq!(
                rows[3..],
                [["v1", word, "-", "px/s"], ["v2", word, "-", "px/s"]].map(|row| row.map(str::to_owned))
            );
        }
        assert_eq!(parameter_rows(&adaptive, None, &b).len(), 3, "the method gives no velocity");
    }
}
