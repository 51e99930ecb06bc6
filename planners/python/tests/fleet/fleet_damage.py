# SPDX-License-Identifier: BSD-3-Clause
"""Damage to folders of results, and a probe that runs every command of leeway.fleet on them, many folders in one process.

With LEEWAY_GUARD (tests/guard) nothing may be written, made or removed but in the folders of results.

A command has ten seconds of processor time, and a minute of the clock: a blocked wait ends there, and a busy machine does not end anything.
"""
import functools
import hashlib
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import pytest

from conftest import FIRST
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


def of_shard(change):
    """change(path) of the first shard's file, and a manifest that records the new bytes: a forger can do so."""
    def apply(out):
        path = out / SHARD
        change(path)
        data = path.read_bytes()
        manifest_with(lambda m: m["shards"][0].update(sha256=hashlib.sha256(data).hexdigest(), bytes=len(data)))(out)
    return apply


SHARD = "00-states-arm/000000.parquet"
PROBE = """
import contextlib, faulthandler, io, os, signal, sys, traceback
from leeway.fleet.__main__ import main
for folder in sys.argv[1:]:
    os.chdir(folder)
    for arguments in (["status", "out"], ["verify", "out"], ["report", "out"], ["run", "c.toml", "--out", "out", "--workers", "0", "--quiet"]):
        print(folder, arguments[0], file=sys.stderr, flush=True)
        out, err = io.StringIO(), io.StringIO()
        faulthandler.dump_traceback_later(60, exit=True)
        signal.setitimer(signal.ITIMER_PROF, 10)
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            try:
                status = main(arguments)
            except BaseException:
                status = "raised " + traceback.format_exc()
        signal.setitimer(signal.ITIMER_PROF, 0)
        faulthandler.cancel_dump_traceback_later()
        print(repr((folder, arguments[0], status, err.getvalue())), flush=True)
"""


def everything_outside(folder):
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file() and not path.is_symlink() and "out" not in path.parts}


@functools.lru_cache
def font_list():
    """Reports are drawn by matplotlib: at first it runs fc-list and keeps the list of fonts in a folder of its own."""
    folder = tempfile.mkdtemp()
    subprocess.run([sys.executable, "-c", "import matplotlib.font_manager"], env={**os.environ, "MPLCONFIGDIR": folder}, check=True)
    return folder


def guarded(places, log):
    """Variables of a process that may write into these folders alone: as it is without the guard, which needs Linux."""
    library = os.environ.get("LEEWAY_GUARD")
    return {**os.environ, "LD_PRELOAD": library, "LEEWAY_GUARD_WRITES": ":".join(map(str, [*places, font_list()])), "LEEWAY_GUARD_LOG": str(log),
        "MPLCONFIGDIR": font_list()} if library else dict(os.environ)


def check_cases(made, tmp_path, cases, harmless):
    """Runs all commands on a folder of each case: name to a change of the results' folder. harmless: they need not be refused."""
    names = sorted(cases)
    folders = {str(tmp_path / f"case{i}"): name for i, name in enumerate(names)}
    before = {}
    for place, name in folders.items():
        folder = pathlib.Path(place)
        shutil.copytree(made, folder)
        (folder / "victim.txt").write_text(VICTIM)
        cases[name](folder / "out")
        before[place] = everything_outside(folder)
    log = tmp_path / "guard.log"
    done = subprocess.run([sys.executable, "-c", PROBE, *folders], capture_output=True, text=True, timeout=600, check=False,
        env=guarded([f"{place}/out" for place in folders], log))
    answers = [eval(line) for line in done.stdout.splitlines()]  # of the probe
    begun = [line for line in done.stderr.splitlines() if line.split(" ")[0] in folders]
    assert done.returncode == 0, ("ended there", folders[begun[-1].split(" ")[0]] if begun else "", done.returncode, done.stderr[-1500:])
    assert not log.exists(), log.read_text()
    told = {name: {} for name in names}
    for place, command, status, err in answers:
        name = folders[place]
        assert status in (0, 1, 2), (name, command, status)
        assert status != 2 or "; " in err.splitlines()[-1], (name, command, err)
        told[name][command] = status
    for place, name in folders.items():
        assert everything_outside(pathlib.Path(place)) == before[place], f"{name}: a file outside was changed"
        assert name in harmless or told[name]["verify"] or told[name]["report"], f"{name}: accepted"
        assert name in harmless or "manifest" not in name or told[name]["status"] == 2, f"{name}: status says {told[name]['status']}"
