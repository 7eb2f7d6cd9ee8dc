"""Pictures of results, with matplotlib where it is installed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ._native import Outline
from ._tables import column_names, factorise, kind_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def plot(
    what: Any,
    *,
    parameters: str | Sequence[str] = ("omega",),
    objects: Sequence[str] | None = None,
    deviations: float = 2.0,
    ax: Axes | None = None,
) -> Axes:
    """Draw an outline, or parameters against time.

    Parameters
    ----------
    what : Outline or table
        An outline, or what `track` returns.
    parameters : str or sequence of str
        Columns to draw against time, each with a band of so many standard deviations.
    objects : sequence of str, optional
        Names of the objects drawn; all by default.
    deviations : float
        Half width of the bands in standard deviations.
    ax : matplotlib.axes.Axes, optional
        What to draw into; the present axes by default.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    TypeError, ValueError
        Something else than an outline or a table, or a column that is not there.
    ModuleNotFoundError
        matplotlib is not installed: ``pip install freeform-motion[plot]``.
    """
    import matplotlib.pyplot as plt

    axes = plt.gca() if ax is None else ax
    if isinstance(what, Outline):
        for piece in what.pieces:
            way = np.vstack([piece, piece[:1]]) if what.is_closed else piece
            axes.plot(way[:, 0], way[:, 1])
        axes.set_aspect("equal")
        return axes
    drawn = (parameters,) if isinstance(parameters, str) else tuple(parameters)
    if kind_of(what) is None:
        raise TypeError(f"an Outline or a table of track() is needed, this is {type(what).__name__}")
    columns = column_names(what)
    for column in ("object", "time", *drawn, *(f"{parameter}_std" for parameter in drawn)):
        if column not in columns:
            raise ValueError(f"the table has no column {column}, only {', '.join(map(str, columns)) or 'none'}")
    codes, names = factorise(what["object"])
    wanted = [str(name) for name in names] if objects is None else list(objects)
    time = np.asarray(what["time"], dtype=np.float64)
    for name in wanted:
        if name not in names:
            raise ValueError(f"object {name!r} is none of {', '.join(map(str, names))}")
        rows = codes == names.index(name)
        for parameter in drawn:
            value = np.asarray(what[parameter], dtype=np.float64)[rows]
            label = parameter if len(wanted) == 1 else f"{parameter} of {name}"
            (line,) = axes.plot(time[rows], value, label=label)
            width = deviations * np.asarray(what[f"{parameter}_std"], dtype=np.float64)[rows]
            axes.fill_between(time[rows], value - width, value + width, color=line.get_color(), alpha=0.25, lw=0)
    axes.set_xlabel("time in s")
    axes.legend()
    return axes
