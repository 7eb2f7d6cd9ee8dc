"""Makes the Parquet files beside it, as pyarrow, pandas and polars write them: python make.py (pyarrow 26, pandas 3, polars 2)."""
import pathlib

import pandas as pd
import polars as pl
import pyarrow as pa
import pyarrow.parquet as pq

folder = pathlib.Path(__file__).parent
frame, time = [3, 4, 6], [0.0, 0.1, 0.3]
x = [[0.0, 2.0, 2.0, 0.0], [0.5, 2.5, 0.5], [1.0, 3.0, 3.0, 1.0]]
y = [[0.0, 0.0, 1.0, 1.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0]]
table = pa.table({"y": y, "x": x, "note": ["a", None, "b"], "time": time, "frame": frame, "object": ["left"] * 3})


def arrow(name, table, **options):
    pq.write_table(table, folder / f"{name}.parquet", store_schema=False, **options)


def but(**columns):
    changed = table
    for name, values in columns.items():
        values = values if isinstance(values, pa.Array) else pa.array(values)
        position = changed.schema.get_field_index(name)
        changed = changed.append_column(name, values) if position < 0 else changed.set_column(position, name, values)
    return changed


# Files that are read.
arrow("good-arrow", table, row_group_size=2)
arrow("good-gzip", table, compression="gzip", data_page_version="2.0")
arrow("good-zstd", table, compression="zstd", data_page_version="2.0", row_group_size=2)
arrow("good-types", but(x=pa.array(x, pa.large_list(pa.float32())), y=pa.array(y, pa.large_list(pa.int8())), frame=pa.array(frame, pa.uint8())))
arrow("good-floats", but(frame=[3.0, 4.0, 6.0], time=pa.array(time), object=pa.array(["left"] * 3).dictionary_encode()))
arrow("good-encodings", table, use_dictionary=False, compression="none",
      column_encoding={"frame": "PLAIN", "object": "PLAIN", "time": "BYTE_STREAM_SPLIT", "x.list.element": "BYTE_STREAM_SPLIT", "y.list.element": "PLAIN"})
arrow("bad-encoding", table, use_dictionary=False, column_encoding={"frame": "DELTA_BINARY_PACKED"})
arrow("good-shuffled", table.take([2, 0, 1]), row_group_size=1)
arrow("good-null-arcs", but(arc=pa.array([None] * 3, pa.list_(pa.int32())), contour=pa.nulls(3)))
frames = pd.DataFrame({"object": pd.Categorical(["left"] * 3), "frame": frame, "time": time, "x": x, "y": y})
frames.to_parquet(folder / "good-pandas.parquet")
points = frames.explode(["x", "y"]).astype({"x": float, "y": float, "object": str})
points.to_parquet(folder / "good-points.parquet", index=False)
pl.DataFrame({"object": ["left"] * 3, "frame": frame, "time": time, "x": x, "y": y}).with_columns(
    pl.col("object").cast(pl.Categorical), pl.col("frame").cast(pl.UInt32)
).write_parquet(folder / "good-polars.parquet", compression="zstd")

# Standard deviations of the points of the first and the last outline.
stated = [[0.125, 0.25, 0.5, 1.0], None, [0.0625, 0.125, 0.25, 0.5]]
with_them = but(deviation=stated)
arrow("deviations-arrow", with_them, row_group_size=2)
arrow("deviations-types", but(deviation=pa.array(stated, pa.large_list(pa.float32()))), compression="gzip", data_page_version="2.0")
arrow("deviations-shuffled", with_them.take([2, 0, 1]), row_group_size=1)
arrow("deviations-empty-list", but(deviation=[stated[0], [], stated[2]]), compression="zstd")
frames.assign(deviation=stated).to_parquet(folder / "deviations-pandas.parquet")
pl.DataFrame(with_them.drop_columns(["note"])).write_parquet(folder / "deviations-polars.parquet", compression="zstd")
by_point = [value for values, of in zip(stated, x) for value in values or [None] * len(of)]
points.assign(deviation=pd.array(by_point, dtype=float)).to_parquet(folder / "deviations-points.parquet", index=False)
pl.DataFrame(points.assign(deviation=by_point)).with_columns(pl.Series("deviation", by_point, strict=False)).write_parquet(folder / "deviations-points-polars.parquet")
arrow("no-deviations-null", but(deviation=pa.nulls(3)))
arrow("no-deviations-null-lists", but(deviation=pa.nulls(3, pa.list_(pa.float64()))))
arrow("no-deviations-empty-lists", but(deviation=[[], None, []]))
points.assign(deviation=None).to_parquet(folder / "no-deviations-null-points.parquet", index=False)

