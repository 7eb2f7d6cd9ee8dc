//! Sampling and corruption of frames.
use freeform_curve_fit::Outline;
use freeform_riccati::{AffineMotion, RigidMotion};
use freeform_sim_camera::{
    BuiltInShape, Camera, Frame, Occlusion, Sampling, Scene, SequenceLength, Settings, Shape, SimulationError,
    Simulator,
};
use nalgebra::{Affine2, Matrix3, Point2};
use proptest::prelude::*;

const AFFINE: AffineMotion = AffineMotion { a1: 0.2, a2: 1.0, a3: -1.3, a4: -0.1, b1: -3.0, b2: 4.0 };

fn scene(shape: BuiltInShape) -> Scene {
    Scene::new(shape, AFFINE, Camera::new(0.1).expect("positive"))
}

fn frames(settings: Settings) -> Vec<Frame> {
    Simulator::new(scene(BuiltInShape::Bird), settings).expect("good settings").frames().collect()
}

fn some_frames(count: usize) -> Settings {
    Settings { length: SequenceLength::Frames(count), ..Settings::default() }
}

fn points(frame: &Frame) -> Vec<Point2<f64>> {
    frame.outline.points().copied().collect()
}

/// The point of the shape nearest to `p`: its distance, and its place as a fraction of the perimeter.
fn nearest(dense: &[Point2<f64>], shape: &Shape, p: &Point2<f64>) -> (f64, f64) {
    let n = dense.len();
    let near = (0..n).min_by(|&i, &j| (p - dense[i]).norm_squared().total_cmp(&(p - dense[j]).norm_squared()));
    let mut place = near.expect("not empty") as f64 / n as f64;
    for _ in 0..4 {
        place += shape.tangent_at(place).dot(&(p - shape.point_at(place))) / shape.perimeter();
    }
    ((p - shape.point_at(place)).norm(), place.rem_euclid(1.0))
}

#[test]
fn the_same_seed_gives_the_same_frames_and_another_seed_others() {
    let busy = |seed| Settings {
        occlusion: Occlusion { fraction: 0.2, probability: 0.5, first_frame: 1 },
        outliers: 0.05,
        wrong_frames: 0.1,
        dropped_frames: 0.1,
        seed,
        ..some_frames(30)
    };
    assert_eq!(frames(busy(7)), frames(busy(7)));
    assert!(frames(busy(7)).iter().zip(&frames(busy(8))).all(|(a, b)| a.outline != b.outline));
}

#[test]
fn a_frame_does_not_depend_on_the_frames_around_it() {
    let all = frames(some_frames(40));
    assert_eq!(frames(some_frames(12))[..], all[..12]);
    let simulator = Simulator::new(scene(BuiltInShape::Bird), some_frames(40)).expect("good settings");
    assert_eq!(simulator.frame(31).as_ref(), Some(&all[31]));
    assert_eq!(simulator.frame(40), None);
    let late = Occlusion { fraction: 0.2, first_frame: 20, ..Occlusion::default() };
    let hidden = frames(Settings { occlusion: late, ..some_frames(40) });
    assert_eq!(hidden[..20], all[..20]);
    assert!(hidden[20..].iter().all(|frame| matches!(frame.outline, Outline::Open(_))));
}

#[test]
fn frames_are_numbered_and_timed() {
    let settings = Settings { fps: 25.0, length: SequenceLength::Seconds(0.48), ..Settings::default() };
    let taken = frames(settings);
    assert_eq!(taken.len(), 12);
    assert!(taken.iter().enumerate().all(|(k, frame)| frame.index == k && frame.time == k as f64 / 25.0));
    // 0.3 s at 30 frames/s is 9.000000000000002 frames in floating point.
    let settings = Settings { length: SequenceLength::Seconds(0.1 + 0.2), ..Settings::default() };
    assert_eq!(frames(settings).len(), 9);
}

#[test]
fn points_without_noise_lie_on_the_moved_outline() {
    for built_in in BuiltInShape::ALL {
        for sampling in [Sampling::default(), Sampling::Regular { jitter: 0.0 }, Sampling::Independent] {
            let settings = Settings { noise: 0.0, points: 100, sampling, ..some_frames(3) };
            let simulator = Simulator::new(scene(built_in), settings).expect("good settings");
            let (shape, dense) = (built_in.shape(), built_in.shape().sample(4000, 0.0));
            for frame in &simulator {
                let back = simulator.true_pose(frame.time).inverse();
                for p in points(&frame) {
                    let (distance, _) = nearest(&dense, &shape, &(back * p));
                    assert!(distance < 1e-6, "{built_in}: {distance:e}");
                }
            }
        }
    }
}

