# SPDX-License-Identifier: BSD-3-Clause
"""Rows of results: columns with units, digests that do not depend on how rows are cut into files, Parquet files with equal bytes.

The digest of a block of rows is the SHA-256 of its address and its columns. The digest of many blocks is the sum of theirs modulo 2^256:
any order, any cut into files gives the same. Sums find faults, not forgers.
"""
from __future__ import annotations

import hashlib
import json
from typing import Any, NamedTuple

import numpy
import pyarrow
import pyarrow.parquet

__all__ = ["Column", "Words", "add_digests", "block_digest", "concatenate", "columns_of", "content_of", "file_of", "read_rows", "table_of", "type_name"]

MODULUS = 1 << 256
MOST_BYTES, MOST_ROW = 1 << 26, 1 << 16  # of a shard, unpacked: so many, and so many for each row
MOST_TEXT = 1 << 16  # characters of a name


class Column(NamedTuple):
    name: str
    type: str  #: "double", "int32", "int64", "uint8", "bool", "string", "list"; list: of doubles
    unit: str  #: "m", "rad", "s", "1"; "" for names
    text: str


class Words(NamedTuple):
    """Strings by index into a list of names."""
    indices: numpy.ndarray
    names: list[str]

    def __len__(self) -> int:
        return len(self.indices)

    def __getitem__(self, rows: slice) -> "Words":
        return Words(self.indices[rows], self.names)

    def strings(self) -> list[str]:
        return numpy.asarray(self.names, object)[self.indices].tolist()


TYPES = {"double": pyarrow.float64(), "int32": pyarrow.int32(), "int64": pyarrow.int64(), "uint8": pyarrow.uint8(), "bool": pyarrow.bool_(),
    "string": pyarrow.dictionary(pyarrow.int32(), pyarrow.string()), "list": pyarrow.list_(pyarrow.float64())}
NUMPY = {"double": "<f8", "int32": "<i4", "int64": "<i8", "uint8": "u1", "bool": "?"}


def _bytes_of(column: Column, values: Any):
    """Bytes, or an array of them."""
    if column.type == "string":
        return "\n".join(values.strings()).encode()
    if column.type == "list":
        sizes = numpy.array([len(row) for row in values], "<i8")
        return sizes.tobytes() + b"".join(numpy.ascontiguousarray(row, "<f8").tobytes() for row in values)
    return numpy.ascontiguousarray(values, NUMPY[column.type]).view("u1")


def block_digest(address: str, columns: list[Column], values: dict[str, Any], rows: slice) -> int:
    """The number of a block of rows. address: part and block."""
    digest = hashlib.sha256(address.encode())
    for column in columns:
        part = _bytes_of(column, values[column.name][rows])
        digest.update(f"\n{column.name}:{column.type}:{len(part)}\n".encode())
        digest.update(part)
    return int.from_bytes(digest.digest(), "big")


def add_digests(numbers) -> str:
    """64 hexadecimal digits of the sum; of numbers or of such digits."""
    return f"{sum(int(n, 16) if isinstance(n, str) else n for n in numbers) % MODULUS:064x}"


def concatenate(columns: list[Column], pieces: list[dict[str, Any]]) -> dict[str, Any]:
    """One piece of several."""
    out = {}
    for column in columns:
        values = [piece[column.name] for piece in pieces]
        if column.type == "string":
            names: dict[str, int] = {}
            indices = []
            for words in values:
                place = numpy.array([names.setdefault(name, len(names)) for name in words.names], "<i4")
                indices.append(place[words.indices])
            out[column.name] = Words(numpy.concatenate(indices), list(names))
        elif column.type == "list":
            out[column.name] = [row for value in values for row in value]
        else:
            out[column.name] = numpy.concatenate(values)
    return out


def _compact(words: Words) -> Words:
    """The same strings; names in the order of their first use, and no others."""
    count = len(words.indices)
    first = numpy.full(len(words.names), count)
    first[words.indices[::-1]] = numpy.arange(count)[::-1]  # the last of equal indices stays, which is the first use
    order = numpy.argsort(first, kind="stable")[:numpy.count_nonzero(first < count)]
    rank = numpy.empty(len(words.names), "<i4")
    rank[order] = numpy.arange(len(order))
    return Words(rank[words.indices], [words.names[k] for k in order])


def _plain_array(type_of: pyarrow.DataType, *parts) -> pyarrow.Array:
    """An array around its buffers; pyarrow.array() would import pandas first."""
    count = len(parts[0]) if len(parts) == 1 else len(parts[0]) - 1
    bits = numpy.packbits(parts[0], bitorder="little") if pyarrow.types.is_boolean(type_of) else None
    buffers = [pyarrow.py_buffer(part) for part in ([bits] if bits is not None else parts)]
    return pyarrow.Array.from_buffers(type_of, count, [None, *buffers])


def _ends(sizes: list[int]) -> numpy.ndarray:
    return numpy.concatenate([[0], numpy.cumsum(sizes, dtype="<i8")]).astype("<i4")


