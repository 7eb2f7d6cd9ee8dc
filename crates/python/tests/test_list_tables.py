"""Tables with one row per outline, whose points are lists: the numbers of tables with one row per point, to the last bit."""

import numpy as np
import pandas
import polars
import pyarrow
import pyarrow.parquet
import pytest

import freeform_motion as ff
from freeform_motion._lists import number_lists


@pytest.fixture(scope="module")
def outlines() -> list[tuple[str, int, float, ff.Outline]]:
    """Birds, one of them partly hidden and seen as arcs, and a plate with a hole, frame by frame."""
    whole = ff.simulate("bird", omega=-0.7, seconds=0.5, seed=2)
    hidden = ff.simulate("bird", omega=1.5, seconds=0.5, occlusion=0.2, seed=1)
    plate = ff.simulate("van", omega=0.5, seconds=0.5, seed=3)
    found = []
    for a, b, c in zip(whole, hidden, plate, strict=True):
        hole = c.outline.centroid + 0.2 * (c.outline.points - c.outline.centroid)
        with_hole = ff.Outline._from_pieces([c.outline.points, hole], True)
        found += [("whole", a.index, a.time, a.outline), ("hidden", b.index, b.time, b.outline), ("plate", c.index, c.time, with_hole)]
    return found


def rows_of(outlines):
    """Columns with one row per outline."""
    rows = {name: [] for name in ("object", "frame", "time", "x", "y", "arc", "contour")}
    for name, frame, time, outline in outlines:
        points = outline.points
        numbers = np.repeat(np.arange(len(outline.pieces)), [len(piece) for piece in outline.pieces]).tolist()
        several = len(outline.pieces) > 1
        values = (name, frame, time, points[:, 0].copy(), points[:, 1].copy())
        marks = (None if outline.is_closed else numbers, numbers if outline.is_closed and several else None)
        for column, value in zip(rows, values + marks, strict=True):
            rows[column].append(value)
    return rows


def arrow(rows, lists=pyarrow.list_):
    marks = {name: pyarrow.array(rows[name], pyarrow.list_(pyarrow.int64())) for name in ("arc", "contour")}
    points = {name: pyarrow.array([c.tolist() for c in rows[name]], lists(pyarrow.float64())) for name in ("x", "y")}
    return pyarrow.table({"object": rows["object"], "frame": rows["frame"], "time": rows["time"], **points, **marks})


def from_parquet(rows, tmp_path, read):
    pyarrow.parquet.write_table(arrow(rows), tmp_path / "outlines.parquet")
    return read(tmp_path / "outlines.parquet")


LIBRARIES = {
    "dict of lists": lambda rows, _: rows,
    "pandas": lambda rows, _: pandas.DataFrame(rows),
    "pandas, of Parquet": lambda rows, tmp: from_parquet(rows, tmp, pandas.read_parquet),
    "pandas, Arrow inside": lambda rows, tmp: from_parquet(rows, tmp, lambda path: pandas.read_parquet(path, dtype_backend="pyarrow")),
    "polars": lambda rows, _: polars.DataFrame(arrow(rows)),
    "polars, of Parquet": lambda rows, tmp: from_parquet(rows, tmp, polars.read_parquet),
    "pyarrow": lambda rows, _: arrow(rows),
    "pyarrow, large lists": lambda rows, _: arrow(rows, pyarrow.large_list),
    "pyarrow, in chunks": lambda rows, _: pyarrow.concat_tables([arrow(rows).slice(0, 7), arrow(rows).slice(7, 1), arrow(rows).slice(8)]),
    "pyarrow, chunks that differ": lambda rows, _: arrow(rows).set_column(
        3, "x", pyarrow.chunked_array([arrow(rows)["x"].chunk(0)[:5], arrow(rows)["x"].chunk(0)[5:]])
    ),
    "pyarrow, a slice": lambda rows, _: pyarrow.concat_tables([arrow(rows).slice(3, 1), arrow(rows)]).combine_chunks().slice(1),
    "record batch": lambda rows, _: arrow(rows).combine_chunks().to_batches()[0],
    "record batches": lambda rows, _: arrow(rows).to_reader(10),
}


@pytest.mark.parametrize("library", LIBRARIES)
def test_every_library_gives_the_numbers_of_a_table_of_points(outlines, library, tmp_path):
    expected = ff.identify(ff.outline_table(outlines))
    found = ff.identify(LIBRARIES[library](rows_of(outlines), tmp_path))
    assert found.objects == expected.objects == ["whole", "hidden", "plate"]
    for name in found.objects:
        np.testing.assert_array_equal(found[name].estimate.values, expected[name].estimate.values)
        np.testing.assert_array_equal(found[name].estimate.std, expected[name].estimate.std)
        assert found[name].frames == 15 and found[name].frames_rejected == 0


