//! The motion filter against simulated outlines: at the bound, and with what a camera does to them.
use crate::filter_support::{filter, filtered, frames_of, settings};
use freeform_curve_fit::Outline;
use freeform_estimate::{BoundaryPoint, CramerRaoBound};
use freeform_outline_filter::{MotionFilter, Phase, Rejection};
use freeform_riccati::{AffineMotion, MotionModel, RigidMotion};
use freeform_sim_camera::{BuiltInShape, Camera, Occlusion, Sampling, Scene, Settings, Shape, Simulator};
use nalgebra::{Affine2, Matrix2, Point2, Rotation2, Vector2};

const RIGID: RigidMotion = RigidMotion { omega: std::f64::consts::FRAC_PI_2, b1: -0.3, b2: 0.4 };
const AFFINE: AffineMotion = AffineMotion { a1: 0.05, a2: 1.2, a3: -1.7, a4: -0.08, b1: -0.3, b2: 0.4 };

fn values(model: MotionModel, motion: AffineMotion) -> Vec<f64> {
    let AffineMotion { a1, a2, a3, a4, b1, b2 } = motion;
    if model == MotionModel::Rigid { vec![a2, b1, b2] } else { vec![a1, a2, a3, a4, b1, b2] }
}

/// Bound of the built-in settings, where `share` of the 400 points inform.
fn bound(shape: BuiltInShape, model: MotionModel, motion: AffineMotion, frames: usize, share: f64) -> Vec<f64> {
    let shape = Shape::from(shape);
    let mut bound = CramerRaoBound::new(model, &values(model, motion)).expect("a motion");
    for frame in 0..frames {
        let time = frame as f64 / 30.0;
        let pose = motion.flow(time);
        let cofactor = pose.matrix().fixed_view::<2, 2>(0, 0).try_inverse().expect("regular").transpose();
        let points = (0..400).map(|i| {
            let s = f64::from(i) / 400.0;
            let normal = (cofactor * shape.normal_at(s).into_inner()).normalize();
            BoundaryPoint { point: pose * shape.point_at(s), normal }
        });
        bound.add_frame(time, points, 0.005, share).expect("finite");
    }
    let covariance = bound.covariance().expect("finite");
    covariance.standard_deviations().map(|std| std.expect("observable")).collect()
}

/// Error over bound of every parameter, and error over the filter's own standard deviation.
fn ratios(filter: &MotionFilter, truth: &[f64], bound: &[f64]) -> Vec<(f64, f64)> {
    let estimate = filter.estimate().expect("an estimate");
    let list = estimate.parameters().zip(truth.iter().zip(bound)).map(|(parameter, (truth, bound))| {
        let error = parameter.value.expect("observable") - truth;
        (error / bound, error / parameter.standard_deviation.expect("given"))
    });
    list.collect()
}

fn root_mean_square(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = values.clone().count() as f64;
    (values.map(|v| v * v).sum::<f64>() / count).sqrt()
}

/// Pools a few runs and compares them with the bound and with the intervals given.
fn assert_at_bound(
    model: MotionModel,
    motion: AffineMotion,
    change: impl Fn(&mut Settings),
    frames: usize,
    limit: f64,
) {
    let mut all = Vec::new();
    for seed in 0..6 {
        let mut settings = settings(frames, 100 + seed);
        change(&mut settings);
        let share = (1.0 - settings.occlusion.fraction) * (1.0 - settings.outliers) * (1.0 - settings.wrong_frames);
        let run = filtered(model, &frames_of(BuiltInShape::Bird, motion, settings));
        assert_eq!(run.restarts(), 0);
        let bound = bound(BuiltInShape::Bird, model, motion, frames, share);
        all.extend(ratios(&run, &values(model, motion), &bound));
    }
    let to_bound = root_mean_square(all.iter().map(|r| r.0));
    let to_own = root_mean_square(all.iter().map(|r| r.1));
    assert!(to_bound < limit, "{to_bound} times the bound");
    // 18 or more numbers of standard deviation 1. After eight frames what cameras have now and then is not ruled out yet.
    assert!((0.4..1.6).contains(&to_own), "intervals hold {to_own} times what they promise");
}

