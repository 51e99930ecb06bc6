# SPDX-License-Identifier: BSD-3-Clause
"""Folders of results that somebody tampered with: nothing outside of them is read, written or deleted, nothing hangs, each fault is named.

Each case changes a whole folder by one class of damage; every command of leeway.fleet then runs on it, many folders in one process. A minute
is a sign of life, not a measurement.
"""
import hashlib
import json
import os
import pathlib
import shutil
import subprocess
import sys

import pytest

from conftest import FIRST

if os.environ.get("LEEWAY_PYTHON_EXTRAS") != "required":
    for name in ("distributed", "pyarrow"):
        pytest.importorskip(name)
import pyarrow
import pyarrow.parquet

from leeway.fleet import run

CAMPAIGN = f"""
name = "small"
seed = 5
shard_rows = 512
[robots.arm]
urdf = "{FIRST}/arm.urdf"
srdf = "{FIRST}/arm.srdf"
group = "arm"
[[work]]
kind = "states"
rows = 1200
[[work]]
kind = "plans"
rows = 3
planners = [{{name = "leeway"}}]
"""
VICTIM = "keep me\n"


@pytest.fixture(scope="session")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("made")
    (folder / "c.toml").write_text(CAMPAIGN)
    assert run(folder / "c.toml", folder / "out", workers=0, quiet=True).complete
    return folder


def manifest_with(change):
    """The manifest changed as an object; digests that a forger can compute are right again."""
    def apply(out):
        path = out / "manifest.json"
        manifest = json.loads(path.read_text())
        change(manifest)
        plan = manifest["plan"]
        if isinstance(plan, dict):
            plan["id"] = hashlib.sha256(json.dumps({**plan, "id": ""}, sort_keys=True, separators=(",", ":")).encode()).hexdigest()
        path.write_text(json.dumps(manifest))
    return apply


def record(**values):
    return manifest_with(lambda m: m["shards"][0].update(values))


def part(**values):
    return manifest_with(lambda m: m["plan"]["parts"][0].update(values))


def in_place_of(name, make):
    def apply(out):
        path = next(out.glob(name))
        path.unlink() if not path.is_dir() else shutil.rmtree(path)
        make(path)
    return apply


def other_table(path):
    """Parquet with another schema, and a manifest that records its bytes."""
    out = path.parents[1]
    pyarrow.parquet.write_table(pyarrow.table({"other": [1, 2]}), path)
    manifest = json.loads((out / "manifest.json").read_text())
    data = path.read_bytes()
    manifest["shards"][0].update(sha256=hashlib.sha256(data).hexdigest(), bytes=len(data))
    (out / "manifest.json").write_text(json.dumps(manifest))


SHARD = "00-states-arm/000000.parquet"
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
    "a shard has another schema": in_place_of(SHARD, other_table),
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
PROBE = """
import contextlib, faulthandler, io, os, sys, traceback
from leeway.fleet.__main__ import main
for folder in sys.argv[1:]:
    os.chdir(folder)
    for arguments in (["status", "out"], ["verify", "out"], ["report", "out"], ["run", "c.toml", "--out", "out", "--workers", "0", "--quiet"]):
        out, err = io.StringIO(), io.StringIO()
        faulthandler.dump_traceback_later(60, exit=True)
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            try:
                status = main(arguments)
            except BaseException:
                status = "raised " + traceback.format_exc()
        faulthandler.cancel_dump_traceback_later()
        print(repr((folder, arguments[0], status, err.getvalue())), flush=True)
"""


def test_there_are_many_cases():
    assert len(CASES) > 150


def everything_outside(folder):
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file() and not path.is_symlink() and "out" not in path.parts}


@pytest.mark.parametrize("chunk", range(4))
def test_tampered_folders_are_refused_and_nothing_outside_is_touched(made, tmp_path, chunk):
    names = sorted(CASES)[chunk::4]
    folders = {str(tmp_path / f"case{i}"): name for i, name in enumerate(names)}
    before = {}
    for place, name in folders.items():
        folder = pathlib.Path(place)
        shutil.copytree(made, folder)
        (folder / "victim.txt").write_text(VICTIM)
        CASES[name](folder / "out")
        before[place] = everything_outside(folder)
    done = subprocess.run([sys.executable, "-c", PROBE, *folders], capture_output=True, text=True, timeout=600, check=False)
    answers = [eval(line) for line in done.stdout.splitlines()]  # of the probe above
    assert done.returncode == 0, (folders[answers[-1][0]] if answers else "", "hangs", done.stderr[-2000:])
    told = {name: {} for name in names}
    for place, command, status, err in answers:
        name = folders[place]
        assert status in (0, 1, 2), (name, command, status)
        assert status != 2 or "; " in err.splitlines()[-1], (name, command, err)
        told[name][command] = status
    for place, name in folders.items():
        assert everything_outside(pathlib.Path(place)) == before[place], f"{name}: a file outside was changed"
        assert name in HARMLESS or told[name]["verify"] or told[name]["report"], f"{name}: accepted"
        assert name in HARMLESS or "manifest" not in name or told[name]["status"] == 2, f"{name}: status says {told[name]['status']}"


@pytest.mark.parametrize("fake", sorted(FAKES.keys() - {"empty", "noise"}))
def test_a_campaign_that_is_no_regular_file_is_refused_and_not_waited_for(tmp_path, fake):
    FAKES[fake](tmp_path / "c.toml")
    done = subprocess.run([sys.executable, "-m", "leeway.fleet", "run", "c.toml", "--workers", "0"], cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 2 and "c.toml" in done.stderr and "; give the path" in done.stderr and "Traceback" not in done.stderr, done.stderr
