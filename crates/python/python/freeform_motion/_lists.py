"""Columns whose rows are lists of numbers: of pyarrow, polars, pandas, or sequences of arrays. Values stay where they are wherever the
library has them one after the other as floats; nothing here goes through the rows in Python but to find the one that an error names."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

#: Lists of some rows: where each begins, and where the last one ends; the values of all.
Lists = tuple[NDArray[np.int64], NDArray[Any]]


def library_of(column: object) -> str:
    """The library that a column is of."""
    return type(column).__module__.partition(".")[0]


def are_lists(column: Any) -> bool:
    """Whether the rows of a column are lists."""
    library = library_of(column)
    if library == "pyarrow":
        return _is_arrow_list(column.type)
    if library == "polars":
        return bool(column.dtype.is_nested()) and hasattr(column.dtype, "inner")
    if library == "pandas":
        if hasattr(column.dtype, "pyarrow_dtype"):
            return _is_arrow_list(column.dtype.pyarrow_dtype)
        if column.dtype.kind != "O":
            return False
        column = column.array
    elif isinstance(column, np.ndarray) and (column.dtype.kind != "O" or column.ndim != 1):
        return False
    present = next((value for value in column if value is not None), None)
    return isinstance(present, (list, tuple)) or isinstance(present, np.ndarray) and present.ndim > 0


def number_lists(column: Any, name: str, *, may_be_missing: bool = False) -> list[Lists]:
    """The lists of a column of real numbers, in the chunks that it has; float64, and an empty list for one that is missing if it may be."""
    chunks = []
    for offsets, values in _chunks(column, name, null_lists=may_be_missing):
        if values.dtype.kind not in "iuf" and not (may_be_missing and values.size == 0):
            raise TypeError(f"column {name}: lists of real numbers are needed, these are of type {values.dtype}")
        chunks.append((offsets, np.require(values, np.float64, ["C", "A"])))
    return chunks


def mark_lists(column: Any, name: str) -> list[Lists]:
    """The lists of a column of arcs or contours; whole numbers, -1 for none, and an empty list for a missing one."""
    chunks = []
    for offsets, values in _chunks(column, name, null_lists=True, null_values=True):
        if values.dtype.kind not in "iuf" and values.size:
            raise TypeError(f"column {name}: lists of whole numbers are needed, these are of type {values.dtype}")
        with np.errstate(invalid="ignore"):
            marks = np.where(values >= 0, values, -1) if values.size else np.empty(0)
        if (marks != np.floor(marks)).any():
            raise ValueError(f"column {name}: {marks[marks != np.floor(marks)][0]} is not a whole number")
        chunks.append((offsets, np.ascontiguousarray(marks, dtype=np.int64)))
    return chunks


def merged(chunks: list[Lists]) -> list[Lists]:
    """All chunks as one, copied."""
    if len(chunks) == 1:
        return chunks
    lengths = np.concatenate([np.empty(0, np.int64), *(np.diff(offsets) for offsets, _ in chunks)])
    values = np.concatenate([np.empty(0), *(values[offsets[0] : offsets[-1]] for offsets, values in chunks)])
    dtype = chunks[0][1].dtype if chunks else np.float64
    return [(_offsets(lengths), np.ascontiguousarray(values, dtype=dtype))]


def rows_of(chunks: list[Lists]) -> list[int]:
    """Number of rows of every chunk."""
    return [len(offsets) - 1 for offsets, _ in chunks]


def _chunks(column: Any, name: str, *, null_lists: bool = False, null_values: bool = False) -> list[Lists]:
    """The lists of a column, and whether they may be missing, or values within them."""
    library = library_of(column)
    if library == "pandas":
        if not hasattr(column.dtype, "pyarrow_dtype"):
            return [_of_sequence(column.array, name, null_lists, null_values)]
        import pyarrow

        column, library = pyarrow.array(column.array), "pyarrow"
    if library == "pyarrow":
        chunks = []
        first = 0
        for chunk in getattr(column, "chunks", [column]):
            chunks.append(_of_arrow(chunk, name, first, null_lists, null_values))
            first += len(chunk)
        return chunks
    if library == "polars":
        return [_of_polars(column, name, null_lists, null_values)]
    return [_of_sequence(column, name, null_lists, null_values)]


def _is_arrow_list(kind: Any) -> bool:
    import pyarrow.types as types

    others = (types.is_large_list, types.is_fixed_size_list, types.is_list_view, types.is_large_list_view)
    return bool(types.is_list(kind) or any(is_kind(kind) for is_kind in others))


def _of_arrow(array: Any, name: str, first: int, null_lists: bool, null_values: bool) -> Lists:
    """Of one Arrow array whose first row has a number."""
    import pyarrow
    import pyarrow.compute

    if array.null_count and not null_lists:
        raise _missing(name, first + int(np.argmax(array.is_null().to_numpy(zero_copy_only=False))), "the list")
    in_order = pyarrow.types.is_list(array.type) or pyarrow.types.is_large_list(array.type)
    if array.null_count or not in_order:
        lengths = pyarrow.compute.list_value_length(array).fill_null(0)
        offsets, values = _offsets(lengths.to_numpy(zero_copy_only=False).astype(np.int64)), array.flatten()
    else:
        # Of a slice, the offsets are those of the slice and the values those of the whole.
        offsets, values = array.offsets.to_numpy().astype(np.int64, copy=False), array.values
    if values.null_count and not null_values:
        _refuse_nulls(values.is_null().to_numpy(zero_copy_only=False), offsets, name, first)
    return offsets, np.asarray(values.to_numpy(zero_copy_only=False))


def _of_polars(series: Any, name: str, null_lists: bool, null_values: bool) -> Lists:
    import polars

    if isinstance(series.dtype, polars.Array):
        series = series.arr.to_list()
    if series.null_count() and not null_lists:
        raise _missing(name, int(series.is_null().arg_max()), "the list")
    lengths = series.list.len().fill_null(0)
    values = series if series.len() and lengths.min() else series.filter(lengths > 0)
    values = values.explode()
    offsets = _offsets(lengths.to_numpy().astype(np.int64))
    if values.null_count() and not null_values:
        _refuse_nulls(values.is_null().to_numpy(), offsets, name, 0)
    return offsets, np.asarray(values.to_numpy())


def _of_sequence(rows: Any, name: str, null_lists: bool, null_values: bool) -> Lists:
    """Of arrays or lists, one for each row."""
    if null_lists and null_values:
        rows = [row if hasattr(row, "__len__") else () for row in rows]
    elif null_lists:
        rows = [() if _is_null(row) else row for row in rows]
    try:
        lengths = np.fromiter(map(len, rows), dtype=np.int64, count=len(rows))
        values = np.concatenate(rows) if len(rows) else np.empty(0)
    except (TypeError, ValueError):
        raise _wrong_row(rows, name) from None
    if values.ndim != 1 or values.dtype.kind not in "iuf" and values.size and not null_values:
        raise _wrong_row(rows, name)
    if values.dtype.kind == "O" and null_values:
        values = np.array([-1 if value is None else value for value in values.tolist()])
    return _offsets(lengths), values


def _is_null(value: Any) -> bool:
    """Whether a value stands for a missing one: None, NaN or a mark of a library, which is not equal to itself either."""
    if value is None or hasattr(value, "__len__"):
        return value is None
    equal = value == value
    return not isinstance(equal, (bool, np.bool_)) or not equal


def _wrong_row(rows: Any, name: str) -> ValueError | TypeError:
    """What is wrong with the first row that is no list of numbers."""
    for row, values in enumerate(rows):
        if values is None or not hasattr(values, "__len__"):
            return _missing(name, row, "the list")
        array = np.asarray(values)
        if array.ndim != 1:
            return ValueError(f"row {row}, column {name}: shape (n,) is needed, this is {array.shape}")
        if array.dtype.kind == "O" and any(value is None for value in values):
            return _missing(name, row, "a value of the list")
        if array.dtype.kind not in "iuf" and array.size:
            return TypeError(f"row {row}, column {name}: real numbers are needed, these are of type {array.dtype}")
    return TypeError(f"column {name}: lists of real numbers are needed")


def _refuse_nulls(is_null: NDArray[np.bool_], offsets: NDArray[np.int64], name: str, first: int) -> None:
    """Refuses nulls that are in any of the lists."""
    places = np.flatnonzero(is_null)
    places = places[(places >= offsets[0]) & (places < offsets[-1])]
    if places.size:
        row = first + int(np.searchsorted(offsets, places[0], side="right")) - 1
        raise _missing(name, row, "a value of the list")


def _missing(name: str, row: int, what: str) -> ValueError:
    return ValueError(f"row {row}, column {name}: {what} is missing")


def _offsets(lengths: NDArray[np.int64]) -> NDArray[np.int64]:
    return np.concatenate(([0], np.cumsum(lengths))).astype(np.int64, copy=False)