#[test]
fn a_rigid_motion_is_found_at_the_bound_from_the_third_frame_on() {
    for frames in [3, 8, 60] {
        assert_at_bound(MotionModel::Rigid, RIGID.into(), |_| (), frames, 1.5);
    }
}

#[test]
fn an_affine_motion_is_found_at_the_bound() {
    assert_at_bound(MotionModel::Affine, AFFINE, |_| (), 60, 1.5);
}

#[test]
fn slender_outlines_under_affine_motion_are_followed_and_found() {
    for shape in [BuiltInShape::Bird, BuiltInShape::Van, BuiltInShape::Shoe] {
        for along in [0.3, 1.2] {
            let across = Rotation2::new(along) * Matrix2::new(1.0, 0.0, 0.0, 0.13) * Rotation2::new(-along);
            let scene = Scene::new(shape, AFFINE, Camera::default())
                .with_initial_pose(Affine2::from_matrix_unchecked(across.to_homogeneous()));
            let settings = Settings { noise: 0.002, ..settings(60, 1) };
            let frames: Vec<_> = Simulator::new(scene, settings).expect("good settings").frames().collect();
            let run = filtered(MotionModel::Affine, &frames);
            assert_eq!((run.frames_rejected(), run.restarts()), (0, 0), "{shape:?} {along}");
            let found = run.estimate().expect("an estimate");
            for (parameter, truth) in found.parameters().zip(values(MotionModel::Affine, AFFINE)) {
                let (value, std) = parameter.value.zip(parameter.standard_deviation).expect("observable");
                assert!((value - truth).abs() < 5.0 * std && std < 0.02, "{shape:?} {along}: {value} {std} {truth}");
            }
        }
    }
}

#[test]
fn an_arc_missing_in_every_frame_the_first_included_leaves_the_filter_at_the_bound() {
    let hide = |settings: &mut Settings| settings.occlusion = Occlusion { fraction: 0.2, ..Occlusion::default() };
    assert_at_bound(MotionModel::Rigid, RIGID.into(), hide, 40, 1.5);
}

#[test]
fn outliers_in_every_frame_the_first_included_leave_the_filter_at_the_bound() {
    assert_at_bound(MotionModel::Rigid, RIGID.into(), |settings| settings.outliers = 0.05, 40, 1.5);
}

#[test]
fn a_map_begun_from_a_part_grows_to_the_whole_outline() {
    let mut settings = settings(40, 7);
    settings.occlusion = Occlusion { fraction: 0.3, ..Occlusion::default() };
    let frames = frames_of(BuiltInShape::Bird, RIGID, settings);
    let first = filtered(MotionModel::Rigid, &frames[..1]);
    let last = filtered(MotionModel::Rigid, &frames);
    let cells = |filter: &MotionFilter| filter.outline_points().count() as f64;
    let growth = cells(&last) / cells(&first);
    assert!((1.3..1.6).contains(&growth), "0.7 of the outline grew by {growth}");
    let (shape, pose) = (Shape::from(BuiltInShape::Bird), RIGID.flow(frames[39].time));
    let truth: Vec<_> = (0..2000).map(|i| pose * shape.point_at(f64::from(i) / 2000.0)).collect();
    let known: Vec<_> = last.outline_points().collect();
    let near =
        |p: &Point2<f64>, list: &[Point2<f64>]| list.iter().map(|q| (p - q).norm()).fold(f64::INFINITY, f64::min);
    assert!(known.iter().filter(|p| near(p, &truth) < 0.01).count() as f64 > 0.97 * known.len() as f64);
    assert!(truth.iter().filter(|p| near(p, &known) < 0.02).count() as f64 > 0.97 * truth.len() as f64);
}

