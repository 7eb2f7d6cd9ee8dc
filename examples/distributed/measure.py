"""What docs/scale.md states: cost per object and frame by every way, and the size of what is kept of an object.

    python examples/distributed/measure.py [--spark]

All ways do the same work in the same run, one after the other and twice around. What counts is the processor time of this process and
all that it started, since that hardly depends on what else the machine does; wall time is printed beside it. Without `--spark` no Java
is needed.
"""

import argparse
import contextlib
import io
import os
import pickle
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pandas as pd
import psutil
import pyarrow.parquet as pq

import dask_batch
import freeform_motion as ff
import record

OBJECTS, FRAMES, POINTS, BUCKETS = 64, 120, 400, 8
SPARK_FRAMES = 60


def processor_seconds():
    """Processor time of this process and of all that it started so far."""
    times = [process.cpu_times() for process in psutil.Process().children(recursive=True)]
    ended = psutil.Process().cpu_times()
    return time.process_time() + sum(t.user + t.system for t in times) + ended.children_user + ended.children_system


def seconds(call):
    """Processor and wall time of a call."""
    before, began = processor_seconds(), time.perf_counter()
    call()
    return processor_seconds() - before, time.perf_counter() - began


def each(name, taken, outlines):
    """A line of the table: microseconds for each object and frame."""
    processor, wall = (1e6 * t / outlines for t in taken)
    print(f"{name:52} {processor:8.1f} us of processor, {wall:8.1f} us of wall time", flush=True)


def in_process(recording):
    """The filter alone, and the way of an example in one process."""
    rows = [row for number in range(16) for row in record.rows(number, FRAMES, POINTS)]
    outlines = [(row["object"], row["time"], ff.Outline(np.column_stack([row["x"], row["y"]]))) for row in rows]

    def steps(given):
        filters = {}
        for name, moment, outline in given:
            filters.setdefault(name, ff.MotionFilter()).step(moment, outline)

    each("step(Outline), first frames included", seconds(lambda: steps(outlines)), len(outlines))
    by_object = {name: [(m, o) for n, m, o in outlines if n == name] for name in {name for name, _, _ in outlines}}
    later = []
    for given in by_object.values():
        motion_filter = ff.MotionFilter()
        for moment, outline in given[:30]:
            motion_filter.step(moment, outline)
        later.append((motion_filter, given[30:]))
    rest = seconds(lambda: [motion_filter.step(*frame) for motion_filter, given in later for frame in given])
    each("step(Outline), after the first second", rest, sum(len(given) for _, given in later))
    arrays = [(name, moment, outline.points) for name, moment, outline in outlines]
    each("step(array)", seconds(lambda: steps(arrays)), len(outlines))
    each("identify(table of Parquet), both cores, reading included", seconds(lambda: identify(recording)), OBJECTS * FRAMES)


def settings():
    """What a frame costs after the first second, by the number of points and what is assumed of the motion."""
    for points in (100, 400):
        for dynamics in ("auto", "generator"):
            taken, frames = np.zeros(2), 0
            for shape in record.SHAPES:
                motion_filter = ff.MotionFilter(dynamics=dynamics)
                given = [(f.time, f.outline) for f in ff.simulate(shape, omega=1.5, b=(0.2, -0.1), seconds=8.0, points=points)]
                for frame in given[:30]:
                    motion_filter.step(*frame)
                taken += seconds(lambda given=given, step=motion_filter.step: [step(*frame) for frame in given[30:]])
                frames += len(given) - 30
            each(f"step(Outline), {points} points, dynamics {dynamics}", taken, frames)


def identify(recording):
    table = pq.read_table(recording, partitioning=None).sort_by([("object", "ascending"), ("frame", "ascending")])
    ff.identify(table, progress=False)


def state(size):
    """What a filter of one object keeps, and what moving it costs."""
    print(f"\n{size} points")
    for shape in ("bird", "glider", "plane"):
        motion_filter = ff.MotionFilter()
        sizes = {}
        for frame in ff.simulate(shape, omega=1.5, b=(0.2, -0.1), seconds=20.0, points=size):
            motion_filter.step(frame.time, frame.outline)
            sizes[frame.index] = len(motion_filter.to_bytes())
        data = motion_filter.to_bytes()
        saved = seconds(lambda: [motion_filter.to_bytes() for _ in range(200)])[0] / 200
        restored = seconds(lambda: [ff.MotionFilter.from_bytes(data) for _ in range(200)])[0] / 200
        told = ", ".join(f"frame {n}: {sizes[n]}" for n in (0, 1, 29, 119, 599))
        print(f"{shape}: bytes at {told}; pickled {len(pickle.dumps(motion_filter))}; saved in {1e6 * saved:.0f} us, "
              f"restored in {1e6 * restored:.0f} us")


def memory(size, count=300):
    """Memory of a filter while it runs: what the process grows by, for each of many filters."""
    frames = [(frame.time, frame.outline) for frame in ff.simulate("bird", omega=1.5, seconds=1.0, points=size)]

    def resident():
        fields = Path("/proc/self/status").read_text()
        return int(fields.split("VmRSS:")[1].split()[0]) * 1024

    filters = [ff.MotionFilter() for _ in range(count)]
    before = resident()
    for motion_filter in filters:
        for moment, outline in frames:
            motion_filter.step(moment, outline)
    print(f"memory of a running filter, {size} points: {(resident() - before) / count / 1e3:.0f} kB")


