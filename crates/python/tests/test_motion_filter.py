"""One object frame by frame."""

import copy
import threading

import numpy as np
import pytest

import freeform_motion as ff


def followed(simulation, as_given=lambda outline: outline):
    motion_filter = ff.MotionFilter()
    for frame in simulation:
        motion_filter.step(frame.time, as_given(frame.outline))
    return motion_filter


def test_the_motion_is_found_within_its_deviations(bird):
    motion_filter = followed(bird)
    estimate = motion_filter.estimate
    assert estimate.names == ("omega", "b1", "b2")
    assert estimate.units == ("rad/s", "1/s", "1/s")
    truth = np.array([1.5, 0.2, -0.1])
    assert (np.abs(estimate.values - truth) < 4 * estimate.std).all()
    assert (estimate.std < 0.01).all() and (estimate.std > 0).all()
    assert estimate.observable.all() and list(estimate) == ["omega", "b1", "b2"]
    assert estimate["omega"].value == estimate.values[0] and estimate["omega"].std == estimate.std[0]
    np.testing.assert_allclose(np.sqrt(np.diag(estimate.covariance)), estimate.std, rtol=1e-12)
    np.testing.assert_allclose(estimate.generator, bird.generator, atol=0.01)


def test_pose_state_and_velocity_describe_one_motion(bird):
    motion_filter = followed(bird)
    state = motion_filter.state
    assert state.time == bird[-1].time and state.covariance.shape == (6, 6)
    assert state.pose_names == ("angle", "x", "y")
    np.testing.assert_allclose(state.pose_values[0], 1.5 * state.time, atol=0.01)
    np.testing.assert_allclose(state.pose, motion_filter.pose)
    first = np.array([0.3, 0.1])
    velocity = state.velocity_of(first)
    moved = state.pose @ [*first, 1.0]
    np.testing.assert_allclose(velocity.point, moved[:2])
    np.testing.assert_allclose(velocity.velocity, (state.estimate.generator @ moved)[:2])
    np.testing.assert_allclose(np.sqrt(np.diag(velocity.covariance)), velocity.std)
    later = state.predicted(state.time + 0.1)
    np.testing.assert_allclose(later.pose_values[0] - state.pose_values[0], 0.1 * state.estimate.values[0])
    assert motion_filter.velocity.velocity.shape == (2,)


@pytest.mark.parametrize(
    "as_given",
    [
        # C order, a list, Fortran order, strided, backwards in memory, closed by a repeated point.
        lambda outline: outline.points,
        lambda outline: outline.points.tolist(),
        lambda outline: np.asfortranarray(outline.points),
        lambda outline: np.repeat(outline.points, 2, axis=0)[::2],
        lambda outline: np.ascontiguousarray(outline.points[::-1])[::-1],
        lambda outline: np.vstack([outline.points, outline.points[:1]]),
    ],
)
def test_outlines_may_come_as_arrays_or_lists_of_points(bird, as_given):
    np.testing.assert_array_equal(followed(bird, as_given).estimate.values, followed(bird).estimate.values)


@pytest.mark.parametrize("dtype", ["int16", "int64", "uint8", "float32"])
def test_points_may_be_of_any_numeric_type(bird, dtype):
    motion_filter = ff.MotionFilter()
    for frame in bird:
        step = motion_filter.step(frame.time, (60 * frame.outline.points + 100).astype(dtype))
        assert step.is_accepted
    assert abs(motion_filter.estimate["omega"].value - 1.5) < 0.1


def test_a_frame_of_another_object_is_rejected_with_the_reason(bird):
    motion_filter = followed(bird)
    step = motion_filter.step(1.0, ff.simulate("square", seconds=0.1)[0].outline)
    assert not step and step.phase == "tracking" and step.agreement < 0.7
    assert "does not fit the object" in step.rejection
    assert motion_filter.frames_rejected == 1 and motion_filter.frames_accepted == 30


def test_a_circle_has_a_velocity_and_no_angular_velocity():
    motion_filter = followed(ff.simulate("circle", omega=1.0, b=(0.3, 0.0), seconds=1.0))
    omega = motion_filter.estimate["omega"]
    assert omega.value is None and omega.std is None and not motion_filter.estimate.observable[0]
    assert np.isnan(motion_filter.estimate.values[0]) and motion_filter.estimate.generator is None
    assert np.isfinite(motion_filter.velocity.velocity).all()


