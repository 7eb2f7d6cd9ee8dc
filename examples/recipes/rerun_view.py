"""What a motion filter sees and knows, in the viewer of rerun: outlines with their times, omega with its band.

    python examples/recipes/rerun_view.py motion.rrd
    rerun motion.rrd

Needs `rerun-sdk`. With `rr.spawn()` in place of `rr.save(...)` the viewer opens and shows every frame at once.
"""

import sys

import numpy as np
import rerun as rr

import freeform_motion as ff


def log_frame(motion_filter: ff.MotionFilter, frame: int, time: float, outline: ff.Outline) -> None:
    """Takes one outline, and logs it with what is known after it."""
    step = motion_filter.step(time, outline)
    rr.set_time("frame", sequence=frame)
    rr.set_time("time", duration=time)
    # A closed contour ends where it begins; an open piece does not.
    pieces = [np.vstack([p, p[:1]]) if outline.is_closed else p for p in outline.pieces]
    colour = (90, 160, 250) if step.is_accepted else (240, 90, 70)
    rr.log("outline/seen", rr.LineStrips2D(pieces, colors=[colour] * len(pieces)))
    if step.rejection:
        rr.log("rejected", rr.TextLog(step.rejection, level="WARN"))
    if motion_filter.pose is None or motion_filter.estimate is None:
        return
    known = motion_filter.outline_points
    rr.log("outline/known", rr.LineStrips2D([np.vstack([known, known[:1]])], colors=[(120, 120, 120)]))
    for name in motion_filter.estimate:
        parameter = motion_filter.estimate[name]
        # A parameter that the outlines do not show has no value, and its curve a gap.
        if parameter.value is not None:
            low, high = parameter.value - 2 * parameter.std, parameter.value + 2 * parameter.std
            rr.log(f"motion/{name}", rr.Scalars([low, parameter.value, high]))


def main() -> None:
    rr.init("freeform", spawn=False)
    rr.save(sys.argv[1] if len(sys.argv) > 1 else "motion.rrd")
    # Image points have y downwards in rerun; so have outlines of masks with `y_up=False`.
    motion_filter = ff.MotionFilter()
    for frame in ff.simulate("glider", omega=1.0, seconds=3.0):
        log_frame(motion_filter, frame.index, frame.time, frame.outline)
    rr.disconnect()


if __name__ == "__main__":
    main()
