"""Reads a run's Parquet files and a trace with pyarrow, pandas and DuckDB and compares what they see.

Usage: python3 tests/cli/read_parquet.py RUN_DIRECTORY TRACE.parquet
Needs the packages pyarrow, pandas and duckdb. Exits with an AssertionError on any difference.
"""

import json
import pathlib
import sys

import duckdb
import pandas
import pyarrow.parquet


def read(path):
    """One file by all three readers: the pyarrow file, and the table as pandas frames it."""
    file = pyarrow.parquet.ParquetFile(path)
    table = file.read()
    frame = pandas.read_parquet(path)
    relation = duckdb.sql(f"SELECT * FROM read_parquet('{path}')")
    queried = relation.df()
    assert list(frame.columns) == table.column_names == relation.columns, path
    assert len(frame) == table.num_rows == file.metadata.num_rows == len(queried), path
    # Bit for bit: pandas and DuckDB must not have converted anything on the way.
    pandas.testing.assert_frame_equal(frame, queried, check_dtype=False, check_exact=True)
    return file, frame


def main(run, trace):
    findings = json.loads((run / "findings.json").read_text(encoding="utf-8"))
    file, frame = read(run / "outcomes.parquet")
    samples = findings["method"]["samples"]
    assert len(frame) == samples, (len(frame), samples)
    assert frame["sample"].tolist() == list(range(samples))
    assert frame["sample"].dtype == "uint64"
    assert frame["deployed"].dtype == "bool"
    assert frame["fault"].isna().all()
    groups = [file.metadata.row_group(k).num_rows for k in range(file.metadata.num_row_groups)]
    assert groups == [min(65536, samples - start) for start in range(0, samples, 65536)], groups

    # The footer names the parents, and a unit for every column of numbers.
    footer = {key.decode(): value.decode() for key, value in file.metadata.metadata.items()}
    for key in ("version", "seed", "study_digest", "row_digest", "file_digests", "texts", "units"):
        assert f"reeldown.{key}" in footer, key
    units = json.loads(footer["reeldown.units"])
    numbers = [name for name in frame if frame[name].dtype == "float64"]
    assert set(numbers) == set(units), set(numbers) ^ set(units)
    assert footer["reeldown.study_digest"] == findings["reproduction"]["study_digest"]

    # Breaches counted in SQL and in pandas are the report's.
    any_breach = duckdb.sql(
        f"""SELECT count(*) FROM read_parquet('{run}/outcomes.parquet')
            WHERE time_margin_s < 0 OR final_velocity_margin_m_per_s < 0
               OR peak_fluid_temperature_margin_k < 0"""
    ).fetchall()[0][0]
    margins = [name for name in frame if "_margin_" in name]
    assert len(margins) == 3, margins
    assert (frame[margins] < 0).any(axis=1).sum() == any_breach
    counted = [p["counts"]["breaches"] for p in findings["probabilities"] if p["kind"] == "any"]
    assert counted == [any_breach], (counted, any_breach)

    # Means by pandas agree with the findings; two summation orders differ by about n eps.
    for outcome in findings["outcomes"]:
        mean = frame[outcome["column"]].mean()
        assert abs(mean / outcome["mean"] - 1) < samples * 2.3e-16, outcome["name"]

    _, indices = read(run / "sensitivity.parquet")
    assert {"first", "total", "shapley", "borgonovo_delta", "hsic", "prcc"} <= set(indices["index"])
    assert indices["estimate"].notna().any()
    assert (indices["lower_95"].notna() | indices["note"].notna()).all()
    assert {"breach.any", "time"} <= set(indices["output"])
    _, course = read(trace)
    assert course["time_s"].is_monotonic_increasing
    versions = (pyarrow.__version__, pandas.__version__, duckdb.__version__)
    print("read by pyarrow %s, pandas %s, DuckDB %s" % versions)


main(pathlib.Path(sys.argv[1]), sys.argv[2])
