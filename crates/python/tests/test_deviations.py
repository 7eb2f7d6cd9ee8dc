"""Standard deviations of points: of outlines, and in the column `deviation` of tables."""

import pickle

import numpy as np
import pandas
import polars
import pyarrow
import pyarrow.parquet
import pytest

import freeform_motion as ff

SQUARE = np.array([[0.0, 0], [2, 0], [2, 2], [0, 2]])
STATED = np.array([0.1, 0.2, 0.3, 0.4])


def squares(count):
    """So many frames of a square that rests, with one row per outline."""
    frames = list(range(count))
    points = {"x": [[0.0, 4.0, 4.0, 0.0]] * count, "y": [[0.0, 0.0, 4.0, 4.0]] * count}
    return {"frame": frames, "time": [0.1 * frame for frame in frames], **points}


def test_an_outline_states_the_deviations_of_its_points_or_none():
    outline = ff.Outline(SQUARE, STATED)
    np.testing.assert_array_equal(outline.deviations, STATED)
    assert outline.deviations.dtype == np.float64 and outline.deviations.shape == (4,)
    assert ff.Outline(SQUARE).deviations is None and ff.Outline(SQUARE, deviations=None).deviations is None
    assert ff.Outline(SQUARE, [1, 2, 3, 4]).deviations.tolist() == [1, 2, 3, 4]
    assert outline == ff.Outline(SQUARE, deviations=STATED.tolist())
    assert outline != ff.Outline(SQUARE) and outline != ff.Outline(SQUARE, 2 * STATED)


def test_a_repeated_last_point_is_dropped_with_its_deviation():
    assert ff.Outline([*SQUARE, SQUARE[0]], [*STATED, 0.5]) == ff.Outline(SQUARE, STATED)


def test_deviations_stay_with_the_points_of_arcs_that_are_turned_round():
    outline = ff.Outline.from_arcs([SQUARE[:2], SQUARE[:1:-1]], [STATED[:2], STATED[:1:-1]])
    np.testing.assert_array_equal(outline.points, SQUARE)
    np.testing.assert_array_equal(outline.deviations, STATED)
    assert ff.Outline.from_arcs([SQUARE[:2], SQUARE[2:]], deviations=None).deviations is None


def test_deviations_move_with_their_points():
    outline = ff.Outline(SQUARE, STATED)
    turned = outline.moved(np.array([[0.0, -1, 5], [1, 0, -3], [0, 0, 1]]))
    np.testing.assert_allclose(turned.deviations, STATED, rtol=1e-9)
    np.testing.assert_allclose(outline.moved(np.diag([3.0, 3, 1])).deviations, 3 * STATED, rtol=1e-9)


def test_outlines_with_deviations_can_be_pickled():
    hole = np.array([[0.5, 0.5], [0.5, 1], [1, 1]])
    body = ff.Outline._from_pieces([SQUARE, hole], True, np.arange(1.0, 8.0))
    arcs = ff.Outline.from_arcs([SQUARE[:2], SQUARE[:1:-1]], [STATED[:2], STATED[:1:-1]])
    for outline in ff.Outline(SQUARE, STATED), arcs, body:
        again = pickle.loads(pickle.dumps(outline))
        assert again == outline
        np.testing.assert_array_equal(again.deviations, outline.deviations)
    # As they were pickled before outlines had deviations.
    assert ff.Outline._from_pieces([SQUARE], True) == ff.Outline(SQUARE)


@pytest.mark.parametrize(
    ("deviations", "error", "message"),
    [
        ([0.1] * 3, ValueError, r"3 standard deviation\(s\) for 4 points"),
        ([0.1] * 5, ValueError, r"5 standard deviation\(s\) for 4 points"),
        ([], ValueError, r"0 standard deviation\(s\) for 4 points"),
        ([0.1, 0.0, 0.1, 0.1], ValueError, "point 1 has the standard deviation 0, which is not a positive finite number"),
        ([0.1, 0.1, -0.5, 0.1], ValueError, "point 2 has the standard deviation -0.5"),
        ([0.1, 0.1, 0.1, np.nan], ValueError, "point 3 has the standard deviation NaN"),
        ([np.inf, 0.1, 0.1, 0.1], ValueError, "point 0 has the standard deviation inf"),
        ([[0.1] * 4], ValueError, r"deviations: shape \(n,\) is needed, this is \(1, 4\)"),
        (0.1, ValueError, r"deviations: shape \(n,\) is needed, this is \(\)"),
        (["a"] * 4, TypeError, "deviations: real numbers are needed"),
        ([0.1, None, 0.1, 0.1], TypeError, "deviations: real numbers are needed, these are of type object"),
    ],
)
def test_deviations_that_are_none_are_refused(deviations, error, message):
    with pytest.raises(error, match=message):
        ff.Outline(SQUARE, deviations)


