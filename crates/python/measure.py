"""Times of the Python package, the least of many, and of Rust for the same input in the same run. Steps are wall time, since they are so
short that nothing else runs in some of them; recordings are processor time.

    cargo build --release --example filter_speed
    python crates/python/measure.py target/release/examples/filter_speed

On one core, with `taskset -c 0` before the second line, ratios hardly depend on what else the machine does.
"""

import resource
import subprocess
import sys
import time

import numpy as np
import pandas
import polars
import pyarrow

import freeform_motion as ff
from freeform_motion._tables import native_table

OBJECTS, FRAMES, REPEATS, ROUNDS = 10, 300, 20, 5


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
        began = time.process_time()
        call()
        times.append(time.process_time() - began)
    return 1e3 * least(times)


def of_program(program, few=1, many=6):
    """Processor time of a round of a program, by runs that differ in their number."""
    taken = []
    for rounds in few, many:
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([program, str(rounds)], check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        taken.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return 1e3 * (taken[1] - taken[0]) / (many - few)


def of_lists(outlines):
    """Tables with one row for each outline."""
    names, frames, times, found = zip(*outlines, strict=True)
    x, y = ([outline.points[:, axis].copy() for outline in found] for axis in (0, 1))
    table = pyarrow.table({"object": names, "frame": frames, "time": times, "x": x, "y": y})
    as_objects = pandas.DataFrame({"object": names, "frame": frames, "time": times, "x": x, "y": y})
    return {"pyarrow, lists": table, "polars, lists": polars.DataFrame(table), "pandas, lists": as_objects}


def main():
    simulation = ff.simulate("bird", omega=1.5, b=(0.2, -0.1), seconds=FRAMES / 30)
    frames = [(frame.time, frame.outline.points) for frame in simulation]
    outlines = [(str(n), k, t, ff.Outline(p)) for k, (t, p) in enumerate(frames) for n in range(OBJECTS)]
    table = ff.outline_table(outlines)
    tables = {"dict of arrays": table, "pandas": pandas.DataFrame(table)}
    tables["pandas, object as a category"] = tables["pandas"].astype({"object": "category"})
    tables |= of_lists(outlines)
    found = {}
    # One after the other and several times around, so that all meet the same machine.
    for _ in range(ROUNDS):
        times = {"step(array)": of_steps(frames, lambda points: points), "step(Outline)": of_steps(frames, ff.Outline)}
        for kind, data in tables.items():
            times[f"identify({kind})"] = of_calls(lambda data=data: ff.identify(data, progress=False), REPEATS // 4)
            times[f"columns({kind})"] = of_calls(lambda data=data: native_table(data, None, None), REPEATS)
        for program in sys.argv[1:]:
            told = subprocess.run([program], capture_output=True, check=True, text=True).stdout.splitlines()
            times["Rust, outline and step"] = float(told[0].rpartition(": ")[2].split()[0])
            times["Rust, outlines and Tracker::follow"] = of_program(program)
        for name, value in times.items():
            found[name] = min(value, found.get(name, value))
    print(f"Steps in us, {OBJECTS} objects in {FRAMES} frames of 400 points in ms:")
    for name, value in found.items():
        print(f"{name}: {value:.1f}")
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
