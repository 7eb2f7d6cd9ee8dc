//! Points that are measured side by side against points that are measured one after the other, on whole tracks.
use freeform_curve_fit::{OpenArc, OpenOutline, Outline};
use freeform_riccati::{MotionModel, map_point};
use nalgebra::{Matrix3, Point2};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use super::Track;
use crate::{
    drawn_curves::{lobed, polar},
    measurement::{Frame, Pass},
};

/// Points of an egg with three bulges, within part of a round, each elsewhere on it.
fn egg(rng: &mut ChaCha8Rng, count: u32, part: f64) -> Vec<Point2<f64>> {
    let point = |i: u32| {
        let t = std::f64::consts::TAU * part * (f64::from(i) + rng.random_range(0.0..1.0)) / f64::from(count);
        let r = lobed(t, &[(3.0, [0.2, 0.0]), (1.0, [0.0, 0.1])]) + rng.random_range(-0.01..0.01);
        let p = polar(r, t);
        Point2::new(p.x, 0.8 * p.y)
    };
    (0..count).map(point).collect()
}

#[test]
fn points_measured_side_by_side_are_measured_as_one_by_one() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let motion = [0.2, -0.1, 0.15, 0.1, 0.3, -0.2];
    for (model, closed, count) in MotionModel::ALL
        .into_iter()
        .flat_map(|model| [(model, true, 301), (model, false, 302), (model, true, 40), (model, true, 1403)])
    {
        let outline = |points: Vec<Point2<f64>>| {
            if closed {
                return Outline::closed(points).expect("an outline");
            }
            let arc = OpenArc::new(points).expect("an arc");
            Outline::Open(OpenOutline::new(vec![arc]).expect("an outline"))
        };
        let part = if closed { 1.0 } else { 0.7 };
        let mut frame = Frame::default();
        let first = outline(egg(&mut rng, count, part));
        let track = Track::begin(model, &first, 0.0, &mut frame).expect("a track");
        let k = model.parameter_count().min(motion.len());
        let flow = model.min(MotionModel::Affine).flow(&motion[..k], 1.0).into_inner();
        let near = model.min(MotionModel::Affine).flow(&motion.map(|m| 1.01 * m)[..k], 1.0).into_inner();
        let (to, pose) = (track.reference().to_image(), *track.body_pose());
        let moved = to * flow * pose * to.try_inverse().expect("a radius");
        // Some points lie beyond the ends of what is known, and some anywhere.
        let mut seen: Vec<_> = egg(&mut rng, count, 1.1 * part).iter().map(|p| map_point(&moved, p)).collect();
        seen.iter_mut().step_by(17).for_each(|p| *p += nalgebra::Vector2::new(0.1, -0.07));
        frame.load(&outline(seen), track.reference());
        frame.clear_shifts(track.map.cells().len());
        frame.shifts.iter_mut().for_each(|shift| *shift = rng.random_range(-0.005..0.005));
        let mut other = frame.clone();
        let mut compared = 0;
        for (pass, pose) in [(Pass::First, near * pose), (Pass::Again, flow * pose)] {
            let view = track.view();
            let null = track.null_directions();
            let inverse: Matrix3<f64> = pose.try_inverse().expect("a pose");
            let half_window = view.half_window_of_places(&pose, &frame);
            view.measure_side_by_side(&mut frame, &inverse, half_window, pass);
            view.write_measurements(&mut frame, &null);
            view.measure_one_by_one(&mut other, &inverse, half_window, &null, pass);
            for (i, (found, expected)) in frame.measurements.iter().zip(&other.measurements).enumerate() {
                assert_eq!(found.cell, expected.cell, "{model:?} {closed} {pass:?} {i}");
                let numbers = |m: &crate::measurement::Measurement| {
                    let [a, b, c, d, e, f, g, h] = m.jacobian;
                    [m.residual, m.by_offset, m.weight, a, b, c, d, e, f, g, h]
                };
                for (found, expected) in numbers(found).iter().zip(numbers(expected)) {
                    assert!((found - expected).abs() < 1e-9, "{model:?} {closed} {pass:?} {i}: {found} {expected}");
                }
                compared += usize::from(found.weight > 0.0);
            }
        }
        assert!(compared > frame.points.len(), "{model:?} {closed}: {compared}");
    }
}
