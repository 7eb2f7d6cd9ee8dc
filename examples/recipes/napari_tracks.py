"""Objects of labelled masks as tracks in napari, coloured by how fast they turn.

    python examples/recipes/napari_tracks.py

Needs `napari[pyqt6]` and a screen. `tracks_of` needs neither: it makes the array and the properties of a `Tracks` layer.
"""

from typing import Any

import numpy as np

import freeform_motion as ff


def tracks_of(masks: np.ndarray, fps: float) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Data and properties of a layer of tracks.

    Returns
    -------
    data : ndarray of shape (n, 4)
        Track, frame, row and column, sorted by track and frame. A track is an object between two losses: one that was lost and begun
        anew is another track.
    properties : dict of ndarray of shape (n,)
        `label` of the mask, `omega` in rad/s and its `omega_std`; NaN where they are not known.
    """
    # y runs down as rows do, so that a positive omega turns counterclockwise on the screen.
    motion = ff.track(masks, fps=fps, y_up=False)
    placed = np.flatnonzero(np.isfinite(motion["x"]) & motion["accepted"])
    labels = motion["object"].astype(int)[placed]
    segments = motion["segment"][placed]
    frames = motion["frame"][placed].astype(int)
    _, tracks = np.unique(np.column_stack([labels, segments]), axis=0, return_inverse=True)
    order = np.lexsort([frames, tracks])
    data = np.column_stack([tracks, frames, motion["y"][placed], motion["x"][placed]])[order].astype(float)
    properties = {"label": labels[order], **{name: motion[name][placed][order] for name in ("omega", "omega_std")}}
    return data, properties


def show(viewer: Any, masks: np.ndarray, fps: float) -> None:
    """Adds masks and tracks to a viewer."""
    data, properties = tracks_of(masks, fps)
    viewer.add_labels(masks.astype(int), name="masks")
    viewer.add_tracks(data, properties=properties, name="tracks", color_by="omega", tail_length=60)


def main() -> None:
    import napari

    viewer = napari.Viewer()
    show(viewer, ff.simulate("glider", omega=1.0, seconds=3.0).masks(), fps=30)
    napari.run()


if __name__ == "__main__":
    main()