#[test]
fn points_run_counter_clockwise_and_have_no_correspondence() {
    let taken = frames(Settings { noise: 0.0, ..some_frames(20) });
    let simulator = Simulator::new(scene(BuiltInShape::Bird), some_frames(1)).expect("good settings");
    let (shape, dense) = (BuiltInShape::Bird.shape(), BuiltInShape::Bird.shape().sample(4000, 0.0));
    let mut first_places = Vec::new();
    for frame in &taken {
        assert!(frame.outline.signed_area() > 0.0);
        let back = simulator.true_pose(frame.time).inverse();
        first_places.push(nearest(&dense, &shape, &(back * points(frame)[0])).1);
    }
    first_places.sort_by(f64::total_cmp);
    assert!(first_places.windows(2).all(|pair| pair[1] - pair[0] > 1e-6));
    assert!(first_places[19] - first_places[0] > 0.5);
}

/// How many points of each frame fall on the first half of the square's perimeter.
fn counts_on_one_half(sampling: Sampling) -> Vec<f64> {
    let settings = Settings { noise: 0.0, sampling, points: 200, ..some_frames(300) };
    let still = Scene::new(BuiltInShape::Square, RigidMotion::default(), Camera::default());
    let simulator = Simulator::new(still, settings).expect("good settings");
    // The diagonal from the first corner halves the perimeter.
    let axis = simulator.scene().shape().point_at(0.0).coords;
    simulator.frames().map(|f| f.outline.points().filter(|p| axis.perp(&p.coords) > 0.0).count() as f64).collect()
}

#[test]
fn independent_points_scatter_as_binomial_and_stratified_ones_do_not() {
    let variance = |counts: &[f64]| counts.iter().map(|c| (c - 100.0).powi(2)).sum::<f64>() / counts.len() as f64;
    // Binomial variance 50; 300 frames know it to 8.2 %, and 5 standard errors are 41 %.
    let independent = variance(&counts_on_one_half(Sampling::Independent));
    assert!((independent / 50.0 - 1.0).abs() < 0.41, "{independent}");
    // At most one stretch at each end of the half is undecided.
    assert!(counts_on_one_half(Sampling::default()).iter().all(|c| (c - 100.0).abs() <= 2.0));
    assert!(counts_on_one_half(Sampling::Regular { jitter: 0.0 }).iter().all(|c| (c - 100.0).abs() <= 1.0));
}

#[test]
fn noise_is_gaussian_of_the_stated_size_and_independent() {
    let clean = frames(Settings { noise: 0.0, ..some_frames(120) });
    let noisy = frames(Settings { noise: 0.005, ..some_frames(120) });
    // The streams are separate, so the difference is the noise alone.
    let pairs = clean.iter().zip(&noisy).flat_map(|(c, n)| points(c).into_iter().zip(points(n)));
    let z: Vec<[f64; 2]> = pairs.map(|(c, n)| ((n - c) / 0.005).into()).collect();
    assert_eq!(z.len(), 48_000);
    let n = z.len() as f64;
    let mean = |value: &dyn Fn(&[f64; 2]) -> f64| z.iter().map(value).sum::<f64>() / n;
    // Bounds of 5 standard errors: each is passed by chance once in 1.7 million.
    for i in 0..2 {
        assert!(mean(&|z| z[i]).abs() < 5.0 / n.sqrt());
        assert!((mean(&|z| z[i].powi(2)) - 1.0).abs() < 5.0 * (2.0 / n).sqrt());
        assert!((mean(&|z| z[i].powi(4)) - 3.0).abs() < 5.0 * (96.0 / n).sqrt());
    }
    assert!(mean(&|z| z[0] * z[1]).abs() < 5.0 / n.sqrt());
    let neighbours = z.windows(2).map(|pair| pair[0][0] * pair[1][0]).sum::<f64>() / n;
    assert!(neighbours.abs() < 5.0 / n.sqrt());
}

#[test]
fn a_wrong_frame_shows_another_object_as_often_as_stated() {
    let taken = frames(Settings { wrong_frames: 0.2, noise: 0.0, points: 60, ..some_frames(1000) });
    let wrong: Vec<_> = taken.iter().filter(|frame| frame.corruption.wrong_shape.is_some()).collect();
    // Binomial standard deviation 12.6; five of them.
    assert!((wrong.len() as f64 - 200.0).abs() < 64.0, "{}", wrong.len());
    let simulator = Simulator::new(scene(BuiltInShape::Bird), some_frames(1)).expect("good settings");
    let (shape, dense) = (BuiltInShape::Bird.shape(), BuiltInShape::Bird.shape().sample(1000, 0.0));
    for frame in wrong.iter().take(20) {
        let back = simulator.true_pose(frame.time).inverse();
        let body: Vec<_> = points(frame).iter().map(|p| back * p).collect();
        let farthest = body.iter().map(|p| nearest(&dense, &shape, p).0).fold(0.0, f64::max);
        assert!(farthest > 0.02, "{farthest}");
        assert!(body.iter().all(|p| p.coords.norm() < 1.0));
    }
}

