"""Which known outline every object of a recording has."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from numpy.typing import ArrayLike

from ._identify import only_for_masks
from ._masks import check_masks, split_tracing, traced, tracer_of
from ._native import Evidence, Outline, Recogniser, Recognition, outlines_of_table
from ._outline_lists import is_outline_list, outlines_by_frame
from ._tables import kind_of, read_table


def recognise(
    data: Any,
    known: Recogniser | Mapping[str, Outline | ArrayLike],
    *,
    columns: Mapping[str, str] | None = None,
    progress: bool | None = None,
    **options: Any,
) -> dict[str, Recognition | None]:
    """Tell which known outline every object of a recording has, under any affine map.

    Parameters
    ----------
    data, columns, progress
        Masks, outlines or a table, as of `identify`; times are not needed.
    known : Recogniser or mapping of str to Outline
        The known outlines by their names.
    **options
        For masks: `link` and the options of `outlines`.

    Returns
    -------
    dict of str to Recognition
        By the names of the objects, in the order in which they first appeared. None where no frame of an object could be compared, as where
        a part of its outline is hidden in all.

    Raises
    ------
    ValueError
        A known outline that is not whole; tables and masks as of `identify`.

    Examples
    --------
    >>> import freeform_motion as ff
    >>> known = {name: ff.simulate(name).true_outline() for name in ("plane", "phone", "hat")}
    >>> ff.recognise(ff.simulate("hat", omega=1.0, seconds=0.2).masks(), known)["1"].name
    'hat'
    """
    if not isinstance(known, (Recogniser, Mapping)):
        raise TypeError(f"known: a Recogniser or a dict of outlines by name is needed, this is {type(known).__name__}")
    recogniser = known if isinstance(known, Recogniser) else Recogniser()
    if isinstance(known, Mapping):
        for name, outline in known.items():
            recogniser.learn(name, outline)
    if len(recogniser) == 0:
        raise ValueError("known: no outline is known")
    evidence: dict[str, Evidence] = {}
    for name, outline in _outlines(data, columns, progress, options):
        try:
            evidence.setdefault(name, Evidence(recogniser)).add(outline)
        except ValueError:
            # Counted, with the reason.
            continue
    return {name: of.recognition for name, of in evidence.items()}


def _outlines(
    data: Any, columns: Mapping[str, str] | None, progress: bool | None, options: Mapping[str, Any]
) -> Iterator[tuple[str, Outline]]:
    """The outlines of all objects, each with its name."""
    tracing, others = split_tracing(options)
    if others:
        raise TypeError(f"recognise() got unexpected arguments: {', '.join(others)}")
    if kind_of(data) is not None:
        only_for_masks(tracing)
        table, _ = read_table(data, columns, None, times_matter=False)
        yield from outlines_of_table(table)
        return
    if columns is not None:
        raise TypeError("columns: only for tables")
    if is_outline_list(data):
        only_for_masks(tracing, found="outlines")
        for of_frame in outlines_by_frame(data):
            yield from of_frame
        return
    check_masks(data)
    for found, _ in traced(data, tracer_of(tracing), progress):
        yield from ((str(name), outline) for name, outline in found)
