"""Filters and trackers saved in the middle of a recording go on as before, to the last bit."""

import copy
import pickle
import random
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest

import freeform_motion as ff


def told(motion_filter):
    state = motion_filter.state
    of = (motion_filter.dynamics, motion_filter.aliases.tolist(), motion_filter.wrong_family, motion_filter.unstated)
    return state and (state.covariance.tobytes(), state.pose.tobytes(), state.estimate.values.tobytes(), of)


@pytest.mark.parametrize("save", [lambda f: ff.MotionFilter.from_bytes(f.to_bytes()), lambda f: pickle.loads(pickle.dumps(f))])
def test_a_filter_goes_on_where_it_was(bird, save):
    straight, interrupted = ff.MotionFilter(), ff.MotionFilter()
    for frame in bird:
        interrupted = save(interrupted)
        assert repr(interrupted.step(frame.time, frame.outline)) == repr(straight.step(frame.time, frame.outline))
        assert told(interrupted) == told(straight)
    assert interrupted.to_bytes() == straight.to_bytes()


def test_a_tracker_goes_on_where_it_was(table):
    frames = np.unique(table["frame"])
    straight = ff.identify(table)
    tracker = ff.Tracker()
    for frame in frames:
        tracker = pickle.loads(pickle.dumps(tracker))
        rows = table["frame"] == frame
        for name in ("left", "right"):
            of = rows & (table["object"] == name)
            points = np.column_stack([table["x"][of], table["y"][of]])
            outline = ff.Outline(points) if name == "right" else ff.Outline.from_arcs([points])
            tracker.push(name, int(frame), table["time"][of][0], outline)
    for ours, expected in zip(tracker.results(), straight, strict=True):
        np.testing.assert_array_equal(ours.estimate.values, expected.estimate.values)
        np.testing.assert_array_equal(ours.estimate.std, expected.estimate.std)
        assert repr(ours.warnings) == repr(expected.warnings)


def test_what_was_told_of_rejected_frames_is_kept(bird):
    tracker = ff.Tracker(scale=0.5)
    for frame in bird:
        tracker.push("bird", frame.index, frame.time, frame.outline)
    tracker.push("bird", 30, 1.0, ff.simulate("square", seconds=0.1)[0].outline)
    tracker.reject("bird", 31, "frame 31: nothing there")
    tracker.push("bird", 32, 0.5, bird[0].outline)
    again = pickle.loads(pickle.dumps(tracker))
    assert [str(w) for w in again.results()[0].warnings] == [str(w) for w in tracker.results()[0].warnings]
    assert again.results()[0].first_rejection == tracker.results()[0].first_rejection
    assert again.scale == 0.5 and again.objects == ["bird"] and again.results()[0].frames_rejected == 3


def follow(motion_filter, frames):
    for time, points in frames:
        motion_filter.step(time, points)
    return motion_filter


def test_a_filter_can_go_on_in_another_process(bird):
    frames = [(frame.time, frame.outline.points) for frame in bird]
    here = follow(ff.MotionFilter(), frames)
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        there = pool.submit(follow, follow(ff.MotionFilter(), frames[:15]), frames[15:]).result()
    assert told(there) == told(here)


def test_bytes_that_are_no_state_are_refused(bird):
    motion_filter = ff.MotionFilter()
    for frame in bird:
        motion_filter.step(frame.time, frame.outline)
    data = motion_filter.to_bytes()
    assert 10_000 < len(data) < 100_000
    for bad, message in [
        (b"", r"0 byte\(s\) are no saved state"),
        (data[:1000], "damaged"),
        (data + b"x", "damaged"),
        (data[:5000] + b"\x00\x01\x02" + data[5003:], "damaged"),
        (bytes([data[0] + 1]) + data[1:], "has the format version 36, this library reads version 35"),
        (ff.Tracker().to_bytes(), "not the state of a filter"),
    ]:
        with pytest.raises(ValueError, match=message):
            ff.MotionFilter.from_bytes(bad)
    with pytest.raises(TypeError):
        ff.MotionFilter.from_bytes("text")
    with pytest.raises(ValueError, match="not the state of a tracker"):
        ff.Tracker.from_bytes(data)
    draw = random.Random(1)
    for _ in range(200):
        with pytest.raises(ValueError):
            ff.MotionFilter.from_bytes(draw.randbytes(draw.randrange(500)))


def test_a_tracker_of_the_adaptive_method_goes_on(bird):
    tracker = ff.Tracker(method="adaptive")
    for frame in bird:
        restored = pickle.loads(pickle.dumps(tracker))
        for one in (tracker, restored):
            one.push("bird", frame.index, frame.time, frame.outline)
        assert restored.to_bytes() == tracker.to_bytes()
    assert repr(restored.results()) == repr(tracker.results())


@pytest.mark.parametrize("motion", ["rigid", "affine", "projective"])
def test_a_pipeline_goes_on_where_it_was(bird, motion):
    straight, interrupted = ff.Pipeline(motion), ff.Pipeline(motion)
    for frame in bird:
        interrupted = pickle.loads(pickle.dumps(copy.deepcopy(interrupted)))
        for one in (straight, interrupted):
            one.push(frame.time, frame.outline)
    assert interrupted.to_bytes() == straight.to_bytes() and straight.estimate is not None
    with pytest.raises(ValueError, match="not the state of a pipeline|version"):
        ff.Pipeline.from_bytes(ff.MotionFilter().to_bytes())


def moving_lines(time):
    """Two lines of a body that turns, as rows (l, k)."""
    w = 0.4 * np.exp(1j * (np.array([0.4, -2.2]) + 3.0 * time))
    return np.column_stack([1j * (1 + w) / (1 - w), [0.1 - 0.2j, 0.1j]])


@pytest.mark.parametrize("law", ["structured", "filtered", "printed", "drem"])
@pytest.mark.parametrize("motion", ["rigid", "affine"])
def test_an_adaptive_identifier_goes_on_where_it_was(motion, law):
    straight, interrupted = (ff.AdaptiveIdentifier(motion, law=law) for _ in range(2))
    saves = [lambda i: ff.AdaptiveIdentifier.from_bytes(i.to_bytes()), lambda i: pickle.loads(pickle.dumps(i)), copy.copy, copy.deepcopy]
    for frame in range(40):
        interrupted = saves[frame % len(saves)](interrupted)
        for identifier in straight, interrupted:
            identifier.step(frame / 30, moving_lines(frame / 30))
        assert interrupted.to_bytes() == straight.to_bytes()
    assert interrupted.frames == 40 and interrupted.is_observable
    assert interrupted.estimate.values.tobytes() == straight.estimate.values.tobytes()


def test_bytes_that_are_no_identifier_are_refused(bird):
    identifier = ff.AdaptiveIdentifier()
    identifier.step(0.0, moving_lines(0.0))
    data = identifier.to_bytes()
    for bad, message in [
        (b"", r"0 byte\(s\) are no saved state"),
        (data[:200], "damaged"),
        (data + b"x", "damaged"),
        (bytes([data[0] + 1]) + data[1:], "has the format version 2, this library reads version 1"),
        (ff.MotionFilter().to_bytes(), "this library reads version 1"),
    ]:
        with pytest.raises(ValueError, match=message):
            ff.AdaptiveIdentifier.from_bytes(bad)
    with pytest.raises(TypeError):
        ff.AdaptiveIdentifier.from_bytes(None)
    with pytest.raises(ValueError):
        ff.MotionFilter.from_bytes(data)
