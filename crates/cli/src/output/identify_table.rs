use std::io::{self, Write};

use freeform_drawing::{MeaningOfB, PARAMETER_COLUMNS, meaning_of_v, parameter_rows};
use freeform_motion::Truth;
use freeform_motion::outline_io::readable;
use freeform_motion::tracker::ObjectResult;

use super::aligned::write_aligned;

/// The results as tables, one per object.
pub(crate) fn write_identify_table(
    sink: &mut impl Write,
    results: &[ObjectResult],
    truth: Option<&Truth>,
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
            "object {}: {motion} motion, {method} method, {frames} frames, {frames_rejected} rejected",
            readable(object)
        )?;
        write_aligned(sink, &PARAMETER_COLUMNS, &parameter_rows(result, truth, b), &[0, 3])?;
        if let Some(velocity) = &result.velocity {
            writeln!(sink, "{}", meaning_of_v(velocity))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use freeform_motion::estimate::{MotionEstimate, PointVelocity};
    use freeform_motion::outline_filter::Ambiguity;
    use freeform_motion::riccati::{MotionModel, RigidMotion};
    use freeform_motion::tracker::Method;
    use freeform_motion::{TracedContours, Warning};
    use nalgebra::{Matrix2, Point2, Vector2};

    use super::*;

    #[test]
    fn the_table_has_a_line_per_parameter_and_says_what_is_not_observable() {
        let estimate = MotionEstimate::new(MotionModel::Rigid, &[1.5, -0.31, 0.4], Some(&[0.001, 0.0123, 0.01]));
        let result = |estimate: Option<MotionEstimate>| ObjectResult {
            frames: 120,
            frames_rejected: 3,
            estimate,
            ..ObjectResult::unknown("0", Method::Adaptive, MotionModel::Rigid)
        };
        let velocity = PointVelocity {
            point: Point2::new(1.5, -2.0),
            velocity: Vector2::new(0.3, -0.456_78),
            covariance: Matrix2::new(1e-6, 0.0, 0.0, 4e-6),
        };
        let ambiguity = Ambiguity { turn: -0.9, rival_turns: vec![0.7], parameters: vec!["omega"] };
        let hidden = vec![Warning::NotObservable { parameters: vec!["omega"], contours: TracedContours::default() }];
        let results = [
            ObjectResult { velocity: Some(velocity), ..result(Some(estimate)) },
            ObjectResult { warnings: hidden, ..result(Some(estimate.with_unobservable(0))) },
            result(Some(estimate.with_unobservable(0))),
            ObjectResult { ambiguity: Some(ambiguity), ..result(Some(estimate.with_unobservable(0))) },
            result(None),
        ];
        let truth = Truth::from(RigidMotion { omega: 1.5, b1: -0.3, b2: 0.0 });
        let mut text = Vec::new();
        write_identify_table(&mut text, &results, Some(&truth), &MeaningOfB::in_coordinates(None)).expect("memory");
        insta::assert_snapshot!(String::from_utf8(text).expect("UTF-8"));
    }
}
