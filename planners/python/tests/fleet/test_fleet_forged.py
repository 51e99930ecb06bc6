# SPDX-License-Identifier: BSD-3-Clause
"""Folders of results by a forger who can compute hashes: tables of other schemas, counts beyond all memory, links, texts without end, numbers that are
none, keys that are there twice. Each is named, no command raises, hangs or touches a file outside."""
import json
import os
import pathlib
import struct

import numpy
import pytest

if os.environ.get("LEEWAY_PYTHON_EXTRAS") != "required":
    for name in ("distributed", "pyarrow", "pandas", "matplotlib"):
        pytest.importorskip(name)
import pyarrow
import pyarrow.parquet

from fleet_damage import SHARD, check_cases, in_place_of, made, manifest_with, of_shard, part, record
from leeway.fleet import report, status, verify

assert made  # a fixture
ROWS = 512


def table_with(change):
    """The first shard's table changed, its metadata kept."""
    def apply(path):
        table = pyarrow.parquet.read_table(path)
        about = table.schema.metadata
        pyarrow.parquet.write_table(change(table).replace_schema_metadata(about), path)
    return of_shard(apply)


def column(name, values):
    return table_with(lambda table: table.set_column(table.schema.get_field_index(name), name, values))


def numbers(name, place, value):
    """One number of a column is another."""
    def change(table):
        array = table.column(name).to_numpy().copy()
        array[place] = value
        return table.set_column(table.schema.get_field_index(name), table.schema.field(name), pyarrow.array(array))
    return table_with(change)


def text(change):
    def apply(out):
        path = out / "manifest.json"
        before = path.read_bytes()
        path.write_bytes(change(before))
        assert path.read_bytes() != before
    return apply


def varint(number):
    """Thrift's signed number."""
    number = (number << 1) ^ (number >> 63) if number < 0 else number << 1
    out = bytearray()
    number &= (1 << 64) - 1
    while number > 127:
        out.append(number & 127 | 128)
        number >>= 7
    return bytes(out + bytes([number]))


def count_in_footer(which, value):
    """The number of rows that the footer states, in one of the places where it does."""
    def apply(path):
        data = path.read_bytes()
        size = struct.unpack("<I", data[-8:-4])[0]
        body, footer = data[:-8 - size], data[-8 - size:-8]
        mark = b"\x16" + varint(ROWS)
        places = [i for i in range(len(footer)) if footer.startswith(mark, i)]
        i = places[which % len(places)]
        footer = footer[:i] + b"\x16" + varint(value) + footer[i + len(mark):]
        path.write_bytes(body + footer + struct.pack("<I", len(footer)) + b"PAR1")
    return of_shard(apply)


def link(target):
    def apply(out):
        (out / SHARD).unlink()
        (out / SHARD).symlink_to(target)
    return apply


