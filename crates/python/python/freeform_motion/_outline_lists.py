"""Recordings as lists of outlines, one element for each frame."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from ._native import Outline, SimulatedFrame, Simulation


def is_outline_list(data: object) -> bool:
    """Whether these are outlines frame by frame: a list of `Outline`, of arrays of points or of dicts of either, or a simulation."""
    if isinstance(data, Simulation):
        return True
    is_list = isinstance(data, Sequence) and not isinstance(data, (str, bytes)) and len(data) > 0
    return is_list and (isinstance(data[0], (Outline, Mapping, SimulatedFrame)) or are_points(data[0]))  # type: ignore[index]


def are_points(data: object) -> bool:
    """Whether this is an array of points, shape (n, 2). A mask two pixels wide would show nothing."""
    return isinstance(data, np.ndarray) and data.ndim == 2 and data.shape[1] == 2 and data.dtype.kind in "fiu"


def simulated_times(data: Any) -> list[float] | None:
    """The times that simulated frames carry, None for other outlines."""
    if all(isinstance(frame, SimulatedFrame) for frame in data):
        return [frame.time for frame in data]
    return None


def outlines_by_frame(data: Any) -> Iterator[list[tuple[str, Outline]]]:
    """The objects of every frame with their outlines; an object without a name is "0", as in tables."""
    for frame, found in enumerate(data):
        if isinstance(found, SimulatedFrame):
            found = found.outline
        by_name = found if isinstance(found, Mapping) else {"0": found}
        for name, outline in by_name.items():
            if not isinstance(outline, Outline) and not are_points(outline):
                raise TypeError(
                    f"frame {frame}, object {name}: an Outline or an array of points of shape (n, 2) is needed, "
                    f"this is {type(outline).__name__}"
                )
        yield [(str(name), _outline_of(frame, name, outline)) for name, outline in by_name.items()]


def _outline_of(frame: int, name: object, points: Any) -> Outline:
    if isinstance(points, Outline):
        return points
    try:
        return Outline(np.asarray(points, dtype=np.float64))
    except ValueError as error:
        raise ValueError(f"frame {frame}, object {name}: {error}") from None
