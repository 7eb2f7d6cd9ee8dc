"""The examples give what one process gives, to the last bit, also where a worker or everything is killed in the middle.

Each test takes a minute on two cores, most of which is the start of processes. `.ci/distributed` runs them.
"""

import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import psutil
import pyarrow.parquet as pq
import pytest

import freeform_motion as ff

EXAMPLES = Path(__file__).parents[1]
sys.path.insert(0, str(EXAMPLES))
import record

OBJECTS, FRAMES, POINTS, BUCKETS = 400, 30, 100, 16
STREAMS = 12
PATIENCE = 600.0


class Run:
    """One of the examples, started by its command."""

    def __init__(self, log, script, *arguments):
        self.log = log
        with open(log, "w") as output:
            command = [sys.executable, str(EXAMPLES / script), *map(str, arguments)]
            self.process = subprocess.Popen(command, stdout=output, stderr=output, cwd=log.parent, start_new_session=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.kill("")

    def told(self):
        return self.log.read_text(errors="replace")

    def descendants(self, of):
        """Processes that the command started, directly or not, by a part of their command line."""
        return [p for p in psutil.Process(self.process.pid).children(recursive=True) if of in " ".join(cmdline(p))]

    def wait_for(self, condition):
        """Waits until something holds while the command still runs."""
        end = time.monotonic() + PATIENCE
        while not condition():
            assert self.process.poll() is None, f"ended too early:\n{self.told()[-3000:]}"
            assert time.monotonic() < end, f"takes too long:\n{self.told()[-3000:]}"
            time.sleep(0.02)

    def kill_one(self, of):
        """Ends one of several processes as a power failure does."""
        victims = self.descendants(of)
        assert len(victims) == 2, victims
        victims[0].send_signal(signal.SIGKILL)

    def kill(self, of):
        """Ends the command and all processes that it started."""
        if self.process.poll() is None:
            family = self.descendants(of)
            self.process.kill()
            for process in family:
                try:
                    process.kill()
                except psutil.NoSuchProcess:
                    pass
        self.process.wait()

    def finish(self):
        assert self.process.wait(timeout=PATIENCE) == 0, self.told()[-3000:]


def cmdline(process):
    try:
        return process.cmdline()
    except (psutil.NoSuchProcess, psutil.ZombieProcess):
        return []


def bits(table, columns):
    """Columns as what can be compared bit by bit, in the order of objects and frames."""
    order = np.lexsort([np.asarray(table[name]) for name in ("frame", "object") if name in table])
    sorted_columns = {name: np.asarray(table[name])[order] for name in columns}
    return {name: c.view(np.uint64) if c.dtype.kind == "f" else c for name, c in sorted_columns.items()}


def assert_same_bits(found, expected, columns):
    found, expected = bits(found, columns), bits(expected, columns)
    for name in columns:
        assert len(found[name]) == len(expected[name]), name
        assert np.array_equal(found[name], expected[name]), name


def columns_of(path):
    table = pq.read_table(path, partitioning=None)
    return {name: table[name].to_numpy() for name in table.column_names}


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    """A recording in buckets, as the examples read it."""
    folder = tmp_path_factory.mktemp("recording") / "outlines"
    record.write_buckets(folder, OBJECTS, FRAMES, POINTS, BUCKETS)
    return folder


@pytest.fixture(scope="module")
def expected():
    """The motions of the same objects, found in one process from arrays that were in no file."""
    outlines = (
        (row["object"], row["frame"], row["time"], ff.Outline(np.column_stack([row["x"], row["y"]])))
        for number in range(OBJECTS)
        for row in record.rows(number, FRAMES, POINTS)
    )
    return ff.identify(ff.outline_table(outlines), progress=False).table()


def test_dask_gives_the_bits_of_one_process_though_a_worker_is_killed(recording, expected, tmp_path):
    motions = tmp_path / "motions"
    with Run(tmp_path / "log", "dask_batch.py", recording, motions) as run:
        run.wait_for(lambda: len(list(motions.glob("*.parquet"))) >= 2)
        run.kill_one("multiprocessing.spawn import spawn_main")
        assert len(list(motions.glob("*.parquet"))) < BUCKETS, "the kill came too late"
        run.finish()
        assert "Restarting worker" in run.told()
    found = columns_of(motions)
    assert "v2_std" in expected
    assert_same_bits(found, expected, list(expected))


def test_dask_goes_on_after_everything_was_killed(recording, expected, tmp_path):
    motions = tmp_path / "motions"
    command = ("dask_batch.py", recording, motions)
    with Run(tmp_path / "log", *command) as run:
        run.wait_for(lambda: len(list(motions.glob("*.parquet"))) >= 2)
        run.kill("")
    done = {path: path.stat().st_mtime_ns for path in motions.glob("*.parquet")}
    assert len(done) < BUCKETS, "the kill came too late"
    with Run(tmp_path / "log", *command) as run:
        run.finish()
    assert all(path.stat().st_mtime_ns == when for path, when in done.items())
    assert_same_bits(columns_of(motions), expected, list(expected))


def test_a_spark_batch_gives_the_bits_of_one_process_though_a_worker_is_killed(recording, expected, tmp_path):
    motions = tmp_path / "motions"
    with Run(tmp_path / "log", "spark_batch.py", recording, motions, "--parts", BUCKETS) as run:
        run.wait_for(lambda: len(list(motions.glob("_temporary/0/task_*"))) >= 2)
        run.kill_one("CoarseGrainedExecutorBackend")
        run.finish()
        assert "Lost executor" in run.told()
    names = [name for name in columns_of(motions)]
    assert {"object", "omega", "omega_std", "b2_std", "frames"} <= set(names)
    assert_same_bits(columns_of(motions), expected, names)


@pytest.fixture(scope="module")
def live(tmp_path_factory):
    """A recording as a stream of files."""
    folder = tmp_path_factory.mktemp("live") / "outlines"
    record.write_stream(folder, STREAMS, FRAMES, POINTS, frames_per_file=5)
    return folder


@pytest.fixture(scope="module")
def expected_stream():
    """What one motion filter for each object says after each frame."""
    found = {name: [] for name in ("object", "frame", "omega", "omega_std")}
    for number in range(STREAMS):
        motion_filter = ff.MotionFilter()
        for row in record.rows(number, FRAMES, POINTS):
            motion_filter.step(row["time"], np.column_stack([row["x"], row["y"]]))
            omega = motion_filter.estimate["omega"] if motion_filter.estimate else None
            found["object"].append(row["object"])
            found["frame"].append(row["frame"])
            found["omega"].append(np.nan if omega is None else omega.value)
            found["omega_std"].append(np.nan if omega is None else omega.std)
    return found


@pytest.mark.parametrize("killed", ["worker", "everything"])
def test_a_spark_stream_goes_on_to_the_last_bit_after_a_kill(live, expected_stream, tmp_path, killed):
    motions, commits = tmp_path / "motions", tmp_path / "motions.checkpoint" / "commits"
    command = ("spark_stream.py", live, motions, "--once")
    files = len(list(live.glob("*.parquet")))
    with Run(tmp_path / "log", *command) as run:
        run.wait_for(lambda: (commits / "1").exists())
        if killed == "worker":
            run.kill_one("CoarseGrainedExecutorBackend")
        else:
            run.kill("")
        assert len(list(commits.glob("[0-9]*"))) < files, "the kill came too late"
        if killed == "worker":
            run.finish()
            assert "Lost executor" in run.told()
    if killed == "everything":
        with Run(tmp_path / "log-again", *command) as run:
            run.finish()
    assert_same_bits(committed(motions), expected_stream, list(expected_stream))


def committed(motions):
    """What Spark counts as written: files that its log names. Those of a task that was killed are not."""
    import json

    names = {
        Path(json.loads(line)["path"]).name
        for batch in (motions / "_spark_metadata").glob("[0-9]*")
        for line in batch.read_text().splitlines()[1:]
    }
    tables = [columns_of(motions / name) for name in sorted(names)]
    whole = {name: np.concatenate([table[name] for table in tables]) for name in tables[0]}
    assert whole["accepted"].all(), whole["reason"][~whole["accepted"]]
    # Missing numbers of Parquet come as NaN.
    return {**whole, "omega": whole["omega"].astype(float), "omega_std": whole["omega_std"].astype(float)}


def test_an_outline_that_cannot_be_used_is_a_row_with_the_reason():
    import pandas as pd
    import spark_stream

    rows = [{**row, "time": 0.0 if row["frame"] == 5 else row["time"]} for row in record.rows(0, 8, POINTS)]
    rows[6]["x"] = rows[6]["x"] * np.nan
    found = list(spark_stream.follow(ff.MotionFilter(), pd.DataFrame(rows)))
    assert [frame for frame, _, accepted, *_ in found if not accepted] == [5, 6]
    assert "after one at" in found[5][3] and found[6][3]
    assert found[7][2] and found[7][4] is not None
