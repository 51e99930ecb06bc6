# SPDX-License-Identifier: BSD-3-Clause
"""Campaigns: equal bytes for any workers, shards and deaths; faults are found and mended; other manifests are refused."""
import contextlib
import errno
import json
import os
import pathlib
import signal
import subprocess
import sys
import threading
import time

import numpy
import pytest

import leeway
from conftest import FIRST, ROOT
from fleet_processes import SMALL, command, files, start_scheduler, start_worker

if os.environ.get("LEEWAY_PYTHON_EXTRAS") != "required":
    for name in ("distributed", "pyarrow"):
        pytest.importorskip(name)
import pyarrow.parquet

from leeway.fleet import FleetError, run, status, verify
from leeway.fleet import manifest, seeds, shard, tables
from leeway.fleet.files import digest_of_file
from leeway.fleet.plan import identity_of, shards_of

@pytest.fixture
def small(tmp_path):
    file = tmp_path / "small.toml"
    file.write_text(SMALL)
    return file


@pytest.fixture(scope="module")
def expected(tmp_path_factory):
    """The results of the small campaign, made in this process."""
    folder = tmp_path_factory.mktemp("expected")
    (folder / "small.toml").write_text(SMALL)
    found = run(folder / "small.toml", folder / "out", workers=0, quiet=True)
    assert found.complete and not found.failures
    return folder / "out"


