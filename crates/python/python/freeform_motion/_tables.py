"""Tables of outlines: pandas, polars, pyarrow, or a mapping of arrays. Nothing here goes through the rows in Python."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._lists import Lists, are_lists, library_of, mark_lists, merged, number_lists, rows_of
from ._masks import warn_caller
from ._native import Outline, ResultWarning, Simulation, origin_warnings
from ._times import frame_rate

REQUIRED = ("frame", "x", "y")
ALL = ("object", "frame", "time", "x", "y", "arc", "contour", "deviation", "warning")

#: Columns that are named where one is missing.
_MOST_NAMED = 12

#: Arcs or contours of outlines of a chunk: None, one per row, or a list per row.
Marks = NDArray[np.int64] | Lists | None

#: x, y, arc, contour and standard deviation of each row.
Points = tuple[
    NDArray[np.float64], NDArray[np.float64], NDArray[np.int64] | None, NDArray[np.int64] | None, NDArray[np.float64] | None
]

#: The same of the rows of a chunk, in lists.
Chunk = tuple[Lists, Lists, Marks, Marks, Lists | None]

#: What the native part takes: names, then object, frame and time of each row, then its point, or lists of them in chunks of rows.
NativeTable = tuple[
    list[str],
    NDArray[np.uint32] | None,
    NDArray[np.uint64],
    NDArray[np.float64],
    Points | list[Chunk],
]


def kind_of(data: object) -> str | None:
    """The library that a table is of, `mapping`, `arrow` for what streams it, or None for what no table is made of."""
    if isinstance(data, (str, bytes, os.PathLike)):
        raise TypeError(f"data, not a path, are needed: pandas.read_csv({str(data)!r}, comment='#') reads a table of outlines")
    library = library_of(data)
    # Columns of a LazyFrame are not looked at: polars warns of what that may cost.
    if library in ("pandas", "polars", "pyarrow") and (type(data).__name__ == "LazyFrame" or hasattr(data, "columns")):
        return library
    if isinstance(data, Mapping):
        return "mapping"
    if hasattr(data, "__arrow_c_stream__"):
        return "arrow"
    if library in ("pandas", "polars", "pyarrow"):
        raise TypeError(f"a table is needed, this is {type(data).__name__}")
    return None


def read_table(
    data: Any, columns: Mapping[str, str] | None, fps: float | None, *, times_matter: bool = True
) -> tuple[NativeTable, list[ResultWarning]]:
    """The columns of a table of outlines, as `native_table`, and what its column `warning` says of how they were found, which is warned of."""
    table = _with_columns(data)
    native = native_table(table, columns, fps, times_matter=times_matter)
    name = (columns or {}).get("warning", "warning")
    texts: list[str] = []
    # A column of this name may be that of another program, of any type, and there may be several.
    if column_names(table).count(name) == 1 and not are_lists(table[name]):
        texts = [value for value in factorise(table[name])[1] if isinstance(value, str)]
    told = origin_warnings(texts)
    for warning in told:
        warn_caller(f"the table says of its outlines: {warning.message} (column {name}: {warning.code})")
    return native, told


def native_table(
    table: Any, columns: Mapping[str, str] | None, fps: float | None, *, times_matter: bool = True
) -> NativeTable:
    """The columns of a table of outlines, checked and as arrays.

    Parameters
    ----------
    table : pandas.DataFrame, polars.DataFrame, pyarrow.Table or mapping of arrays
        One row per point, or one row per outline with lists.
    columns : mapping of str to str, optional
        Names of the columns where they are not `object`, `frame`, `time`, `x`, `y`, `arc`, `contour`, `deviation` and `warning`.
    fps : float, optional
        Frames per second, where there is no column `time`.
    times_matter : bool
        Without it there need be no time at all.
    """
    table = _with_columns(table)
    if columns is not None and not isinstance(columns, Mapping):
        raise TypeError(f"columns: a dict such as {{'x': 'name in the table'}} is needed, this is {type(columns).__name__}")
    renamed = dict(columns or {})
    unknown = set(renamed) - set(ALL)
    if unknown:
        raise ValueError(f"columns: {', '.join(sorted(unknown))} is none of {', '.join(ALL)}")
    present = column_names(table)

    def find(name: str) -> Any | None:
        column = renamed.get(name, name)
        if present.count(column) > 1:
            raise ValueError(f"column {column} is there {present.count(column)} times")
        return table[column] if column in present else None

    required = REQUIRED if fps is not None or not times_matter else (*REQUIRED, "time")
    missing = [renamed.get(name, name) for name in required if find(name) is None]
    missing += [column for name, column in renamed.items() if column not in present and column not in missing]
    if missing:
        raise ValueError(f"missing column(s) {', '.join(missing)}, {_in_short(present)}")
    frame = _frame_numbers(_numbers(find("frame"), "frame"))
    time = find("time")
    if not times_matter:
        times = np.asarray(frame, dtype=np.float64)
    elif time is None:
        times = frame / frame_rate(fps, "a column time")
    elif fps is not None:
        raise ValueError(f"give fps or the column {renamed.get('time', 'time')}, not both")
    else:
        times = _reals(time, "time")
    names: list[str] = []
    codes = None
    objects = find("object")
    if objects is not None:
        found, values = factorise(objects)
        absent = np.flatnonzero(found < 0)
        if absent.size:
            raise ValueError(f"row {absent[0]}, column object: the name is missing")
        names, codes = [str(value) for value in values], found.astype(np.uint32)
    x, y, arc, contour, deviation = (find(name) for name in ("x", "y", "arc", "contour", "deviation"))
    if deviation is not None and not are_lists(deviation) and _is_missing(deviation):
        deviation = None
    if are_lists(x) and are_lists(y):
        return names, codes, frame, times, _list_chunks(x, y, arc, contour, deviation)
    for name, column in (("x", x), ("y", y), ("arc", arc), ("contour", contour), ("deviation", deviation)):
        if column is not None and are_lists(column):
            raise ValueError(f"column {name} has lists, but column {'y' if name == 'x' else 'x'} has none")
    stated = None if deviation is None else _reals(deviation, "deviation")
    return names, codes, frame, times, (_reals(x, "x"), _reals(y, "y"), _marks(arc), _marks(contour), stated)


def _with_columns(table: Any) -> Any:
    """What has columns, of what streams Arrow too."""
    if type(table).__name__ == "LazyFrame":
        raise TypeError("a table is needed, this is a LazyFrame: collect() makes a table of it")
    if kind_of(table) != "arrow":
        return table
    import pyarrow

    try:
        return pyarrow.table(table)
    except (TypeError, pyarrow.ArrowInvalid) as error:
        raise TypeError(f"a table is needed, this is {type(table).__name__}: {error}") from None


def _in_short(present: list[Any]) -> str:
    """What columns there are; a picture has hundreds."""
    names = [str(name) for name in present]
    more = f" and {len(names) - _MOST_NAMED} more" if len(names) > _MOST_NAMED else ""
    hint = "" if set(REQUIRED) & set(names) else "; masks are an array of shape (frames, height, width) or a list of arrays"
    return f"the table has {', '.join(names[:_MOST_NAMED]) or 'none'}{more}{hint}"


def _list_chunks(x: Any, y: Any, arc: Any, contour: Any, deviation: Any) -> list[Chunk]:
    """Lists of points in chunks of rows, those of the columns where they agree."""
    lists = [number_lists(x, "x"), number_lists(y, "y")]
    # Arcs, contours and standard deviations.
    others: list[Any] = [None, None, None]
    for position, (name, column) in enumerate((("arc", arc), ("contour", contour))):
        if column is not None and are_lists(column):
            others[position] = mark_lists(column, name)
    if deviation is not None:
        if not are_lists(deviation):
            raise ValueError("column x has lists, but column deviation has none")
        others[2] = number_lists(deviation, "deviation", may_be_missing=True)
    of_lists = [chunks for chunks in (*lists, *others) if chunks is not None]
    if any(rows_of(chunks) != rows_of(lists[0]) for chunks in of_lists):
        lists = [merged(chunks) for chunks in lists]
        others = [None if chunks is None else merged(chunks) for chunks in others]
    ends = np.cumsum(rows_of(lists[0]))
    for position, column in enumerate((arc, contour, None)):
        if others[position] is None:
            of_rows = _marks(column)
            others[position] = [None] * len(ends) if of_rows is None else np.split(of_rows, ends)[: len(ends)]
    return list(zip(*lists, *others, strict=True))


def _is_missing(column: Any) -> bool:
    """Whether a column has nothing but missing values, so that its type says nothing."""
    library = library_of(column)
    if library in ("pyarrow", "polars"):
        nulls = column.null_count if library == "pyarrow" else column.null_count()
        return bool(nulls == len(column))
    if library == "pandas":
        return bool(column.isna().all())
    array = np.asarray(column)
    if array.dtype.kind == "f":
        return bool(np.isnan(array).all())
    return array.dtype.kind == "O" and array.ndim == 1 and all(value is None for value in array)


def _marks(column: Any) -> NDArray[np.int64] | None:
    """Arcs or contours of rows by number, negative for none; None where there are none at all."""
    if column is None:
        return None
    codes, values = factorise(column)
    # A column of whole numbers has no other way to say that an outline is closed.
    empty = [number for number, value in enumerate(values) if value == "" or _is_negative(value)]
    marks = np.where(np.isin(codes, empty), -1, codes).astype(np.int64)
    return marks if (marks >= 0).any() else None


def _is_negative(value: Any) -> bool:
    return isinstance(value, (int, float, np.number)) and bool(value < 0)


def column_names(table: Any) -> list[Any]:
    """The names of the columns of a table, in their order."""
    if isinstance(table, Mapping):
        return list(table)
    return list(getattr(table, "column_names", table.columns))


def _array(column: Any) -> NDArray[Any]:
    """A column as a numpy array; missing numbers are NaN."""
    if library_of(column) == "pyarrow":
        return np.asarray(column.to_numpy())
    if np.ma.is_masked(column) and column.dtype.kind in "iuf":
        return np.where(np.ma.getmaskarray(column), np.nan, np.ma.getdata(column))
    return np.asarray(column.to_numpy() if hasattr(column, "to_numpy") else column)


def _numbers(column: Any, name: str) -> NDArray[Any]:
    array = _array(column)
    if array.ndim != 1:
        raise ValueError(f"column {name}: shape (n,) is needed, this is {array.shape}")
    if array.dtype.kind == "O" and len(array) == 0:
        return array.astype(np.float64)
    if array.dtype.kind == "O" and hasattr(column, "isna"):
        # A pandas column of numbers with its own mark for missing ones.
        if getattr(column.dtype, "kind", "O") in "iuf":
            return np.asarray(column.to_numpy(dtype=np.float64, na_value=np.nan))
    if array.dtype.kind not in "iuf":
        raise TypeError(f"column {name}: real numbers are needed, these are of type {array.dtype}")
    return array


def _reals(column: Any, name: str) -> NDArray[np.float64]:
    return np.require(_numbers(column, name), np.float64, ["C", "A"])


def _frame_numbers(array: NDArray[Any]) -> NDArray[np.uint64]:
    with np.errstate(invalid="ignore"):
        wrong = ~((array >= 0) & (array == np.floor(array)) & (array < 2.0**63))
    if wrong.any():
        row = int(np.argmax(wrong))
        raise ValueError(f"row {row}, column frame: {array[row]} is not a frame number (a whole number, 0 or more)")
    return np.ascontiguousarray(array, dtype=np.uint64)


def factorise(column: Any) -> tuple[NDArray[np.int64], list[Any]]:
    """Numbers of the values in the order of their first appearance, -1 for missing ones, and the values."""
    library = library_of(column)
    if library == "pandas":
        import pandas

        codes, values = pandas.factorize(column)
        return codes.astype(np.int64), list(values)
    if library == "pyarrow":
        import pyarrow

        encoded = column.combine_chunks() if isinstance(column, pyarrow.ChunkedArray) else column
        if isinstance(encoded, pyarrow.ChunkedArray):
            encoded = pyarrow.concat_arrays(encoded.chunks)
        if not isinstance(encoded, pyarrow.DictionaryArray):
            encoded = encoded.dictionary_encode()
        codes = encoded.indices.fill_null(-1).to_numpy(zero_copy_only=False).astype(np.int64)
        return _by_appearance(codes, encoded.dictionary.to_pylist())
    if library == "polars":
        runs = column.rle().struct.unnest()
        return _of_runs(runs["len"].to_numpy(), runs["value"].to_list())
    array = np.asarray(column)
    if np.ma.is_masked(column):
        array = array.astype(object)
        array[np.ma.getmaskarray(column)] = None
    if array.ndim != 1:
        raise ValueError(f"a column of shape (n,) is needed, this is {array.shape}")
    if len(array) == 0:
        return np.empty(0, np.int64), []
    starts = np.concatenate(([0], np.flatnonzero(array[1:] != array[:-1]) + 1))
    return _of_runs(np.diff(np.append(starts, len(array))), array[starts].tolist())


def _by_appearance(codes: NDArray[np.int64], values: list[Any]) -> tuple[NDArray[np.int64], list[Any]]:
    """The same with values in the order of their first appearance; the ones that do not appear are left out."""
    change = np.flatnonzero(np.diff(codes)) + 1
    starts = np.concatenate(([0], change)) if len(codes) else change
    lengths = np.diff(np.append(starts, len(codes)))
    return _of_runs(lengths, [values[code] if code >= 0 else None for code in codes[starts].tolist()])


def _of_runs(lengths: NDArray[Any], values: list[Any]) -> tuple[NDArray[np.int64], list[Any]]:
    """From runs of equal values, one per outline or arc at least, to numbers for every row."""
    positions: dict[Any, int] = {}
    codes = [-1 if value is None or value != value else positions.setdefault(value, len(positions)) for value in values]
    return np.repeat(np.asarray(codes, dtype=np.int64), lengths), list(positions)


def table_like(kind: str, columns: dict[str, Any]) -> Any:
    """Columns as a table of a library."""
    if kind == "pandas":
        import pandas

        return pandas.DataFrame(columns)
    if kind == "polars":
        import polars

        return polars.DataFrame(columns)
    if kind in ("pyarrow", "arrow"):
        import pyarrow

        return pyarrow.table(columns)
    return columns


def with_names(columns: dict[str, Any], names: list[str]) -> dict[str, Any]:
    """Columns with the names of the objects in place of their numbers, and texts as arrays."""
    named = np.array(names, dtype=np.str_) if names else np.empty(0, dtype="U1")
    # Arrays of fixed width would have the longest reason's room in every row. Libraries take no empty array of objects for texts.
    texts = {name: np.array(columns[name], dtype=object if columns[name] else "U1") for name in ("reason", "unstated")}
    return {**columns, "object": named[columns["object"]], "phase": np.array(columns["phase"], dtype="U9"), **texts}


def outline_table(outlines: Simulation | Iterable[tuple[object, int, float, Outline]]) -> dict[str, Any]:
    """Outlines as a table with one row per point.

    Parameters
    ----------
    outlines : Simulation or iterable of tuple
        For each outline the name of its object, the number of its frame, its time in seconds, and the outline.

    Returns
    -------
    dict of ndarray
        Columns `object`, `frame`, `time`, `x`, `y`; also `arc` if there are open outlines, -1 for closed ones, `contour` if there are
        outlines with several contours, -1 for the others, and `deviation` if there are outlines with standard deviations of their points
        (along the normal of the contour, in the unit of `x` and `y`), NaN for the others. What `pandas.DataFrame`, `polars.DataFrame` and
        `pyarrow.table` take.
    """
    if isinstance(outlines, Simulation):
        outlines = (("0", frame.index, frame.time, frame.outline) for frame in outlines)
    names: list[str] = []
    frames: list[int] = []
    times: list[float] = []
    arcs: list[int] = []
    contours: list[int] = []
    pieces: list[NDArray[np.float64]] = []
    deviations: list[NDArray[np.float64]] = []
    for name, frame, time, outline in outlines:
        if not isinstance(outline, Outline):
            raise TypeError(f"frame {frame}, object {name}: an Outline is needed, this is {type(outline).__name__}")
        found = outline.pieces
        for number, piece in enumerate(found):
            names.append(str(name))
            frames.append(frame)
            times.append(time)
            arcs.append(-1 if outline.is_closed else number)
            contours.append(number if outline.is_closed and len(found) > 1 else -1)
            pieces.append(piece)
        stated = outline.deviations
        deviations.append(np.full(len(outline), np.nan) if stated is None else stated)
    lengths = [len(piece) for piece in pieces]
    points = np.concatenate(pieces) if pieces else np.empty((0, 2))
    table: dict[str, Any] = {
        "object": np.repeat(np.array(names, dtype=np.str_), lengths),
        "frame": np.repeat(np.array(frames, dtype=np.int64), lengths),
        "time": np.repeat(np.array(times, dtype=np.float64), lengths),
        "x": np.ascontiguousarray(points[:, 0]),
        "y": np.ascontiguousarray(points[:, 1]),
    }
    for column, marks in (("arc", arcs), ("contour", contours)):
        if any(mark >= 0 for mark in marks):
            table[column] = np.repeat(np.array(marks, dtype=np.int64), lengths)
    deviation = np.concatenate(deviations) if deviations else np.empty(0)
    if not np.isnan(deviation).all():
        table["deviation"] = deviation
    return table