@pytest.mark.parametrize(("of", "kind"), [(pandas.DataFrame, pandas.DataFrame), (lambda rows: polars.DataFrame(arrow(rows)), polars.DataFrame), (arrow, pyarrow.Table)])
def test_track_returns_a_table_of_the_same_kind(outlines, of, kind):
    tracked = ff.track(of(rows_of(outlines)))
    assert isinstance(tracked, kind)
    expected = ff.track(ff.outline_table(outlines))
    for name in ("omega", "omega_std", "x", "angle"):
        np.testing.assert_array_equal(np.asarray(tracked[name]), expected[name])


def test_outlines_are_recognised_from_lists_too(outlines):
    known = {"bird": ff.simulate("bird").true_outline(), "hat": ff.simulate("hat").true_outline()}
    assert ff.recognise(arrow(rows_of(outlines[:3])), known)["whole"].name == "bird"


def test_rows_may_be_arcs_or_contours(outlines):
    pieces = [
        (name, frame, time, number, piece)
        for name, frame, time, outline in outlines
        if name != "whole"
        for number, piece in enumerate(outline.pieces)
    ]
    table = {
        "object": [row[0] for row in pieces],
        "frame": [row[1] for row in pieces],
        "time": [row[2] for row in pieces],
        "x": [row[4][:, 0] for row in pieces],
        "y": [row[4][:, 1] for row in pieces],
        "arc": [row[3] if row[0] == "hidden" else -1 for row in pieces],
        "contour": [row[3] if row[0] == "plate" else None for row in pieces],
    }
    expected = ff.identify(ff.outline_table(outlines))
    for data in (table, pandas.DataFrame(table)):
        found = ff.identify(data)
        assert found.objects == ["hidden", "plate"]
        for name in found.objects:
            np.testing.assert_array_equal(found[name].estimate.values, expected[name].estimate.values)


def test_values_that_are_floats_already_are_not_copied(outlines):
    table = arrow(rows_of(outlines)).combine_chunks()
    of_arrow = table["x"].chunk(0).values.to_numpy()
    of_polars = polars.DataFrame(table)["x"]
    for column, values in (table["x"], of_arrow), (of_polars, of_polars.explode().to_numpy()):
        [(offsets, found)] = number_lists(column, "x")
        assert offsets[-1] == len(values)
        # Some versions of polars copy what they explode.
        is_copied = column is of_polars and not np.shares_memory(values, of_polars.explode().to_numpy())
        assert is_copied or np.shares_memory(found, values)
    in_chunks = pyarrow.concat_tables([table.slice(0, 5), table.slice(5)])["x"]
    assert all(np.shares_memory(found, of_arrow) for _, found in number_lists(in_chunks, "x"))


def test_whole_numbers_and_single_precision_are_lists_of_numbers_too():
    points = np.round(100 + 90 * ff.simulate("bird", points=200)[0].outline.points)
    expected = ff.identify({"frame": [0], "time": [0.0], "x": [points[:, 0]], "y": [points[:, 1]]})[0]
    assert expected.frames_rejected == 0
    kinds = [pyarrow.list_(kind) for kind in (pyarrow.int32(), pyarrow.float32(), pyarrow.uint8())]
    for kind in [*kinds, pyarrow.list_(pyarrow.float64(), 200), pyarrow.list_view(pyarrow.float64())]:
        lists = {name: pyarrow.array([points[:, axis].tolist()], kind) for axis, name in enumerate("xy")}
        table = pyarrow.table({"frame": [0], "time": [0.0], **lists})
        for data in (table, table.to_pandas(), *([] if "view" in str(kind) else [polars.DataFrame(table)])):
            assert repr(ff.identify(data)[0]) == repr(expected)


def spoiled(rows, name, row, value):
    return {**rows, name: [value if number == row else values for number, values in enumerate(rows[name])]}


OUTLINE = np.array([0.0, 4.0, 4.0, 0.0])

BAD = {
    "not a number": ("x", [0.0, np.nan, 4.0, 0.0], ValueError, "row 1, column x: .* is not a finite number"),
    "infinite": ("y", [0.0, 0.0, np.inf, 4.0], ValueError, "row 1, column y: .* is not a finite number"),
    "too large": ("y", [0.0, 0.0, 1e200, 4.0], ValueError, "row 1, column y: 1e200 is beyond 1e100"),
    "null in a list": ("x", [0.0, None, 4.0, 0.0], ValueError, "row 1, column x: a value of the list is missing"),
    "no list": ("y", None, ValueError, "row 1, column y: the list is missing"),
    "lists of different length": ("y", [0.0, 0.0, 4.0], ValueError, r"row 1, column y: 3 value\(s\), column x has 4 in this row"),
    "frames that do not increase": ("frame", 0, ValueError, "row 1, column frame: second outline of object .* in frame 0"),
    "unsorted frames": ("frame", 7, ValueError, "row 2, column frame: frame 2 of object .* comes after its frame 7"),
    "no frame number": ("frame", -1, ValueError, "row 1, column frame: -1 is not a frame number"),
    "times that do not increase": ("time", 0.0, ValueError, "row 1, column time: time 0 .* is not after 0"),
}