@pytest.mark.parametrize(
    ("deviations", "error", "message"),
    [
        ([STATED[:2]], ValueError, r"deviations: 1 array\(s\) for 2 arc\(s\)"),
        ([STATED[:2]] * 3, ValueError, r"deviations: 3 array\(s\) for 2 arc\(s\)"),
        ([STATED[:2], STATED[:3]], ValueError, r"3 standard deviation\(s\) for 2 points"),
        ([STATED[:2], [0.1, 0.0]], ValueError, "point 1 has the standard deviation 0"),
        ([STATED[:2], [0.1, np.nan]], ValueError, "point 1 has the standard deviation NaN"),
        (STATED, ValueError, r"shape \(n,\) is needed, this is \(\)"),
        ([STATED[:2], None], TypeError, "real numbers are needed"),
        (0.1, TypeError, "not iterable"),
    ],
)
def test_deviations_that_do_not_fit_the_arcs_are_refused(deviations, error, message):
    with pytest.raises(error, match=message):
        ff.Outline.from_arcs([SQUARE[:2], SQUARE[2:]], deviations)


@pytest.fixture(scope="module")
def outlines() -> list[tuple[str, int, float, ff.Outline]]:
    """A whole bird, one that is partly hidden, and a plate with a hole. Points on one side of the birds are known less well, and of the
    plate nothing is stated."""
    whole = ff.simulate("bird", omega=-0.7, seconds=0.5, noise=0.01, seed=2)
    hidden = ff.simulate("bird", omega=1.5, seconds=0.5, noise=0.01, occlusion=0.2, seed=1)
    plate = ff.simulate("van", omega=0.5, seconds=0.5, seed=3)
    found = []
    for a, b, c in zip(whole, hidden, plate, strict=True):
        hole = c.outline.centroid + 0.2 * (c.outline.points - c.outline.centroid)
        with_hole = ff.Outline._from_pieces([c.outline.points, hole], True)
        stating = [
            ff.Outline._from_pieces(of.pieces, of.is_closed, 0.01 + 0.005 * np.abs(of.points[:, 0]))
            for of in (a.outline, b.outline)
        ]
        found += [("whole", a.index, a.time, stating[0]), ("hidden", b.index, b.time, stating[1]), ("plate", c.index, c.time, with_hole)]
    return found


def pushed(outlines):
    """The results of the outlines pushed one by one."""
    tracker = ff.Tracker()
    for name, frame, time, outline in outlines:
        tracker.push(name, frame, time, outline)
    return ff.Identification(tracker.results())


def rows_of(outlines):
    """Columns with one row per outline."""
    names = ("object", "frame", "time", "x", "y", "arc", "contour", "deviation")
    rows = {name: [] for name in names}
    for name, frame, time, outline in outlines:
        numbers = np.repeat(np.arange(len(outline.pieces)), [len(piece) for piece in outline.pieces])
        x, y = (np.ascontiguousarray(outline.points[:, axis]) for axis in (0, 1))
        marks = (None, numbers) if outline.is_closed else (numbers, None)
        for column, value in zip(names, (name, frame, time, x, y, *marks, outline.deviations), strict=True):
            rows[column].append(value)
    return rows


def arrow(rows):
    lists = {name: pyarrow.array(rows[name], pyarrow.list_(kind)) for name, kind in (
        ("x", pyarrow.float64()), ("y", pyarrow.float64()), ("arc", pyarrow.int64()), ("contour", pyarrow.int64()), ("deviation", pyarrow.float64())
    )}
    return pyarrow.table({**{name: rows[name] for name in ("object", "frame", "time")}, **lists})


def parquet(table, tmp_path, read):
    pyarrow.parquet.write_table(table, tmp_path / "outlines.parquet")
    return read(tmp_path / "outlines.parquet")


