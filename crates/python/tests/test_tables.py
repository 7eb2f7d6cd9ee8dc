"""Tables in and out: the same numbers to the last bit from every library."""

import numpy as np
import pandas
import polars
import pyarrow
import pytest

import freeform_motion as ff
from freeform_motion._tables import column_names, factorise


def pushed(table):
    """The results of the table pushed outline by outline."""
    tracker = ff.Tracker()
    keys = dict.fromkeys(zip(table["frame"].tolist(), table["object"].tolist(), strict=True))
    for frame, name in keys:
        rows = (table["frame"] == frame) & (table["object"] == name)
        points = np.column_stack([table["x"][rows], table["y"][rows]])
        arcs = table["arc"][rows]
        if arcs[0] < 0:
            outline = ff.Outline(points)
        else:
            outline = ff.Outline.from_arcs([points[arcs == arc] for arc in dict.fromkeys(arcs.tolist())])
        tracker.push(name, frame, table["time"][rows][0], outline)
    return ff.Identification(tracker.results())


LIBRARIES = {
    "dict": dict,
    "pandas": pandas.DataFrame,
    "pandas, names as categories": lambda table: pandas.DataFrame(table).astype({"object": "category"}),
    "pandas, own types": lambda table: pandas.DataFrame(table).convert_dtypes(),
    "polars": polars.DataFrame,
    "polars, names as categories": lambda table: polars.DataFrame(table).with_columns(
        polars.col("object").cast(polars.Categorical)
    ),
    "pyarrow": pyarrow.table,
    "pyarrow, names as a dictionary": lambda table: pyarrow.table(
        {**table, "object": pyarrow.array(table["object"]).dictionary_encode()}
    ),
    "pyarrow, in chunks": lambda table: pyarrow.concat_tables(
        [pyarrow.table(table).slice(0, 1000), pyarrow.table(table).slice(1000)]
    ),
    "names as objects": lambda table: {**table, "object": table["object"].astype(object)},
    "whole numbers as floats": lambda table: {**table, "frame": table["frame"].astype(float)},
}


@pytest.mark.parametrize("library", LIBRARIES)
def test_every_library_gives_the_results_of_outlines_pushed_one_by_one(table, library):
    expected = pushed(table)
    found = ff.identify(LIBRARIES[library](table))
    assert found.objects == expected.objects == ["left", "right"]
    for name in found.objects:
        np.testing.assert_array_equal(found[name].estimate.values, expected[name].estimate.values)
        np.testing.assert_array_equal(found[name].estimate.std, expected[name].estimate.std)
    assert abs(found["left"].estimate["omega"].value - 1.5) < 0.05
    assert abs(found["right"].estimate["omega"].value + 0.7) < 0.05


@pytest.mark.parametrize(
    ("of", "kind"), [(dict, dict), (pandas.DataFrame, pandas.DataFrame), (polars.DataFrame, polars.DataFrame), (pyarrow.table, pyarrow.Table)]
)
def test_track_returns_a_table_of_the_same_kind_with_a_row_per_object_and_frame(table, of, kind):
    tracked = ff.track(of(table))
    assert isinstance(tracked, kind)
    names = np.asarray(tracked["object"])
    assert len(names) == 30 and names[:2].tolist() == ["left", "right"]
    omega = np.asarray(tracked["omega"])
    assert np.isnan(omega[:2]).all() and np.isfinite(omega[4:]).all()
    last = ff.identify(table)["right"].estimate
    assert omega[-1] == last.values[0] and np.asarray(tracked["omega_std"])[-1] == last.std[0]
    assert np.asarray(tracked["phase"])[-1] == "tracking" and np.asarray(tracked["accepted"]).all()
    np.testing.assert_array_equal(np.asarray(tracked["time"])[::2], np.unique(table["time"]))
    assert (np.asarray(tracked["segment"]) == 0).all()


def test_an_object_given_up_and_begun_anew_has_another_segment(bird):
    outlines = [("a", frame.index, frame.time, frame.outline) for frame in bird]
    other = ff.simulate("square", omega=-1.0, seconds=2.0)
    outlines += [("a", 30 + frame.index, 1.0 + frame.time, frame.outline) for frame in other]
    segment = ff.track(ff.outline_table(outlines))["segment"]
    assert (segment[:31] == 0).all() and segment[-1] == 1 and (np.diff(segment) >= 0).all()


