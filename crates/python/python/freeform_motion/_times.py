"""Times of frames."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count
from numbers import Real
from typing import Any

import numpy as np

#: Frames per second beyond which squares of rates are no numbers.
_FASTEST = 1e100


def frame_rate(fps: Any, otherwise: str) -> float:
    """Frames per second, checked; `otherwise` is what may be given in their place."""
    if isinstance(fps, np.ndarray) and fps.ndim == 0:
        fps = fps[()]
    if fps is not None and (isinstance(fps, (bool, np.bool_)) or not isinstance(fps, Real)):
        raise TypeError(f"fps: a number of frames per second is needed, this is {type(fps).__name__}")
    rate = np.nan if fps is None else float(fps)
    if not 1 / _FASTEST <= rate <= _FASTEST:
        raise ValueError(f"fps: a positive number of frames per second is needed (or {otherwise}), this is {fps}")
    return rate


def times_of(frames: Any, fps: Any, times: Any) -> Iterator[float]:
    """The time of each mask or outline."""
    if times is None:
        rate = frame_rate(fps, "times")
        return (frame / rate for frame in count())
    if fps is not None:
        raise ValueError("give fps or times, not both")
    array = np.ma.getdata(np.asanyarray(times))
    if array.dtype.kind not in "iuf" and array.size:
        hint = "; in seconds: (times - times[0]) / np.timedelta64(1, 's')" if array.dtype.kind in "mM" else ""
        raise TypeError(f"times: real numbers are needed, these are of type {array.dtype}{hint}")
    if array.ndim != 1 or hasattr(frames, "__len__") and len(frames) != len(array):
        of = f" for {len(frames)} frames" if hasattr(frames, "__len__") else ""
        raise ValueError(f"times: one number for each frame is needed, this is of shape {array.shape}{of}")
    array = array.astype(np.float64)
    known = np.isfinite(array) & ~np.ma.getmaskarray(times)
    if not known.all():
        raise ValueError(f"times: that of frame {int(np.argmin(known))} is not finite")
    if (np.diff(array) <= 0).any():
        frame = int(np.argmax(np.diff(array) <= 0)) + 1
        raise ValueError(f"times: {array[frame]} of frame {frame} does not follow {array[frame - 1]} of frame {frame - 1}")
    return iter(array.tolist())