LISTS = {
    "dict of lists": lambda rows, _: rows,
    "pandas": lambda rows, _: pandas.DataFrame(rows),
    "pandas, of Parquet": lambda rows, tmp: parquet(arrow(rows), tmp, pandas.read_parquet),
    "pandas, Arrow inside": lambda rows, tmp: parquet(arrow(rows), tmp, lambda path: pandas.read_parquet(path, dtype_backend="pyarrow")),
    "polars": lambda rows, _: polars.DataFrame(arrow(rows)),
    "pyarrow": lambda rows, _: arrow(rows),
    "pyarrow, in chunks": lambda rows, _: pyarrow.concat_tables([arrow(rows).slice(0, 7), arrow(rows).slice(7, 1), arrow(rows).slice(8)]),
    "pyarrow, chunks that differ": lambda rows, _: arrow(rows).set_column(
        7, "deviation", pyarrow.chunked_array([arrow(rows)["deviation"].chunk(0)[:5], arrow(rows)["deviation"].chunk(0)[5:]])
    ),
    "record batches": lambda rows, _: arrow(rows).to_reader(10),
    "empty lists": lambda rows, _: {**rows, "deviation": [() if stated is None else stated for stated in rows["deviation"]]},
}

POINTS = {
    "dict": lambda table: table,
    "pandas": pandas.DataFrame,
    "pandas, own types": lambda table: pandas.DataFrame(table).convert_dtypes(),
    "polars": polars.DataFrame,
    "polars, nulls": lambda table: polars.DataFrame(table).with_columns(polars.col("deviation").fill_nan(None)),
    "pyarrow": pyarrow.table,
    "pyarrow, nulls": lambda table: pyarrow.table({**table, "deviation": pyarrow.array(table["deviation"], from_pandas=True)}),
    "32 bits": lambda table: {**table, "deviation": table["deviation"].astype(np.float32).astype(float)},
}


def assert_same(found, expected):
    assert found.objects == expected.objects
    for name in found.objects:
        np.testing.assert_array_equal(found[name].estimate.values, expected[name].estimate.values)
        np.testing.assert_array_equal(found[name].estimate.std, expected[name].estimate.std)


@pytest.mark.parametrize("library", LISTS)
def test_lists_of_deviations_give_the_results_of_outlines_pushed_one_by_one(outlines, library, tmp_path):
    assert_same(ff.identify(LISTS[library](rows_of(outlines), tmp_path)), pushed(outlines))


@pytest.mark.parametrize("library", POINTS)
def test_deviations_of_rows_give_the_results_of_outlines_pushed_one_by_one(outlines, library):
    if library == "32 bits":
        outlines = [
            (*of, outline if outline.deviations is None else ff.Outline._from_pieces(
                outline.pieces, outline.is_closed, outline.deviations.astype(np.float32)))
            for *of, outline in outlines
        ]
    assert_same(ff.identify(POINTS[library](ff.outline_table(outlines))), pushed(outlines))


def test_deviations_weigh_the_points(outlines):
    table = ff.outline_table(outlines)
    weighed = ff.identify(table)
    plain = ff.identify({name: column for name, column in table.items() if name != "deviation"})
    assert (weighed["whole"].estimate.values != plain["whole"].estimate.values).all()
    assert_same(ff.Identification([weighed["plate"]]), ff.Identification([plain["plate"]]))


def test_the_column_may_have_another_name(outlines):
    table = ff.outline_table(outlines)
    renamed = {("sigma" if name == "deviation" else name): column for name, column in table.items()}
    assert_same(ff.identify(renamed, columns={"deviation": "sigma"}), ff.identify(table))


def test_an_outline_table_has_the_column_if_any_outline_has_deviations(outlines):
    table = ff.outline_table(outlines)
    expected = [np.full(len(of), np.nan) if of.deviations is None else of.deviations for *_, of in outlines]
    np.testing.assert_array_equal(table["deviation"], np.concatenate(expected))
    plates = [of for of in outlines if of[0] == "plate"]
    assert "deviation" not in ff.outline_table(plates) and "deviation" not in ff.outline_table([])


@pytest.mark.parametrize("nothing", [
    [None] * 3, pandas.Series([None] * 3), polars.Series([None] * 3), pyarrow.nulls(3), np.full(3, np.nan), [[], None, []],
    pyarrow.nulls(3, pyarrow.list_(pyarrow.float64())), pyarrow.array([[], None, []]), polars.Series([[], None, []], dtype=polars.List(polars.Float64)),
])
def test_a_column_of_nothing_but_missing_values_states_no_deviations(nothing):
    rows = squares(3)
    assert repr(ff.identify({**rows, "deviation": nothing})[0]) == repr(ff.identify(rows)[0])


def spoiled(values, row, value):
    return [value if number == row else old for number, old in enumerate(values)]