def test_smoothed_poses_are_known_better_than_filtered_ones(table):
    filtered, smoothed = (ff.track(table, smooth=smooth, adaptive=False) for smooth in (False, True))
    early = slice(4, 10)
    assert (smoothed["angle_std"][early] < filtered["angle_std"][early]).all()
    np.testing.assert_array_equal(smoothed["angle_std"][-2:], filtered["angle_std"][-2:])
    assert np.isfinite(smoothed["angle"][:2]).all()


def test_a_motion_that_changes_is_smoothed_as_well_as_a_constant_one(bird):
    outlines = []
    for frame in bird:
        outlines.append(("constant", frame.index, frame.time, frame.outline))
        turn = 0.8 * np.sin(6.0 * frame.time)
        rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        outlines.append(("swinging", frame.index, frame.time, ff.Outline(frame.outline.points @ rotation.T)))
    table = ff.outline_table(outlines)
    smoothed = ff.track(table, smooth=True)
    filtered = ff.track(table)
    for name in ["constant", "swinging"]:
        rows = smoothed["object"] == name
        before, after = filtered["omega"][rows], smoothed["omega"][rows]
        assert np.isfinite(after).sum() > 10
        assert not np.array_equal(before, after, equal_nan=True)


def test_the_adaptive_method_has_a_motion_and_no_pose(table):
    tracked = ff.track(table, method="adaptive")
    assert "angle" not in tracked and np.isfinite(tracked["omega"][-1]) and np.isnan(tracked["omega_std"]).all()


LATER_COLUMNS = ["v1", "v1_std", "v2", "v2_std", "reason", "unstated", "point_x", "point_y"]


def empty_values(tracked, row):
    """Names of the columns of values, those with a standard deviation, that are NaN in a row."""
    return [name for name in tracked if f"{name}_std" in tracked and np.isnan(tracked[name][row])]


def told(tracked, row):
    """Names of what is not stated in a row, each with its reason."""
    return dict(value.split(" ") for value in tracked["unstated"][row].split("; ") if value)


def test_the_velocity_of_the_middle_and_the_reasons_come_behind_all_other_columns(table, as_table):
    tracked = ff.track(as_table(table))
    assert column_names(tracked) == [
        *["object", "frame", "time", "phase", "accepted", "angle", "angle_std", "x", "x_std", "y", "y_std"],
        *["omega", "omega_std", "b1", "b1_std", "b2", "b2_std", "segment", *LATER_COLUMNS],
    ]
    expected = ff.identify(table)["right"].velocity
    found = [np.asarray(tracked[name])[-1] for name in LATER_COLUMNS[:4]]
    assert found == [expected.velocity[0], expected.std[0], expected.velocity[1], expected.std[1]]
    points = np.column_stack([np.asarray(tracked[name]) for name in ("point_x", "point_y")])
    assert points[-1].tolist() == list(expected.point)
    # Where the velocity is not stated there is no point.
    assert (np.isnan(points) == np.isnan(np.asarray(tracked["v1"]))[:, np.newaxis]).all() and np.isnan(points[0]).all()
    texts = {name: np.asarray(tracked[name]).tolist() for name in ("reason", "unstated")}
    assert texts["reason"] == [""] * 30 and texts["unstated"][-1] == ""
    assert texts["unstated"][0] == "; ".join(f"{name} unknown" for name in ("angle", "x", "y", "omega", "b1", "b2", "v1", "v2"))


@pytest.mark.parametrize("motion", ["rigid", "similarity", "affine", "projective"])
@pytest.mark.parametrize("smooth", [False, True])
@pytest.mark.parametrize("shape", ["bird", "circle", "square"])
def test_every_value_that_is_nan_has_a_reason_in_its_row(shape, motion, smooth):
    tracked = ff.track(
        ff.outline_table(ff.simulate(shape, b=(0.2, -0.1), omega=1.0, seconds=0.5)), motion=motion, smooth=smooth, adaptive=False
    )
    for row in range(len(tracked["frame"])):
        assert list(told(tracked, row)) == empty_values(tracked, row)
    reasons = {reason for row in range(len(tracked["frame"])) for reason in told(tracked, row).values()}
    assert reasons <= {"unknown", "unobservable", "ambiguous"}
    assert ("unobservable" in reasons) == (shape == "circle"), reasons


