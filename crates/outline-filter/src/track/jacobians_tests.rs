//! What a frame is linearised to, on whole tracks: Jacobians, weights, null directions.
use freeform_riccati::{MotionModel, map_point};
use nalgebra::{Matrix3, Point2, Vector2};

use super::Track;
use crate::{
    drawn_curves::outline,
    map::NullDirection,
    measurement::{Frame, Measurement, NO_CELL, Pass},
};

const SMALL: f64 = 1e-9;

/// A track of an oval, whose second axis is so many times the first, with next to no noise.
fn oval(model: MotionModel, axis: f64, frame: &mut Frame) -> Track {
    let outline = outline(300, |t| Point2::new(t.cos() + 0.2 * (1.0 - axis) * (2.0 * t).cos(), axis * t.sin()));
    let mut track = Track::begin(model, &outline, 0.0, frame).expect("a track");
    track.set_noise(SMALL);
    track
}

/// Points in a pose on every cell, a bit along it, and so far off along its normal.
fn points_on(track: &Track, pose: &Matrix3<f64>, off: impl Fn(usize) -> f64) -> Vec<Point2<f64>> {
    let cells = track.map.cells().iter().zip(&track.belief.offsets).enumerate();
    let point = |(number, (cell, offset)): (usize, (&crate::map::Cell, &f64))| {
        let along = Vector2::new(-cell.normal.y, cell.normal.x);
        let q = cell.centre + (offset + off(number)) * cell.normal + 0.2 * track.map.spacing() * along;
        map_point(pose, &q)
    };
    cells.map(point).collect()
}

fn measured(track: &Track, points: &[Point2<f64>], pose: &Matrix3<f64>, null: &[NullDirection]) -> Vec<Measurement> {
    let mut frame = Frame { points: points.to_vec(), ..Frame::default() };
    frame.clear_shifts(track.map.cells().len());
    track.view().measure(&mut frame, pose, null, Pass::First);
    frame.measurements
}

#[test]
fn jacobians_are_the_derivatives_of_the_residuals_by_the_pose_error_and_the_offset() {
    let motion = [0.2, -0.3, 0.15, 0.1, 0.3, -0.2, 0.05, -0.04];
    for model in MotionModel::ALL {
        let k = model.parameter_count();
        let mut track = oval(model, 0.6, &mut Frame::default());
        // Jacobians are those at the cells: these are the derivatives where cells have no offsets.
        track.belief.offsets.fill(0.0);
        let pose = model.flow(&motion[..k], 1.0).into_inner();
        let points = points_on(&track, &pose, |_| 0.0);
        let at = measured(&track, &points, &pose, &[]);
        let step = 1e-6;
        let mut compared = 0;
        for j in 0..k {
            let [forth, back] = [step, -step].map(|size| {
                let mut error = [0.0; 8];
                error[j] = size;
                let moved = model.flow(&error[..k], 1.0).into_inner() * pose;
                measured(&track, &points, &moved, &[])
            });
            for ((m, forth), back) in at.iter().zip(&forth).zip(&back).filter(|((m, _), _)| m.cell != NO_CELL) {
                if m.cell == forth.cell && m.cell == back.cell {
                    let slope = (forth.residual - back.residual) / (2.0 * step);
                    assert!((slope + m.jacobian[j]).abs() < 1e-6, "{model:?} {j}: {slope} {}", m.jacobian[j]);
                    compared += 1;
                }
            }
        }
        assert!(compared > k * points.len() / 2, "{model:?}: {compared}");
        let mut other = track.clone();
        other
            .belief
            .offsets
            .iter_mut()
            .enumerate()
            .for_each(|(i, offset)| *offset = if i % 2 == 0 { 0.01 } else { -0.02 });
        for (m, moved) in at.iter().zip(measured(&other, &points, &pose, &[])).filter(|(m, moved)| m.cell == moved.cell)
        {
            assert!(m.cell == NO_CELL || (m.residual - moved.residual).abs() > 1e-3, "{model:?}");
            let apart = m.jacobian.iter().zip(&moved.jacobian).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(apart < 1e-12, "{model:?}: an offset has moved a Jacobian by {apart}");
        }
        let mut other = track.clone();
        other.belief.offsets.iter_mut().for_each(|offset| *offset += step);
        for (m, moved) in at.iter().zip(measured(&other, &points, &pose, &[])) {
            let slope = (moved.residual - m.residual) / step;
            assert!((slope + m.by_offset).abs() < 1e-6, "{model:?}: {slope} {}", m.by_offset);
        }
    }
}

#[test]
fn points_count_in_full_up_to_three_deviations_and_not_at_all_beyond_six() {
    let track = oval(MotionModel::Rigid, 0.6, &mut Frame::default());
    let pose = Matrix3::identity();
    let deviations = |number: usize| match number % 20 {
        0 => 2.9,
        5 => 4.5,
        10 => -6.1,
        _ => 0.0,
    };
    let points = points_on(&track, &pose, |number| SMALL * deviations(number));
    for (number, m) in measured(&track, &points, &pose, &[]).iter().enumerate() {
        let expected = match number % 20 {
            5 => (1.0_f64 - 0.25).powi(2),
            10 => 0.0,
            _ => 1.0,
        };
        assert!((m.weight - expected).abs() < 1e-3, "{number}: {}", m.weight);
    }
}

#[test]
fn jacobians_say_nothing_of_a_null_direction_that_is_projected_out() {
    for model in [MotionModel::Rigid, MotionModel::Similarity, MotionModel::Affine] {
        let k = model.parameter_count();
        let track = oval(model, 1.0, &mut Frame::default());
        let mut motion = [0.0; 8];
        (motion[k - 2], motion[k - 1]) = (0.4, -0.7);
        let pose = model.flow(&motion[..k], 1.0).into_inner();
        let null = track.map.null_directions(model, &pose);
        assert_eq!(null.len(), 1, "{model:?}");
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        assert!((dot(&null[0].direction, &null[0].dual) - 1.0).abs() < 1e-9, "{model:?}");
        for m in measured(&track, &points_on(&track, &pose, |_| 0.0), &pose, &null) {
            assert!(dot(&m.jacobian, &null[0].direction).abs() < 1e-9, "{model:?}");
            assert!(m.jacobian.iter().any(|entry| entry.abs() > 0.1), "{model:?}");
        }
    }
}
