"""Whatever is wrong is a ValueError or TypeError that says what, and nothing is changed by it."""

import numpy as np
import pytest

import freeform_motion as ff

SQUARE = [[0, 0], [1, 0], [1, 1], [0, 1]]


@pytest.mark.parametrize(
    ("points", "error", "message"),
    [
        ([], ValueError, r"shape \(n, 2\) is needed, this is \(0,\)"),
        ([[0, 0], [1, 1]], ValueError, "at least 3 are needed"),
        ([[0, 0], [1, 1], [2, 2]], ValueError, "lie on one line"),
        ([[1, 1]] * 9, ValueError, "all 8 points are equal"),
        ([[0, 0], [1, np.nan], [1, 1]], ValueError, "point 1 has a coordinate that is not finite"),
        ([[0, 0], [1, np.inf], [1, 1]], ValueError, "not finite"),
        ([[0, 0], [1, 1e200], [1, 1]], ValueError, "beyond 1e100"),
        (np.zeros((5, 3)), ValueError, r"shape \(n, 2\) is needed, this is \(5, 3\)"),
        (np.zeros((5, 2, 2)), ValueError, r"this is \(5, 2, 2\)"),
        (np.zeros(8), ValueError, r"this is \(8,\)"),
        (7, ValueError, r"this is \(\)"),
        ([[0, 0], [1, 0, 3], [1, 1]], ValueError, "inhomogeneous"),
        ("outline", TypeError, "real numbers are needed"),
        (None, TypeError, "of type object"),
        (np.array(SQUARE, dtype=complex), TypeError, "of type complex128"),
        (np.array(SQUARE, dtype=str), TypeError, "real numbers are needed"),
        (np.array(SQUARE, dtype=bool), TypeError, "of type bool"),
        (np.array(SQUARE, dtype="datetime64[s]"), TypeError, "real numbers are needed"),
        ({"x": [0, 1]}, TypeError, "of type object"),
    ],
)
def test_points_that_are_no_outline(points, error, message):
    for take in ff.Outline, lambda given: ff.MotionFilter().step(0.0, given), ff.fit:
        with pytest.raises(error, match=message):
            take(points)