# Open outlines: two arcs of an outline in one row, and in two.
arrow("arcs-lists", pa.table({"frame": [0], "time": [0.0], "x": [[0.0, 1.0, 5.0, 5.0]], "y": [[0.0, 0.0, 1.0, 2.0]], "arc": [[0, 0, 1, 1]]}))
arrow("arcs-rows", pa.table({"frame": [0, 0], "time": [0.0, 0.0], "x": [[5.0, 5.0], [0.0, 1.0]], "y": [[1.0, 2.0], [0.0, 0.0]], "arc": [1, 0]}))

arcs = {"frame": [0, 0], "time": [0.0, 0.0], "x": [[0.0, 1.0], [5.0, 5.0]], "y": [[0.0, 0.0], [1.0, 2.0]], "arc": [0, 1]}
arrow("deviations-arcs-rows", pa.table({**arcs, "deviation": [[0.1, 0.2], [0.3, 0.4]]}).take([1, 0]))
arrow("deviations-arcs-lists", pa.table({"frame": [0], "time": [0.0], "x": [[0.0, 1.0, 5.0, 5.0]], "y": [[0.0, 0.0, 1.0, 2.0]], "arc": [[0, 0, 1, 1]],
                                         "deviation": [[0.1, 0.2, 0.3, 0.4]]}))

# Files that are refused.
arrow("bad-null-list", but(x=[x[0], None, x[2]]))
arrow("bad-null-value", but(y=[y[0], [0.0, None, 1.0], y[2]]))
arrow("bad-nan", but(x=[x[0], x[1], [1.0, float("nan"), 3.0, 1.0]]))
arrow("bad-length", but(y=[y[0], y[1][:2], y[2]]))
arrow("bad-text", but(x=[["0", "1", "2"]] * 3))
arrow("bad-struct", but(x=[{"a": 1.0, "b": 2.0}] * 3))
arrow("bad-nested", but(x=[[[1.0]]] * 3))
arrow("bad-time", but(time=pa.array([0, 1, 2], pa.timestamp("ms"))))
arrow("bad-frame", but(frame=[3, -4, 6]))
arrow("bad-frame-fraction", but(frame=[3.0, 4.5, 6.0]))
arrow("bad-null-frame", but(frame=pa.array([3, None, 6])))
arrow("bad-name", but(object=["left", None, "left"]))
arrow("bad-codec", table, compression="brotli")
arrow("bad-columns", table.drop_columns(["x", "time"]))
arrow("bad-twice", table.append_column("x", table["y"]))
arrow("bad-second", but(frame=[3, 4, 4], time=[0.0, 0.1, 0.1]))
arrow("bad-arc-length", but(arc=[None, [0, 0], None]))
arrow("bad-arc", but(arc=[0.5, 1.0, 2.0]))
arrow("bad-time-order", but(time=[0.0, 0.3, 0.1]))
arrow("bad-mixed-lists", but(y=[0.0, 1.0, 2.0]))
arrow("degenerate", but(x=[x[0], [], x[2]], y=[y[0], [], y[2]]))
for name, last in [("zero", [1.0, 0.0, 1.0, 1.0]), ("negative", [1.0, 1.0, 1.0, -0.5]), ("nan", [1.0, float("nan"), 1.0, 1.0]),
                   ("infinite", [1.0, float("inf"), 1.0, 1.0]), ("huge", [1.0, 1e101, 1.0, 1.0]), ("null-value", [1.0, None, 1.0, 1.0]),
                   ("short", [1.0] * 3), ("long", [1.0] * 5)]:
    arrow(f"bad-deviations-{name}", but(deviation=[stated[0], None, last]))
arrow("bad-deviations-text", but(deviation=[["0.1"] * 4, None, None]))
arrow("bad-deviations-one", but(deviation=[0.1, 0.2, 0.3]))
arrow("bad-deviations-nested", but(deviation=[[[0.1]]] * 3))
arrow("bad-deviations-some-arcs", pa.table({**arcs, "deviation": [[0.1, 0.2], None]}))
for name, values in [("zero", [1.0] * 5 + [0.0] * 6), ("nan", [1.0] * 5 + [float("nan")] * 6), ("list", [[1.0]] * 11), ("text", ["0.1"] * 11)]:
    arrow(f"bad-deviations-points-{name}", pa.table({**pa.Table.from_pandas(points, preserve_index=False).to_pydict(), "deviation": values}))
some = [1.0] * 5 + [None] + [1.0] * 5
arrow("bad-deviations-some-points", pa.table({**pa.Table.from_pandas(points, preserve_index=False).to_pydict(), "deviation": some}))