#[test]
fn no_wrong_frame_shows_the_object_itself() {
    let settings = Settings { wrong_frames: 0.9, points: 10, ..some_frames(400) };
    let simulator = Simulator::new(scene(BuiltInShape::Glider), settings).expect("good settings");
    assert!(simulator.frames().all(|frame| frame.corruption.wrong_shape != Some(BuiltInShape::Glider)));
}

#[test]
fn dropped_frames_leave_gaps_as_often_as_stated() {
    let taken = frames(Settings { dropped_frames: 0.3, points: 10, ..some_frames(1000) });
    // Binomial standard deviation 14.5; five of them.
    assert!((taken.len() as f64 - 700.0).abs() < 73.0, "{}", taken.len());
    assert!(taken.windows(2).all(|pair| pair[0].index < pair[1].index));
    assert!(taken.iter().all(|frame| frame.time == frame.index as f64 / 30.0));
}

#[test]
fn an_arc_is_hidden_as_often_as_stated() {
    let occlusion = Occlusion { fraction: 0.3, probability: 0.4, first_frame: 0 };
    let taken = frames(Settings { occlusion, points: 20, ..some_frames(1000) });
    let open = taken.iter().filter(|frame| matches!(frame.outline, Outline::Open(_))).count();
    // Binomial standard deviation 15.5; five of them.
    assert!((open as f64 - 400.0).abs() < 78.0, "{open}");
    assert!(taken.iter().all(|f| f.outline.point_count() == if f.corruption.hidden.is_some() { 14 } else { 20 }));
}

proptest! {
    #[test]
    fn the_missing_arc_has_the_stated_fraction(fraction in 0.05..0.9_f64, seed in any::<u64>()) {
        let occlusion = Occlusion { fraction, ..Occlusion::default() };
        let settings = Settings { occlusion, noise: 0.0, seed, ..some_frames(2) };
        let simulator = Simulator::new(scene(BuiltInShape::Glider), settings).expect("good settings");
        let (shape, dense) = (BuiltInShape::Glider.shape(), BuiltInShape::Glider.shape().sample(3000, 0.0));
        for frame in &simulator {
            let hidden = frame.corruption.hidden.expect("an arc is missing from every frame");
            prop_assert_eq!(hidden.length, fraction);
            prop_assert_eq!(frame.outline.pieces().count(), 1);
            prop_assert_eq!(frame.outline.point_count(), (400.0 * (1.0 - fraction)).round() as usize);
            let back = simulator.true_pose(frame.time).inverse();
            // Places counted from the start of the gap, so that the visible ones are the last.
            let places: Vec<f64> = points(&frame)
                .iter()
                .map(|p| (nearest(&dense, &shape, &(back * p)).1 - hidden.start).rem_euclid(1.0))
                .collect();
            prop_assert!(places.iter().all(|s| *s > fraction - 1e-6 && *s < 1.0 + 1e-6));
            prop_assert!(places.windows(2).all(|pair| pair[1] > pair[0] - 1e-6));
            let spacing = (1.0 - fraction) / places.len() as f64;
            prop_assert!(places[0] < fraction + spacing + 1e-6 && places[places.len() - 1] > 1.0 - spacing - 1e-6);
            prop_assert!(!hidden.contains(hidden.start - 0.01) && hidden.contains(hidden.start + 0.5 * fraction));
        }
    }

    #[test]
    fn the_stated_share_of_points_is_moved_within_the_radius(
        outliers in 0.0..0.9_f64, radius in 0.01..1.0_f64, seed in any::<u64>(),
    ) {
        let clean = frames(Settings { seed, ..some_frames(2) });
        let dirty = frames(Settings { seed, outliers, outlier_radius: radius, ..some_frames(2) });
        for (clean, dirty) in clean.iter().zip(&dirty) {
            let shifts: Vec<f64> = points(clean).iter().zip(points(dirty)).map(|(c, d)| (d - c).norm()).collect();
            let moved: Vec<usize> = (0..shifts.len()).filter(|&k| shifts[k] > 0.0).collect();
            prop_assert_eq!(moved.len(), (400.0 * outliers).round() as usize);
            prop_assert_eq!(&moved, &dirty.corruption.outliers);
            prop_assert!(shifts.iter().all(|shift| *shift <= radius * (1.0 + 1e-12)));
        }
    }
}