def test_the_deviation_is_made_of_a_random_and_a_systematic_part(bird):
    plain, wide = ff.MotionFilter(), ff.MotionFilter(edge_uncertainty=0.01)
    for frame in bird:
        plain.step(frame.time, frame.outline)
        wide.step(frame.time, frame.outline)
    estimate = wide.estimate
    np.testing.assert_array_equal(estimate.values, plain.estimate.values)
    assert (estimate.std_systematic > 0.005).all()
    # What cameras are usually off by is systematic too.
    assert (plain.estimate.std_systematic < 0.1 * estimate.std_systematic).all()
    np.testing.assert_allclose(estimate.std_random, plain.estimate.std_random)
    np.testing.assert_allclose(np.hypot(estimate.std_random, estimate.std_systematic), estimate.std)
    omega = estimate["omega"]
    assert (omega.std_random, omega.std_systematic) == (estimate.std_random[0], estimate.std_systematic[0])


def test_the_rounding_of_masks_to_pixels_is_part_of_the_deviations():
    masks = ff.simulate("bird", omega=0.02, b=(0.01, 0.0), seconds=1.0).masks(60, 80)
    estimate = ff.identify(masks, fps=30)["1"].estimate
    assert (estimate.std_systematic > 0).all()
    assert abs(estimate["omega"].value - 0.02) < 2 * estimate["omega"].std
    # Rounding that is not told of is found from the points.
    found = ff.identify(masks, fps=30, edge_uncertainty=0.0)["1"].estimate
    assert (found.std_systematic > 0.5 * estimate.std_systematic).all()
    # The pixels of another scale are of another size.
    scaled = ff.identify(masks, fps=30, pixel_size=0.1)["1"].estimate
    np.testing.assert_allclose(scaled.std_systematic, estimate.std_systematic * [1.0, 0.1, 0.1], rtol=1e-6)
    # Outlines of masks, one by one.
    motion_filter = ff.MotionFilter(mask_pixel=1.0)
    for frame, mask in enumerate(masks):
        motion_filter.step(frame / 30, ff.outlines(mask)[1])
    np.testing.assert_array_equal(motion_filter.estimate.std, estimate.std)


def test_a_symmetric_outline_has_other_angular_velocities():
    motion_filter = followed(ff.simulate("square", omega=1.0, seconds=1.0))
    omega = motion_filter.estimate["omega"].value
    turns = (motion_filter.aliases - omega) / 30 / (np.pi / 2)
    assert len(turns) > 0 and np.abs(turns - turns.round()).max() < 0.05 and (turns.round() != 0).all()
    assert followed(ff.simulate("bird", omega=1.0, seconds=1.0)).aliases.shape == (0,)


def thrown(seconds=2.0):
    """A van that spins while its middle goes along a parabola."""
    for frame in ff.simulate("van", omega=2.0, seconds=seconds):
        path = np.array([frame.time, 0.8 * frame.time**2])
        yield frame.time, frame.outline.points + path


def test_the_dynamics_that_held_are_told():
    motion_filter = ff.MotionFilter()
    assert motion_filter.dynamics is None
    for time, points in thrown():
        motion_filter.step(time, points)
    weights = motion_filter.dynamics
    assert list(weights) == ["generator", "velocity", "accelerating"]
    assert abs(sum(weights.values()) - 1.0) < 1e-9 and weights["accelerating"] > 0.9
    one = ff.MotionFilter(dynamics="velocity")
    for time, points in thrown(0.5):
        one.step(time, points)
    assert one.dynamics == {"generator": 0.0, "velocity": 1.0, "accelerating": 0.0}
    steady = ff.MotionFilter(process_noise=(0.1, 0.1))
    for time, points in thrown(0.5):
        steady.step(time, points)
    assert steady.dynamics is None


def test_what_the_model_leaves_out_is_told():
    frames = ff.simulate("bird", affine=[0.02, 1.0, -1.0, 0.02, 0, 0], seconds=4.0)
    rigid, similar = ff.MotionFilter(), ff.MotionFilter("similarity")
    for frame in frames:
        rigid.step(frame.time, frame.outline)
        similar.step(frame.time, frame.outline)
    assert rigid.wrong_family in ("growth", "shear", "perspective", "rolling_shutter", "lens", "shape")
    assert similar.wrong_family is None and (rigid.estimate.std_systematic > 0).all()
    assert followed(ff.simulate("bird", seconds=2.0)).wrong_family is None


