"""How every object of a large recording moves, found on a cluster with Dask.

    python examples/distributed/dask_batch.py outlines motions
    python examples/distributed/dask_batch.py outlines motions --scheduler tcp://10.0.0.1:8786

The first line starts two workers on this machine; if there is no folder `outlines`, it simulates a recording into it. The second one
uses a cluster that is running, with `freeform_motion` and `pyarrow` on every worker and both folders on a file system that all can see.

The recording is in *buckets*: `outlines/bucket=3/*.parquet` has all outlines of some of the objects, one row each. An object is followed
from its first frame to its last, so that objects are what can be spread, and a bucket is what one task reads. `record.py` shows how to
write buckets; with Spark, `write.partitionBy("bucket")` does.
"""

import argparse
import os
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
from dask.distributed import Client, as_completed

import freeform_motion as ff
import record

# ## One task
#
# A task reads one bucket, sorts its outlines by time, and writes one row for each object: the motion with its standard deviations. Its
# result appears under its name when it is whole. If a worker dies, Dask gives its tasks to another one; whether a task ran once, twice
# or one time and a half, the file in the end is the same to the last bit.


def identify_bucket(bucket: str, motions: str) -> int:
    """Writes the motions of the objects of a bucket; returns how many there are."""
    outlines = pq.read_table(bucket, partitioning=None).sort_by([("object", "ascending"), ("frame", "ascending")])
    found = pa.table(ff.identify(outlines, progress=False).table())
    path = Path(motions) / f"{Path(bucket).name}.parquet"
    unfinished = path.with_name(f".{path.name}.{os.getpid()}")
    pq.write_table(found, unfinished)
    os.replace(unfinished, path)
    return len(found)


# ## The whole recording
#
# Buckets whose results are there already are left out: the same command goes on after the whole cluster was switched off. A task that
# was on three workers when they died is given up with `KilledWorker`, since it may be what kills them; `allowed_failures` is that
# number. `ff.identify` uses all cores of its machine for the objects of a bucket, so one worker with one thread for each machine is right.


def identify_recording(client: Client, outlines: Path, motions: Path) -> None:
    """Writes the motions of all objects of a recording, bucket by bucket."""
    motions.mkdir(parents=True, exist_ok=True)
    buckets = sorted(outlines.glob("bucket=*"))
    left = [str(bucket) for bucket in buckets if not (motions / f"{bucket.name}.parquet").exists()]
    print(f"{len(left)} of {len(buckets)} buckets to do", flush=True)
    tasks = client.map(identify_bucket, left, motions=str(motions), pure=False)
    for done, task in enumerate(as_completed(tasks), 1):
        print(f"{done} of {len(left)}: {task.result()} objects", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description="Finds how every object of a recording moves, with Dask.")
    parser.add_argument("outlines", type=Path, help="folder of buckets; simulated if it is not there")
    parser.add_argument("motions", type=Path, help="folder for the results")
    parser.add_argument("--scheduler", help="address of a running cluster (default: workers on this machine)")
    parser.add_argument("--workers", type=int, default=2, help="workers on this machine")
    options = parser.parse_args()
    if not options.outlines.exists():
        record.write_buckets(options.outlines)
    here = {"n_workers": options.workers, "threads_per_worker": 1, "dashboard_address": None}
    with Client(**({"address": options.scheduler} if options.scheduler else here)) as client:
        identify_recording(client, options.outlines.resolve(), options.motions.resolve())
    print(pq.read_table(options.motions).select(["object", "omega", "omega_std"]).slice(0, 5).to_pandas())


if __name__ == "__main__":
    main()