def with_dask(recording):
    from dask.distributed import Client

    with tempfile.TemporaryDirectory() as folder, Client(n_workers=2, threads_per_worker=1, dashboard_address=None) as client:
        for name in ("Dask, first tasks, with imports", "Dask, again"):
            motions = Path(folder) / name
            with contextlib.redirect_stdout(io.StringIO()):
                taken = seconds(lambda motions=motions: dask_batch.identify_recording(client, recording, motions))
            each(name, taken, OBJECTS * FRAMES)


def with_spark(folder):
    """Cost of a batch, of an object in a batch, and of an outline, from runs that differ in their numbers."""
    import spark_batch
    import spark_stream

    # What a script defines goes to the workers by itself; what it imports from beside it does not.
    os.environ["PYTHONPATH"] = str(Path(__file__).parent)
    spark = spark_stream.session("local-cluster[2,1,1024]", 4)

    def batch(objects):
        outlines = spark.read.option("recursiveFileLookup", "true").parquet(str(folder / f"batch-{objects}"))
        return seconds(spark_batch.identify_recording(outlines, BUCKETS).collect)

    def stream(name, objects, frames_per_file):
        live, results = folder / name, folder / f"{name}-results"
        record.write_stream(live, objects, SPARK_FRAMES, POINTS, frames_per_file)
        stream = spark.readStream.schema(spark_stream.OUTLINES).option("maxFilesPerTrigger", 1).parquet(str(live))
        query = spark_stream.motions_of(stream).writeStream.format("parquet").outputMode("append")
        query = query.option("path", str(results)).option("checkpointLocation", f"{results}.checkpoint").trigger(availableNow=True)
        started = []
        taken = seconds(lambda: (started.append(query.start()), started[0].awaitTermination()))
        each(f"Spark stream, {objects} objects in {SPARK_FRAMES // frames_per_file} batches", taken, objects * SPARK_FRAMES)
        walls = [progress["durationMs"]["triggerExecution"] / 1e3 for progress in started[0].recentProgress]
        written = sum(path.stat().st_size for path in Path(f"{results}.checkpoint").rglob("*") if path.is_file())
        print(f"    batches of {walls} s; checkpoint {written / objects / 1e3:.0f} kB an object")
        return taken[0]

    for objects in (OBJECTS, 4 * OBJECTS):
        record.write_buckets(folder / f"batch-{objects}", objects, SPARK_FRAMES, POINTS, BUCKETS)
    each("Spark batch, first job, with imports", batch(OBJECTS), OBJECTS * SPARK_FRAMES)
    few, many = batch(OBJECTS), batch(4 * OBJECTS)
    each(f"Spark batch, {OBJECTS} objects", few, OBJECTS * SPARK_FRAMES)
    each(f"Spark batch, {4 * OBJECTS} objects", many, 4 * OBJECTS * SPARK_FRAMES)
    each("Spark batch, each further outline", np.subtract(many, few), 3 * OBJECTS * SPARK_FRAMES)

    stream("first", 16, 30)
    costs = [stream("few", 16, 15), stream("many", 256, 15), stream("often", 256, 5)]
    # Batches, objects in batches, outlines.
    counts = [[4, 64, 960], [4, 1024, 15360], [12, 3072, 15360]]
    found = np.linalg.solve(np.array(counts, dtype=float), np.array(costs))
    print("processor time: a batch {:.2f} s, an object in a batch {:.2f} ms, an outline {:.3f} ms".format(*(found * [1, 1e3, 1e3])))
    spark.stop()


def of_rows():
    """Python's own part of a row of a stream: a pandas row into a filter."""
    import spark_stream

    objects = [pd.DataFrame(list(record.rows(number, FRAMES, POINTS))) for number in range(16)]
    taken = seconds(lambda: [list(spark_stream.follow(ff.MotionFilter(), rows)) for rows in objects])
    each("follow(rows of pandas), first frames included", taken, len(objects) * FRAMES)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--spark", action="store_true", help="Spark too")
    parser.add_argument("--memory", type=int, metavar="POINTS", help="only the memory of a running filter")
    options = parser.parse_args()
    if options.memory:
        return memory(options.memory)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        recording = folder / "outlines"
        record.write_buckets(recording, OBJECTS, FRAMES, POINTS, BUCKETS)
        table = pq.read_table(recording, partitioning=None)
        size = sum(path.stat().st_size for path in recording.rglob("*.parquet"))
        print(f"Parquet: {size / table.num_rows:.0f} bytes an outline of {POINTS} points; in memory {table.nbytes / table.num_rows:.0f}")
        for _ in range(2):
            in_process(recording)
            of_rows()
            with_dask(recording)
        if options.spark:
            with_spark(folder)
            in_process(recording)
        settings()
        for points in (100, 400):
            state(points)
            # In a process of its own: this one has memory to spare.
            subprocess.run([sys.executable, __file__, "--memory", str(points)], check=True)


if __name__ == "__main__":
    main()
