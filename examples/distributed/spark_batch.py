"""How every object of a large recording moves, found on a cluster with Spark.

    python examples/distributed/spark_batch.py outlines motions
    python examples/distributed/spark_batch.py outlines motions --master spark://10.0.0.1:7077

The first line starts a cluster of two workers on this machine; if there is no folder `outlines`, it simulates a recording into it. The
second one uses a cluster that is running, with `freeform_motion`, `pandas` and `pyarrow` for the Python of every worker.

The recording is Parquet with one row for each outline: `object`, `frame`, `time`, and the points along the contour as lists `x` and `y`.
In which files and in which order the rows are does not matter: Spark brings together those of an object.
"""

import argparse
import os
import sys
from pathlib import Path

import pyarrow as pa
from pyspark.sql import DataFrame, SparkSession

import freeform_motion as ff
import record

# ## One object
#
# `applyInArrow` hands all outlines of one object to a function as an Arrow table and takes one back, here of one row. A shuffle keeps no
# order, so the outlines are sorted by time first. Columns and their types have to be told to Spark beforehand.

MOTION = ("omega", "b1", "b2")
RESULT = {"object": "string", "frames": "long", "frames_rejected": "long"} | {
    column: "double" for name in MOTION for column in (name, f"{name}_std")
}


def identify_object(outlines: pa.Table) -> pa.Table:
    """The motion of one object, from all of its outlines."""
    found = ff.identify(outlines.sort_by("frame"), progress=False)
    return pa.table(found.table()).select(list(RESULT))


# ## All objects
#
# The work is following objects, not reading files, so there are as many parts as it takes for every core to have several: a dead worker
# then costs little. Spark gives its tasks to another one, and takes no row of a task that did not end.


def identify_recording(outlines: DataFrame, parts: int) -> DataFrame:
    """A table with the motion of every object."""
    schema = ", ".join(f"{name} {kind}" for name, kind in RESULT.items())
    return outlines.repartition(parts, "object").groupBy("object").applyInArrow(identify_object, schema)


# ## A cluster
#
# `local-cluster[2,1,1024]` are two workers of one core and 1024 MB each, in processes of their own on this machine: what runs there runs
# on a real cluster. Workers have to run the Python of the driver.


def session(master: str) -> SparkSession:
    """A session on a cluster."""
    os.environ.setdefault("PYSPARK_PYTHON", sys.executable)
    return SparkSession.builder.master(master).appName("freeform batch").config("spark.ui.enabled", "false").getOrCreate()


def main() -> None:
    parser = argparse.ArgumentParser(description="Finds how every object of a recording moves, with Spark.")
    parser.add_argument("outlines", type=Path, help="folder of Parquet files; simulated if it is not there")
    parser.add_argument("motions", help="folder for the results, as Parquet")
    parser.add_argument("--parts", type=int, default=8, help="parts that the objects are divided into")
    parser.add_argument("--master", default="local-cluster[2,1,1024]", help="the cluster (default: two workers on this machine)")
    options = parser.parse_args()
    if not options.outlines.exists():
        record.write_buckets(options.outlines)
    spark = session(options.master)
    recording = spark.read.option("recursiveFileLookup", "true").parquet(str(options.outlines))
    identify_recording(recording, options.parts).write.mode("overwrite").parquet(options.motions)
    spark.read.parquet(options.motions).select("object", "omega", "omega_std").sort("object").show(5)
    spark.stop()


if __name__ == "__main__":
    main()
