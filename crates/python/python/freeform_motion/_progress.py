"""Progress bars, where tqdm is installed."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def progress_bar(wanted: bool | None, total: int | None) -> Iterator[Callable[[int], object] | None]:
    """What to call with the number of frames done; None for no bar.

    Parameters
    ----------
    wanted : bool, optional
        None for a bar on a terminal where tqdm is installed. True needs tqdm.
    total : int, optional
        Number of frames, where it is known.
    """
    if wanted is False or wanted is None and not sys.stderr.isatty():
        yield None
        return
    try:
        from tqdm.auto import tqdm
    except ModuleNotFoundError:
        if wanted:
            raise
        yield None
        return
    with tqdm(total=total, unit="frame", leave=False) as bar:
        yield bar.update
