"""Checked by mypy, not run: how the package is used with types."""

import numpy as np

import freeform_motion as ff

masks = np.zeros((10, 20, 30), dtype=np.uint8)
results: ff.Identification = ff.identify(masks, fps=30.0, link="places")
estimate = results["1"].estimate
if estimate is not None:
    omega: float | None = estimate["omega"].value
    total: float = float(estimate.values.sum())
motion_filter = ff.MotionFilter("rigid", patience=3)
step: ff.FilterStep = motion_filter.step(0.0, [[0, 0], [1, 0], [1, 1]])
lines = ff.fit(ff.Outline(np.eye(3)[:, :2]), degree=4).decompose().lines()
moduli = np.abs(lines)
by_label: dict[int, ff.Outline] = ff.outlines(masks[0])
weights: dict[str, float] | None = motion_filter.dynamics
recognised: dict[str, ff.Recognition | None] = ff.recognise(masks, {"square": np.eye(3)[:, :2]})
stated: np.ndarray | None = ff.Outline(np.eye(3)[:, :2], deviations=[0.1, 0.2, 0.3]).deviations
