"""What several tests look at."""

import os

import numpy as np
import pandas
import polars
import pyarrow
import pytest

import freeform_motion as ff

# Pictures are drawn without a screen.
os.environ.setdefault("MPLBACKEND", "Agg")


@pytest.fixture(params=["dict", "pandas", "polars", "pyarrow"])
def as_table(request):
    """What makes a table of each library of a dict of columns."""
    return {"dict": dict, "pandas": pandas.DataFrame, "polars": polars.DataFrame, "pyarrow": pyarrow.table}[request.param]


@pytest.fixture(scope="session")
def bird() -> ff.Simulation:
    """A second of a bird that turns at 1.5 rad/s and drifts."""
    return ff.simulate("bird", omega=1.5, b=(0.2, -0.1), seconds=1.0)


@pytest.fixture(scope="session")
def masks() -> np.ndarray:
    """A second of masks of a glider that turns at 1 rad/s."""
    return ff.simulate("glider", omega=1.0, seconds=1.0).masks()


@pytest.fixture(scope="session")
def table() -> dict[str, np.ndarray]:
    """Two birds, one of them partly hidden, frame by frame."""
    left = ff.simulate("bird", omega=1.5, seconds=0.5, occlusion=0.2, seed=1)
    right = ff.simulate("bird", omega=-0.7, seconds=0.5, seed=2)
    rows = []
    for a, b in zip(left, right, strict=True):
        rows += [("left", a.index, a.time, a.outline), ("right", b.index, b.time, b.outline)]
    return ff.outline_table(rows)
