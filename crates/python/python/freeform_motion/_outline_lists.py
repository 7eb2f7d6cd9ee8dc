"""Recordings as lists of outlines, one element for each frame."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from ._native import Outline, SimulatedFrame, Simulation


def is_outline_list(data: object) -> bool:
    """Whether these are outlines frame by frame: a list of `Outline` or of dicts of them, or a simulation."""
    if isinstance(data, Simulation):
        return True
    is_list = isinstance(data, Sequence) and not isinstance(data, (str, bytes)) and len(data) > 0
    return is_list and isinstance(data[0], (Outline, Mapping, SimulatedFrame))  # type: ignore[index]


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
            if not isinstance(outline, Outline):
                raise TypeError(f"frame {frame}, object {name}: an Outline is needed, this is {type(outline).__name__}")
        yield [(str(name), outline) for name, outline in by_name.items()]
