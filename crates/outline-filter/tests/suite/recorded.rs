//! Recorded sequences: states of the filter smoothed over all frames, and one motion estimated from all frames at once.
use crate::recording::{
    Corruption, NOISE, SECONDS_PER_FRAME, bound, constant_motion, is_near_95_percent, parameters, record,
    root_mean_square,
};
use freeform_curve_fit::Outline;
use freeform_estimate::{MotionState, ProcessNoise, SmootherError, smooth};
use freeform_outline_filter::{BatchError, FilterError, FilterSettings, MotionFilter, estimate_batch};
use freeform_riccati::MotionModel;
use freeform_sim_camera::BuiltInShape;
use nalgebra::{Affine2, Matrix3, Point2};
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};

/// States after each frame from the second on.
fn states(settings: FilterSettings, frames: &[(f64, Outline)]) -> Vec<MotionState> {
    let mut filter = MotionFilter::new(settings).expect("good settings");
    let mut states = Vec::new();
    for (time, outline) in frames {
        filter.step(*time, outline).expect("increasing times");
        states.extend(filter.state());
    }
    states
}

#[test]
fn the_state_is_what_the_filter_says_of_pose_and_motion() {
    for model in MotionModel::ALL {
        let frames = record(BuiltInShape::Bird, &constant_motion(model, 8), Corruption::default(), NOISE, 1);
        let mut filter = MotionFilter::new(FilterSettings { model, ..FilterSettings::default() }).expect("ok");
        filter.step(frames[0].0, &frames[0].1).expect("a first frame");
        assert_eq!(filter.state(), None);
        for (time, outline) in &frames[1..] {
            filter.step(*time, outline).expect("increasing times");
        }
        let state = filter.state().expect("a state");
        assert_eq!((state.time(), state.model()), (frames[7].0, model));
        let pose = filter.pose().expect("a pose");
        assert!((state.pose().matrix() - pose.matrix()).norm() < 1e-9);
        assert_eq!(state.motion().values(), filter.estimate().expect("an estimate").values());
        let k = model.parameter_count();
        let joint = state.covariance();
        let motion = filter.covariance().expect("a covariance");
        assert!((joint.view((k, k), (k, k)) - &motion).norm() < 1e-6 * motion.norm());
    }
}

#[test]
fn the_velocity_of_a_point_is_how_fast_its_pose_takes_it_along() {
    for model in MotionModel::ALL {
        let frames = record(BuiltInShape::Bird, &constant_motion(model, 8), Corruption::default(), NOISE, 1);
        let settings = FilterSettings { model, ..FilterSettings::default() };
        let state = states(settings, &frames).pop().expect("a state");
        let first = Point2::new(0.4, -0.3);
        let at = |seconds: f64| state.predicted(state.time() + seconds, &ProcessNoise::default()).pose() * first;
        let found = state.velocity_of(&first);
        assert!((found.point - at(0.0)).norm() < 1e-12);
        let difference = (at(1e-4) - at(-1e-4)) / 2e-4;
        assert!((found.velocity - difference).norm() < 1e-6, "{model}: {} {difference}", found.velocity);
        // The errors go along with the point: those of the velocity are those of places a little later and earlier.
        let place = |seconds: f64| {
            let later = state.predicted(state.time() + seconds, &ProcessNoise::default());
            later.velocity_of(&first).covariance
        };
        assert!((place(1e-6) - found.covariance).norm() < 1e-3 * found.covariance.norm(), "{model}");
    }
}

