"""How flat free-form objects move, from their outlines alone.

Angular velocity, pose and motion of objects without marks, with standard deviations that can be trusted, from outlines, masks or tables.

- `identify` gives the motion of every object of a recording, `track` its pose and motion in every frame. Both take labelled masks, or a
  table of outline points (pandas, polars, pyarrow, or a mapping of arrays).
- `MotionFilter` follows one object frame by frame, `Tracker` many objects by name. Both can be pickled and go on where they were.
- `recognise` tells which known outline each object has; `Recogniser` and `Evidence` do it frame by frame.
- `outlines` finds the outlines in a labelled mask; `simulate` makes outlines and masks of a moving object.
- `fit` fits an implicit polynomial, `Decomposition` takes it apart into complex lines; `Pipeline` and `AdaptiveIdentifier` are the paper's
  method on top of them.
- `CramerRaoBound` tells how well any method can do.

A positive omega turns clockwise where y points up: ``x' = omega y + b1``, ``y' = -omega x + b2``.
"""

from ._identify import Identification, identify, track
from ._masks import outlines
from ._native import (
    AdaptiveIdentifier,
    Correspondence,
    CramerRaoBound,
    Decomposition,
    Estimate,
    Evidence,
    FilterStep,
    Fit,
    ImplicitPolynomial,
    MotionFilter,
    MotionState,
    ObjectResult,
    Observation,
    Outline,
    Parameter,
    Pipeline,
    PointVelocity,
    Recogniser,
    Recognition,
    ResultWarning,
    SimulatedFrame,
    Simulation,
    Tracker,
    fit,
    homography,
    simulate,
)
from ._plot import plot
from ._recognise import recognise
from ._tables import outline_table

__version__: str


def __getattr__(name: str) -> str:
    # Not before it is asked for: reading it takes longer than importing all of this.
    if name == "__version__":
        from importlib.metadata import version

        return version("freeform-motion")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


__all__ = [
    "AdaptiveIdentifier",
    "Correspondence",
    "CramerRaoBound",
    "Decomposition",
    "Estimate",
    "Evidence",
    "FilterStep",
    "Fit",
    "Identification",
    "ImplicitPolynomial",
    "MotionFilter",
    "MotionState",
    "ObjectResult",
    "Observation",
    "Outline",
    "Parameter",
    "Pipeline",
    "PointVelocity",
    "Recogniser",
    "Recognition",
    "ResultWarning",
    "SimulatedFrame",
    "Simulation",
    "Tracker",
    "fit",
    "homography",
    "identify",
    "outline_table",
    "outlines",
    "plot",
    "recognise",
    "simulate",
    "track",
]
