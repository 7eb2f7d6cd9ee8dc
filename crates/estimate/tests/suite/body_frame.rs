//! Where the body frame lies beside the outline is an error of poses, and of nothing else.
use freeform_estimate::{MotionState, NormalisedState, ProcessNoise};
use freeform_riccati::{MAX_PARAMETERS, MotionModel};
use nalgebra::{DMatrix, Point2};

/// A state of a body that turns, of which the body frame is known to a deviation of each parameter.
fn state(body_frame: f64) -> MotionState {
    let model = MotionModel::Rigid;
    let mut motion = [0.0; MAX_PARAMETERS];
    motion[..3].copy_from_slice(&[2.0, 0.3, -0.1]);
    let covariance = DMatrix::from_diagonal_element(6, 6, 1e-4);
    NormalisedState {
        model,
        time: 1.0,
        origin: Point2::new(3.0, 4.0),
        radius: 2.0,
        pose: model.flow(&motion[..3], 1.0).into_inner(),
        motion,
        covariance: covariance.clone(),
        body_frame: DMatrix::from_diagonal_element(3, 3, body_frame * body_frame),
        covariance_given_outline: covariance,
        observable: [true; MAX_PARAMETERS],
        hidden: [false; MAX_PARAMETERS],
        centroid: Point2::new(0.2, -0.1),
    }
    .into()
}

#[test]
fn where_the_body_frame_lies_is_an_error_of_poses_and_none_of_the_motion_or_of_the_velocity_of_the_middle() {
    let [known, unknown] = [0.0, 0.5].map(state);
    let angle = |state: &MotionState| state.pose_parameters()[0].standard_deviation;
    assert!((angle(&known) - 0.01).abs() < 1e-12 && (angle(&unknown) - 0.01_f64.hypot(0.5)).abs() < 1e-12);
    let added = unknown.covariance() - known.covariance();
    assert!(added[(0, 0)] > 0.2 && added.view((3, 0), (3, 6)).amax() < 1e-12, "{added}");
    assert_eq!(unknown.motion(), known.motion());
    assert_eq!(unknown.velocity_of_middle(), known.velocity_of_middle());
    // A point of the body is another one where its frame lies elsewhere.
    let point = Point2::new(5.0, 4.0);
    let [of_known, of_unknown] = [&known, &unknown].map(|state| state.velocity_of(&point).standard_deviations());
    assert!(of_unknown.min() > 3.0 * of_known.max(), "{of_unknown} {of_known}");
}

#[test]
fn where_the_body_frame_lies_goes_along_with_the_body() {
    // Half a turn later the error of the pose is the same turn, about a centre that has gone along.
    let [known, unknown] = [0.0, 0.5].map(|deviation| state(deviation).predicted(1.5, &ProcessNoise::default()));
    let added = |name: &str| {
        let variance = |state: &MotionState| {
            let pose = state.pose_parameters();
            pose.iter().find(|parameter| parameter.name == name).expect("a number of a pose").standard_deviation.powi(2)
        };
        variance(&unknown) - variance(&known)
    };
    let before = state(0.5).pose_parameters()[0].standard_deviation.powi(2) - 1e-4;
    assert!((added("angle") - before).abs() < 1e-9, "{} {before}", added("angle"));
    assert_eq!(unknown.velocity_of_middle(), known.velocity_of_middle());
}

#[test]
fn smoothed_poses_have_where_the_body_frame_lies_as_the_last_state_says_it() {
    let noises = [ProcessNoise::default(), ProcessNoise { rates: 0.1, velocities: 0.1 }];
    for noise in noises {
        // What is known of the outline by the first state is no error of its body frame yet.
        let (first, last) = (state(0.0), state(0.5).predicted(1.5, &noise));
        let smoothed = freeform_estimate::smooth(&[first.clone(), last], &noise).expect("increasing times");
        let angle = |state: &MotionState| state.pose_parameters()[0].standard_deviation;
        assert!(angle(&first) < 0.011 && (0.49..0.52).contains(&angle(&smoothed[0])), "{}", angle(&smoothed[0]));
        let [before, after] = [&first, &smoothed[0]].map(|state| state.velocity_of_middle().standard_deviations());
        assert!((after - before).amax() < before.max(), "{after} {before}");
    }
}
