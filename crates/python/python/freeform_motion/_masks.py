"""Outlines of the objects in labelled masks."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sized
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._native import LabelTracer, Outline
from ._progress import progress_bar

#: Options that say how outlines are found in masks, and what they are by default.
_TRACING: dict[str, Any] = {
    "link": "labels",
    "y_up": True,
    "pixel_size": 1.0,
    "pixel_aspect": 1.0,
    "minimum_area": 9,
    "smoothing": None,
    "clipping": "close",
}


def outlines(
    labels: ArrayLike,
    *,
    y_up: bool = True,
    pixel_size: float = 1.0,
    pixel_aspect: float = 1.0,
    minimum_area: int = 9,
    smoothing: float | None = None,
    clipping: str = "close",
) -> dict[int, Outline]:
    """Find the outline of every object in a labelled mask, to a fraction of a pixel.

    Parameters
    ----------
    labels : array_like, shape (height, width), bool or integer
        The label of the object that each pixel belongs to, 0 for the ground: as from scikit-image, Cellpose or SAM. Of a label in
        several parts the largest is taken; holes are filled.
    y_up : bool
        Whether y runs upwards from the lower edge of the mask, or downwards from its upper edge. It decides the sign of omega. Pixel
        (row r, column c) has its centre at ``x = c + 0.5``, and ``y = height - r - 0.5`` or ``y = r + 0.5``.
    pixel_size : float
        Height of a pixel in the unit of length wanted.
    pixel_aspect : float
        Width of a pixel over its height.
    minimum_area : int
        Smallest object taken, in pixels.
    smoothing : float, optional
        Standard deviation of the Gaussian that takes off the stairs of the mask, in pixels; 1 if left out.
    clipping : str
        What to make of an object that the edge of the mask cuts: `close` its outline along the edge, or keep the `open` arcs that are
        seen.

    Returns
    -------
    dict of int to Outline
        By label, in increasing order.

    Examples
    --------
    >>> import numpy as np
    >>> import freeform_motion as ff
    >>> labels = np.zeros((40, 60), dtype=int)
    >>> labels[10:20, 5:30] = 3
    >>> found = ff.outlines(labels)
    >>> found[3].centroid.round(6).tolist()
    [17.5, 25.0]
    """
    tracer = LabelTracer(
        link="labels",
        y_up=y_up,
        pixel_size=pixel_size,
        pixel_aspect=pixel_aspect,
        minimum_area=minimum_area,
        smoothing=smoothing,
        clipping=clipping,
    )
    found, refused, in_parts = tracer.trace(0, label_array(labels))
    if in_parts is not None:
        _warn(in_parts.partition(", ")[2])
    if refused:
        raise ValueError(refused[0][1].partition(", ")[2])
    return dict(found)


def _warn(message: str) -> None:
    """Warns where this package was called."""
    frame, level = sys._getframe(1), 2
    while frame.f_back is not None and frame.f_globals.get("__package__") == __package__:
        frame, level = frame.f_back, level + 1
    warnings.warn(message, stacklevel=level)


def label_array(labels: Any, frame: int | None = None) -> NDArray[np.int64]:
    """Labels as the native part takes them."""
    place = "mask" if frame is None else f"mask {frame}"
    if isinstance(labels, (Outline, Mapping)):
        raise TypeError(f"{place}: a mask is needed, this is {type(labels).__name__}; a recording of outlines is a list of them")
    array = np.asarray(labels)
    if array.ndim != 2:
        raise ValueError(f"{place}: shape (height, width) is needed, this is {array.shape}")
    if array.dtype.kind not in "biu":
        hint = "; make a mask of a picture first, such as picture > level" if array.dtype.kind == "f" else ""
        raise TypeError(f"{place}: labels are whole numbers, these are of type {array.dtype}{hint}")
    return np.ascontiguousarray(array, dtype=np.int64)


def check_masks(masks: Any) -> None:
    """Refuses what cannot be masks."""
    if isinstance(masks, np.ndarray) and masks.ndim != 3:
        raise ValueError(f"masks: shape (frames, height, width) is needed, this is {masks.shape}")
    if not isinstance(masks, Iterable) or isinstance(masks, (str, bytes)):
        raise TypeError(f"masks or a table are needed, this is {type(masks).__name__}")


def split_tracing(options: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Options that say how outlines are found in masks, and the others."""
    tracing = {name: value for name, value in options.items() if name in _TRACING}
    return tracing, {name: value for name, value in options.items() if name not in tracing}


def tracer_of(tracing: Mapping[str, Any]) -> LabelTracer:
    """The tracer with these options."""
    return LabelTracer(**{**_TRACING, **tracing})


def traced(
    masks: Iterable[Any], tracer: LabelTracer, progress: bool | None
) -> Iterator[tuple[list[tuple[int, Outline]], list[tuple[int, str]]]]:
    """The objects of every mask with their outlines, and those without one with the reason."""
    is_told = False
    with progress_bar(progress, len(masks) if isinstance(masks, Sized) else None) as advance:
        for frame, mask in enumerate(masks):
            found, refused, in_parts = tracer.trace(frame, label_array(mask, frame))
            if in_parts is not None and not is_told:
                _warn(in_parts)
                is_told = True
            yield found, refused
            if advance is not None:
                advance(1)


def times_of(masks: Any, fps: float | None, times: Any) -> Iterator[float]:
    """The time of each mask or outline."""
    if times is not None:
        if fps is not None:
            raise ValueError("give fps or times, not both")
        array = np.asarray(times, dtype=np.float64)
        if array.ndim != 1 or hasattr(masks, "__len__") and len(masks) != len(array):
            count = f" for {len(masks)} frames" if hasattr(masks, "__len__") else ""
            raise ValueError(f"times: one number for each frame is needed, this is of shape {array.shape}{count}")
        if not np.isfinite(array).all():
            raise ValueError(f"times: that of frame {int(np.argmin(np.isfinite(array)))} is not finite")
        if (np.diff(array) <= 0).any():
            frame = int(np.argmax(np.diff(array) <= 0)) + 1
            raise ValueError(f"times: {array[frame]} of frame {frame} does not follow {array[frame - 1]} of frame {frame - 1}")
        return iter(array.tolist())
    if fps is None or not (np.isfinite(fps) and fps > 0):
        raise ValueError(f"fps: a positive number of frames per second is needed (or times), this is {fps}")
    rate = float(fps)
    return (frame / rate for frame in _count())


def _count() -> Iterator[int]:
    frame = 0
    while True:
        yield frame
        frame += 1
