use std::io::{self, Write};

use freeform_motion::riccati::AffineMotion;

use super::aligned::write_aligned;
use super::number::{significant, with_deviation};
use super::velocity::velocity_text;
use crate::meaning_of_b::MeaningOfB;
use crate::tracking::ObjectResult;
use crate::truth::parameters_in;

/// Heads of the columns of [`parameter_rows`]; the last two only where the truth is known.
pub(crate) const COLUMNS: [&str; 6] = ["parameter", "value", "std", "unit", "truth", "error"];

/// The parameters of an object as text, one row each.
pub(crate) fn parameter_rows(result: &ObjectResult, truth: Option<&AffineMotion>, b: &MeaningOfB) -> Vec<Vec<String>> {
    let model = result.motion;
    let truth = truth.and_then(|motion| parameters_in(model, motion));
    let found: Vec<_> = result.estimate.as_ref().map_or_else(Vec::new, |estimate| estimate.parameters().collect());
    let is_ambiguous = |name| result.ambiguity.as_ref().is_some_and(|turns| turns.parameters.contains(name));
    let names = model.parameter_names().iter().zip(model.units());
    names
        .enumerate()
        .map(|(index, (name, unit))| {
            let parameter = found.get(index);
            let value = parameter.and_then(|p| p.value);
            let deviation = parameter.and_then(|p| p.standard_deviation);
            let none = || "-".to_owned();
            let [value_text, deviation_text] = match (value, deviation) {
                (Some(value), Some(deviation)) => with_deviation(value, deviation),
                (Some(value), None) => [significant(value, 6), none()],
                (None, _) if is_ambiguous(name) => ["ambiguous".to_owned(), none()],
                (None, _) if parameter.is_some() => ["unobservable".to_owned(), none()],
                (None, _) => [none(), none()],
            };
            let unit = b.short_unit.filter(|_| name.starts_with('b')).unwrap_or(unit);
            let mut row = vec![(*name).to_owned(), value_text, deviation_text, unit.to_owned()];
            if let Some(truth) = &truth {
                row.push(significant(truth[index], 6));
                row.push(value.map_or_else(|| "-".to_owned(), |value| error_text(value, truth[index])));
            }
            row
        })
        .collect()
}

/// The difference from the truth, with its share of the truth where that is not 0.
fn error_text(value: f64, truth: f64) -> String {
    let difference = significant(value - truth, 2);
    if truth == 0.0 {
        return difference;
    }
    format!("{difference} ({} %)", significant(100.0 * ((value - truth) / truth).abs(), 2))
}

/// The results as tables, one per object.
pub(crate) fn write_identify_table(
    sink: &mut impl Write,
    results: &[ObjectResult],
    truth: Option<&AffineMotion>,
    b: &MeaningOfB,
) -> io::Result<()> {
    for (index, result) in results.iter().enumerate() {
        if index > 0 {
            writeln!(sink)?;
        }
        let ObjectResult { object, motion, frames, frames_rejected, .. } = result;
        let method = result.method.name();
        writeln!(
            sink,
            "object {object}: {motion} motion, {method} method, {frames} frames, {frames_rejected} rejected"
        )?;
        write_aligned(sink, &COLUMNS, &parameter_rows(result, truth, b), &[0, 3])?;
        if let Some(velocity) = &result.velocity {
            writeln!(sink, "{}", velocity_text(velocity, b))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use freeform_motion::identify::{MotionEstimate, PointVelocity};
    use freeform_motion::riccati::{MotionModel, RigidMotion};
    use nalgebra::{Matrix2, Point2, Vector2};

    use super::*;
    use crate::args::IdentifyMethod;
    use crate::tracking::Estimate;
    use crate::turns::Turns;

    #[test]
    fn the_table_has_a_line_per_parameter_and_says_what_is_not_observable() {
        let estimate = MotionEstimate::new(MotionModel::Rigid, &[1.5, -0.31, 0.4], Some(&[0.001, 0.0123, 0.01]));
        let result = |estimate: MotionEstimate| ObjectResult {
            object: "0".to_owned(),
            method: IdentifyMethod::Adaptive,
            motion: MotionModel::Rigid,
            frames: 120,
            frames_rejected: 3,
            first_rejection: None,
            estimate: Estimate::of(estimate, None),
            velocity: None,
            ambiguity: None,
            warnings: Vec::new(),
        };
        let diverged = MotionEstimate::new(MotionModel::Rigid, &[f64::NAN, 0.0, 0.0], None);
        let velocity = PointVelocity {
            point: Point2::new(1.5, -2.0),
            velocity: Vector2::new(0.3, -0.456_78),
            covariance: Matrix2::new(1e-6, 0.0, 0.0, 4e-6),
        };
        let turns = Turns { turn: 50.0, rival_turns: vec![-40.0], parameters: vec!["omega"] };
        let results = [
            ObjectResult { velocity: Some(velocity), ..result(estimate) },
            result(estimate.with_unobservable(0)),
            ObjectResult { ambiguity: Some(turns), ..result(estimate.with_unobservable(0)) },
            result(diverged),
        ];
        let truth = RigidMotion { omega: 1.5, b1: -0.3, b2: 0.0 }.into();
        let mut text = Vec::new();
        write_identify_table(&mut text, &results, Some(&truth), &MeaningOfB::in_coordinates(None)).expect("memory");
        insta::assert_snapshot!(String::from_utf8(text).expect("UTF-8"));
    }
}
