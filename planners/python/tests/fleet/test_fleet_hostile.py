# SPDX-License-Identifier: BSD-3-Clause
"""Folders of results that somebody tampered with: nothing outside of them is read, written or deleted, nothing hangs, each fault is named.

Each case changes a whole folder by one class of damage; every command of leeway.fleet then runs on it.
"""
import os
import pathlib
import shutil
import subprocess
import sys

import pytest

if os.environ.get("LEEWAY_PYTHON_EXTRAS") != "required":
    for name in ("distributed", "pyarrow"):
        pytest.importorskip(name)
import pyarrow
import pyarrow.parquet

from fleet_damage import SHARD, check_cases, in_place_of, made, manifest_with, of_shard, part, record

assert made  # a fixture
FAKES = {"a pipe": os.mkfifo, "a device": lambda p: p.symlink_to("/dev/zero"), "a folder": pathlib.Path.mkdir, "a dangling link": lambda p: p.symlink_to("nowhere"),
    "empty": pathlib.Path.touch, "noise": lambda p: p.write_bytes(bytes(range(256)) * 9)}
ODD = {"a number": 7, "null": None, "a list": [], "true": True, "a NUL": "a\0b", "negative": -1, "huge": 10**9, "beyond int64": 2**63, "a fraction": 0.5, "a text": "x"}
CASES = {f"manifest.json is {name}": in_place_of("manifest.json", fake) for name, fake in FAKES.items()}
CASES |= {f"a shard is {name}": in_place_of(SHARD, fake) for name, fake in FAKES.items()}
CASES |= {f"file of a shard is {name}": record(file=value) for name, value in ODD.items()}
CASES |= {f"file of a shard is {name}": record(file=name) for name in ("../victim.txt", "../../victim.txt", "/etc/hostname", "", ".", "..", "00-states-arm/../../victim.txt", "manifest.json",
    "00-states-arm/000001.parquet", "00-states-arm//000000.parquet", "./00-states-arm/000000.parquet")}
CASES |= {f"{field} of a shard is {name}": record(**{field: value}) for field in ("index", "rows", "sha256", "content", "bytes") for name, value in ODD.items()
    if not (field == "bytes" and isinstance(value, int) and not isinstance(value, bool))}
CASES |= {f"{field} of a part is {name}": part(**{field: value}) for field in ("rows", "kind", "robot", "scenes", "options", "extra", "index") for name, value in ODD.items()
    if not (field in ("rows", "robot") and name in ("a number", "a text"))}
CASES |= {f"robot of a part is {name}": part(robot=name) for name in ("../..", "/tmp", "a/b", "")}
CASES |= {f"the shards are {name}": manifest_with(lambda m, value=value: m.update(shards=value)) for name, value in ODD.items()}
CASES |= {f"the plan is {name}": manifest_with(lambda m, value=value: m.update(plan=value)) for name, value in ODD.items()}
CASES |= {f"shard_rows is {name}": manifest_with(lambda m, value=value: m["plan"]["campaign"].update(shard_rows=value)) for name, value in ODD.items() if name not in ("a number", "huge", "beyond int64")}
CASES |= {
    "a shard is there twice": manifest_with(lambda m: m["shards"].append(m["shards"][0])),
    "the content is another": manifest_with(lambda m: m.update(content="0" * 64)),
    "a count of scenes is 1e18": part(scenes=[["", 10**18]]),
    "the plan was changed without its digest": lambda out: (out / "manifest.json").write_text((out / "manifest.json").read_text().replace('"seed": 5', '"seed": 6')),
    "the manifest is deeply nested": lambda out: (out / "manifest.json").write_text("[" * 200000),
    "the manifest is cut": lambda out: (out / "manifest.json").write_bytes((out / "manifest.json").read_bytes()[:700]),
    "a shard has another schema": of_shard(lambda path: pyarrow.parquet.write_table(pyarrow.table({"other": [1, 2]}), path)),
    "a folder of shards is a link": lambda out: (shutil.move(out / "00-states-arm", out.parent / "elsewhere"), (out / "00-states-arm").symlink_to(out.parent / "elsewhere")),
    "the lock is a pipe": in_place_of(".lock", os.mkfifo),
    "the lock is a link": in_place_of(".lock", lambda p: p.symlink_to("../victim.txt")),
    "runs.jsonl is a pipe": in_place_of("runs.jsonl", os.mkfifo),
    "runs.jsonl is a link": in_place_of("runs.jsonl", lambda p: p.symlink_to("../victim.txt")),
    "runs.jsonl is noise": in_place_of("runs.jsonl", lambda p: p.write_bytes(b"\xff{\n[1]\nnull\n")),
    "times are of another schema": in_place_of("01-plans-arm/_*.parquet", lambda p: pyarrow.parquet.write_table(pyarrow.table({"x": [1]}), p)),
    "times are a pipe": in_place_of("01-plans-arm/_*.parquet", os.mkfifo),
    "report.html is a link": lambda out: (out / "report.html").symlink_to("../victim.txt"),
}
HARMLESS = {"runs.jsonl is a pipe", "runs.jsonl is a link", "runs.jsonl is noise", "report.html is a link", "the lock is a link", "the lock is a pipe"}  # named on standard error at most
def test_there_are_many_cases():
    assert len(CASES) > 150


@pytest.mark.parametrize("chunk", range(4))
def test_tampered_folders_are_refused_and_nothing_outside_is_touched(made, tmp_path, chunk):
    check_cases(made, tmp_path, {name: CASES[name] for name in sorted(CASES)[chunk::4]}, HARMLESS)


@pytest.mark.parametrize("fake", sorted(FAKES.keys() - {"empty", "noise"}))
def test_a_campaign_that_is_no_regular_file_is_refused_and_not_waited_for(tmp_path, fake):
    FAKES[fake](tmp_path / "c.toml")
    done = subprocess.run([sys.executable, "-m", "leeway.fleet", "run", "c.toml", "--workers", "0"], cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 2 and "c.toml" in done.stderr and "; give the path" in done.stderr and "Traceback" not in done.stderr, done.stderr