#[test]
fn frames_that_show_another_object_are_rejected_and_counted_and_none_of_the_others() {
    let mut settings = settings(90, 3);
    settings.wrong_frames = 0.1;
    let frames = frames_of(BuiltInShape::Bird, RIGID, settings);
    assert!(frames[..3].iter().all(|frame| frame.corruption.wrong_shape.is_none()), "choose another seed");
    let wrong = frames.iter().filter(|frame| frame.corruption.wrong_shape.is_some()).count();
    assert!(wrong > 3);
    let mut filter = filter(MotionModel::Rigid);
    for frame in &frames {
        let step = filter.step(frame.time, &frame.outline).expect("increasing times");
        assert_eq!(step.is_accepted(), frame.corruption.wrong_shape.is_none(), "frame {}", frame.index);
        match step.rejection {
            Some(Rejection::AgreementTooSmall { agreement, smallest }) => {
                assert!(agreement < smallest && smallest == 0.7);
            }
            other => assert_eq!((other, step.is_accepted()), (None, true), "frame {}", frame.index),
        }
    }
    assert_eq!((filter.frames_rejected(), filter.frames_accepted()), (wrong, frames.len() - wrong));
}

/// Rejection of a last frame that is changed.
fn rejection_of_last(change: impl Fn(Point2<f64>, usize) -> Point2<f64>) -> Option<Rejection> {
    let frames = frames_of(BuiltInShape::Bird, RIGID, settings(30, 8));
    let mut filter = filtered(MotionModel::Rigid, &frames[..29]);
    let changed = frames[29].outline.points().enumerate().map(|(index, p)| change(*p, index)).collect();
    let outline = Outline::closed(changed).expect("an outline");
    filter.step(frames[29].time, &outline).expect("increasing times").rejection
}

#[test]
fn a_frame_that_jumps_and_one_whose_points_scatter_are_rejected_for_that() {
    assert_eq!(rejection_of_last(|p, _| p), None);
    let jumped = rejection_of_last(|p, _| p + Vector2::new(0.02, 0.02)).expect("rejected");
    let Rejection::InnovationTooLarge { innovation, largest } = jumped else { panic!("{jumped}") };
    assert!(
        innovation > largest && jumped.to_string().starts_with("jumps away from where it was expected"),
        "{jumped}"
    );
    let scattered = rejection_of_last(|p, index| p * if index % 2 == 0 { 1.05 } else { 0.95 }).expect("rejected");
    let Rejection::NoiseTooLarge { noise } = scattered else { panic!("{scattered}") };
    assert!(noise > 0.01 && scattered.to_string().contains("scatter by 0.0"), "{scattered}");
}

#[test]
fn the_velocity_of_the_centroid_is_known_with_a_standard_deviation_that_holds() {
    let motion = RigidMotion { omega: 2.0, b1: -5.0, b2: 4.0 };
    let truth = motion.generator();
    let (mut squares, runs) = (0.0, 30);
    for seed in 0..runs {
        let run = filtered(MotionModel::Rigid, &frames_of(BuiltInShape::Bird, motion, settings(8, seed)));
        let found = run.velocity().expect("known");
        let error = found.velocity - (truth * found.point.to_homogeneous()).xy();
        squares += error.dot(&(found.covariance.try_inverse().expect("regular") * error)) / 2.0;
        let last = run.outline_points().map(|p| p.coords).collect::<Vec<_>>();
        let middle = Point2::from(last.iter().sum::<Vector2<f64>>() / last.len() as f64);
        assert!((middle - found.point).norm() < 0.02, "{middle} {}", found.point);
    }
    let mean = squares / runs as f64;
    // After eight frames the motion might have changed steadily, and what cameras have now and then is not ruled out: deviations allow for both.
    assert!((0.25..1.6).contains(&mean), "{mean}");
}

#[test]
fn a_first_frame_of_another_object_is_forgotten() {
    let mut frames = frames_of(BuiltInShape::Bird, RIGID, settings(40, 5));
    let other = frames_of(BuiltInShape::Van, RIGID, settings(1, 5));
    frames[0].outline = other[0].outline.clone();
    let run = filtered(MotionModel::Rigid, &frames);
    assert_eq!(run.restarts(), 1);
    let bound = bound(BuiltInShape::Bird, MotionModel::Rigid, RIGID.into(), 36, 1.0);
    assert!(ratios(&run, &values(MotionModel::Rigid, RIGID.into()), &bound).iter().all(|r| r.0.abs() < 5.0));
}