LISTS = pyarrow.array([[1.0]] * ROWS)
OTHER_TYPES = {
    "texts": pyarrow.array(["a"] * ROWS), "large texts": pyarrow.array(["a"] * ROWS, pyarrow.large_string()), "bytes": pyarrow.array([b"\xff"] * ROWS), "half floats": pyarrow.array(numpy.ones(ROWS, "f2")),
    "decimals": pyarrow.array([1] * ROWS, pyarrow.decimal128(38, 5)), "times": pyarrow.array([0] * ROWS, pyarrow.timestamp("ns")), "nulls": pyarrow.nulls(ROWS),
    "structs": pyarrow.array([{"x": None}] * ROWS), "lists of lists": pyarrow.array([[[1.0, None], None]] * ROWS), "lists of nulls": pyarrow.array([[None]] * ROWS, pyarrow.list_(pyarrow.float64())),
    "null lists": pyarrow.array([None] * ROWS, pyarrow.list_(pyarrow.float64())), "maps": pyarrow.array([[("a", 1)]] * ROWS, pyarrow.map_(pyarrow.string(), pyarrow.int64())), "numbers and a null": pyarrow.array([1.0] * (ROWS - 1) + [None]),
    "bools": pyarrow.array([True] * ROWS), "lists": LISTS, "dictionaries of numbers": pyarrow.array([5] * ROWS).dictionary_encode(), "dictionaries": pyarrow.array(["x"] * ROWS).dictionary_encode(),
    "huge texts": pyarrow.array(["x" * 10_000_000] + ["y"] * (ROWS - 1)).dictionary_encode(), "intervals": pyarrow.array([(1, 2, 3)] * ROWS, pyarrow.month_day_nano_interval()) if False else pyarrow.array([1] * ROWS, pyarrow.duration("s")),
    "uint64 beyond": pyarrow.array([2**64 - 1] * ROWS, pyarrow.uint64()),
}
CASES = {f"lower of a shard is {name}": column("lower", values) for name, values in OTHER_TYPES.items() if name not in ("bools", "lists", "dictionaries")}
CASES |= {f"lower of a shard is {name}": column("lower", OTHER_TYPES[name]) for name in ("bools", "lists", "dictionaries")}
CASES |= {f"first of a shard is {name}": column("first", OTHER_TYPES[name]) for name in ("texts", "huge texts", "lists of nulls", "numbers and a null", "structs")}
CASES |= {
    "a shard has no columns": table_with(lambda t: t.select([])), "a shard lacks a column": table_with(lambda t: t.drop_columns(["lower"])), "a shard lacks its scenes": table_with(lambda t: t.drop_columns(["scene"])),
    "a shard has a column twice": table_with(lambda t: pyarrow.Table.from_arrays([*t.columns, t.column("lower")], names=[*t.column_names, "lower"])),
    "a shard has no rows": table_with(lambda t: t.slice(0, 0)), "a shard has a row less": table_with(lambda t: t.slice(0, ROWS - 1)), "a shard has its rows twice": table_with(lambda t: pyarrow.concat_tables([t, t])),
    "a shard has 20,000 columns": table_with(lambda t: pyarrow.table({f"c{k}": t.column("lower") for k in range(20000)})),
    "a shard has 2^24 values in lists": table_with(lambda t: t.append_column("wide", pyarrow.ListArray.from_arrays(pyarrow.array(numpy.linspace(0, 2**24, ROWS + 1).astype("i4")), pyarrow.array(numpy.zeros(2**24))))),
    "scene of a shard is beyond": numbers("scene", 3, 7), "scene of a shard is negative": numbers("scene", 0, -1), "scene of a shard is 2^31 - 1": numbers("scene", 9, 2**31 - 1),
}
COUNTS = {"2^63 - 1": 2**63 - 1, "-1": -1, "0": 0, "2^31": 2**31, "2^62": 2**62}
CASES |= {f"the footer of a shard says {name} rows, place {k}": count_in_footer(k, value) for k in (0, 1, -1, -2) for name, value in COUNTS.items()}
CASES |= {
    "metadata of a shard is missing": of_shard(lambda path: pyarrow.parquet.write_table(pyarrow.parquet.read_table(path).replace_schema_metadata({}), path)),
    "metadata of a shard is no JSON": of_shard(lambda path: pyarrow.parquet.write_table(pyarrow.parquet.read_table(path).replace_schema_metadata({"leeway": "{"}), path)),
    "metadata of a shard is nested": of_shard(lambda path: pyarrow.parquet.write_table(pyarrow.parquet.read_table(path).replace_schema_metadata({"leeway": "[" * 100000}), path)),
    "metadata of a shard is a list": of_shard(lambda path: pyarrow.parquet.write_table(pyarrow.parquet.read_table(path).replace_schema_metadata({"leeway": "[]"}), path)),
    "metadata of a shard is 30 MB": of_shard(lambda path: pyarrow.parquet.write_table(pyarrow.parquet.read_table(path).replace_schema_metadata({"leeway": json.dumps({"leeway": "x" * 30_000_000})}), path)),
    "a shard is the next one": of_shard(lambda path: path.write_bytes(path.with_name("000001.parquet").read_bytes())),
    "a shard is that of another part": of_shard(lambda path: path.write_bytes(next(path.parents[1].glob("01-*/000000.parquet")).read_bytes())),
    "a shard is the file of times": of_shard(lambda path: path.write_bytes(next(path.parents[1].glob("01-*/_*.parquet")).read_bytes())),
    "a shard is CSV": of_shard(lambda path: path.write_text("lower\n1\n")), "a shard is cut in its footer": of_shard(lambda path: path.write_bytes(path.read_bytes()[:-9] + b"PAR1")),
    "a shard is a link to the next one": link("000001.parquet"), "a shard is a link to itself": link("000000.parquet"), "a shard is a link outside": link("../../victim.txt"),
    "a shard is a link to a folder": link("/"), "a shard is a link to a socket's place": link("/proc/self/fd/0"), "a shard is a link to memory": link("/proc/self/mem"),
    "times are a link outside": in_place_of("01-plans-arm/_*.parquet", lambda p: p.symlink_to("../../victim.txt")), "times are a link to a device": in_place_of("01-plans-arm/_*.parquet", lambda p: p.symlink_to("/dev/urandom")),
}
KEYS = {"plan": b'"plan": {}, "plan"', "shards": b'"shards": [], "shards"', "seed": b'"seed": 7, "seed"', "sha256": b'"sha256": "0", "sha256"'}
CASES |= {f"the manifest has {key} twice": text(lambda data, key=key, value=value: data.replace(b'"' + key.encode() + b'"', value, 1)) for key, value in KEYS.items()}
NO_NUMBERS = {"NaN": b"NaN", "Infinity": b"Infinity", "-Infinity": b"-Infinity", "1e400": b"1e400", "5,000 digits": b"9" * 5000, "-0": b"-0", "5.0": b"5.0", "0x5": b"0x5", "05": b"05"}
CASES |= {f"seed of the manifest is {name}": text(lambda data, value=value: data.replace(b'"seed": 5', b'"seed": ' + value)) for name, value in NO_NUMBERS.items()}
CASES |= {f"bytes in the manifest is {name}": text(lambda data, value=value: data.replace(b'"bytes": ', b'"bytes": ' + value + b', "x": ', 1)) for name, value in NO_NUMBERS.items()}
CASES |= {
    "the manifest is UTF-16": text(lambda data: data.decode().encode("utf-16")), "the manifest has a mark of its byte order": text(lambda data: b"\xef\xbb\xbf" + data), "the manifest has a NUL": text(lambda data: data + b"\0"),
    "the manifest is there twice": text(lambda data: data + data), "the manifest has half a surrogate": manifest_with(lambda m: m["plan"]["campaign"].update(name="\ud800")),
    "the manifest has a name of 10 MB": manifest_with(lambda m: m["plan"]["campaign"].update(name="x" * 10_000_000)), "the manifest has options in 60 tables": part(options=json.loads('{"min_d":' * 30 + "1" + "}" * 30)),
    "the manifest has options without min_d": part(options={}), "the manifest has min_d of a list": part(options={"min_d": [1]}), "robot in the manifest has 10 MB": part(robot="x" * 10_000_000), "robot in the manifest has 300 letters": part(robot="x" * 300),
    "kind in the manifest has 10 MB": part(kind="x" * 10_000_000), "scenes in the manifest have 10 MB": part(scenes=[["x" * 10_000_000, 1]]), "scenes in the manifest are 10^6": part(scenes=[["", 1]] * 10**6), "scenes in the manifest are triples": part(scenes=[["", 1, 2]]),
    "leeway in the manifest is null": manifest_with(lambda m: m["plan"].update(leeway=None)), "module in the manifest is a list": manifest_with(lambda m: m["plan"].update(module=[])), "module in the manifest is missing": manifest_with(lambda m: m["plan"].pop("module")),
    "a maker in the manifest is a number": record(module=7), "a maker in the manifest is missing": manifest_with(lambda m: m["shards"][0].pop("leeway")), "a record in the manifest has more": record(more=1), "format in the manifest is true": manifest_with(lambda m: m["plan"].update(format=True)),
    "sha256 in the manifest has 10 MB": record(sha256="0" * 10_000_000), "sha256 in the manifest has capitals": record(sha256="A" * 64), "sha256 in the manifest has other digits": record(sha256="\u0660" * 64), "sha256 in the manifest has a line's end": record(sha256="0" * 64 + "\n"),
    "a maker of a shard is another": record(module="0" * 64), "a version of a shard is another": record(leeway="9.9.9"), "a version of a shard has 10 MB": record(leeway="9" * 10_000_000),
}
PARTS = {"a folder": pathlib.Path.mkdir, "a pipe": os.mkfifo, "a link outside": lambda p: p.symlink_to("../../victim.txt"), "a full folder": lambda p: (p.mkdir(), (p / "x").touch())}
CASES |= {f"half a shard is {name}": lambda out, make=make: make(out / "00-states-arm" / ".000009.parquet.1.part") for name, make in PARTS.items()}
CASES |= {
    "a folder of half shards is a link": lambda out: ((out.parent / "there").mkdir(), (out.parent / "there" / ".victim.part").write_text("keep me"), (out / "02-more").symlink_to("../there")),
    "folders are links in a circle": lambda out: (out / "00-states-arm" / "again").symlink_to(".."), "runs.jsonl is a folder": in_place_of("runs.jsonl", pathlib.Path.mkdir),
    "runs.jsonl has numbers that are none": in_place_of("runs.jsonl", lambda p: p.write_text('{"workers": NaN, "shards": 1e400, "rows": 1, "seconds": -5, "processor_seconds": 1}\n' + '{"workers": true, "shards": 1, "rows": 1e308, "seconds": 1e-308, "processor_seconds": 1e308}\n')),
    "runs.jsonl has a huge number": in_place_of("runs.jsonl", lambda p: p.write_text('{"workers": 1, "shards": 1, "rows": 1' + "0" * 4000 + ', "seconds": 1, "processor_seconds": 1}\n')),
    "runs.jsonl has 10^5 lines": in_place_of("runs.jsonl", lambda p: p.write_text("[" * 50 + "\n" * 100000)), "runs.jsonl is nested": in_place_of("runs.jsonl", lambda p: p.write_text("[" * 100000)),
    "report.html is a folder": lambda out: (out / "report.html").mkdir(), "report.html is a pipe": lambda out: os.mkfifo(out / "report.html"), "the lock is a folder": in_place_of(".lock", pathlib.Path.mkdir), "times are missing": in_place_of("01-plans-arm/_*.parquet", lambda p: None),
}
TOML = {"is nested": "x = " + "[" * 100000, "has deep keys": "a." * 3000 + "a = 1", "has inline tables in each other": "x = " + "{a=" * 5000, "has a key twice": 'name = "a"\nname = "b"', "has a table twice": "[robots.arm]\n[robots.arm]", "is UTF-16": None,
    "has a NUL": 'name = "a\0"', "has a seed of 5,000 digits": "seed = " + "9" * 5000, "has a seed of nan": 'name = "a"\nseed = nan', "has a name of 10 MB": 'name = "' + "x" * 10_000_000 + '"', "has 10^5 tables": "".join(f"[scenes.s{k}]\n" for k in range(100000)), "has times": "name = 2020-01-01T00:00:00Z",
    "is 20 MB": "#" * 20_000_000}
