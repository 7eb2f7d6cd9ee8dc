"""From labelled masks to motion."""

import numpy as np
import pytest

import freeform_motion as ff


def disc(height, width, row, column, radius, label=1):
    rows, columns = np.mgrid[:height, :width]
    return np.where(np.hypot(rows - row, columns - column) < radius, label, 0)


@pytest.mark.parametrize("dtype", [bool, np.uint8, np.uint16, np.int32, np.int64])
def test_the_motion_is_found_from_masks_of_any_type(masks, dtype):
    estimate = ff.identify(masks.astype(dtype), fps=30)["1"].estimate
    assert abs(estimate["omega"].value - 1.0) < 0.02
    assert estimate["omega"].std < 0.01


def test_omega_over_time_from_masks(masks):
    tracked = ff.track(masks, fps=30)
    assert len(tracked["time"]) == 30 and tracked["time"][-1] == 29 / 30
    assert np.isnan(tracked["omega"][0]) and np.abs(tracked["omega"][5:] - 1.0).max() < 0.05
    np.testing.assert_allclose(tracked["angle"][1:], tracked["time"][1:], atol=0.02)


def test_times_may_be_given_and_masks_may_come_one_by_one(masks):
    times = np.arange(30) / 30
    expected = ff.identify(masks, fps=30)[0].estimate.values
    np.testing.assert_array_equal(ff.identify((mask for mask in masks), times=times)[0].estimate.values, expected)
    np.testing.assert_array_equal(ff.identify(list(masks), fps=30, progress=False)[0].estimate.values, expected)


def test_outlines_have_the_place_and_area_of_their_labels():
    labels = disc(80, 120, 30, 40, 15, label=4) + disc(80, 120, 55, 90, 10, label=9)
    found = ff.outlines(labels)
    assert list(found) == [4, 9]
    np.testing.assert_allclose(found[4].centroid, [40.5, 80 - 30.5], atol=0.05)
    np.testing.assert_allclose(found[4].signed_area, (labels == 4).sum(), rtol=0.02)
    downwards = ff.outlines(labels, y_up=False, pixel_size=0.5)
    np.testing.assert_allclose(downwards[9].centroid, [0.5 * 90.5, 0.5 * 55.5], atol=0.05)


def test_specks_are_no_objects_and_holes_are_filled():
    labels = disc(60, 60, 30, 30, 15) - disc(60, 60, 30, 30, 4)
    labels[2:4, 2:4] = 7
    found = ff.outlines(labels)
    assert list(found) == [1] and found[1].signed_area > 650


def test_an_object_at_the_edge_is_closed_or_open():
    labels = disc(60, 60, 30, 0, 15)
    assert ff.outlines(labels)[1].is_closed
    assert not ff.outlines(labels, clipping="open")[1].is_closed


def test_labels_that_change_are_linked_by_place():
    frames = []
    for frame in range(12):
        a, b = (5, 8) if frame % 2 else (8, 5)
        frames.append(disc(80, 120, 20, 20 + 2 * frame, 9, a) + disc(80, 120, 60, 100 - 2 * frame, 12, b))
    linked = ff.identify(frames, fps=10, link="places")
    assert len(linked) == 2 and all(result.frames == 12 for result in linked)
    velocities = sorted(result.velocity.velocity[0] for result in linked)
    np.testing.assert_allclose(velocities, [-20, 20], atol=0.5)
    assert len(ff.identify(frames, fps=10, link="largest")) == 1


def test_frames_without_the_object_are_no_frames_of_it(masks):
    gaps = masks.copy()
    gaps[10:12] = 0
    result = ff.identify(gaps, fps=30)[0]
    assert result.frames == 28 and result.frames_rejected == 0


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda m: ff.identify(m), ValueError, "fps: a positive number"),
        (lambda m: ff.identify(m, fps=-1), ValueError, "fps: a positive number"),
        (lambda m: ff.identify(m, fps=30, times=[0]), ValueError, "not both"),
        (lambda m: ff.identify(m, times=[0, 1]), ValueError, "one number for each frame"),
        (lambda m: ff.identify(iter(m), times=[0, 1]), ValueError, "there is none for mask 2"),
        (lambda m: ff.identify(m, times=np.zeros(30)), ValueError, "0.0 of frame 1 does not follow 0.0 of frame 0"),
        (lambda m: ff.identify(m[0], fps=30), ValueError, r"shape \(frames, height, width\) is needed"),
        (lambda m: ff.identify(m * 0.5, fps=30), TypeError, "mask 0: labels are whole numbers"),
        (lambda m: ff.identify([m], fps=30), ValueError, r"mask 0: shape \(height, width\) is needed"),
        (lambda m: ff.identify("masks", fps=30), TypeError, "data, not a path, are needed: pandas.read_csv"),
        (lambda m: ff.identify(None, fps=30), TypeError, "this is NoneType"),
        (lambda m: ff.identify(m, fps=30, link="names"), ValueError, "is none of labels, places, nearest, largest"),
        (lambda m: ff.identify(m, fps=30, smoothing=-1.0), ValueError, "smoothing is -1"),
        (lambda m: ff.identify(m, fps=30, pixel_size=0.0), ValueError, "pixel_size is 0"),
        (lambda m: ff.outlines(m), ValueError, r"shape \(height, width\)"),
        (lambda m: ff.outlines(m[0], clipping="cut"), ValueError, "is none of close, open"),
        (lambda m: ff.outlines(np.empty((0, 5), int)), ValueError, "no pixels"),
        (lambda m: ff.outlines(m[0], minimum_area=-1), ValueError, "a whole number"),
    ],
)
def test_wrong_masks_and_options_are_refused(masks, call, error, message):
    with pytest.raises(error, match=message):
        call(masks)