#[test]
fn a_map_of_few_frames_that_more_speak_against_than_for_is_begun_anew() {
    let mut frames = frames_of(BuiltInShape::Bird, RIGID, settings(30, 5));
    let others = frames_of(BuiltInShape::Van, RIGID, settings(3, 5));
    for (frame, other) in frames.iter_mut().zip(&others) {
        frame.outline = other.outline.clone();
    }
    let run = filtered(MotionModel::Rigid, &frames);
    // Three frames of the van, four of the bird against it, the last of which begins the new map.
    assert_eq!((run.restarts(), run.frames_rejected()), (1, 4));
    assert_eq!(run.frames_accepted() + run.frames_rejected(), frames.len());
    let bound = bound(BuiltInShape::Bird, MotionModel::Rigid, RIGID.into(), 24, 1.0);
    assert!(ratios(&run, &values(MotionModel::Rigid, RIGID.into()), &bound).iter().all(|r| r.0.abs() < 5.0));
}

#[test]
fn gaps_and_uneven_times_change_nothing() {
    let all = frames_of(BuiltInShape::Bird, RIGID, settings(90, 11));
    let kept: Vec<_> =
        all.into_iter().filter(|frame| frame.index % 7 != 3 && !(30..50).contains(&frame.index)).collect();
    let run = filtered(MotionModel::Rigid, &kept);
    assert_eq!((run.frames_rejected(), run.phase()), (0, Phase::Tracking));
    let bound = bound(BuiltInShape::Bird, MotionModel::Rigid, RIGID.into(), 90, 0.6);
    assert!(ratios(&run, &values(MotionModel::Rigid, RIGID.into()), &bound).iter().all(|r| r.0.abs() < 4.0));
}

#[test]
fn large_turns_and_shifts_between_the_first_frames_are_found() {
    for (seed, (turn, x, y)) in [(50.0, 0.3, 0.2), (-55.0, -0.4, 0.1), (30.0, 0.0, -0.5)].into_iter().enumerate() {
        let motion = RigidMotion { omega: 5.0 * f64::to_radians(turn), b1: 5.0 * x, b2: 5.0 * y };
        for shape in [BuiltInShape::Bird, BuiltInShape::Phone, BuiltInShape::Shoe] {
            let settings = Settings { fps: 5.0, ..settings(4, seed as u64) };
            let run = filtered(MotionModel::Rigid, &frames_of(shape, motion, settings));
            assert_eq!(run.frames_rejected(), 0, "{shape}");
            let estimate = run.estimate().expect("an estimate");
            let omega = estimate.values()[0];
            assert!((omega - motion.omega).abs() < 0.1, "{shape}: {omega} for {}", motion.omega);
        }
    }
}

#[test]
fn exact_points_give_the_motion_to_the_precision_of_the_cells() {
    for sampling in [Sampling::Regular { jitter: 0.0 }, Sampling::Independent] {
        let exact = Settings { noise: 0.0, sampling, ..settings(20, 0) };
        let run = filtered(MotionModel::Rigid, &frames_of(BuiltInShape::Bird, RIGID, exact));
        assert_eq!(run.frames_rejected(), 0, "{sampling:?}");
        for (value, truth) in
            run.estimate().expect("an estimate").values().iter().zip(values(MotionModel::Rigid, RIGID.into()))
        {
            assert!((value - truth).abs() < 1e-3, "{value} for {truth}");
        }
    }
}

#[test]
fn an_object_that_shrinks_or_grows_a_lot_keeps_the_intervals_honest() {
    for growth in [-0.5, 0.5] {
        let motion = AffineMotion { a1: growth, a2: 1.2, a3: -1.2, a4: growth, b1: -0.3, b2: 0.4 };
        let mut squares = Vec::new();
        for seed in 0..4 {
            let frames = frames_of(BuiltInShape::Phone, motion, settings(100, seed));
            let estimate = filtered(MotionModel::Similarity, &frames).estimate().expect("an estimate");
            for (parameter, truth) in estimate.parameters().zip([growth, 1.2, -0.3, 0.4]) {
                let error = parameter.value.expect("observable") - truth;
                squares.push(error / parameter.standard_deviation.expect("given"));
            }
        }
        let size = root_mean_square(squares.iter().copied());
        assert!(size < 1.7, "growth {growth}: {size} standard deviations");
    }
}

