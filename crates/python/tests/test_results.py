"""What is told of an object: with covariances, by its name, and taken from one process to another."""

import operator
import pickle
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest

import freeform_motion as ff


def again(value):
    return pickle.loads(pickle.dumps(value))


def test_results_of_a_recording_come_back_from_another_process(table):
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        there = pool.submit(ff.identify, table).result()
    here = ff.identify(table)
    assert repr(there) == repr(here) and there.objects == here.objects
    for ours, expected in zip(there, here, strict=True):
        np.testing.assert_array_equal(ours.estimate.values, expected.estimate.values)
        np.testing.assert_array_equal(ours.estimate.covariance, expected.estimate.covariance)
        np.testing.assert_array_equal(ours.velocity.covariance, expected.velocity.covariance)
        assert [w.code for w in ours.warnings] == [w.code for w in expected.warnings]
        assert ours.dynamics == expected.dynamics


def test_states_parameters_and_warnings_can_be_pickled(bird):
    motion_filter = ff.MotionFilter(edge_uncertainty=0.01)
    for frame in bird:
        motion_filter.step(frame.time, frame.outline)
    state, omega = again(motion_filter.state), again(motion_filter.estimate["omega"])
    np.testing.assert_array_equal(state.covariance, motion_filter.state.covariance)
    np.testing.assert_array_equal(state.predicted(2.0).pose, motion_filter.state.predicted(2.0).pose)
    assert repr(omega) == repr(motion_filter.estimate["omega"]) and omega.std_systematic > 0
    square = ff.identify(ff.simulate("square", seconds=1.0))[0]
    assert square.warnings and [str(w) for w in again(square).warnings] == [str(w) for w in square.warnings]
    assert str(again(square.warnings[0])) == str(square.warnings[0])
    np.testing.assert_array_equal(again(square).aliases, square.aliases)


@pytest.mark.parametrize("kind", ["Estimate", "MotionState", "PointVelocity", "ObjectResult", "ResultWarning"])
@pytest.mark.parametrize("data", [b"", b"no result of anything", bytes(40)])
def test_bytes_that_are_no_result_are_refused(kind, data):
    with pytest.raises(ValueError):
        operator.attrgetter(f"{kind}._restored")(ff)(data)


@pytest.mark.parametrize("scale", [None, 0.1])
def test_estimates_of_trackers_have_the_covariance_that_their_deviations_come_from(bird, scale):
    tracker = ff.Tracker("affine", scale=scale)
    for frame in bird:
        observation = tracker.push("bird", frame.index, frame.time, frame.outline)
    for estimate in (tracker.results()[0].estimate, observation.estimate):
        np.testing.assert_allclose(np.sqrt(np.diag(estimate.covariance)), estimate.std, rtol=1e-9)
        assert (np.abs(np.linalg.eigvalsh(estimate.covariance)) > 0).all() and estimate.covariance.shape == (6, 6)
    motion_filter = ff.MotionFilter("affine")
    for frame in bird:
        motion_filter.step(frame.time, frame.outline)
    factors = np.array([1, 1, 1, 1, 1 / (scale or 1), 1 / (scale or 1)])
    expected = motion_filter.estimate.covariance * np.outer(factors, factors)
    np.testing.assert_allclose(tracker.results()[0].estimate.covariance, expected, rtol=1e-9)


def test_objects_are_named_by_labels_too(bird):
    tracker = ff.Tracker()
    for frame in bird:
        tracker.push(7, frame.index, frame.time, frame.outline)
    tracker.reject(7, 30, "frame 30: nothing there")
    assert tracker.objects == ["7"] and tracker.results()[0].frames == 31
    with pytest.raises(TypeError, match="object: a string or a whole number is needed, this is float"):
        tracker.push(7.0, 31, 2.0, bird[0].outline)


def test_a_label_that_is_no_position_is_answered_with_the_name(bird):
    results = ff.identify([{7: frame.outline} for frame in bird], fps=30)
    assert results["7"].frames == 30
    with pytest.raises(IndexError, match=r"position 7 of 1 object\(s\); names are strings: \['7'\]"):
        results[7]


def test_a_list_of_outlines_is_a_recording(bird):
    outlines = [frame.outline for frame in bird]
    expected = ff.identify(ff.outline_table(bird))[0].estimate
    for data, times in [(outlines, {"fps": 30}), (bird, {}), (list(bird), {}), (outlines, {"times": [f.time for f in bird]})]:
        np.testing.assert_array_equal(ff.identify(data, **times)[0].estimate.values, expected.values)
    two = ff.track([{"left": one, 3: other} for one, other in zip(outlines, reversed(outlines), strict=True)], fps=30)
    assert set(two["object"]) == {"left", "3"} and len(two["time"]) == 60
    known = {name: ff.simulate(name).true_outline() for name in ("bird", "phone", "hat")}
    assert ff.recognise(outlines, known)["0"].name == "bird"