@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda m: ff.identify(m, fps="30"), TypeError, "fps: a number of frames per second is needed, this is str"),
        (lambda m: ff.identify(m, fps=True), TypeError, "this is bool"),
        (lambda m: ff.identify(m, fps=np.array([30.0])), TypeError, "this is ndarray"),
        (lambda m: ff.identify(m, fps=np.nan), ValueError, "this is nan"),
        (lambda m: ff.identify(m, fps=1e-300), ValueError, "this is 1e-300"),
        (lambda m: ff.identify(m, times=np.arange(30).astype("datetime64[ns]")), TypeError, r"datetime64\[ns\]; in seconds"),
        (lambda m: ff.identify(m, times=["a"] * 30), TypeError, "times: real numbers are needed"),
        (lambda m: ff.identify(m, times=np.arange(30) * 1j), TypeError, "of type complex128"),
        (lambda m: ff.identify(m, times=[0.0, None] * 15), TypeError, "of type object"),
        (lambda m: ff.identify(m, times=np.ma.masked_equal(np.arange(30), 4)), ValueError, "that of frame 4 is not finite"),
        (lambda m: ff.identify([*m[:3], None], fps=30), TypeError, "mask 3: an array of shape .* is needed, this is NoneType"),
        (lambda m: ff.identify([m[0], m[1, :-1]], fps=30), ValueError, r"mask 1 is of shape \(\d+, \d+\), mask 0 of"),
        (lambda m: ff.identify([np.zeros((9, 2))], fps=30), ValueError, "frame 0, object 0: all 8 points are equal"),
        (lambda m: ff.identify(m, fps=30, columns={"x": "px"}), TypeError, "columns: only for tables"),
        (lambda m: ff.identify({"left": m}, fps=30), ValueError, r"the table has left; masks are an array"),
        (lambda m: ff.identify(np.zeros(3, [("frame", int)]), fps=30), TypeError, "a structured array"),
        (lambda m: ff.outlines(m[0].astype(np.int8) * np.int8(-128)), ValueError, "label -128: labels are numbers from 1"),
        (lambda m: ff.outlines(-m[0].astype(np.int8)), ValueError, "mask: label -1: labels are numbers from 1"),
        (lambda m: ff.outlines(m[0].astype(np.uint64) << np.uint64(63)), ValueError, "9223372036854775808 is beyond"),
        (lambda m: ff.recognise(m, 3), TypeError, "known: a Recogniser or a dict of outlines by name is needed, this is int"),
        (lambda m: ff.recognise(m, {}), ValueError, "no outline is known"),
    ],
)
def test_what_is_no_recording_of_masks_is_told_what_is_needed(masks, call, error, message):
    with pytest.raises(error, match=message):
        call(masks)


def test_minus_one_beside_labels_and_masked_pixels_are_ground(masks):
    expected = ff.outlines(masks[0])[1].points
    watershed = np.where(masks[0] > 0, masks[0].astype(np.int32), -1)
    np.testing.assert_array_equal(ff.outlines(watershed)[1].points, expected)
    hidden = np.ma.masked_array(np.ones_like(masks[0]), mask=masks[0] == 0)
    np.testing.assert_array_equal(ff.outlines(hidden)[1].points, expected)


def test_a_mask_of_two_values_the_wrong_way_round_is_warned_of_once(masks):
    with pytest.warns(UserWarning, match="frame 0, label 1 is along all of the edge, as the ground is") as told:
        ff.identify(masks == 0, fps=30)
    assert len(told) == 1 and told[0].filename == __file__
    with pytest.warns(UserWarning, match="label 20 is along all of the edge"):
        ff.outlines(masks[0] * 180 + 20)
    # An object that the edge cuts is no ground.
    assert ff.outlines(disc(60, 60, 30, 0, 29))[1].is_closed


def test_masks_without_an_object_are_warned_of():
    with pytest.warns(UserWarning, match=r"there is no object in any of 5 mask\(s\)"):
        found = ff.identify(np.zeros((5, 20, 20), int), fps=30)
    with pytest.raises(KeyError, match="there are no objects"):
        found["1"]


def test_two_bodies_under_one_label_are_warned_of_once(masks):
    two = np.concatenate([masks, masks], axis=2) > 0
    with pytest.warns(UserWarning, match="give each a label of its own") as told:
        ff.identify(two, fps=30)
    assert len(told) == 1 and "frame 0, label 1" in str(told[0].message) and told[0].filename == __file__
    with pytest.warns(UserWarning, match="label 1: the largest part"):
        ff.outlines(two[0])


def test_a_part_of_a_label_that_is_no_dirt_is_warned_of():
    part = disc(60, 90, 30, 25, 20) + disc(60, 90, 30, 70, 11)
    with pytest.warns(UserWarning, match="the largest part, of 1245 pixels, is taken, and one of 373 pixels is not"):
        ff.outlines(part)
    # Who asks for the largest is told where another may be it.
    assert len(ff.identify([part] * 3, fps=30, link="largest")) == 1
    assert ff.outlines(disc(60, 90, 30, 25, 20) + disc(60, 90, 30, 70, 9)).keys() == {1}


def test_grey_pictures_are_not_taken_for_labels(masks):
    grey = blurred(masks[0] * 255.0)
    with pytest.raises(ValueError, match="these are grey values and no labels"):
        ff.identify([grey.astype(np.uint8)] * 3, fps=30)
    assert ff.outlines(masks[0] * np.uint8(255)).keys() == {255}


def blurred(picture):
    """The mean of 5 by 5 pixels."""
    padded = np.pad(picture, 2)
    height, width = picture.shape
    return sum(padded[i : i + height, j : j + width] for i in range(5) for j in range(5)) / 25