@pytest.mark.parametrize("time", [np.nan, np.inf, -np.inf, 0.0, -1.0])
def test_times_that_do_not_increase_leave_the_filter_as_it_was(bird, time):
    motion_filter = ff.MotionFilter()
    motion_filter.step(0.0, bird[0].outline)
    with pytest.raises(ValueError, match="after one at 0 s"):
        motion_filter.step(time, bird[1].outline)
    assert motion_filter.frames_accepted == 1 and motion_filter.step(0.1, bird[3].outline)


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: ff.MotionFilter("rotating"), ValueError, "is none of rigid, similarity, affine, projective"),
        (lambda: ff.MotionFilter(3), TypeError, "str"),
        (lambda: ff.MotionFilter(patience=0), ValueError, "patience of 0 is not at least 1"),
        (lambda: ff.MotionFilter(patience=-1), ValueError, "a whole number from 0 is needed, this is -1"),
        (lambda: ff.MotionFilter(patience=2**80), ValueError, "a whole number"),
        (lambda: ff.MotionFilter(patience=1.5), TypeError, "integer"),
        (lambda: ff.MotionFilter(smallest_agreement=1.0), ValueError, "smallest agreement of 1 is not between 0 and 1"),
        (lambda: ff.MotionFilter(process_noise=(np.nan, 0)), ValueError, "process noise of rates"),
        (lambda: ff.MotionFilter(unknown=1), TypeError, "unknown"),
        (lambda: ff.Tracker(method="guess"), ValueError, "is none of filter, adaptive"),
        (lambda: ff.Tracker(scale=0.0), ValueError, "0"),
        (lambda: ff.MotionFilter(dynamics="chaotic"), ValueError, "is none of auto, generator, velocity, accelerating"),
        (lambda: ff.MotionFilter(edge_uncertainty=-1.0), ValueError, "edge uncertainty of -1 is not finite and not negative"),
        (lambda: ff.Tracker(mask_pixel=float("nan")), ValueError, "mask pixel of NaN is not finite and not negative"),
        (lambda: ff.Tracker(rectify=np.zeros((3, 3))), ValueError, "singular"),
        (lambda: ff.Tracker(rectify=np.eye(2)), ValueError, r"rectify: shape \(3, 3\) is needed"),
        (lambda: ff.homography(SQUARE, SQUARE[:3]), ValueError, "4 and 3 points"),
        (lambda: ff.homography(SQUARE[:3], SQUARE[:3]), ValueError, "at least 4 are needed"),
        (lambda: ff.homography([[0, 0], [1, 0], [2, 0], [0, 1]], SQUARE), ValueError, "no three may lie on one line"),
        (lambda: ff.Recogniser(unknown=1.0), ValueError, r"unknown is 1, not in \(0, 1\)"),
        (lambda: ff.Recogniser().recognise(ff.simulate("hat").true_outline()), ValueError, "no outline is known"),
        (lambda: ff.Recogniser().learn("arc", ff.Outline.from_arcs([SQUARE])), ValueError, "a part of the outline is hidden"),
        (lambda: ff.Evidence(3), TypeError, "Recogniser"),
        (lambda: ff.simulate(affine=[0] * 6, projective=[0] * 8), ValueError, "not both"),
        (lambda: ff.fit(SQUARE * 9, normalise="none"), ValueError, "is none of similarity, affine"),
        (lambda: ff.Tracker().push("a", -1, 0.0, SQUARE), ValueError, "a whole number from 0 is needed"),
        (lambda: ff.Tracker().push(1.5, 0, 0.0, SQUARE), TypeError, "a string or a whole number is needed, this is float"),
        (lambda: ff.Pipeline(law="best"), ValueError, "is none of structured, filtered, printed, drem"),
        (lambda: ff.fit(SQUARE * 9, degree=3), ValueError, "degree 3 is not one of 2, 4, 6, 8"),
        (lambda: ff.fit(SQUARE * 9, method="4l"), ValueError, "is none of bounded, gs3l, 3l"),
        (lambda: ff.fit(SQUARE * 9, offset=2.0), ValueError, "offset 2 is outside"),
        (lambda: ff.ImplicitPolynomial(2, [1, 2]), ValueError, "2 coefficients, degree 2 has 6"),
        (lambda: ff.ImplicitPolynomial(2, [np.nan] * 6), ValueError, "coefficient 0 is not finite"),
        (lambda: ff.Outline(SQUARE).moved(np.zeros((3, 3))), ValueError, "last row of 0, 0, 1"),
        (lambda: ff.Outline(SQUARE).moved(np.eye(2)), ValueError, r"shape \(3, 3\) is needed"),
        (lambda: ff.Outline(SQUARE).moved(np.diag([1.0, 0.0, 1.0])), ValueError, "one line"),
        (lambda: ff.Outline(SQUARE).normals(0.5), ValueError, "outside"),
        (lambda: ff.Outline.from_arcs([]), ValueError, "at least one arc"),
        (lambda: ff.Outline.from_arcs(3), TypeError, "iterable"),
        (lambda: ff.simulate("dragon"), ValueError, "no shape is called"),
        (lambda: ff.simulate("missing.csv"), ValueError, "missing.csv"),
        (lambda: ff.simulate(points=-1), ValueError, "a whole number"),
        (lambda: ff.simulate(points=2), ValueError, "at least 3"),
        (lambda: ff.simulate(points=10**12), ValueError, "1000000000000 points, more than 4194304"),
        (lambda: ff.simulate(seconds=0.1).true_outline(count=10**12), ValueError, "more than 4194304"),
        (lambda: ff.simulate(seconds=0.1).masks(2**31, 2**31), MemoryError, "no memory for 3 masks"),
        (lambda: ff.simulate(noise=-1.0), ValueError, "noise"),
        (lambda: ff.simulate(omega=np.inf), ValueError, "not finite"),
        (lambda: ff.simulate(seconds=1e9), ValueError, "frames"),
        (lambda: ff.simulate(seconds=0.1).masks(0, 5), ValueError, "0"),
        (lambda: ff.simulate(seconds=0.1).true_pose(-1.0), ValueError, "-1"),
        (lambda: ff.CramerRaoBound("rigid", [1.0]), ValueError, "1 motion parameters where the model has 3"),
        (lambda: ff.AdaptiveIdentifier().step(0.0, [[1, 2, 3]]), ValueError, r"shape \(m, 2\)"),
        (lambda: ff.AdaptiveIdentifier().step(0.0, [["a", "b"]]), TypeError, "complex numbers are needed"),
        (lambda: ff.AdaptiveIdentifier().step(0.0, np.empty((0, 2))), ValueError, "pair"),
    ],
)
def test_arguments_out_of_range_or_of_the_wrong_type(call, error, message):
    with pytest.raises(error, match=message):
        call()


def test_an_index_beyond_the_end_of_a_simulation_is_an_index_error(bird):
    assert bird[-1].index == len(bird) - 1
    for index in len(bird), -len(bird) - 1:
        with pytest.raises(IndexError, match="of 30"):
            bird[index]


def test_an_unknown_parameter_is_a_key_error(bird):
    motion_filter = ff.MotionFilter()
    for frame in bird[0], bird[1]:
        motion_filter.step(frame.time, frame.outline)
    with pytest.raises(KeyError, match="is none of omega, b1, b2"):
        motion_filter.estimate["sigma"]


def test_a_shape_in_a_picture_of_another_format_is_told_as_such(tmp_path):
    path = tmp_path / "shape.jpg"
    path.write_bytes(b"\xff\xd8\xff\xe0" + bytes(100))
    with pytest.raises(ValueError, match="shape.jpg: pictures of type image/jpeg are not supported"):
        ff.simulate(str(path))


def test_masked_points_are_refused_and_not_taken_as_they_are(bird):
    points = np.ma.masked_array(bird[0].outline.points, mask=False)
    assert len(ff.Outline(points)) == len(points)
    points[3] = np.ma.masked
    for take in ff.Outline, lambda given: ff.MotionFilter().step(0.0, given):
        with pytest.raises(ValueError, match="points: some are masked"):
            take(points)


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda b: ff.plot(3), TypeError, r"an Outline or a table of track\(\) is needed, this is int"),
        (lambda b: ff.plot({}), ValueError, "no column object, only none"),
        (lambda b: ff.plot(ff.track(b), parameters=["sigma"]), ValueError, "no column sigma, only object, frame, time"),
        (lambda b: ff.outline_table([("a", 0, 0.0, b[0].outline.points)]), TypeError, "object a: an Outline is needed, this is ndarray"),
    ],
)
def test_what_cannot_be_drawn_or_made_a_table_of(bird, call, error, message):
    with pytest.raises(error, match=message):
        call(bird)