BAD_LISTS = {
    "short": ([0.1] * 3, ValueError, r"row 1, column deviation: 3 value\(s\), column x has 4 in this row"),
    "long": ([0.1] * 5, ValueError, r"row 1, column deviation: 5 value\(s\), column x has 4 in this row"),
    "zero": ([0.1, 0.0, 0.1, 0.1], ValueError, "row 1, column deviation: 0 is not a standard deviation"),
    "negative": ([0.1, -0.5, 0.1, 0.1], ValueError, "row 1, column deviation: -0.5 is not a standard deviation"),
    "NaN": ([0.1, np.nan, 0.1, 0.1], ValueError, "row 1, column deviation: .* is not a finite number"),
    "infinite": ([0.1, np.inf, 0.1, 0.1], ValueError, "row 1, column deviation: .* is not a finite number"),
    "too large": ([0.1, 1e200, 0.1, 0.1], ValueError, "row 1, column deviation: 1e200 is beyond 1e100"),
    "null in a list": ([0.1, None, 0.1, 0.1], ValueError, "row 1, column deviation: a value of the list is missing"),
}


@pytest.mark.parametrize("fault", BAD_LISTS)
def test_lists_of_deviations_that_break_the_rules_are_refused_with_row_and_column(as_table, fault):
    value, error, message = BAD_LISTS[fault]
    table = as_table({**squares(3), "deviation": [None, value, STATED.tolist()]})
    for take in ff.identify, ff.track:
        with pytest.raises(error, match=message):
            take(table)


@pytest.mark.parametrize(
    ("deviation", "error", "message"),
    [
        ([["a"] * 4] * 3, TypeError, "column deviation: .*real numbers are needed"),
        ([0.1, 0.2, 0.3], ValueError, "column x has lists, but column deviation has none"),
        ([[[0.1]] * 4] * 3, (ValueError, TypeError), "column deviation"),
    ],
)
def test_a_column_of_deviations_that_does_not_fit_lists_is_refused(as_table, deviation, error, message):
    table = as_table({**squares(3), "deviation": deviation})
    with pytest.raises(error, match=message):
        ff.identify(table)


def test_a_number_among_lists_of_deviations_and_a_column_of_another_length_are_refused():
    rows = squares(2)
    for table in ({**rows, "deviation": [STATED, 0.1]}, pandas.DataFrame({**rows, "deviation": [STATED, 0.1]})):
        with pytest.raises(ValueError, match="row 1, column deviation: the list is missing"):
            ff.identify(table)
    with pytest.raises(ValueError, match="column deviation has 3 rows"):
        ff.identify({**rows, "deviation": [STATED] * 3})


def with_deviation(table, row, value):
    column = table["deviation"].copy()
    column[row] = value
    return {**table, "deviation": column}


@pytest.mark.parametrize(
    ("spoil", "error", "message"),
    [
        (lambda t: with_deviation(t, 7, 0.0), ValueError, "row 7, column deviation: 0 is not a standard deviation"),
        (lambda t: with_deviation(t, 7, -0.5), ValueError, "row 7, column deviation: -0.5 is not a standard deviation"),
        (lambda t: with_deviation(t, 7, np.inf), ValueError, "row 7, column deviation: .* is not a finite number"),
        (lambda t: with_deviation(t, 7, 1e200), ValueError, "row 7, column deviation: 1e200 is beyond 1e100"),
        (lambda t: {**t, "deviation": t["deviation"].astype(str)}, TypeError, "column deviation: real numbers are needed"),
        (lambda t: {**t, "deviation": t["deviation"][:-1]}, ValueError, "column deviation has .* rows"),
        (lambda t: {**t, "deviation": t["deviation"].reshape(-1, 1)}, ValueError, r"column deviation: shape \(n,\) is needed"),
        (lambda t: {**t, "deviation": [[value] for value in t["deviation"].tolist()]}, ValueError, "column deviation has lists, but column x has none"),
    ],
)
def test_deviations_of_rows_that_break_the_rules_are_refused_with_row_and_column(outlines, spoil, error, message):
    for take in ff.identify, ff.track:
        with pytest.raises(error, match=message):
            take(spoil(ff.outline_table(outlines)))


def test_an_outline_with_deviations_of_some_points_is_a_rejected_frame(outlines):
    whole = [of for of in outlines if of[0] == "whole"]
    table = ff.outline_table(whole)
    rows = np.flatnonzero(table["frame"] == 10)
    result = ff.identify(with_deviation(table, rows[3], np.nan))[0]
    assert result.frames == 15 and result.frames_rejected == 1
    points = len(rows)
    assert f"{points - 1} standard deviation(s) for {points} points" in result.first_rejection