def test_processes_give_the_bytes_of_one_process(small, expected, tmp_path):
    done = command("run", small, "--out", tmp_path / "out", "--workers", 2, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    out, err = done.communicate(timeout=200)
    assert done.returncode == 0, out + err
    assert "6 of 6 shards" in out and "us a row" in err and "left" in err
    assert files(tmp_path / "out") == files(expected)


@pytest.mark.parametrize("rows", [1, 300, 100000])
def test_shards_of_any_size_hold_the_same_rows(expected, tmp_path, rows):
    file = tmp_path / "other.toml"
    file.write_text(SMALL.replace("shard_rows = 512", f"shard_rows = {rows}").replace("rows = 2000", "rows = 700").replace("rows = 600", "rows = 90"))
    found = run(file, tmp_path / "out", workers=0, quiet=True)
    whole = tmp_path / "whole.toml"
    whole.write_text(file.read_text().replace(f"shard_rows = {rows}", "shard_rows = 513"))
    assert found.content == run(whole, tmp_path / "whole", workers=0, quiet=True).content
    table = pyarrow.parquet.read_table(tmp_path / "out" / "00-states-arm")
    same = pyarrow.parquet.read_table(expected / "00-states-arm").slice(0, 512)
    assert table.slice(0, 512).column("lower").combine_chunks().equals(same.column("lower").combine_chunks())


def test_rows_are_those_of_the_checker(expected, checker):
    table = pyarrow.parquet.read_table(expected / "00-states-arm")
    q = numpy.column_stack([table.column(f"q:{name}") for name in checker.variables])
    found = checker.clearance(q)
    assert (table.column("lower").to_numpy() == found.lower).all() and (table.column("upper").to_numpy() == found.upper).all()
    assert table.column("first").to_pylist() == checker.names[found.pairs[:, 0]].tolist()
    assert table.column("second").to_pylist() == checker.names[found.pairs[:, 1]].tolist()
    assert (q >= checker.lower).all() and (q <= checker.upper).all() and len(numpy.unique(q)) == q.size
    assert table.schema.field("lower").metadata[b"unit"] == b"m"
    assert json.loads(table.schema.metadata[b"leeway"])["leeway"] == leeway.__version__


def test_edges_are_labelled_and_audited(expected, checker):
    table = pyarrow.parquet.read_table(expected / "01-edges-arm").to_pandas()
    a, b = (table[[f"{end}:{name}" for name in checker.variables]].to_numpy() for end in "ab")
    assert (checker.edges(a, b).verdicts == table["verdict"]).all()
    looked = table[table["audited"]]
    assert 20 < len(looked) < 120 and not table["contradiction"].any()
    assert looked["least"].notna().all() and table[~table["audited"]]["least"].isna().all()
    free = looked[looked["verdict"] == int(leeway.Verdict.FREE)]
    assert len(free) and (free["least"] >= free["lower"]).all()


def test_looks_refute_a_wrong_verdict(checker, states):
    from leeway.fleet.looks import look_at_edges
    found = checker.edges(states[:-1], states[1:])
    chosen = numpy.arange(len(found.verdicts)) < 60
    lies = found._replace(verdicts=numpy.where(found.free, int(leeway.Verdict.BLOCKED), int(leeway.Verdict.FREE)).astype("u1"),
        lower=numpy.zeros(len(chosen)))
    _, honest = look_at_edges(checker, states[:-1], states[1:], found, chosen, 0.0, 1e-3, "both", 0.02)
    _, caught = look_at_edges(checker, states[:-1], states[1:], lies, chosen, 0.0, 1e-3, "both", 0.02)
    assert not honest.any() and caught[:60].all() and not caught[60:].any()


def test_numbers_of_rows_do_not_depend_on_other_rows():
    key = seeds.key_of(1, "a")
    whole = seeds.rows_of(key, 0, 100, 7)
    assert (seeds.rows_of(key, 37, 59, 7) == whole[37:59]).all() and whole.min() >= 0 and whole.max() < 1
    assert abs(seeds.rows_of(key, 0, 20000, 5).mean() - 0.5) < 0.01 and seeds.key_of(1, "a") != seeds.key_of(1, "b")


def test_the_death_of_a_worker_loses_nothing(expected, tmp_path):
    """The worker that makes the third shard kills itself, once."""
    import distributed
    file = tmp_path / "small.toml"
    file.write_text(SMALL)
    plugin = tmp_path / "deadly.py"
    plugin.write_text(f"""
import os, pathlib, signal
from leeway.fleet import shard
honest = shard.write_atomically
def deadly(path, data):
    token = pathlib.Path({str(tmp_path / 'token')!r})
    if path.name == "000002.parquet" and not token.exists():
        token.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    honest(path, data)
def dask_setup(worker):
    shard.write_atomically = deadly
""")
    env = {**os.environ, "PYTHONPATH": f"{tmp_path}:{os.environ.get('PYTHONPATH', '')}", "DASK_DISTRIBUTED__WORKER__PRELOAD": "deadly"}
    done = command("run", file, "--out", tmp_path / "out", "--workers", 2, "--quiet", env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    out, _ = done.communicate(timeout=200)
    assert (tmp_path / "token").exists() and done.returncode == 0, out
    assert files(tmp_path / "out") == files(expected) and distributed is not None


def test_a_worker_goes_on_while_it_writes(expected, tmp_path):
    """The first shard is written only when the rows of another one are there."""
    file = tmp_path / "small.toml"
    file.write_text(SMALL)
    (tmp_path / "slow.py").write_text(f"""
import pathlib, time
from leeway.fleet import shard
write, make, token = shard.write_atomically, shard.make_rows, pathlib.Path({str(tmp_path / 'token')!r})
def slow(path, data):
    if path.name == "000000.parquet" and "states" in path.parent.name:
        end = time.monotonic() + 60
        while not token.exists():
            assert time.monotonic() < end, "no other shard was made"
            time.sleep(0.01)
    write(path, data)
def make_rows(plan, worlds, piece):
    made = make(plan, worlds, piece)
    if piece.index:
        token.touch()
    return made
def dask_setup(worker):
    shard.write_atomically, shard.make_rows = slow, make_rows
""")
    env = {**os.environ, "PYTHONPATH": f"{tmp_path}:{os.environ.get('PYTHONPATH', '')}", "DASK_DISTRIBUTED__WORKER__PRELOAD": "slow"}
    done = command("run", file, "--out", tmp_path / "out", "--workers", 1, "--quiet", env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    out, _ = done.communicate(timeout=200)
    assert done.returncode == 0 and files(tmp_path / "out") == files(expected), out


@pytest.fixture
def cluster(tmp_path):
    """A scheduler and a worker as on other machines: (address, processes)."""
    scheduler, address = start_scheduler(tmp_path)
    worker = start_worker(address)
    yield address, scheduler, worker
    for process in (worker, scheduler):
        process.kill()
        process.wait()


def test_a_scheduler_of_ones_own_does_the_work(expected, small, tmp_path, cluster):
    done = command("run", small, "--out", tmp_path / "out", "--scheduler", cluster[0], "--quiet", stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    out, _ = done.communicate(timeout=200)
    assert done.returncode == 0, out
    assert files(tmp_path / "out") == files(expected)


def test_workers_that_join_late_get_work(expected, small, tmp_path):
    """A scheduler without a worker is waited for; two workers by hand come later, one with two threads."""
    scheduler, address = start_scheduler(tmp_path)
    run_ = command("run", small, "--out", tmp_path / "out", "--scheduler", address, "--quiet", stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    told = run_.stderr.readline()
    workers = [start_worker(address, threads) for threads in (1, 2)]
    out, err = run_.communicate(timeout=200)
    for process in (*workers, scheduler):
        process.kill()
        process.wait()
    assert "has no workers yet" in told and run_.returncode == 0, told + out + err
    assert files(tmp_path / "out") == files(expected)


def test_workers_and_schedulers_that_cannot_be_are_refused(small, tmp_path):
    for options, message in (({"workers": -3}, "workers: is -3; give a whole number from 0"), ({"scheduler": "nonsense"}, "nonsense: cannot be reached.*address that dask scheduler prints")):
        with pytest.raises(ValueError, match=message):
            run(small, tmp_path / "out", quiet=True, **options)
    (tmp_path / "file").write_text("")
    with pytest.raises(FleetError, match="file: cannot hold results: .*; give another --out"):
        run(small, tmp_path / "file", workers=0, quiet=True)


def test_the_death_of_a_scheduler_is_told_and_loses_nothing(expected, small, tmp_path, cluster):
    big = tmp_path / "big.toml"
    big.write_text(SMALL.replace("rows = 2000\n", "rows = 2000000\n"))
    done = command("run", big, "--out", tmp_path / "big", "--scheduler", cluster[0], "--quiet", stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    for _ in range(400):  # a file that has no record yet does not count as done
        with contextlib.suppress(FleetError):
            if status(tmp_path / "big").done >= 1:
                break
        time.sleep(0.5)
    cluster[1].kill()
    out, _ = done.communicate(timeout=280)
    assert done.returncode in (1, 2) and ("the connection is lost" in out or "goes on where it was" in out), out
    assert status(tmp_path / "big").done >= 1


@pytest.mark.parametrize("delay", [2.0, 3.5])
def test_a_killed_run_goes_on_with_the_same_bytes(expected, small, tmp_path, delay):
    first = command("run", small, "--out", tmp_path / "out", "--workers", 1, "--quiet", stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    threading.Timer(delay, first.kill).start()
    first.wait(timeout=200)
    for _ in range(100):  # its worker notices
        try:
            found = run(small, tmp_path / "out", workers=0, quiet=True)
            break
        except FleetError:
            time.sleep(0.1)
    assert found.complete and files(tmp_path / "out") == files(expected)


def test_files_that_no_manifest_records_are_taken_over(expected, small, tmp_path):
    out = tmp_path / "out"
    run(small, out, workers=0, quiet=True)
    plan, records = manifest.read_manifest(out)
    before = {path: path.stat().st_mtime_ns for path in out.rglob("*.parquet")}
    manifest.write_manifest(out, plan, {0: records[0]})
    victim = out / records[1]["file"]
    other = out / records[2]["file"]
    victim.write_bytes(other.read_bytes())  # a whole file, of another shard
    assert run(small, out, workers=0, quiet=True).complete and files(out) == files(expected)
    kept = [path for path, time_ns in before.items() if path.stat().st_mtime_ns == time_ns]
    assert len(kept) == 5 and victim not in kept


def test_corrupt_shards_are_found_and_made_again(expected, small, tmp_path, capsys):
    out = tmp_path / "out"
    run(small, out, workers=0, quiet=True)
    _, records = manifest.read_manifest(out)
    flipped, cut, gone = (out / records[i]["file"] for i in (0, 2, 5))
    data = bytearray(flipped.read_bytes())
    data[len(data) // 2] ^= 1
    flipped.write_bytes(data)
    cut.write_bytes(cut.read_bytes()[:100])
    gone.unlink()
    found = verify(out)
    assert not found.sound and set(found.faults) == {records[i]["file"] for i in (0, 2, 5)}
    again = run(small, out, workers=0, quiet=True)
    assert again.made == 3 and files(out) == files(expected) and verify(out, small, remake=2).sound
    assert "made again" in capsys.readouterr().err


def test_rows_made_again_are_compared(small, tmp_path):
    out = tmp_path / "out"
    run(small, out, workers=0, quiet=True)
    plan, records = manifest.read_manifest(out)
    path = out / records[0]["file"]
    table = pyarrow.parquet.read_table(path)
    lie = table.set_column(table.schema.get_field_index("lower"), table.schema.field("lower"), pyarrow.array(table.column("lower").to_numpy() + 1))
    path.write_bytes(tables.file_of(lie))
    records[0]["sha256"] = digest_of_file(path)
    manifest.write_manifest(out, plan, records)
    assert verify(out).faults == {records[0]["file"]: "has other rows than the recorded ones"}
    about = json.loads(lie.schema.metadata[b"leeway"])
    records[0]["content"] = about["content"] = shard.content_of_file(path, shards_of(plan)[0])  # a forger can compute it
    path.write_bytes(tables.file_of(lie.replace_schema_metadata({"leeway": json.dumps(about)})))
    records[0]["sha256"] = digest_of_file(path)
    manifest.write_manifest(out, plan, records)
    assert verify(out).sound and verify(out, small, remake=6).different == [records[0]["file"]]


def test_other_manifests_are_refused_with_a_remedy(small, tmp_path):
    out = tmp_path / "out"
    run(small, out, workers=0, quiet=True)
    path = out / "manifest.json"
    good = path.read_text()
    path.write_text(good.replace('"format": 3', '"format": 99'))
    with pytest.raises(FleetError, match="is 99, and this version of leeway knows 3; go on with leeway"):
        run(small, out, workers=0, quiet=True)
    path.write_text(good)
    _, records = manifest.read_manifest(out)
    plan = {**json.loads(good)["plan"], "leeway": "9.9.9"}
    manifest.write_manifest(out, {**plan, "id": identity_of(plan)}, records)
    with pytest.raises(FleetError, match="is 9.9.9.*go on with leeway 9.9.9, or give another --out"):
        run(small, out, workers=0, quiet=True)
    path.write_text(good[:100])
    with pytest.raises(FleetError, match="is no manifest.*move it away"):
        status(out)
    path.write_text(good)
    small.write_text(SMALL.replace("seed = 5", "seed = 6"))
    with pytest.raises(FleetError, match=r"another campaign, campaign.seed: 5 there, 6 now; give another --out"):
        run(small, out, workers=0, quiet=True)


def test_two_runs_in_one_folder_are_refused(small, tmp_path):
    with manifest.locked(tmp_path / "out"), pytest.raises(FleetError, match="another run works in this folder"):
        run(small, tmp_path / "out", workers=0, quiet=True)


def test_a_full_disk_loses_nothing(expected, small, tmp_path, monkeypatch):
    out, count, fsync = tmp_path / "out", [0], os.fsync

    def full(descriptor):
        count[0] += 1
        if count[0] == 7:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        fsync(descriptor)

    monkeypatch.setattr(shard.os, "fsync", full)
    found = run(small, out, workers=0, quiet=True)
    assert not found.complete and found.made >= 1 and "No space left on device; make room" in found.failures[0]
    assert not list(out.rglob(".*.part"))
    monkeypatch.undo()
    assert run(small, out, workers=0, quiet=True).complete and files(out) == files(expected)


def test_dry_runs_estimate_and_write_nothing(small, tmp_path):
    found = run(small, tmp_path / "out", dry_run=True)
    assert found.rows == [2000, 600] and found.shards == 6 and 0 < found.seconds < 100 and 50000 < found.bytes < 5000000
    assert not (tmp_path / "out").exists() and "MB" in repr(found)


def test_the_example_is_a_campaign(tmp_path):
    found = run(ROOT / "examples" / "python" / "campaign.toml", tmp_path / "out", dry_run=True)
    assert found.rows == [60000, 12000, 200] and found.seconds > 0


MISTAKES = {
    'kind = "states"': ('kind = "stats"', r"work\[0\].kind: is 'stats'; give one of states, edges"),
    "rows = 2000": ("rows = 0", r"work\[0\].rows: is 0; give at least 1"),
    "audit = 0.1": ("audits = 0.1", r"work\[1\].audits: is no known entry; known are"),
    "seed = 5": ('seed = "5"', "seed: is '5'; give a whole number"),
    'scenes = ["desk"]\nrows = 2000\n': ('rows = 2000\n', r"work\[0\].scenes: is missing, and the campaign has desk.*name the scenes"),
    'scenes = ["desk"]\nrows = 2000': ('scenes = ["table"]\nrows = 2000', r"work\[0\].scenes: names 'table'.*it has desk"),
    "[robots.arm]": ("[robots.arm", "TOML"),
    f'file = "{FIRST}/scene.yaml"': ('count = 3', "has both or none of file and generator"),
    f'urdf = "{FIRST}/arm.urdf"': ('urdf = "none.urdf"', r"none.urdf: No such file or directory; correct the path"),
    f'srdf = "{FIRST}/arm.srdf"': ('srdf = 3', "robots.arm.srdf: is 3; give text in quotes"),
    "audit_step = 0.05": ("audit_step = inf", r"work\[1\].audit_step: is inf; give a number"),
    "rows = 600": ("rows = 600\nslack = 0", r"work\[1\].slack: is 0; give at least 1e-09"),
    'kind = "edges"': ('kind = "edges"\nrobots = ["arm", "arm"]', "names 'arm' twice"),
}
OF_ROBOT = {'group = "leg"': r"small.toml: robots.arm.group: is 'leg'; the SRDF has arm, gripper; give one of its groups, or leave the entry out",
    'group = "arm"\nreference = {yaw = "a"}': "robots.arm.reference.yaw: is 'a'; give a number",
    'group = "arm"\nreference = {yawn = 1}': "robots.arm.reference.yawn: is no variable of the robot; give some of yaw",
    'group = "arm"\npackages = [1]': r"robots.arm.packages\[0\]: is 1; give text in quotes",
    f'group = "arm"\n[robots."../arm"]\nurdf = "{FIRST}/arm.urdf"': r"\.\./arm: is no name of a robot"}


@pytest.mark.parametrize(("place", "wrong", "message"), [(place, *pair) for place, pair in MISTAKES.items()] + [('group = "arm"', *pair) for pair in OF_ROBOT.items()])
def test_mistakes_in_campaigns_are_located(small, tmp_path, place, wrong, message):
    assert place in SMALL
    small.write_text(SMALL.replace(place, wrong))
    with pytest.raises(FleetError, match=message):
        run(small, tmp_path / "out", workers=0, quiet=True)
    assert not (tmp_path / "out").exists()


def test_status_and_exit_codes(small, tmp_path, expected):
    for arguments, code in ((["status", expected], 0), (["verify", expected], 0), (["status", tmp_path / "none"], 2), (["run", tmp_path / "none.toml"], 2)):
        done = command(*arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        out, err = done.communicate(timeout=100)
        assert done.returncode == code, out + err
        assert (out if code == 0 else err).strip()


def test_ctrl_c_keeps_finished_shards(small, tmp_path):
    big = tmp_path / "big.toml"
    big.write_text(SMALL.replace("rows = 2000", "rows = 2000000"))
    first = command("run", big, "--out", tmp_path / "out", "--workers", 1, "--quiet", stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler))
    for _ in range(2000):
        if list((tmp_path / "out").rglob("00000[5-9].parquet")):
            break
        time.sleep(0.1)
    first.send_signal(signal.SIGINT)
    assert first.wait(timeout=200) != 0
    assert status(tmp_path / "out").done >= 1
