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

_GROUND = "{} is along all of the edge, as the ground is: the ground is 0, and mask == 0 turns a mask of two values over"


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
        The label of the object that each pixel belongs to, 0 for the ground: as from scikit-image, Cellpose or SAM. -1 beside other
        labels is ground too. Of a label in several parts the largest is taken; holes are filled.
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
    array = label_array(labels)
    found, refused, in_parts = tracer.trace(0, array)
    if in_parts is not None:
        warn_caller(in_parts.partition(", ")[2])
    if (ground := ground_label(array)) is not None:
        warn_caller(_GROUND.format(f"label {ground}"))
    if refused:
        raise ValueError(refused[0][1].partition(", ")[2])
    return dict(found)


def warn_caller(message: str) -> None:
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
    # What a masked array masks is no object.
    array = np.asarray(labels.filled(0) if isinstance(labels, np.ma.MaskedArray) else labels)
    if array.ndim == 0:
        raise TypeError(f"{place}: an array of shape (height, width) is needed, this is {type(labels).__name__}")
    if array.ndim != 2:
        raise ValueError(f"{place}: shape (height, width) is needed, this is {array.shape}")
    if array.dtype.kind not in "biu":
        hint = "; make a mask of a picture first, such as picture > level" if array.dtype.kind == "f" else ""
        if array.dtype.kind == "f" and array.shape[1] == 2:
            hint = "; points of an outline are an Outline(points)"
        raise TypeError(f"{place}: labels are whole numbers, these are of type {array.dtype}{hint}")
    if array.dtype.kind == "u" and array.dtype.itemsize == 8 and array.size and array.max() > np.iinfo(np.int64).max:
        raise ValueError(f"{place}: label {array.max()} is beyond {np.iinfo(np.int64).max}")
    if array.dtype.kind == "i" and array.size and (least := array.min()) < 0 and (least < -1 or array.max() < 1):
        raise ValueError(
            f"{place}: label {least}: labels are numbers from 1, and 0 is the ground (so is -1 beside them); numbers that are too large for "
            f"{array.dtype} become negative"
        )
    return np.ascontiguousarray(array, dtype=np.int64)


def ground_label(labels: NDArray[np.int64]) -> int | None:
    """The label that holds more than half of the edge of a mask, on all four sides, as the ground does and no object."""
    if labels.size == 0:
        return None
    sides = (labels[0], labels[-1], labels[:, 0], labels[:, -1])
    edge = np.concatenate(sides)
    if 2 * np.count_nonzero(edge > 0) <= len(edge):
        return None
    found, counts = np.unique(edge, return_counts=True)
    label, most = found[counts.argmax()], counts.max()
    return int(label) if label > 0 and 2 * most > len(edge) and all((side == label).any() for side in sides) else None


def check_masks(masks: Any) -> None:
    """Refuses what cannot be masks."""
    if isinstance(masks, np.ndarray) and masks.dtype.names:
        raise TypeError("masks or a table are needed, this is a structured array; pandas.DataFrame(array) makes a table of it")
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
    shape: tuple[int, ...] | None = None
    frames = objects = 0
    told: set[str] = set()

    def tell(kind: str, message: str) -> None:
        if kind not in told:
            told.add(kind)
            warn_caller(message)

    with progress_bar(progress, len(masks) if isinstance(masks, Sized) else None) as advance:
        for frame, mask in enumerate(masks):
            labels = label_array(mask, frame)
            shape = shape or labels.shape
            if labels.shape != shape:
                raise ValueError(f"mask {frame} is of shape {labels.shape}, mask 0 of {shape}: all have to be whole pictures of one camera")
            found, refused, in_parts = tracer.trace(frame, labels)
            if in_parts is not None:
                tell("parts", in_parts)
            if "ground" not in told and (ground := ground_label(labels)) is not None:
                tell("ground", _GROUND.format(f"frame {frame}, label {ground}"))
            frames, objects = frame + 1, objects + len(found) + len(refused)
            yield found, refused
            if advance is not None:
                advance(1)
    if objects == 0:
        warn_caller(f"there is no object in any of {frames} mask(s)")