CASES |= {f"the campaign {name}": lambda out, text=text: (out.parent / "c.toml").write_bytes(text.encode() if text is not None else "name = 1".encode("utf-16")) for name, text in TOML.items()}
HARMLESS = {name for name in CASES if name.startswith(("half a shard", "runs.jsonl", "the campaign", "folders are links", "a folder of half", "the lock"))}
HARMLESS |= {"report.html is a pipe", "the manifest has a name of 10 MB",  # a name is long or short
    "the footer of a shard says 2^31 rows, place -1"}  # of a group of rows: pyarrow does not use it, and the rows have their digest


def test_there_are_many_more_cases():
    assert len(CASES) > 150


@pytest.mark.parametrize("chunk", range(6))
def test_forged_folders_are_refused_and_nothing_outside_is_touched(made, tmp_path, chunk):
    check_cases(made, tmp_path, {name: CASES[name] for name in sorted(CASES)[chunk::6]}, HARMLESS)


def test_a_missing_shard_is_named_by_all_commands(made, tmp_path):
    import shutil
    out = tmp_path / "out"
    shutil.copytree(made / "out", out)
    (out / SHARD).unlink()
    assert list(status(out).faults) == list(verify(out).faults) == list(report(out).faults) == [SHARD] and not status(out).complete and status(out, trust=True).complete
    manifest_with(lambda m: (m["shards"].pop(0), m.update(content=f"{sum(int(s['content'], 16) for s in m['shards']) % 2**256:064x}")))(out)
    for found in (status(out), verify(out), report(out)):
        assert found.missing == [SHARD] and f"{SHARD}: is missing" in repr(found)