#[test]
fn errors_that_go_together_along_the_outline_widen_the_deviations_of_state_and_estimate_alike() {
    let mut frames =
        record(BuiltInShape::Bird, &constant_motion(MotionModel::Rigid, 20), Corruption::default(), NOISE, 3);
    let mut random = ChaCha8Rng::seed_from_u64(5);
    for (_, outline) in &mut frames {
        // One error for each dozen of points, as the edges of pixels or a shadow make it.
        let mut shift = nalgebra::Vector2::zeros();
        let moved = outline.points().enumerate().map(|(index, point)| {
            if index % 12 == 0 {
                let mut error = || -> f64 { StandardNormal.sample(&mut random) };
                shift = 2.0 * NOISE * nalgebra::Vector2::new(error(), error());
            }
            point + shift
        });
        *outline = Outline::closed(moved.collect()).expect("an outline");
    }
    let mut filter = MotionFilter::new(FilterSettings::default()).expect("good settings");
    for (time, outline) in &frames {
        filter.step(*time, outline).expect("increasing times");
    }
    let (state, estimate) = (filter.state().expect("a state").motion(), filter.estimate().expect("an estimate"));
    for (of_state, of_estimate) in state.parameters().zip(estimate.parameters()) {
        let [a, b] = [of_state, of_estimate].map(|p| p.standard_deviation.expect("one"));
        assert!((a - b).abs() < 1e-6 * b, "{}: {a} {b}", of_state.name);
    }
}

#[test]
fn without_process_noise_the_smoothed_motion_is_the_last_one_and_the_poses_lie_on_its_path() {
    for model in MotionModel::ALL {
        let frames = record(BuiltInShape::Glider, &constant_motion(model, 20), Corruption::default(), NOISE, 4);
        let filtered = states(FilterSettings { model, ..FilterSettings::default() }, &frames);
        let smoothed = smooth(&filtered, &ProcessNoise::default()).expect("one run");
        let last = filtered.last().expect("states");
        for state in &smoothed {
            for (value, truth) in state.motion().values().iter().zip(last.motion().values()) {
                assert!((value - truth).abs() < 1e-9 * (1.0 + truth.abs()), "{model}: {value} {truth}");
            }
            let back = last.predicted(state.time(), &ProcessNoise::default());
            assert!((state.pose().matrix() - back.pose().matrix()).norm() < 1e-9, "{model} at {}", state.time());
        }
    }
}

/// A rigid motion whose parameters walk at random, by the standard deviations per square root of a second given: poses and parameters
/// after each frame.
fn random_walk(noise: &ProcessNoise, frames: usize, seed: u64) -> (Vec<Matrix3<f64>>, Vec<[f64; 3]>) {
    let mut rng = ChaCha8Rng::seed_from_u64(1000 + seed);
    let mut theta = [1.0, 0.2, -0.1];
    let mut pose = Matrix3::identity();
    let (mut poses, mut motions) = (vec![pose], vec![theta]);
    for _ in 1..frames {
        pose = MotionModel::Rigid.flow(&theta, SECONDS_PER_FRAME).into_inner() * pose;
        for (value, rate) in theta.iter_mut().zip([noise.rates, noise.velocities, noise.velocities]) {
            let step: f64 = StandardNormal.sample(&mut rng);
            *value += rate * SECONDS_PER_FRAME.sqrt() * step;
        }
        poses.push(pose);
        motions.push(theta);
    }
    (poses, motions)
}