@pytest.mark.parametrize("fault", BAD)
def test_lists_that_break_the_rules_are_refused_with_row_and_column(as_table, fault):
    name, value, error, message = BAD[fault]
    rows = {"frame": [0, 1, 2], "time": [0.0, 0.1, 0.2], "x": [OUTLINE.tolist()] * 3, "y": [[0.0, 0.0, 4.0, 4.0]] * 3}
    table = as_table(spoiled(rows, name, 1, value))
    for take in ff.identify, ff.track:
        with pytest.raises(error, match=message):
            take(table)


@pytest.mark.parametrize(
    ("columns", "error", "message"),
    [
        ({"y": None}, ValueError, r"missing column\(s\) y"),
        ({"y": [0.0, 1.0, 2.0]}, ValueError, "column x has lists, but column y has none"),
        ({"x": [0.0, 1.0, 2.0]}, ValueError, "column y has lists, but column x has none"),
        ({"x": [0.0, 1.0, 2.0], "y": [0.0, 1.0, 2.0], "arc": [[1], [2], [3]]}, ValueError, "column arc has lists"),
        ({"x": [["a", "b", "c", "d"]] * 3}, TypeError, "column x: .*real numbers are needed"),
        ({"x": [[True, False, True, False]] * 3}, TypeError, "column x: .*real numbers are needed"),
        ({"x": [[[0.0], [4.0], [4.0], [0.0]]] * 3}, (ValueError, TypeError), "column x"),
        ({"arc": [[0, 0, 0], None, None]}, ValueError, r"row 0, column arc: 3 value\(s\)"),
        ({"arc": [[0, 0, -1, 0], None, None]}, ValueError, "row 0, column arc: some rows"),
        ({"arc": [[0, 0, 1, 0], None, None]}, ValueError, "row 0, column arc: arc .* second time"),
        ({"contour": [["a", "b", "c", "d"]] * 3}, TypeError, "column contour: lists of whole numbers are needed"),
        ({"contour": [[0.5, 0.5, 0.5, 0.5]] * 3}, ValueError, "column contour: 0.5 is not a whole number"),
        ({"frame": [0, 1]}, ValueError, "column (time|x) has 3 rows, column frame has 2"),
        ({"object": ["a", None, "a"]}, ValueError, "row 1, column object: the name is missing"),
    ],
)
def test_columns_that_do_not_fit_lists_are_refused(columns, error, message):
    rows = {"frame": [0, 1, 2], "time": [0.0, 0.1, 0.2], "x": [OUTLINE.tolist()] * 3, "y": [[0.0, 0.0, 4.0, 4.0]] * 3}
    rows = {name: column for name, column in {**rows, **columns}.items() if column is not None}
    tables = [rows]
    if len(rows["frame"]) == 3:
        tables += [pandas.DataFrame(rows), polars.DataFrame(rows), pyarrow.table(rows)]
    for table in tables:
        with pytest.raises(error, match=message):
            ff.identify(table)


def test_a_row_whose_points_are_no_outline_is_a_rejected_frame(outlines):
    rows = rows_of(outlines)
    flat = spoiled(rows, "y", 6, np.zeros(len(rows["y"][6])))
    result = ff.identify(arrow(flat))["whole"]
    assert result.frames == 15 and result.frames_rejected == 1 and "row 6: frame 2" in result.first_rejection
    empty = spoiled(spoiled(rows, "x", 6, np.empty(0)), "y", 6, np.empty(0))
    for table in (arrow(empty), polars.DataFrame(arrow(empty)), pandas.DataFrame(empty)):
        assert ff.identify(table)["whole"].frames_rejected == 1


def test_a_table_without_rows_has_no_results():
    empty = arrow({name: [] for name in ("object", "frame", "time", "x", "y", "arc", "contour")}).cast(
        pyarrow.schema({"object": pyarrow.string(), "frame": pyarrow.int64(), "time": pyarrow.float64(), **{
            name: pyarrow.list_(pyarrow.float64()) for name in ("x", "y")}, **{
            name: pyarrow.list_(pyarrow.int64()) for name in ("arc", "contour")}})
    )
    for table in (empty, polars.DataFrame(empty), empty.to_reader()):
        assert len(ff.identify(table)) == 0