def test_nothing_is_stated_of_an_object_that_is_lost(bird):
    motion_filter = followed(bird)
    assert motion_filter.unstated is None
    # A frame that repeats the one before it would be passed over.
    squares = ff.simulate("square", seconds=0.2)
    for number in range(3):
        motion_filter.step(1.1 + number / 30, squares[number].outline)
    assert motion_filter.phase == "lost" and motion_filter.unstated == "lost"
    assert np.isnan(motion_filter.estimate.values).all() and motion_filter.velocity is None


def test_a_projective_motion_is_found():
    truth = np.array([0.1, 0.8, -0.8, -0.1, 0.1, 0.05, 0.2, -0.1])
    motion_filter = ff.MotionFilter("projective")
    for frame in ff.simulate("bird", projective=truth, seconds=1.0, noise=0.002):
        motion_filter.step(frame.time, frame.outline)
    estimate = motion_filter.estimate
    assert estimate.names == ("a1", "a2", "a3", "a4", "b1", "b2", "c1", "c2")
    assert (np.abs(estimate.values - truth) < 4 * estimate.std).all(), (estimate.values, estimate.std)


def test_a_filter_without_frames_knows_nothing():
    motion_filter = ff.MotionFilter("affine")
    assert motion_filter.estimate is None and motion_filter.state is None and motion_filter.pose is None
    assert motion_filter.phase == "waiting" and motion_filter.motion == "affine"
    assert motion_filter.outline_points.shape == (0, 2)


@pytest.mark.parametrize(("motion", "count"), [("rigid", 3), ("similarity", 4), ("affine", 6), ("projective", 8)])
def test_every_motion_model_has_its_parameters(bird, motion, count):
    motion_filter = ff.MotionFilter(motion)
    for frame in bird[0], bird[1], bird[2]:
        motion_filter.step(frame.time, frame.outline)
    assert motion_filter.estimate.values.shape == motion_filter.estimate.std.shape == (count,)
    assert motion_filter.state.covariance.shape == (2 * count, 2 * count)


def test_a_copy_goes_its_own_way(bird):
    motion_filter = followed(bird)
    for other in copy.copy(motion_filter), copy.deepcopy(motion_filter):
        other.step(2.0, bird[0].outline)
        assert other.frames_accepted + other.frames_rejected == 31
    assert motion_filter.frames_accepted == 30


def test_work_that_is_done_between_frames_changes_no_result(bird):
    straight, prepared = ff.MotionFilter(), ff.MotionFilter()
    trackers = ff.Tracker(), ff.Tracker()
    waiting = 0
    for frame in bird:
        assert repr(prepared.step(frame.time, frame.outline)) == repr(straight.step(frame.time, frame.outline))
        observations = [tracker.push("bird", frame.index, frame.time, frame.outline) for tracker in trackers]
        while prepared.prepare():
            waiting += 1
        trackers[1].prepare()
        for one, other in (prepared, straight), observations:
            assert (one.state is None) == (other.state is None)
            if one.state is not None:
                assert one.state.covariance.tobytes() == other.state.covariance.tobytes()
                assert one.state.estimate.values.tobytes() == other.state.estimate.values.tobytes()
    # Of the map that is cut anew after the fourth frame, and the four frames measured on it.
    assert waiting > 3


def test_threads_may_share_a_filter_and_others_run_while_it_works(bird):
    motion_filter = ff.MotionFilter()
    lock, frames = threading.Lock(), iter(bird)

    def work() -> None:
        while True:
            with lock:
                frame = next(frames, None)
                if frame is None:
                    return
                motion_filter.step(frame.time, frame.outline)
            assert motion_filter.phase in ("waiting", "acquiring", "tracking")

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert motion_filter.frames_accepted == 30


def test_corners_in_whole_pixels_are_those_of_a_polygon():
    corners = 60.0 * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, -0.4], [-0.3, -0.4], [-0.3, 1.2], [-1.0, 1.2]])
    motion_filter = ff.MotionFilter()
    accepted = 0
    for frame in range(40):
        # Omega is clockwise.
        angle = -0.8 * frame / 30
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        accepted += motion_filter.step(frame / 30, np.round(corners @ turn.T + 150.0)).is_accepted
    omega = motion_filter.estimate["omega"]
    assert accepted >= 35 and abs(omega.value - 0.8) < 4 * omega.std and omega.std < 0.1