#[test]
fn smoothing_a_motion_that_drifts_leaves_less_than_0_6_of_the_error_of_omega_and_intervals_of_motion_hold() {
    let process_noise = ProcessNoise { rates: 0.5, velocities: 0.1 };
    let settings = FilterSettings { process_noise, ..FilterSettings::default() };
    let (mut before, mut after) = (vec![Vec::new(); 3], vec![Vec::new(); 3]);
    let (mut angles_before, mut angles_after) = (Vec::new(), Vec::new());
    let (mut covered, mut count) = (0, 0);
    let (mut filtered_deviations, mut angle_deviations) = (Vec::new(), Vec::new());
    for seed in 0..8 {
        let (poses, motions) = random_walk(&process_noise, 60, seed);
        let shape = if seed % 2 == 0 { BuiltInShape::Bird } else { BuiltInShape::Van };
        let frames = record(shape, &poses, Corruption::default(), NOISE, seed);
        let filtered = states(settings, &frames);
        assert_eq!(filtered.len(), 59);
        let smoothed = smooth(&filtered, &process_noise).expect("one run");
        for (i, (f, s)) in filtered.iter().zip(&smoothed).enumerate() {
            let truth = motions[i + 1];
            for (j, parameter) in s.motion().parameters().enumerate() {
                let error = parameter.value.expect("observable") - truth[j];
                covered += usize::from(error.abs() < 1.96 * parameter.standard_deviation.expect("given"));
                count += 1;
                after[j].push(error);
                before[j].push(f.motion().values()[j] - truth[j]);
            }
            let angle_of = |m: &Matrix3<f64>| (m[(0, 1)] - m[(1, 0)]).atan2(m[(0, 0)] + m[(1, 1)]);
            let truth = angle_of(&poses[i + 1]);
            let (f, s) = (f.pose_parameters()[0], s.pose_parameters()[0]);
            angles_before.push((f.value - truth).sin());
            angles_after.push((s.value - truth).sin());
            filtered_deviations.push((f.value - truth).sin() / f.standard_deviation);
            angle_deviations.push((s.value - truth).sin() / s.standard_deviation);
        }
    }
    let ratio_of_omega = root_mean_square(&after[0]) / root_mean_square(&before[0]);
    assert!(ratio_of_omega < 0.6, "omega: {ratio_of_omega}");
    for j in 1..3 {
        let ratio = root_mean_square(&after[j]) / root_mean_square(&before[j]);
        assert!(ratio < 0.8, "velocity {j}: {ratio}");
    }
    assert!(root_mean_square(&angles_after) < root_mean_square(&angles_before));
    println!(
        "error of omega, smoothed over filtered: {ratio_of_omega:.2}; {covered} of {count} intervals of motion hold"
    );
    let (f, s) = (root_mean_square(&filtered_deviations), root_mean_square(&angle_deviations));
    println!("error of the angle in standard deviations: {f:.2} filtered, {s:.2} smoothed");
    // Errors of about ten frames hang together.
    assert!(is_near_95_percent(covered, count, 10), "{covered} of {count}");
    // Of the noise in the first frame, which every pose is told from, the filter forgets a part as the motion drifts.
    assert!(root_mean_square(&angle_deviations) < 2.0, "{}", root_mean_square(&angle_deviations));
}

#[test]
fn the_pose_is_told_in_the_numbers_of_its_model() {
    for (model, names) in [
        (MotionModel::Rigid, "angle x y"),
        (MotionModel::Similarity, "scale angle x y"),
        (MotionModel::Affine, "m11 m12 m21 m22 x y"),
        (MotionModel::Projective, "m11 m12 m21 m22 x y m31 m32"),
    ] {
        let poses = constant_motion(model, 15);
        let frames = record(BuiltInShape::Bird, &poses, Corruption::default(), NOISE, 2);
        let filtered = states(FilterSettings { model, ..FilterSettings::default() }, &frames);
        let parameters = filtered.last().expect("states").pose_parameters();
        assert_eq!(parameters.iter().map(|p| p.name).collect::<Vec<_>>().join(" "), names);
        let centre = frames[0].1.centroid();
        let at = crate::recording::map(&poses[14], &centre);
        let truth = |name| match name {
            "angle" => (poses[14][(0, 1)] - poses[14][(1, 0)]).atan2(poses[14][(0, 0)] + poses[14][(1, 1)]),
            "scale" => poses[14].fixed_view::<2, 2>(0, 0).determinant().sqrt(),
            "x" => at.x,
            "y" => at.y,
            _ => f64::NAN,
        };
        for p in &parameters {
            let (truth, std) = (truth(p.name), p.standard_deviation);
            assert!(std > 0.0 && std < 0.05, "{model} {}: {std}", p.name);
            assert!(truth.is_nan() || (p.value - truth).abs() < 5.0 * std, "{model} {}: {} {truth}", p.name, p.value);
        }
    }
}

