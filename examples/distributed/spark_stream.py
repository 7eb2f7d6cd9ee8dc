"""How objects move, while they do: live streams of outlines on a cluster with Spark, which go on where they were after a failure.

    python examples/distributed/spark_stream.py live motions
    python examples/distributed/spark_stream.py live motions --master spark://10.0.0.1:7077

The first line starts a cluster of two workers on this machine; if there is no folder `live`, it simulates a recording into it. Both go on
until they are stopped, and take every file that comes into the folder; with `--once` they end when all files are taken. When anything
was killed, the same line goes on from the last checkpoint, and no row of the result is lost, doubled, or different in a single bit.

A file is Parquet with one row for each outline: `object`, `frame`, `time`, and the points along the contour as lists `x` and `y`. With
Kafka in place of files, `spark.readStream.format("kafka")` and its topic take the place of `parquet` below, and nothing else changes.
"""

import argparse
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from pyspark.sql import DataFrame, SparkSession
from pyspark.sql.streaming import StatefulProcessor, StatefulProcessorHandle

import freeform_motion as ff
import record

# ## One object
#
# The state of an object is a motion filter, and what Spark keeps of it are the bytes of `to_bytes`. They hold all that the filter knows:
# one that is restored goes on to the last bit, on whichever worker. They are about 80 kB, and no more after a day.
#
# Spark calls `handleInputRows` for each object with the rows that came since the last call, in any order. An outline that cannot be used,
# such as one that comes too late, is a row with the reason: nothing that a camera sends ends the stream.

OUTLINES = "object string, frame long, time double, x array<double>, y array<double>"
MOTIONS = "object string, frame long, time double, accepted boolean, reason string, omega double, omega_std double"
#: An object that was not seen for an hour is forgotten.
FORGET_MS = 3_600_000


class Follower(StatefulProcessor):
    """Follows every object with a motion filter of its own."""

    def init(self, handle: StatefulProcessorHandle) -> None:
        self.saved = handle.getValueState("motion filter", "state binary", ttlDurationMs=FORGET_MS)

    def handleInputRows(self, key: Any, rows: Iterator[pd.DataFrame], timerValues: Any) -> Iterator[pd.DataFrame]:
        saved = self.saved.get() if self.saved.exists() else None
        motion_filter = ff.MotionFilter.from_bytes(bytes(saved[0])) if saved else ff.MotionFilter()
        outlines = pd.concat(rows).sort_values("frame", kind="stable")
        found = [(key[0], *motion) for motion in follow(motion_filter, outlines)]
        self.saved.update((motion_filter.to_bytes(),))
        yield pd.DataFrame(found, columns=["object", "frame", "time", "accepted", "reason", "omega", "omega_std"])

    def close(self) -> None:
        pass


def follow(motion_filter: ff.MotionFilter, outlines: pd.DataFrame) -> Iterator[tuple[Any, ...]]:
    """What is known after each outline: frame, time, whether it was used and why not, omega and its standard deviation."""
    for frame, time, x, y in outlines[["frame", "time", "x", "y"]].itertuples(index=False):
        try:
            step = motion_filter.step(time, np.column_stack([x, y]))
            accepted, reason = step.is_accepted, step.rejection
        except ValueError as error:
            accepted, reason = False, str(error)
        omega = motion_filter.estimate["omega"] if motion_filter.estimate else None
        yield frame, time, accepted, reason, omega and omega.value, omega and omega.std


# ## All objects
#
# The number of partitions of the state is set when a stream first starts, and stays: take as many as the cluster may ever have cores.


def motions_of(outlines: DataFrame) -> DataFrame:
    """A stream with one row for each outline of a stream."""
    return outlines.groupBy("object").transformWithStateInPandas(
        Follower(), outputStructType=MOTIONS, outputMode="Append", timeMode="ProcessingTime"
    )


# ## A cluster, a stream, a checkpoint
#
# The checkpoint has to be on storage that outlives the cluster, as the result has. RocksDB keeps the states on the disks of the workers
# and writes changes to the checkpoint; states that Spark holds in the memory of Java cannot be used here. Where states are forgotten after
# a time, Spark would run batch after batch while nothing comes in, only to look at the clock; without those, it does so with the next data.


def session(master: str, partitions: int) -> SparkSession:
    """A session on a cluster, with states in RocksDB."""
    os.environ.setdefault("PYSPARK_PYTHON", sys.executable)
    states = "spark.sql.streaming.stateStore"
    builder = SparkSession.builder.master(master).appName("freeform stream").config("spark.ui.enabled", "false")
    builder = builder.config(f"{states}.providerClass", "org.apache.spark.sql.execution.streaming.state.RocksDBStateStoreProvider")
    builder = builder.config(f"{states}.rocksdb.changelogCheckpointing.enabled", "true")
    builder = builder.config("spark.sql.streaming.noDataMicroBatches.enabled", "false")
    return builder.config("spark.sql.shuffle.partitions", partitions).getOrCreate()


def main() -> None:
    parser = argparse.ArgumentParser(description="Follows all objects of a live stream of outlines, with Spark.")
    parser.add_argument("outlines", type=Path, help="folder into which files of outlines come; simulated if it is not there")
    parser.add_argument("motions", type=Path, help="folder for the results, as Parquet, with the checkpoint beside it")
    parser.add_argument("--once", action="store_true", help="end when all files are taken")
    parser.add_argument("--partitions", type=int, default=4, help="parts that the objects are divided into")
    parser.add_argument("--master", default="local-cluster[2,1,1024]", help="the cluster (default: two workers on this machine)")
    options = parser.parse_args()
    if not options.outlines.exists():
        record.write_stream(options.outlines)
    spark = session(options.master, options.partitions)
    outlines = spark.readStream.schema(OUTLINES).option("maxFilesPerTrigger", 1).parquet(str(options.outlines))
    stream = motions_of(outlines).writeStream.format("parquet").outputMode("append")
    stream = stream.option("path", str(options.motions)).option("checkpointLocation", f"{options.motions}.checkpoint")
    if options.once:
        stream = stream.trigger(availableNow=True)
    stream.start().awaitTermination()
    spark.read.parquet(str(options.motions)).sort("frame", "object", ascending=False).show(5)
    spark.stop()


if __name__ == "__main__":
    main()