def test_the_reasons_of_the_table_are_those_of_the_observations():
    simulation = ff.simulate("circle", omega=1.0, b=(0.2, -0.1), seconds=0.5)
    tracker = ff.Tracker()
    observations = [tracker.push("0", frame.index, frame.time, frame.outline) for frame in simulation]
    tracked = ff.track(ff.outline_table(simulation))
    known = [row for row, observation in enumerate(observations) if observation.velocity is not None]
    assert known and len(known) < len(observations)
    for row, observation in enumerate(observations):
        reasons = told(tracked, row)
        for name in ("omega", "b1", "b2"):
            assert reasons.get(name) == observation.not_stated(name)
        assert reasons.get("v1") == reasons.get("v2") == observation.velocity_not_stated
    found = [[tracked[name][row] for name in ("v1", "v2")] for row in known]
    assert found == [observations[row].velocity.velocity.tolist() for row in known]


def test_turns_between_which_the_outlines_do_not_decide_are_ambiguous_in_the_table():
    # 43 degrees from frame to frame, which may as well be 47 the other way round.
    tracked = ff.track(ff.outline_table(ff.simulate("square", omega=1.5, seconds=1.0, fps=2.0)))
    reasons = told(tracked, -1)
    assert reasons == dict.fromkeys(["angle", "omega", "b1", "b2", "v1", "v2"], "ambiguous")
    assert list(reasons) == empty_values(tracked, -1)


def test_an_angle_that_may_be_whole_turns_off_is_nan_and_the_place_is_not():
    # 170 degrees from frame to frame, which may as well be 190 the other way round.
    tracked = ff.track(ff.outline_table(ff.simulate("bird", omega=29.7, seconds=1.0, fps=10.0)))
    assert told(tracked, -1)["angle"] == "ambiguous" and np.isnan(tracked["angle"]).all()
    assert np.isfinite(tracked["x"][1:]).all() and np.isfinite(tracked["y"][1:]).all()


def test_masks_have_the_same_columns_as_tables(masks, table):
    of_masks = ff.track(masks, fps=30)
    assert list(of_masks) == list(ff.track(table))
    assert np.isfinite(of_masks["v1"][-1]) and of_masks["unstated"][-1] == ""


def test_the_adaptive_method_has_reasons_and_no_velocity_of_the_middle(table):
    tracked = ff.track(table, method="adaptive")
    assert list(tracked)[-3:] == ["segment", "reason", "unstated"] and not {"v1", "point_x"} & set(tracked)
    for row in range(len(tracked["frame"])):
        assert list(told(tracked, row)) == empty_values(tracked, row)
    assert set(told(tracked, 0).values()) == {"unknown"} and tracked["unstated"][-1] == ""


def test_the_camera_scale_divides_the_velocity_of_the_middle_in_the_table(table):
    plain, scaled = ff.track(table), ff.track(table, scale=0.5)
    for name in [*LATER_COLUMNS[:4], "point_x", "point_y"]:
        np.testing.assert_allclose(scaled[name], 2 * plain[name])
    assert scaled["unstated"].tolist() == plain["unstated"].tolist()


def test_the_camera_scale_divides_velocities(table):
    plain, scaled = ff.identify(table)["left"], ff.identify(table, scale=0.5)["left"]
    np.testing.assert_allclose(scaled.estimate.values, plain.estimate.values * [1, 2, 2])
    np.testing.assert_allclose(scaled.velocity.velocity, 2 * plain.velocity.velocity)


def test_a_table_without_objects_has_one_and_frames_make_times(bird):
    table = ff.outline_table(bird)
    expected = ff.identify(table)[0].estimate.values
    alone = {name: table[name] for name in ("frame", "x", "y")}
    found = ff.identify(alone, fps=30.0)
    assert found.objects == ["0"] and "arc" not in table
    np.testing.assert_array_equal(found[0].estimate.values, expected)


def test_columns_may_have_other_names(bird):
    table = pandas.DataFrame(ff.outline_table(bird))
    renamed = table.rename(columns={"x": "px", "time": "t"})
    found = ff.identify(renamed, columns={"x": "px", "time": "t"})
    np.testing.assert_array_equal(found[0].estimate.values, ff.identify(table)[0].estimate.values)


