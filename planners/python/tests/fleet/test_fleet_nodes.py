# SPDX-License-Identifier: BSD-3-Clause
"""Campaigns with bad nodes: a node of another build, without the files, or with a fault of its own is set aside by name, its shards go to others, and
no row of it gets into the results."""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time

import pytest

import leeway
from conftest import FIRST
from fleet_processes import SMALL, command, files, start_scheduler, start_worker

if os.environ.get("LEEWAY_PYTHON_EXTRAS") != "required":
    for name in ("distributed", "pyarrow"):
        pytest.importorskip(name)
import pyarrow
import pyarrow.parquet

from leeway.fleet import FleetError, run, status, verify
from leeway.fleet.files import digest_of_file
from leeway.fleet.manifest import read_manifest, write_manifest

MANY = SMALL.replace("shard_rows = 512", "shard_rows = 64").replace("rows = 2000", "rows = 8000")  # 42 shards


@pytest.fixture(scope="module")
def expected(tmp_path_factory):
    folder = tmp_path_factory.mktemp("expected")
    (folder / "small.toml").write_text(MANY)
    assert run(folder / "small.toml", folder / "out", workers=0, quiet=True).complete
    return folder / "out"


class Machines:
    """A scheduler, and workers with the name of a machine and faults of their own."""

    def __init__(self, folder):
        self.folder = folder
        self.scheduler, self.address = start_scheduler(folder)
        self.processes = [self.scheduler]

    def start(self, node, fault="", package=None):
        """fault: lines of Python in the worker's process. package: the folder that holds its leeway."""
        (self.folder / f"preload_{node}.py").write_text(f"import os, pathlib, platform\nplatform.node = lambda: {node!r}\n{fault}\ndef dask_setup(worker):\n    pass\n")
        path = f"{package}:{self.folder}" if package else self.folder
        self.processes.append(start_worker(self.address, preload=f"preload_{node}", path=path))

    def ready(self, count):
        import distributed
        with distributed.Client(self.address) as client:
            client.wait_for_workers(count, timeout=60)

    def run(self, out, file, timeout=200):
        """(exit status, output)"""
        done = command("run", file, "--out", out, "--scheduler", self.address, "--quiet", stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        text, _ = done.communicate(timeout=timeout)
        return done.returncode, text


@pytest.fixture
def machines(tmp_path):
    made = Machines(tmp_path)
    yield made
    for process in reversed(made.processes):
        process.kill()
        process.wait()


@pytest.fixture
def many(tmp_path):
    file = tmp_path / "many.toml"
    file.write_text(MANY)
    return file


def other_build(folder, version=None):
    """A copy of the package that differs by a comment, and states this version."""
    package = pathlib.Path(leeway.__file__).parent
    shutil.copytree(package, folder / "leeway", ignore=shutil.ignore_patterns("__pycache__"))
    start = folder / "leeway" / "__init__.py"
    start.write_text((f"from . import _core\n_core.version = {version!r}\n" if version else "") + start.read_text() + "# another build\n")
    return folder


def test_a_worker_of_another_version_gets_no_work(expected, machines, many, tmp_path):
    machines.start("old", package=other_build(tmp_path / "other", "9.9.9"))
    machines.start("new")
    machines.ready(2)
    code, text = machines.run(tmp_path / "out", many)
    assert code == 0 and "42 of 42 shards" in text, text
    assert "on node old is set aside: it has leeway 9.9.9, module" in text and f"and the campaign leeway {leeway.__version__}, module" in text
    assert "install the same build there" in text and "node new" not in text
    assert files(tmp_path / "out") == files(expected) and verify(tmp_path / "out").sound


def test_a_campaign_with_workers_of_another_build_only_ends_and_says_why(machines, many, tmp_path):
    machines.start("a", package=other_build(tmp_path / "other"))
    machines.ready(1)
    code, text = machines.run(tmp_path / "out", many)
    assert code == 1 and "all nodes are set aside, 42 shards are missing" in text and "node a" in text and "; mend the nodes" in text, text
    assert "Traceback" not in text and not list((tmp_path / "out").rglob("*.parquet"))


BLIND = """
import builtins
def hidden(call):
    def opened(path, *arguments, **options):
        if "many.fleet" in str(path):
            raise FileNotFoundError(2, "No such file or directory", str(path))
        return call(path, *arguments, **options)
    return opened
os.open = hidden(os.open)
builtins.open = hidden(builtins.open)
"""


def test_a_node_without_the_folder_is_set_aside_and_ends_no_campaign(expected, machines, many, tmp_path):
    machines.start("blind", BLIND)
    machines.start("good")
    machines.ready(2)
    out = tmp_path / "many.fleet"
    code, text = machines.run(out, many)
    assert code == 0 and "42 of 42 shards" in text, text
    assert f"on node blind is set aside: {out / 'manifest.json'}: No such file or directory; let this node see the campaign's files" in text
    assert text.count("is set aside") == 1 and files(out) == files(expected)


def test_a_node_without_the_robot_is_set_aside(expected, machines, many, tmp_path):
    machines.start("blind", BLIND.replace("many.fleet", "arm.urdf"))
    machines.start("good")
    machines.ready(2)
    code, text = machines.run(tmp_path / "out", many)
    assert code == 0 and f"node blind is set aside: {FIRST}/arm.urdf: No such file or directory; let this node see" in text, text
    assert files(tmp_path / "out") == files(expected)


def test_a_bad_worker_that_joins_late_is_asked_too(expected, machines, tmp_path):
    big = tmp_path / "many.toml"
    big.write_text(MANY.replace("rows = 8000\n", "rows = 400000\n").replace("shard_rows = 64", "shard_rows = 8192"))
    machines.start("good")
    machines.ready(1)
    out = tmp_path / "many.fleet"
    done = command("run", big, "--out", out, "--scheduler", machines.address, "--quiet", stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    end = time.monotonic() + 100
    while not list(out.rglob("000000.parquet")) and time.monotonic() < end:
        time.sleep(0.05)
    machines.start("late", BLIND)
    text, _ = done.communicate(timeout=200)
    assert done.returncode == 0 and "node late is set aside" in text and verify(out).sound, text


FAILING = """
from leeway.fleet import shard
made = shard.make_rows
def make_rows(plan, worlds, piece):
    with open({log!r}, "a") as file:
        file.write(f"{{platform.node()}} {{piece.name}}\\n")
    if {which}:
        raise RuntimeError("a broken " + platform.node())
    return made(plan, worlds, piece)
shard.make_rows = make_rows
"""


def test_a_node_at_which_everything_fails_is_set_aside_after_two_shards(expected, machines, many, tmp_path):
    log = tmp_path / "log"
    machines.start("bad", FAILING.format(log=str(log), which="True"))
    machines.start("good")
    machines.ready(2)
    code, text = machines.run(tmp_path / "out", many)
    assert code == 0 and "42 of 42 shards" in text, text
    assert "node bad is set aside: 2 shards failed there and not at other nodes: a broken bad" in text and files(tmp_path / "out") == files(expected)


def test_a_shard_is_given_up_after_two_failures_at_different_nodes(machines, many, tmp_path):
    log = tmp_path / "log"
    for node in "ab":
        machines.start(node, FAILING.format(log=str(log), which="piece.name == '00-states-arm/000005.parquet'"))
    machines.ready(2)
    code, text = machines.run(tmp_path / "out", many)
    tries = [line.split()[0] for line in log.read_text().splitlines() if line.endswith("00-states-arm/000005.parquet")]
    assert code == 1 and sorted(tries) == ["a", "b"], (tries, text)
    assert "41 of 42 shards" in text and text.count("00-states-arm/000005.parquet: RuntimeError: a broken") == 1 and "set aside" not in text


def test_a_shard_of_a_campaign_with_one_node_is_given_up_at_once(machines, many, tmp_path):
    machines.start("a", FAILING.format(log=str(tmp_path / "log"), which="piece.index % 2"))
    machines.ready(1)
    code, text = machines.run(tmp_path / "out", many)
    assert code == 1 and "21 of 42 shards" in text and "and 16 other shards failed" in text and len((tmp_path / "log").read_text().splitlines()) == 42, text


def test_a_node_that_cannot_write_is_set_aside_and_the_others_go_on(expected, machines, many, tmp_path):
    machines.start("full", """
import errno
from leeway.fleet import shard
def full(descriptor):
    raise OSError(errno.EROFS, os.strerror(errno.EROFS))
shard.os.fsync = full
""")
    machines.start("good")
    machines.ready(2)
    code, text = machines.run(tmp_path / "out", many)
    assert code == 0 and "node full is set aside:" in text and "cannot be written: Read-only file system" in text, text
    assert files(tmp_path / "out") == files(expected)


def forged(folder, in_record, in_file):
    """A copy of the results in which shard 3 says another maker."""
    plan, records = read_manifest(folder)
    path = folder / records[3]["file"]
    if in_file:
        table = pyarrow.parquet.read_table(path)
        about = {**json.loads(table.schema.metadata[b"leeway"]), **in_file}
        pyarrow.parquet.write_table(table.replace_schema_metadata({"leeway": json.dumps(about)}), path)
    records[3].update(in_record, sha256=digest_of_file(path), bytes=path.stat().st_size)
    write_manifest(folder, plan, records)
    return records[3]["file"]


@pytest.mark.parametrize(("in_record", "in_file"), [({"leeway": "9.9.9"}, {}), ({"module": "0" * 64}, {}), ({}, {"leeway": "9.9.9"}), ({}, {"module": "0" * 64}),
    ({"leeway": "9.9.9", "module": "0" * 64}, {"leeway": "9.9.9", "module": "0" * 64})])
def test_a_shard_of_another_maker_is_named_by_verify(expected, tmp_path, in_record, in_file):
    out = tmp_path / "out"
    shutil.copytree(expected, out)
    name = forged(out, in_record, in_file)
    found = verify(out)
    assert not found.sound and list(found.faults) == [name] and "was made by leeway" in found.faults[name] and "module" in found.faults[name]


def test_a_file_of_another_maker_that_no_manifest_records_is_made_again(expected, tmp_path):
    (tmp_path / "small.toml").write_text(MANY)
    shutil.copytree(expected, tmp_path / "out")
    name = forged(tmp_path / "out", {}, {"module": "0" * 64})
    plan, records = read_manifest(tmp_path / "out")
    del records[3]
    write_manifest(tmp_path / "out", plan, records)
    assert run(tmp_path / "small.toml", tmp_path / "out", workers=0, quiet=True).made == 1 and files(tmp_path / "out") == files(expected), name


def test_results_of_another_build_are_refused(many, tmp_path):
    run(many, tmp_path / "out", workers=0, quiet=True)
    done = subprocess.run([sys.executable, "-m", "leeway.fleet", "run", many, "--out", tmp_path / "out", "--workers", "0"], capture_output=True, text=True, timeout=100,
        env={**os.environ, "PYTHONPATH": f"{other_build(tmp_path / 'other')}:{os.environ.get('PYTHONPATH', '')}"}, check=False)
    assert done.returncode == 2 and "plan.module: is of another build" in done.stderr and "; go on with that build, or give another --out" in done.stderr, done.stderr
    with pytest.raises(FleetError, match="campaign"):
        verify(tmp_path / "out", remake=1)


@pytest.mark.parametrize("moment", ["start", "work", "work, twice"])
def test_ctrl_c_in_a_terminal_ends_in_one_line(many, tmp_path, moment):
    """SIGINT to the whole process group, as a terminal sends it: to the client, both workers and their helpers."""
    big = tmp_path / "big.toml"
    big.write_text(MANY.replace("rows = 8000\n", "rows = 2000000\n").replace("shard_rows = 64", "shard_rows = 1024"))
    out = tmp_path / "out"
    process = command("run", big, "--out", out, "--workers", 2, "--quiet", stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)
    end = time.monotonic() + 100
    manifest, known = out / "manifest.json", '"sha256"' if moment != "start" else ""
    while time.monotonic() < end and not (manifest.exists() and known in manifest.read_text()):
        time.sleep(0.02)
    os.killpg(process.pid, signal.SIGINT)
    if moment.endswith("twice"):
        time.sleep(0.1)
        os.killpg(process.pid, signal.SIGINT)
    text, err = process.communicate(timeout=100)
    assert process.returncode == 130 and err == "interrupted; run the same command again, it goes on where it was\n" and not text, (process.returncode, text, err)
    if moment != "start":
        found = status(out)
        assert found.done >= 1 and not found.faults
    with pytest.raises(ProcessLookupError):  # nobody of the group is left
        for _ in range(200):
            os.killpg(process.pid, 0)
            time.sleep(0.05)