#[test]
fn states_that_do_not_belong_together_are_not_smoothed() {
    let frames = record(BuiltInShape::Bird, &constant_motion(MotionModel::Rigid, 6), Corruption::default(), NOISE, 1);
    let run = states(FilterSettings::default(), &frames);
    let noise = ProcessNoise::default();
    assert_eq!(smooth(&[], &noise), Ok(Vec::new()));
    assert_eq!(smooth(&run[..1], &noise), Ok(run[..1].to_vec()));
    let backwards = [run[1].clone(), run[0].clone()];
    assert!(matches!(smooth(&backwards, &noise), Err(SmootherError::TimeNotIncreasing { index: 1, .. })));
    let other = record(BuiltInShape::Van, &constant_motion(MotionModel::Rigid, 6), Corruption::default(), NOISE, 1);
    let other = states(FilterSettings::default(), &other);
    let mixed = [run[0].clone(), other[1].clone()];
    assert_eq!(smooth(&mixed, &noise), Err(SmootherError::AnotherRun { index: 1 }));
}

/// Error over bound of the batch estimator and of the filter, and how many of the former lie within their 95 % intervals.
fn batch_and_filter(model: MotionModel, corruption: Corruption, runs: u64) -> (Vec<f64>, Vec<f64>, usize) {
    let (mut batch, mut filter, mut covered) = (Vec::new(), Vec::new(), 0);
    let truth = parameters(model);
    for shape in [BuiltInShape::Bird, BuiltInShape::Van] {
        let smallest = bound(shape, model, 20, (1.0 - corruption.hidden) * (1.0 - corruption.outliers));
        for seed in 0..runs {
            let frames = record(shape, &constant_motion(model, 20), corruption, NOISE, seed);
            let found = estimate_batch(model, &frames).expect("a motion");
            assert!(found.converged && found.frames_used >= 19, "{found:?}");
            assert!((found.noise / NOISE - 1.0).abs() < 0.15, "{}", found.noise);
            let run = states(FilterSettings { model, ..FilterSettings::default() }, &frames);
            let last = run.last().expect("states").motion();
            for (j, parameter) in found.motion.parameters().enumerate() {
                let error = parameter.value.expect("observable") - truth[j];
                covered += usize::from(error.abs() < 1.96 * parameter.standard_deviation.expect("given"));
                batch.push(error / smallest[j]);
                filter.push((last.values()[j] - truth[j]) / smallest[j]);
            }
        }
    }
    (batch, filter, covered)
}

#[test]
fn all_frames_at_once_are_at_the_bound_as_the_filter_is_for_every_model_with_hidden_arcs() {
    let (mut batch, mut filter, mut covered) = (Vec::new(), Vec::new(), 0);
    for model in MotionModel::ALL {
        let (b, f, c) = batch_and_filter(model, Corruption { hidden: 0.2, outliers: 0.0 }, 3);
        batch.extend(b);
        filter.extend(f);
        covered += c;
    }
    let (batch_error, filter_error) = (root_mean_square(&batch), root_mean_square(&filter));
    assert!(batch_error < 1.3 && batch_error < 1.1 * filter_error, "batch {batch_error}, filter {filter_error}");
    assert!(is_near_95_percent(covered, batch.len(), 3), "{covered} of {}", batch.len());
}

#[test]
fn outliers_leave_the_motion_of_all_frames_within_one_and_a_half_times_the_bound() {
    for model in [MotionModel::Rigid, MotionModel::Affine] {
        let (batch, ..) = batch_and_filter(model, Corruption { hidden: 0.2, outliers: 0.05 }, 3);
        assert!(root_mean_square(&batch) < 1.5, "{model}: {}", root_mean_square(&batch));
    }
}