def _array(column: Column, values: Any) -> pyarrow.Array:
    if column.type == "string":
        words = _compact(values)
        names = [name.encode() for name in words.names]
        return pyarrow.DictionaryArray.from_arrays(_plain_array(pyarrow.int32(), words.indices),
            _plain_array(pyarrow.string(), _ends([len(name) for name in names]), b"".join(names)))
    if column.type == "list":
        rows = [numpy.asarray(row, "<f8").ravel() for row in values]
        flat = _plain_array(pyarrow.float64(), numpy.concatenate([*rows, numpy.empty(0)]))
        return pyarrow.ListArray.from_arrays(_plain_array(pyarrow.int32(), _ends([len(row) for row in rows])), flat, TYPES["list"])
    return _plain_array(TYPES[column.type], numpy.ascontiguousarray(values, NUMPY[column.type]))


def table_of(columns: list[Column], values: dict[str, Any], metadata: dict[str, Any]) -> pyarrow.Table:
    """A table with units and descriptions of its columns, and metadata as JSON under the key "leeway"."""
    fields = [pyarrow.field(c.name, TYPES[c.type], False, {"unit": c.unit, "text": c.text}) for c in columns]
    schema = pyarrow.schema(fields, {"leeway": json.dumps(metadata, sort_keys=True)})
    return pyarrow.Table.from_arrays([_array(c, values[c.name]) for c in columns], schema=schema)


def file_of(table: pyarrow.Table) -> pyarrow.Buffer:
    """A Parquet file. Equal tables give equal bytes with one version of pyarrow: no dates, no choice by time."""
    words = [field.name for field in table.schema if pyarrow.types.is_dictionary(field.type)]
    out = pyarrow.BufferOutputStream()
    pyarrow.parquet.write_table(table, out, version="2.6", data_page_version="1.0", compression="zstd", compression_level=1,
        use_dictionary=words, write_statistics=True, row_group_size=1 << 18, use_deprecated_int96_timestamps=False)
    return out.getvalue()


def type_name(type_of: pyarrow.DataType) -> str:
    """Column.type of a column that table_of() made."""
    return next(name for name, known in TYPES.items() if known == type_of)


def read_rows(file, rows: int, columns: list[str] | None = None) -> pyarrow.Table:
    """The table of a file that file_of() wrote, with this many rows. Raises ValueError, KeyError, OSError or ArrowException for another one, before
    its pages are unpacked: a few bytes can promise any number of values."""
    opened = pyarrow.parquet.ParquetFile(file)
    about = opened.metadata
    if about.num_rows != rows:
        raise ValueError(f"has {about.num_rows} rows, and the shard has {rows}")
    names = [field.name for field in opened.schema_arrow]
    if len(set(names)) < len(names):
        raise ValueError("has a column twice")
    for field in opened.schema_arrow:
        if field.type not in TYPES.values():
            raise ValueError(f"column {field.name} has the type {field.type}")
    groups = [about.row_group(k) for k in range(about.num_row_groups)]
    values = sum(group.column(c).num_values for group in groups for c in range(about.num_columns))
    unpacked = sum(group.column(c).total_uncompressed_size for group in groups for c in range(about.num_columns))
    if not 0 <= max(8 * values, unpacked) <= MOST_BYTES + MOST_ROW * rows:
        raise ValueError(f"has {values} values of {unpacked} bytes in {rows} rows")
    table = opened.read(columns)
    if table.num_rows != rows or (columns is not None and table.column_names != columns):
        raise ValueError(f"has not the columns {', '.join(columns or names)} of {rows} rows")
    for name in table.column_names:
        _check_column(name, table.column(name))
    return table


def _check_column(name: str, column: pyarrow.ChunkedArray) -> None:
    for chunk in column.chunks:
        chunk.validate(full=True)
        if chunk.null_count or (pyarrow.types.is_list(chunk.type) and chunk.flatten().null_count):
            raise ValueError(f"column {name} has nulls")
        if pyarrow.types.is_dictionary(chunk.type) and max(map(len, chunk.dictionary.to_pylist()), default=0) > MOST_TEXT:
            raise ValueError(f"column {name} has a text of more than {MOST_TEXT} characters")


def columns_of(columns: list[Column], table: pyarrow.Table) -> dict[str, Any]:
    """The arrays of a table that table_of() made."""
    out: dict[str, Any] = {}
    for column in columns:
        chunk = table.column(column.name).combine_chunks()
        if column.type == "string":
            if isinstance(chunk, pyarrow.ChunkedArray):
                chunk = chunk.unify_dictionaries().combine_chunks() if chunk.num_chunks else pyarrow.array([], TYPES["string"])
            out[column.name] = Words(chunk.indices.to_numpy(zero_copy_only=False), chunk.dictionary.to_pylist())
        elif column.type == "list":
            out[column.name] = [numpy.asarray(row, "<f8") for row in chunk.to_pylist()]
        else:
            out[column.name] = chunk.to_numpy(zero_copy_only=False)
    return out


def content_of(address: str, columns: list[Column], values: dict[str, Any], blocks: list[tuple[int, slice]]) -> str:
    """The digest of blocks: (number, rows) of each."""
    return add_digests(block_digest(f"{address}/{number}", columns, values, rows) for number, rows in blocks)
