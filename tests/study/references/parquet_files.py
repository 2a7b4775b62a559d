"""Writes tests/study/parquet/: one table by pyarrow, in the ways in which Parquet files are written.

Sixty rows in three row groups. Column by column, for row k from 0: what `number_of` in tests/study/parquet_files.rs says;
columns that hold no numbers stand between them. Needs pyarrow 26.0.1 (any may do).
"""

import datetime
import decimal
import pathlib

import pyarrow as pa
import pyarrow.parquet as pq

ROWS = range(60)
UTC_DAY = datetime.date(2026, 11, 25)


def column(kind, value):
    return pa.array([value(k) for k in ROWS], type=kind)


TABLE = pa.table({
    "day": column(pa.date32(), lambda k: UTC_DAY + datetime.timedelta(days=k)),
    "double": column(pa.float64(), lambda k: 0.0015 + k * 1e-7),
    "single": column(pa.float32(), lambda k: k / 8),
    "half": column(pa.float16(), lambda k: (k - 30) / 4),
    "pair": column(pa.struct([("a", pa.int8()), ("b", pa.float64())]), lambda k: {"a": k, "b": None}),
    "int8": column(pa.int8(), lambda k: k - 30),
    "uint8": column(pa.uint8(), lambda k: 255 - k),
    "int16": column(pa.int16(), lambda k: -32768 + k),
    "int32": column(pa.int32(), lambda k: k * k - 7),
    "list": column(pa.list_(pa.float64()), lambda k: [1.0] * (k % 3)),
    "uint32": column(pa.uint32(), lambda k: 2**32 - 1 - k),
    "int64": column(pa.int64(), lambda k: (k - 30) * 10**12),
    "uint64": column(pa.uint64(), lambda k: 2**64 - 1 - k * 2**20),
    "text": column(pa.string(), lambda k: f"{k}.5"),
    "decimal": column(pa.decimal128(9, 4), lambda k: decimal.Decimal(620 + k) / 10000),
    "wide": column(pa.decimal128(38, 20), lambda k: decimal.Decimal(-3 * k) / 10**20),
    "missing": column(pa.float64(), lambda k: None if k % 7 == 3 else float(k)),
    "never": pa.nulls(60),
    "few": column(pa.float64(), lambda k: (k // 9) * 0.25),
    "flag": column(pa.bool_(), lambda k: k % 2 == 0),
    "clock": column(pa.timestamp("us"), lambda k: datetime.datetime(2026, 11, 25, 12, 0, k % 60)),
    "bytes": column(pa.binary(2), lambda k: b"ab"),
})
SPLIT = {"double": "BYTE_STREAM_SPLIT", "single": "BYTE_STREAM_SPLIT", "half": "BYTE_STREAM_SPLIT",
         "int8": "DELTA_BINARY_PACKED", "int16": "DELTA_BINARY_PACKED", "int32": "DELTA_BINARY_PACKED",
         "uint32": "DELTA_BINARY_PACKED", "int64": "DELTA_BINARY_PACKED", "uint64": "DELTA_BINARY_PACKED",
         "uint8": "DELTA_BINARY_PACKED", "flag": "RLE"}
WAYS = {
    "plain": dict(use_dictionary=False, compression="none"),
    "dictionary_snappy": dict(compression="snappy"),
    "dictionary_zstd_2": dict(compression="zstd", data_page_version="2.0"),
    "split_gzip": dict(use_dictionary=False, column_encoding=SPLIT, compression="gzip"),
    "split_brotli_2": dict(use_dictionary=False, column_encoding=SPLIT, compression="brotli",
                           data_page_version="2.0"),
    "decimal_lz4": dict(compression="lz4", store_decimal_as_integer=True, data_page_size=64),
}

home = pathlib.Path(__file__).parent.parent / "parquet"
for name, way in WAYS.items():
    pq.write_table(TABLE, home / f"{name}.parquet", row_group_size=25, write_statistics=False,
                   store_schema=name == "plain", **way)
