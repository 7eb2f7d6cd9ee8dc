"""Times of the Python package, the least of many; `cargo run --release --example filter_speed` prints those of Rust for the same input.

    python crates/python/measure.py
"""

import subprocess
import sys
import time

import numpy as np
import pandas

import freeform_motion as ff

OBJECTS, FRAMES, REPEATS = 10, 300, 20


def least(times):
    return min(times)


def of_steps(frames, as_given):
    times = []
    for _ in range(REPEATS):
        motion_filter = ff.MotionFilter()
        given = [(moment, as_given(points)) for moment, points in frames]
        for moment, points in given[: FRAMES // 3]:
            motion_filter.step(moment, points)
        for start in range(FRAMES // 3, FRAMES, 50):
            began = time.perf_counter()
            for moment, points in given[start : start + 50]:
                motion_filter.step(moment, points)
            times.append((time.perf_counter() - began) / 50)
    return 1e6 * least(times)


def of_calls(call, repeats):
    times = []
    for _ in range(repeats):
        began = time.perf_counter()
        call()
        times.append(time.perf_counter() - began)
    return 1e3 * least(times)


def main():
    simulation = ff.simulate("bird", omega=1.5, b=(0.2, -0.1), seconds=FRAMES / 30)
    frames = [(frame.time, frame.outline.points) for frame in simulation]
    print(f"step(array): {of_steps(frames, lambda points: points):.1f} us")
    print(f"step(Outline): {of_steps(frames, ff.Outline):.1f} us")
    outlines = [(str(n), k, t, ff.Outline(p)) for k, (t, p) in enumerate(frames) for n in range(OBJECTS)]
    table = ff.outline_table(outlines)
    columns = {"dict of arrays": table, "pandas": pandas.DataFrame(table)}
    columns["pandas, object as a category"] = columns["pandas"].astype({"object": "category"})
    for kind, data in columns.items():
        milliseconds = of_calls(lambda data=data: ff.identify(data, progress=False), REPEATS // 4)
        print(f"identify({kind}), {OBJECTS} objects in {FRAMES} frames of 400 points: {milliseconds:.1f} ms")
    print(f"track(dict of arrays): {of_calls(lambda: ff.track(table, progress=False), REPEATS // 4):.1f} ms")
    masks = simulation.masks()[:60]
    print(f"identify(masks), 240 x 320: {of_calls(lambda: ff.identify(masks, fps=30, progress=False), 5) / 60:.2f} ms a mask")
    motion_filter = ff.MotionFilter()
    for moment, points in frames:
        motion_filter.step(moment, points)
    state = motion_filter.to_bytes()
    print(f"state: {len(state)} bytes, saved in {of_calls(motion_filter.to_bytes, 50) * 1e3:.0f} us, "
          f"restored in {of_calls(lambda: ff.MotionFilter.from_bytes(state), 50) * 1e3:.0f} us")
    program = "import time; import numpy; t = time.perf_counter(); import freeform_motion; print(time.perf_counter() - t)"
    seconds = [float(subprocess.run([sys.executable, "-c", program], capture_output=True, check=True).stdout) for _ in range(9)]
    print(f"import after numpy: {1e3 * np.min(seconds):.1f} ms")


if __name__ == "__main__":
    main()
