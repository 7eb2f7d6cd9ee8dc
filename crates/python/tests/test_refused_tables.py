"""Tables that are refused, with what is wrong and where."""

import numpy as np
import pandas
import polars
import pytest

import freeform_motion as ff


def with_value(table, name, row, value):
    column = table[name].copy()
    column[row] = value
    return {**table, name: column}


@pytest.mark.parametrize(
    ("spoil", "error", "message"),
    [
        (lambda t: {"frame": t["frame"]}, ValueError, r"missing column\(s\) x, y, time, the table has frame"),
        (lambda t: with_value(t, "x", 7, np.nan), ValueError, "row 7, column x: .* is not a finite number"),
        (lambda t: with_value(t, "y", 7, np.inf), ValueError, "row 7, column y"),
        (lambda t: with_value(t, "y", 7, 1e200), ValueError, "row 7, column y: 1e200 is beyond 1e100"),
        (lambda t: with_value(t, "time", 3, np.nan), ValueError, "row 3, column time"),
        (lambda t: with_value(t, "time", 3, 9.0), ValueError, "row 3, column time: the time changes from 0 to 9"),
        (lambda t: with_value(t, "frame", 5, -1), ValueError, "row 5, column frame: -1 is not a frame number"),
        (lambda t: {**t, "frame": t["frame"] + 0.5}, ValueError, "row 0, column frame: 0.5 is not a frame number"),
        (lambda t: {**t, "frame": t["frame"][::-1]}, ValueError, "column frame: frame 13 .* comes after its frame 14"),
        (lambda t: {**t, "time": -t["time"]}, ValueError, "is not after"),
        (lambda t: {n: c[np.argsort(c.size * [0] + t["x"])] for n, c in t.items()}, ValueError, "row .*, column frame"),
        (lambda t: with_value(t, "arc", 3, -1), ValueError, "row 3, column arc: some rows"),
        (lambda t: {**t, "y": t["y"][:-1]}, ValueError, "column y has .* rows"),
        (lambda t: {**t, "x": t["x"].astype(str)}, TypeError, "column x: real numbers are needed"),
        (lambda t: {**t, "x": t["x"].reshape(-1, 1)}, ValueError, r"column x: shape \(n,\) is needed"),
        (lambda t: {**t, "object": np.array([None] * len(t["x"]))}, ValueError, "row 0, column object: the name is missing"),
    ],
)
def test_tables_that_break_the_rules_are_refused_with_row_and_column(table, spoil, error, message):
    for take in ff.identify, ff.track:
        with pytest.raises(error, match=message):
            take(spoil(table))


def test_missing_values_of_a_dataframe_are_refused(table):
    frame = polars.DataFrame(table).with_columns(polars.when(polars.int_range(polars.len()) == 4).then(None).otherwise(polars.col("x")).alias("x"))
    with pytest.raises(ValueError, match="row 4, column x"):
        ff.identify(frame)
    nullable = pandas.DataFrame(table).convert_dtypes()
    nullable.loc[4, "x"] = pandas.NA
    with pytest.raises(ValueError, match="row 4, column x"):
        ff.identify(nullable)


def test_options_of_masks_and_unknown_columns_are_refused_for_tables(table):
    with pytest.raises(TypeError, match="link: only for masks"):
        ff.identify(table, link="places")
    with pytest.raises(ValueError, match="z is none of object"):
        ff.identify(table, columns={"z": "x"})
    with pytest.raises(ValueError, match=r"missing column\(s\) px"):
        ff.identify(table, columns={"x": "px"})
    with pytest.raises(ValueError, match="fps: a positive number"):
        ff.identify({n: table[n] for n in ("frame", "x", "y")}, fps=0.0)
    with pytest.raises(ValueError, match="give fps or the column time, not both"):
        ff.identify(table, fps=30)
    with pytest.raises(TypeError, match="columns: a dict such as .* is needed, this is str"):
        ff.identify(table, columns="x")


def test_what_is_no_table_is_told_as_such(table):
    frame = pandas.DataFrame(table)
    with pytest.raises(ValueError, match="column x is there 2 times"):
        ff.identify(pandas.concat([frame, frame[["x"]]], axis=1))
    for series in frame["x"], polars.Series(table["x"]):
        with pytest.raises(TypeError, match="a table is needed, this is Series"):
            ff.identify(series)
    with pytest.raises(TypeError, match=r"a LazyFrame: collect\(\) makes a table of it"):
        ff.identify(polars.DataFrame(table).lazy())
    with pytest.raises(ValueError, match=r"the table has 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11 and 28 more"):
        ff.identify(pandas.DataFrame(np.zeros((30, 40), int)))


def test_masked_values_of_a_column_are_missing(table):
    def with_mask(name):
        return {**table, name: np.ma.masked_array(table[name], np.arange(len(table[name])) == 7)}

    refused = [
        ("x", "is not a finite number"),
        ("time", "is not a finite number"),
        ("frame", "is not a frame number"),
        ("object", "the name is missing"),
    ]
    for name, message in refused:
        with pytest.raises(ValueError, match=f"row 7, column {name}: .*{message}"):
            ff.identify(with_mask(name))
