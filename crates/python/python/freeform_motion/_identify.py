"""The motion of every object of a recording."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from ._masks import check_masks, split_tracing, traced, tracer_of
from ._native import LabelTracer, ObjectResult, Observation, Recorder, Tracker, identify_table, results_of, track_table
from ._outline_lists import is_outline_list, outlines_by_frame, simulated_times
from ._progress import progress_bar
from ._tables import kind_of, read_table, table_like, with_names
from ._times import times_of


class Identification(Sequence[ObjectResult]):
    """The results of all objects: a sequence, also indexed by the names of the objects."""

    def __init__(self, results: Iterable[ObjectResult]) -> None:
        self._results = list(results)

    @property
    def objects(self) -> list[str]:
        """Names of the objects in the order in which they first appeared."""
        return [result.object for result in self._results]

    @overload
    def __getitem__(self, key: int | str) -> ObjectResult: ...
    @overload
    def __getitem__(self, key: slice) -> Identification: ...
    def __getitem__(self, key: int | str | slice) -> ObjectResult | Identification:
        if isinstance(key, slice):
            return Identification(self._results[key])
        if isinstance(key, str):
            for result in self._results:
                if result.object == key:
                    return result
            raise KeyError(f"{key!r} is none of {', '.join(self.objects)}" if self._results else f"{key!r}: there are no objects")
        if not -len(self) <= key < len(self):
            hint = f"; names are strings: [{str(key)!r}]" if str(key) in self.objects else ""
            raise IndexError(f"position {key} of {len(self)} object(s){hint}")
        return self._results[key]

    def __len__(self) -> int:
        return len(self._results)

    def table(self) -> dict[str, NDArray[Any]]:
        """One row per object.

        Returns
        -------
        dict of ndarray
            Columns `object`, `frames`, `frames_rejected`, then each parameter and its `_std`, `_std_random` and `_std_systematic`, NaN where
            it is not observable; `v1` and `v2` with their `_std` for the velocity of the middle of the object.
        """
        columns: dict[str, NDArray[Any]] = {
            "object": np.array(self.objects, dtype=np.str_),
            "frames": np.array([result.frames for result in self], dtype=np.int64),
            "frames_rejected": np.array([result.frames_rejected for result in self], dtype=np.int64),
        }
        estimates = [result.estimate for result in self]
        names = next((estimate.names for estimate in estimates if estimate is not None), ())
        for index, name in enumerate(names):
            columns[name] = _column([None if e is None else e.values[index] for e in estimates])
            for part in ("std", "std_random", "std_systematic"):
                columns[f"{name}_{part}"] = _column([None if e is None else getattr(e, part)[index] for e in estimates])
        velocities = [result.velocity for result in self]
        for index, name in enumerate(("v1", "v2")):
            columns[name] = _column([None if v is None else v.velocity[index] for v in velocities])
            columns[f"{name}_std"] = _column([None if v is None else v.std[index] for v in velocities])
        return columns

    def __repr__(self) -> str:
        lines = [repr(result) for result in self._results]
        return "Identification(\n  " + ",\n  ".join(lines) + "\n)" if lines else "Identification()"


def _column(values: list[float | None]) -> NDArray[np.float64]:
    return np.array([np.nan if value is None else value for value in values], dtype=np.float64)


def identify(
    data: Any,
    *,
    fps: float | None = None,
    times: Any = None,
    columns: Mapping[str, str] | None = None,
    motion: str = "rigid",
    method: str = "filter",
    scale: float | None = None,
    progress: bool | None = None,
    **options: Any,
) -> Identification:
    """Identify the motion of every object of a recording.

    Parameters
    ----------
    data : masks, outlines or table
        Masks: an array of shape (frames, height, width), bool or integer labels with 0 for the ground, or any iterable of arrays of shape
        (height, width). Outlines: a list with an `Outline` or an array of points, shape (n, 2), for each frame, or with a
        dict of them by object, as from `outlines`. Table: a pandas or polars DataFrame, a pyarrow Table or RecordBatch, or a mapping of arrays, with the columns
        `frame`, `time`, `x`, `y` and optionally `object`, `arc` (the open piece of a partly hidden outline), `contour` (boundary, holes
        and marks of one body) and `deviation` (standard deviation of the point along the normal of the contour, in the unit of `x` and
        `y`). Either one row per point, the rows of one outline following each other in the order of the contour; or one row per
        outline, with lists of numbers in `x`, `y` and `deviation`, as in Parquet.
    fps : float, optional
        Frames per second; needed for masks and outlines without `times`, and for tables without a column `time`.
    times : array_like, shape (frames,), optional
        Times of the masks or outlines in seconds, instead of `fps`.
    columns : mapping of str to str, optional
        Names of the columns of a table where they are others.
    motion, method, scale
        As of `Tracker`: the motion model, `filter` or `adaptive`, and the camera scale f/Z0.
    progress : bool, optional
        Whether to show a progress bar; by default on a terminal, if tqdm is installed.
    **options
        For masks: `link` and the options of `outlines`. `link` is `labels` if a label stays with its object, `places` if objects are to
        be recognised from mask to mask by place, size and shape, `nearest` or `largest` for one object. For both: further settings of
        `Tracker`, such as `dynamics`, `edge_uncertainty` and `rectify`. For masks
        `mask_pixel` is the size of their pixels, unless `edge_uncertainty` is given.

    Returns
    -------
    Identification
        The results by position or name of the object.

    Raises
    ------
    ValueError
        A column that is missing, rows out of order, numbers that are not finite: with the row (from 0) and the column.
    TypeError
        Values of another type than numbers, pictures where masks are needed.

    Examples
    --------
    >>> import freeform_motion as ff
    >>> masks = ff.simulate("glider", omega=1.0, seconds=1.0).masks()
    >>> motion = ff.identify(masks, fps=30)["1"].estimate
    >>> abs(motion["omega"].value - 1.0) < 0.02
    True
    """
    kind = kind_of(data)
    tracer, tracker = _split(options, data, kind, times, columns, motion=motion, method=method, scale=scale)
    if kind is not None:
        table, origin = read_table(data, columns, fps)
        with progress_bar(progress, None) as advance:
            identify_table(tracker, table, advance)
        return Identification(results_of(tracker, None, origin))
    for _ in _follow(tracker, data, fps, times, tracer, progress):
        pass
    return Identification(results_of(tracker, tracer))


def track(
    data: Any,
    *,
    fps: float | None = None,
    times: Any = None,
    columns: Mapping[str, str] | None = None,
    motion: str = "rigid",
    method: str = "filter",
    scale: float | None = None,
    smooth: bool = False,
    progress: bool | None = None,
    **options: Any,
) -> Any:
    """Pose and motion of every object in every frame of a recording.

    Parameters
    ----------
    data, fps, times, columns, motion, method, scale, progress, **options
        As of `identify`.
    smooth : bool
        Whether later frames take part in the poses and motions of earlier ones. A motion that is not seen to change is taken for constant;
        `adaptive=False` says that it is one. What changes suddenly stays as it was known before.

    Returns
    -------
    table
        Of the kind of `data`, a dict of arrays for masks and outlines. One row per object and frame, in the order of the data: `object`, `frame`,
        `time`, `phase`, `accepted`; the pose (motion filter), for a rigid motion `angle`, `x` and `y`, each with its `_std`; the motion, for
        a rigid one `omega`, `b1` and `b2`, each with its `_std`; `segment`, counted up from 0 where poses get another reference: the object was
        begun anew, the second frame shows far more of it than the first, its turn is shown for the first time, another of several turns is
        taken, or an edge proves not to be of it; `v1` and `v2`, each with its `_std`, the velocity of
        the middle of the object (motion filter), in the unit of `x` and `y` per second; `reason`, why the frame was not accepted; `unstated`,
        which values of the row are not stated and why, such as `omega ambiguous; b1 ambiguous`, by the words of `Observation.not_stated`;
        `point_x` and `point_y`, where that middle is (motion filter), which need not be at `x` and `y`.
        NaN where something is not known, an empty text where there is nothing to tell; `reason` and `unstated` are arrays of objects in a dict.
        Angles are in radians since the first frame and continuous, NaN while whole turns are ambiguous; x and y say where the centre of
        the first outline is.

    Raises
    ------
    ValueError, TypeError
        As `identify`.
    """
    kind = kind_of(data)
    tracer, tracker = _split(options, data, kind, times, columns, motion=motion, method=method, scale=scale)
    if kind is not None:
        table, _ = read_table(data, columns, fps)
        with progress_bar(progress, None) as advance:
            found = track_table(tracker, table, smooth, advance)
    else:
        recorder = Recorder(tracker, smooth)
        for observation in _follow(tracker, data, fps, times, tracer, progress):
            recorder.take(observation)
        found = recorder.columns(tracker)
    return table_like(kind or "mapping", with_names(found, tracker.objects))


def _split(
    options: dict[str, Any], data: Any, kind: str | None, times: Any, columns: Any, **arguments: Any
) -> tuple[LabelTracer | None, Tracker]:
    """What traces masks, where the data are masks, and what follows the outlines."""
    tracing, settings = split_tracing(options)
    if kind is None and columns is not None:
        raise TypeError("columns: only for tables")
    if kind is not None:
        only_for_masks(tracing, times)
    elif is_outline_list(data):
        only_for_masks(tracing, found="outlines")
    else:
        tracer = tracer_of(tracing)
        # In another plane pixels have another size everywhere.
        if settings.get("rectify") is None and "edge_uncertainty" not in settings:
            settings.setdefault("mask_pixel", tracer.pixel)
        return tracer, Tracker(**arguments, **settings)
    return None, Tracker(**arguments, **settings)


def only_for_masks(tracing: dict[str, Any], times: Any = None, found: str = "a table") -> None:
    """Refuses options of masks where the data are something else."""
    given = [*tracing, *(["times"] if times is not None else [])]
    if given:
        raise TypeError(f"{', '.join(given)}: only for masks, but the data are {found}")


def _follow(
    tracker: Tracker,
    data: Any,
    fps: float | None,
    times: Any,
    tracer: LabelTracer | None,
    progress: bool | None,
) -> Iterator[Observation]:
    """Follows the objects of masks, or of outlines where there is no tracer."""
    if tracer is None:
        if fps is None and times is None:
            times = simulated_times(data)
        yield from _follow_outlines(tracker, data, times_of(data, fps, times), progress)
    else:
        check_masks(data)
        yield from _follow_masks(tracker, data, times_of(data, fps, times), tracer, progress)


def _follow_outlines(
    tracker: Tracker, data: Any, seconds: Iterator[float], progress: bool | None
) -> Iterator[Observation]:
    with progress_bar(progress, len(data)) as advance:
        for frame, (time, found) in enumerate(zip(seconds, outlines_by_frame(data))):
            for name, outline in found:
                yield tracker.push(name, frame, time, outline)
            if advance is not None:
                advance(1)


def _follow_masks(
    tracker: Tracker, masks: Any, seconds: Iterator[float], tracer: LabelTracer, progress: bool | None
) -> Iterator[Observation]:
    known: set[int] = set()
    for frame, (found, refused) in enumerate(traced(masks, tracer, progress)):
        time = next(seconds, None)
        if time is None:
            raise ValueError(f"times: there is none for mask {frame}")
        for name, outline in found:
            known.add(name)
            yield tracker.push(str(name), frame, time, outline)
        for name, reason in refused:
            if name in known:
                yield tracker.reject(str(name), frame, reason)