def test_results_come_as_a_table_too(table):
    results = ff.identify(table)
    rows = pandas.DataFrame(results.table())
    assert rows["object"].tolist() == ["left", "right"]
    assert rows["omega"].tolist() == [result.estimate.values[0] for result in results]
    assert rows["omega_std_random"].tolist() == [result.estimate.std_random[0] for result in results]
    assert rows["omega_std_systematic"].tolist() == [result.estimate.std_systematic[0] for result in results]
    assert rows["v1_std"].tolist() == [result.velocity.std[0] for result in results]
    assert len(results) == 2 and results[1].object == "right" and results[:1].objects == ["left"]
    assert "omega" in repr(results)
    with pytest.raises(KeyError, match="none of left, right"):
        results["middle"]


def test_points_that_are_no_outline_are_a_rejected_frame(bird):
    table = ff.outline_table(bird)
    rows = table["frame"] == 10
    flat = {**table, "y": np.where(rows, 0.0, table["y"])}
    result = ff.identify(flat)[0]
    assert result.frames == 30 and result.frames_rejected == 1
    assert "lie on one line" in result.first_rejection and "rows 4000 to 4399" in result.first_rejection
    tracked = ff.track(flat)
    assert not tracked["accepted"][10] and np.isnan(tracked["time"][10])
    # Every frame has a reason of its own or none.
    assert tracked["reason"][10] == result.first_rejection
    assert [row for row, reason in enumerate(tracked["reason"]) if reason] == [10]
    assert list(told(tracked, 10)) == empty_values(tracked, 10) and set(told(tracked, 10).values()) == {"unknown"}


def test_an_empty_table_has_no_results():
    empty = {name: np.empty(0) for name in ("frame", "time", "x", "y")}
    assert len(ff.identify(empty)) == 0 and len(ff.track(empty)["time"]) == 0
    for of in pandas.DataFrame, polars.DataFrame, pyarrow.table:
        tracked = ff.track(of(empty))
        assert all(len(tracked[name]) == 0 for name in LATER_COLUMNS)


@pytest.mark.parametrize("of", [polars.DataFrame, pyarrow.table])
def test_columns_of_texts_are_texts_in_every_library(table, of):
    for rows in (table, {name: np.empty(0, column.dtype) for name, column in table.items()}):
        tracked = ff.track(of(rows))
        of_texts = [tracked[name].dtype if of is polars.DataFrame else tracked[name].type for name in ("reason", "unstated", "phase")]
        assert of_texts == [polars.String if of is polars.DataFrame else pyarrow.string()] * 3


@pytest.mark.parametrize("of", [np.array, pandas.Series, polars.Series, lambda values: pyarrow.chunked_array([values])])
def test_values_are_numbered_as_they_appear(of):
    codes, values = factorise(of(["b", "b", "a", "b", "c"]))
    assert codes.tolist() == [0, 0, 1, 0, 2] and values == ["b", "a", "c"]


def test_progress_counts_every_frame(table, monkeypatch):
    counted = []

    class Bar:
        def __init__(self, **_):
            pass

        def __enter__(self):
            return self

        def __exit__(self, *_):
            pass

        def update(self, frames):
            counted.append(frames)

    monkeypatch.setattr("tqdm.auto.tqdm", Bar)
    ff.identify(table, progress=True)
    assert sum(counted) == 30
    ff.identify(table, progress=False)
    assert sum(counted) == 30


@pytest.mark.parametrize("library", LIBRARIES.values(), ids=LIBRARIES)
def test_what_a_table_says_of_how_its_outlines_were_found_is_warned_of_and_in_the_results(table, library):
    told = np.full(len(table["frame"]), "tracing_doubtful rate_assumed")
    known = {"plane": ff.simulate("plane").true_outline()}

    def recognise(data):
        return ff.recognise(data, known)

    for use in (ff.identify, ff.track, recognise):
        with pytest.warns(UserWarning) as heard:
            results = use(library({**table, "warning": told}))
        messages = [str(warning.message) for warning in heard]
        assert ["tracing_doubtful" in messages[0], "rate_assumed" in messages[1], len(messages)] == [True, True, 2]
        assert all(warning.filename == __file__ for warning in heard)
        if use is ff.identify:
            codes = [[warning.code for warning in result.warnings] for result in results]
            assert all(of_object[-2:] == ["tracing_doubtful", "rate_assumed"] for of_object in codes)


def test_a_column_warning_of_another_program_says_nothing(table):
    count = len(table["frame"])
    for values in (np.zeros(count), np.arange(count), np.full(count, "low battery"), np.full(count, None)):
        assert ff.identify({**table, "warning": values})[0].warnings == ff.identify(table)[0].warnings == []