#[test]
fn outliers_fill_the_disc_evenly() {
    let clean = frames(some_frames(20));
    let dirty = frames(Settings { outliers: 0.5, outlier_radius: 0.3, ..some_frames(20) });
    let pairs = clean.iter().zip(&dirty).flat_map(|(c, d)| points(c).into_iter().zip(points(d)));
    let shifts: Vec<f64> = pairs.map(|(c, d)| (d - c).norm() / 0.3).filter(|r| *r > 0.0).collect();
    assert_eq!(shifts.len(), 4000);
    // Evenly over the area means that r^2 is uniform: half of them within 0.5; 5 standard errors of 4000 are 158.
    let inner = shifts.iter().filter(|r| **r * **r < 0.5).count() as f64;
    assert!((inner - 2000.0).abs() < 158.0, "{inner}");
}

#[test]
fn settings_without_sense_are_refused_by_name() {
    type Change = fn(&mut Settings, f64);
    type Group<'a> = (&'a [(&'a str, Change)], &'a [f64]);
    let at_least_zero: [(&str, Change); 2] =
        [("noise", |s, v| s.noise = v), ("outlier radius", |s, v| s.outlier_radius = v)];
    let fractions: [(&str, Change); 4] = [
        ("occlusion", |s, v| s.occlusion.fraction = v),
        ("outliers", |s, v| s.outliers = v),
        ("wrong frames", |s, v| s.wrong_frames = v),
        ("dropped frames", |s, v| s.dropped_frames = v),
    ];
    let shares: [(&str, Change); 2] = [
        ("occlusion probability", |s, v| s.occlusion.probability = v),
        ("sampling jitter", |s, v| s.sampling = Sampling::Regular { jitter: v }),
    ];
    let positive: [(&str, Change); 2] =
        [("fps", |s, v| s.fps = v), ("seconds", |s, v| s.length = SequenceLength::Seconds(v))];
    let (nan, inf) = (f64::NAN, f64::INFINITY);
    let groups: [Group<'_>; 4] = [
        (&at_least_zero, &[-1e-9, nan, inf, -inf]),
        (&fractions, &[-0.1, 1.0, 1.5, nan, inf]),
        (&shares, &[-0.1, 1.1, nan, inf]),
        (&positive, &[0.0, -30.0, nan, inf]),
    ];
    for (name, change, value) in
        groups.iter().flat_map(|(group, values)| group.iter().flat_map(|(n, c)| values.iter().map(move |v| (n, c, *v))))
    {
        let mut settings = Settings::default();
        change(&mut settings, value);
        let error = Simulator::new(scene(BuiltInShape::Bird), settings).expect_err("out of range");
        assert!(matches!(error, SimulationError::OutOfRange { setting, .. } if setting == *name), "{error} for {name}");
        assert!(error.to_string().contains(*name));
    }
}

#[test]
fn sequences_that_are_too_small_or_too_long_are_refused() {
    let error = |settings| Simulator::new(scene(BuiltInShape::Bird), settings).expect_err("no sequence");
    let few = |points| error(Settings { points, ..Settings::default() });
    assert_eq!(few(2), SimulationError::TooFewPoints { points: 2, visible: 2, needed: 3 });
    assert_eq!(few(0), SimulationError::TooFewPoints { points: 0, visible: 0, needed: 3 });
    let occlusion = Occlusion { fraction: 0.9, ..Occlusion::default() };
    let hidden = error(Settings { points: 20, occlusion, ..Settings::default() });
    assert_eq!(hidden, SimulationError::TooFewPoints { points: 20, visible: 2, needed: 3 });
    assert_eq!(error(some_frames(0)), SimulationError::NoFrame);
    assert!(matches!(error(some_frames(usize::MAX)), SimulationError::TooManyFrames { .. }));
    let endless = Settings { length: SequenceLength::Seconds(1e300), fps: 1e300, ..Settings::default() };
    assert!(matches!(error(endless), SimulationError::TooManyFrames { .. }));
}

#[test]
fn a_motion_that_leaves_the_range_of_numbers_is_refused() {
    let run = |motion: AffineMotion| {
        let scene = Scene::new(BuiltInShape::Bird, motion, Camera::default());
        Simulator::new(scene, Settings::default()).map(|_| ())
    };
    let rest = AffineMotion::default();
    for motion in [
        AffineMotion { a1: 300.0, a4: 300.0, ..rest },
        AffineMotion { a1: -300.0, a4: -300.0, ..rest },
        AffineMotion { a1: 20.0, ..rest },
        AffineMotion { b1: 1e12, ..rest },
        AffineMotion { a2: f64::NAN, ..rest },
    ] {
        assert!(matches!(run(motion), Err(SimulationError::PoseOutOfRange { .. })), "{motion:?}");
    }
    assert_eq!(run(AffineMotion { a1: 1.0, ..rest }), Ok(()));
    let flat = Affine2::from_matrix_unchecked(Matrix3::new(1.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0));
    let scene = scene(BuiltInShape::Bird).with_initial_pose(flat);
    let error = Simulator::new(scene, Settings::default()).expect_err("a flat object");
    assert_eq!(error, SimulationError::PoseOutOfRange { time: 0.0 });
}
