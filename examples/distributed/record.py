"""Simulated recordings of many objects, as tables in Parquet: what the examples beside this file work on.

    python record.py buckets FOLDER     one folder for each bucket of objects, for batches
    python record.py stream FOLDER      one file for each third of a second, for live streams

A table has one row for each outline: `object`, `frame`, `time` in seconds, and the points along the contour as lists `x` and `y`. So no
shuffle of rows can tear a contour apart.
"""

import argparse
import os
import time
import zlib
from collections import defaultdict
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

import freeform_motion as ff

SHAPES = ("bird", "glider", "plane", "phone", "hat", "van", "shoe", "boomerang")

SCHEMA = pa.schema(
    {
        "object": pa.string(),
        "frame": pa.int64(),
        "time": pa.float64(),
        "x": pa.list_(pa.float64()),
        "y": pa.list_(pa.float64()),
    }
)


def rows(number, frames, points):
    """The outlines of one object; every object has a motion of its own."""
    omega, b = 0.2 + 0.37 * (number % 7), (0.3 - 0.1 * (number % 5), 0.1 * (number % 3))
    shape = SHAPES[number % len(SHAPES)]
    simulation = ff.simulate(shape, omega=omega, b=b, seconds=(frames - 0.5) / 30, points=points, seed=number)
    for frame in simulation:
        x, y = frame.outline.points.T
        yield {"object": f"{number:06}", "frame": frame.index, "time": frame.time, "x": x, "y": y}


def bucket_of(name, buckets):
    """The bucket of an object, the same in every process and on every machine."""
    return zlib.crc32(name.encode()) % buckets


def write(path, outlines):
    """Writes a table that appears under its name when it is whole."""
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_name(f".{path.name}")
    pq.write_table(pa.Table.from_pylist(outlines, SCHEMA), unfinished)
    os.replace(unfinished, path)


def write_buckets(folder, objects=40, frames=60, points=400, buckets=8):
    """A recording that is over: `FOLDER/bucket=3/outlines.parquet` has the objects of bucket 3, all of their frames."""
    contents = defaultdict(list)
    for number in range(objects):
        outlines = list(rows(number, frames, points))
        contents[bucket_of(outlines[0]["object"], buckets)] += outlines
    for bucket, outlines in contents.items():
        write(Path(folder) / f"bucket={bucket}" / "outlines.parquet", outlines)


def write_stream(folder, objects=8, frames=60, points=400, frames_per_file=10):
    """A recording as it comes in: `FOLDER/frames-000010.parquet` has frames 10 to 19 of all objects."""
    began = time.time() - frames / 30
    outlines = [outline for number in range(objects) for outline in rows(number, frames, points)]
    for first in range(0, frames, frames_per_file):
        part = [outline for outline in outlines if first <= outline["frame"] < first + frames_per_file]
        path = Path(folder) / f"frames-{first:06}.parquet"
        write(path, part)
        # Streams take files in the order of their times, and these were written at once.
        os.utime(path, (began + first / 30, began + first / 30))


def main():
    parser = argparse.ArgumentParser(description="Simulates a recording of many objects.")
    parser.add_argument("kind", choices=["buckets", "stream"])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--objects", type=int, default=40)
    parser.add_argument("--frames", type=int, default=60)
    parser.add_argument("--points", type=int, default=400, help="points of an outline")
    options = vars(parser.parse_args())
    {"buckets": write_buckets, "stream": write_stream}[options.pop("kind")](**options)


if __name__ == "__main__":
    main()