#[test]
#[ignore = "minutes: cargo test --workspace --test suite many_recordings -- --ignored --nocapture"]
fn many_recordings_leave_batch_and_filter_within_1_3_of_the_bound_in_every_setting() {
    use MotionModel::{Affine, Projective, Rigid, Similarity};
    println!("| setting | batch estimator | motion filter | intervals of the batch hold |\n|---|---|---|---|");
    for (model, outliers) in
        [(Rigid, 0.0), (Similarity, 0.0), (Affine, 0.0), (Projective, 0.0), (Rigid, 0.05), (Affine, 0.05)]
    {
        let (batch, filter, covered) = batch_and_filter(model, Corruption { hidden: 0.2, outliers }, 16);
        let (batch_error, filter_error) = (root_mean_square(&batch), root_mean_square(&filter));
        let with = if outliers > 0.0 { " and 5 % outliers" } else { "" };
        let count = batch.len();
        println!("| {model}, a fifth hidden{with} | {batch_error:.2} | {filter_error:.2} | {covered} of {count} |");
        assert!(batch_error < 1.3 && filter_error < 1.3, "{model}: batch {batch_error}, filter {filter_error}");
        assert!(is_near_95_percent(covered, count, 3), "{model}: {covered} of {count}");
    }
}

#[test]
fn all_frames_at_once_find_the_same_motion_wherever_the_scene_is() {
    let frames = record(BuiltInShape::Bird, &constant_motion(MotionModel::Rigid, 10), Corruption::default(), NOISE, 1);
    let matrix = Matrix3::new(0.0, -50.0, 300.0, 50.0, 0.0, -200.0, 0.0, 0.0, 1.0);
    let change = Affine2::from_matrix_unchecked(matrix);
    let moved: Vec<_> = frames.iter().map(|(t, outline)| (*t, outline.moved(&change).expect("regular"))).collect();
    let plain = estimate_batch(MotionModel::Rigid, &frames).expect("a motion");
    let turned = estimate_batch(MotionModel::Rigid, &moved).expect("a motion");
    let expected = matrix * plain.motion.generator() * change.inverse().matrix();
    let difference = turned.motion.generator() - expected;
    // Cells are sought by place, so that a point may come to another one.
    assert!(difference[(0, 1)].abs() < 2e-3 && difference[(0, 2)].abs() < 0.6, "{difference}");
    assert!((turned.noise / plain.noise - 50.0).abs() < 1.0);
}

#[test]
fn recordings_that_show_no_motion_are_refused_with_the_reason() {
    let frames = record(BuiltInShape::Bird, &constant_motion(MotionModel::Rigid, 3), Corruption::default(), NOISE, 1);
    let none = estimate_batch(MotionModel::Rigid, &[]);
    assert_eq!(none.err(), Some(BatchError::NoStart { frames: 0 }));
    assert_eq!(estimate_batch(MotionModel::Rigid, &frames[..1]).err(), Some(BatchError::NoStart { frames: 1 }));
    let twice = [frames[0].clone(), frames[0].clone()];
    let refused = estimate_batch(MotionModel::Rigid, &twice).err();
    assert!(matches!(refused, Some(BatchError::Frame { index: 1, error: FilterError::TimeNotIncreasing(_) })));
    let triangle = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(x, y)| Point2::new(x, y));
    let few = [(0.0, Outline::closed(triangle.to_vec()).expect("a triangle"))];
    let refused = estimate_batch(MotionModel::Rigid, &few).err();
    assert!(matches!(refused, Some(BatchError::Frame { index: 0, error: FilterError::TooFewPoints { found: 3, .. } })));
}

#[test]
fn rejected_frames_at_the_end_of_a_recording_change_nothing_in_the_batch() {
    let mut frames =
        record(BuiltInShape::Van, &constant_motion(MotionModel::Rigid, 20), Corruption::default(), NOISE, 3);
    let alone = estimate_batch(MotionModel::Rigid, &frames).expect("an estimate");
    for step in 1..3 {
        let (time, outline) = &frames[frames.len() - 1];
        // Of half the size: nothing of the object, wherever it may be.
        let away = outline.points().map(|p| Point2::new(0.5 * p.x + f64::from(step), 0.5 * p.y)).collect();
        frames.push((time + SECONDS_PER_FRAME, Outline::closed(away).expect("an outline")));
    }
    let with_others = estimate_batch(MotionModel::Rigid, &frames).expect("an estimate");
    assert_eq!((with_others.frames_used, with_others.motion.values()), (alone.frames_used, alone.motion.values()));
}