def test_an_observation_has_the_velocity_of_the_middle_and_says_why_a_parameter_is_not_stated():
    tracker = ff.Tracker()
    for frame in ff.simulate("circle", b=(0.3, 0.0), seconds=1.0):
        last = tracker.push("a", frame.index, frame.time, frame.outline)
    result = ff.Identification(tracker.results())["a"]
    np.testing.assert_array_equal(last.velocity.velocity, result.velocity.velocity)
    assert (last.not_stated("omega"), last.not_stated("nothing of this name")) == ("unobservable", "unknown")


def test_a_result_says_why_a_value_is_not_stated_also_after_it_was_pickled():
    circle = ff.identify(ff.simulate("circle", b=(0.3, 0.0), seconds=1.0))[0]
    assert circle.estimate["omega"].value is None and circle.velocity is not None
    bird = ff.identify(ff.simulate("bird", seconds=1.0))[0]
    adaptive = ff.identify(ff.simulate("bird", seconds=1.0), method="adaptive")[0]
    for told in (circle, again(circle)):
        assert (told.not_stated("omega"), told.not_stated("nothing of this name")) == ("unobservable", "unknown")
        assert told.velocity_not_stated is None
    for told in (bird, again(bird)):
        assert [told.not_stated(name) for name in ("omega", "b1", "b2")] == [None] * 3
    assert again(adaptive).velocity_not_stated == "unknown"


def test_results_that_were_pickled_before_they_had_reasons_or_units_are_read(bird):
    result = ff.identify(bird)[0]
    restore, (data,) = result.__reduce__()
    # No parameter without a value, and a velocity: an empty list and none; then the unit of velocities.
    assert data[-3:] == b"\0\0\2"
    for end in (-1, -3):
        state, checksum = data[16:end], 0xCBF29CE484222325
        for byte in state:
            checksum = (checksum ^ byte) * 0x100000001B3 % 2**64
        before = restore(data[:8] + checksum.to_bytes(8, "little") + state)
        assert repr(before) == repr(result) and before.not_stated("omega") is None
        assert before.not_stated("nothing of this name") == "unknown" and before.estimate.units == result.estimate.units


def test_arrays_of_points_are_outlines_as_for_the_motion_filter(bird):
    outlines = [frame.outline for frame in bird]
    of_points = ff.identify([outline.points for outline in outlines], fps=30)
    np.testing.assert_array_equal(of_points[0].estimate.values, ff.identify(outlines, fps=30)[0].estimate.values)
    named = ff.identify([{"a": outline.points.astype(np.float32)} for outline in outlines], fps=30)
    np.testing.assert_allclose(named["a"].estimate.values, of_points[0].estimate.values, atol=1e-4)


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda o: ff.identify(o), ValueError, "a positive number of frames per second"),
        (lambda o: ff.identify(o, fps=30, smoothing=2.0), TypeError, "smoothing: only for masks, but the data are outlines"),
        (lambda o: ff.identify([{"a": 1}], fps=30), TypeError, "frame 0, object a: an Outline or an array of points"),
        (lambda o: ff.identify("rigid.csv"), TypeError, "read_csv\\('rigid.csv', comment='#'\\) reads a table"),
        (lambda o: ff.identify([o[0].points, np.full((5, 2), np.nan)], fps=30), ValueError, "frame 1, object 0: "),
        (lambda o: ff.identify(iter(o), fps=30), TypeError, "a recording of outlines is a list of them"),
        (lambda o: ff.identify(o[:3], times=[0.0, 0.1, 0.1]), ValueError, "0.1 of frame 2 does not follow 0.1 of frame 1"),
        (lambda o: ff.identify(o[:3], times=[0.0, np.nan, 0.1]), ValueError, "that of frame 1 is not finite"),
        (lambda o: ff.identify(o[:3], times=[0.0, 0.1]), ValueError, "one number for each frame"),
    ],
)
def test_lists_of_outlines_are_looked_at(bird, call, error, words):
    with pytest.raises(error, match=words):
        call([frame.outline for frame in bird])


def test_velocities_of_masks_are_in_pixels_and_those_of_other_data_in_lengths_that_have_no_name(table):
    masks = ff.simulate("glider", omega=1.0, seconds=0.5).masks()
    units = {
        "pixels": ff.identify(masks, fps=30),
        "pixel heights": ff.identify(masks, fps=30, pixel_aspect=1.1),
        "a length": ff.identify(masks, fps=30, pixel_size=0.25),
        "scaled": ff.identify(masks, fps=30, scale=0.1),
        "table": ff.identify(table),
    }
    found = {name: results[0].estimate.units[1:] for name, results in units.items()}
    expected = {"pixels": "px/s", "pixel heights": "pixel heights/s", "a length": "1/s", "scaled": "1/s", "table": "1/s"}
    assert found == {name: (unit, unit) for name, unit in expected.items()}
    estimate = units["pixels"][0].estimate
    assert estimate.units[0] == "rad/s" and estimate["b1"].unit == "px/s" and "px/s" in repr(estimate)
    assert again(estimate).units == estimate.units == again(units["pixels"][0]).estimate.units
    assert again(estimate["b1"]).unit == "px/s"