#[test]
fn an_outline_that_few_points_show_is_cut_anew_from_the_first_frames() {
    let frames = frames_of(BuiltInShape::Van, RIGID, Settings { points: 60, ..settings(20, 3) });
    let coarse = filtered(MotionModel::Rigid, &frames[..3]);
    let fine = filtered(MotionModel::Rigid, &frames);
    let cells = |filter: &MotionFilter| filter.outline_points().count();
    assert!(cells(&coarse) < 70 && cells(&fine) > 120, "{} {}", cells(&coarse), cells(&fine));
    assert_eq!(fine.frames_rejected(), 0);
}

#[test]
fn forty_points_a_frame_tell_the_motion_whatever_the_first_frames_left_open() {
    let mut wide = 0;
    for shape in [BuiltInShape::Bird, BuiltInShape::Van] {
        for seed in 0..20 {
            let frames = frames_of(shape, RIGID, Settings { points: 40, noise: 0.005, ..settings(60, seed) });
            let run = filtered(MotionModel::Rigid, &frames);
            let estimate = run.estimate().expect("an estimate");
            let omega = estimate.parameters().next().expect("omega comes first");
            let (value, std) = (
                omega.value.unwrap_or_else(|| {
                    panic!(
                        "{shape:?}, seed {seed}: {:?} {:?} {}",
                        run.unstated(),
                        run.dynamics(),
                        run.frames_rejected()
                    )
                }),
                omega.standard_deviation.expect("known"),
            );
            let error = (value - RIGID.omega).abs();
            assert!(error < 5.0 * std && std < 0.02, "{shape:?}, seed {seed}: {value}, std {std}");
            wide += usize::from(std > 0.006);
        }
    }
    // Where noise looks like a motion that changes a little.
    assert!(wide < 4, "{wide}");
}

#[test]
fn real_masks_with_correlated_errors_are_followed_and_broken_ones_rejected() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/sequences/microrobot_h");
    let Ok(tracker) = std::fs::read_to_string(folder.join("authors_tracker.csv")) else {
        println!("skipped: no recorded sequence at {}", folder.display());
        return;
    };
    let angles: Vec<f64> =
        tracker.lines().skip(1).map(|l| l.rsplit(',').next().expect("a column").parse().expect("degrees")).collect();
    let (mut filter, mut seen) = (filter(MotionModel::Rigid), Vec::new());
    for (index, angle) in angles.iter().enumerate() {
        let picture = freeform_outline_io::read_picture(folder.join(format!("masks/{index:04}.png"))).expect("a mask");
        let traced = freeform_outline_io::trace_mask(&picture, &freeform_outline_io::TraceSettings::default());
        let step = filter.step(index as f64 / 15.07, &traced.expect("an object").outline).expect("increasing times");
        if step.is_accepted() {
            let pose = filter.pose().expect("a pose");
            let m = pose.matrix();
            seen.push(((m[(1, 0)] - m[(0, 1)]).atan2(m[(0, 0)] + m[(1, 1)]).to_degrees(), *angle));
        }
    }
    assert!((115..=132).contains(&seen.len()), "{} of {} frames", seen.len(), angles.len());
    let difference =
        |from: (f64, f64), to: (f64, f64)| ((to.0 - from.0 - to.1 + from.1) + 180.0).rem_euclid(360.0) - 180.0;
    let mut steps: Vec<f64> = seen.windows(2).map(|pair| difference(pair[0], pair[1]).abs()).collect();
    steps.sort_by(f64::total_cmp);
    assert!(steps[steps.len() / 2] < 2.0, "median {}", steps[steps.len() / 2]);
    let total = difference(seen[0], seen[seen.len() - 1]);
    assert!(total.abs() < 4.0, "total {total}");
}
