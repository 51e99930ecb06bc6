# SPDX-License-Identifier: BSD-3-Clause
"""Audits of a table: each row has the scene and the start that it names, and no other."""
import json
import os
import shutil

import numpy
import pytest

import leeway
from conftest import FIRST

if os.environ.get("LEEWAY_PYTHON_EXTRAS") != "required":
    for name in ("distributed", "pyarrow", "pandas"):
        pytest.importorskip(name)
import pyarrow
import pyarrow.parquet

from leeway.fleet import FleetError, run, verify
from leeway.fleet.manifest import read_manifest
from leeway.fleet.plan import parts_of
from leeway.fleet.reporting import frame_of, report

CAMPAIGN = f"""
name = "audits"
[robots.arm]
urdf = "{FIRST}/arm.urdf"
srdf = "{FIRST}/arm.srdf"
group = "arm"
[scenes.desk]
file = "{FIRST}/scene.yaml"
[scenes.shelves]
generator = "shelves"
count = 3
[[work]]
kind = "audit"
table = "table.csv"
"""
GRIP = 0.03


@pytest.fixture
def folder(tmp_path, checker, robot, states):
    """A campaign with three paths; two are in one file."""
    free = states[checker.is_free(states, min_d=0.01)]
    blocked = states[~checker.is_free(states)]
    numpy.savez(tmp_path / "two.npz", good=checker.plan(free[0], free[1]).path, bad=numpy.array([free[0], blocked[0], free[1]]))
    numpy.save(tmp_path / "one.npy", free[:3])
    shutil.copy(FIRST / "scene.yaml", tmp_path / "own scene.yaml")
    wide = float(robot.upper[robot.variables.index("grip")])
    (tmp_path / "start.json").write_text(json.dumps({"start_state": {"joint_state": {"name": [*checker.variables, "grip"], "position": [*free[0].tolist(), wide]}}}))
    (tmp_path / "c.toml").write_text(CAMPAIGN)
    return tmp_path


def audited(folder, table, name="table.csv"):
    """The frame of a table's rows."""
    if isinstance(table, str):
        (folder / name).write_text(table)
    out = folder / "out"
    found = run(folder / "c.toml", out, workers=0, quiet=True)
    assert found.complete, found
    return frame_of(out, parts_of(read_manifest(out)[0])[0])


def test_each_row_has_its_own_scene_and_start(folder, checker, robot, scene):
    frame = audited(folder, "path,scene,start,name\ntwo.npz,desk,,good\ntwo.npz,desk,,bad\ntwo.npz,,,bad\none.npy,shelves/2,,\none.npy,own scene.yaml,start.json,\ntwo.npz,desk,start.json,\n")
    assert frame["scene"].tolist() == ["desk", "desk", "", "shelves/2", "own scene.yaml", "desk", "desk"]
    assert frame["path"].tolist() == ["good", "bad", "bad", "", "", "good", "bad"] and frame["start"].tolist() == [""] * 4 + ["start.json"] * 3
    assert frame["verdict"][0] == int(leeway.Verdict.FREE) and frame["verdict"][1] == int(leeway.Verdict.BLOCKED)
    two = numpy.load(folder / "two.npz")
    assert frame["least"][1] <= 0 or frame["lower"][1] == 0
    wide = {"grip": float(robot.upper[robot.variables.index("grip")])}
    own = leeway.Checker(robot, scene, group="arm", reference=wide)
    for row, path, judge in ((0, two["good"], checker), (1, two["bad"], checker), (2, two["bad"], leeway.Checker(robot, group="arm")), (4, numpy.load(folder / "one.npy"), own), (5, two["good"], own)):
        found = judge.path(path, slack=1e-4)
        expected = float(found.lower.min()) if found.all_free else 0.0
        assert frame["lower"][row] == expected and (frame["verdict"][row] == int(leeway.Verdict.FREE)) == found.all_free, row
    assert numpy.isnan(frame["start_gap"][:4]).all() and (frame["start_gap"][4:] < 1e-12).all()
    assert verify(folder / "out", folder / "c.toml", remake=9).sound
    assert report(folder / "out").tables["00 audit, arm"]["scenes"].tolist() == ["desk", "no obstacles", "own scene.yaml", "shelves/2"]


def test_a_path_that_begins_elsewhere_shows_its_gap(folder, checker):
    request = json.loads((folder / "start.json").read_text())
    request["start_state"]["joint_state"]["position"][1] += 0.25
    (folder / "start.json").write_text(json.dumps(request))
    assert abs(audited(folder, "path,scene,start\none.npy,desk,start.json\n")["start_gap"][0] - 0.25) < 1e-12


def test_a_table_in_parquet_has_the_rows_of_one_in_csv(folder):
    first = audited(folder, "path,scene,start\none.npy,desk,start.json\ntwo.npz,,\n")
    pyarrow.parquet.write_table(pyarrow.table({"scene": pyarrow.array(["desk", None]).dictionary_encode(), "path": ["one.npy", "two.npz"], "start": ["start.json", None]}), folder / "t.parquet")
    (folder / "c.toml").write_text(CAMPAIGN.replace("table.csv", "t.parquet"))
    shutil.rmtree(folder / "out")
    assert audited(folder, None).equals(first)


def test_other_files_than_those_of_the_plan_are_refused(folder):
    audited(folder, "path,scene,start\none.npy,own scene.yaml,start.json\n")
    for name in ("start.json", "one.npy", "table.csv", "own scene.yaml"):
        before = (folder / name).read_bytes()
        changed = before.replace(b"position", b"position", 1) + b"\n" if name != "own scene.yaml" else before.replace(b"0.", b"0.1", 1)
        (folder / name).write_bytes(changed)
        with pytest.raises(FleetError, match="another campaign|other"):
            run(folder / "c.toml", folder / "out", workers=0, quiet=True)
        (folder / name).write_bytes(before)


@pytest.mark.parametrize(("table", "message"), [("", "path: is missing; known are path, name, scene, start"), ("path,scene\n", "has no rows"), ("path\none.npy\n", "scene: is missing"),
    ("path,scene,stat\none.npy,desk,\n", "stat: is no known column"), ("path,scene,path\none.npy,desk,x\n", "header: has 'path' as column 1 and again as column 3"),
    ("path,scene\none.npy\n", "row 1: has 1 cells under 2 columns"), ("path,scene\n,desk\n", "row 1: has no path"), ("path,scene\none.npy,table\n", "row 1: scene: .*table: No such file"),
    ("path,scene\nnone.npy,desk\n", "row 1: none.npy: No such file"), ("path,scene\none.npy,desk\none.npy,\none.npy,desk\n", "row 1 and row 3: are the same; keep one"),
    ("path,scene\none.npy,shelves\n", "scene shelves is 3 scenes; give shelves/0 to shelves/2"), ("path,scene\none.npy,shelves/3\n", "shelves has 3 scenes; give"),
    ("path,scene,name\ntwo.npz,desk,best\n", "has no path 'best'; give one of its names"), ("path,scene,start\none.npy,desk,one.npy\n", "one.npy"),
    ("path,scene,start\none.npy,desk,other.json\n", "has no joint of the robot arm"), ('path,scene\n"one.npy,desk\n', "is no table"), ("path,scene\none.npy,pipe\n", "pipe: is no regular file")])
def test_mistakes_in_tables_are_located(folder, table, message):
    (folder / "other.json").write_text(json.dumps({"start_state": {"joint_state": {"name": ["a"], "position": [0]}}}))
    os.mkfifo(folder / "pipe")
    (folder / "table.csv").write_text(table)
    with pytest.raises(FleetError, match=message):
        run(folder / "c.toml", folder / "out", workers=0, quiet=True)


@pytest.mark.parametrize(("columns", "message"), [({"path": [1], "scene": ["desk"]}, "path: has the type int64; give texts"), ({"path": [["one.npy"]], "scene": ["desk"]}, "path: has the type list"),
    ({"path": [None], "scene": ["desk"]}, "path: has the type null")])
def test_tables_of_other_types_are_refused(folder, columns, message):
    (folder / "c.toml").write_text(CAMPAIGN.replace("table.csv", "t.parquet"))
    pyarrow.parquet.write_table(pyarrow.table(columns), folder / "t.parquet")
    with pytest.raises(FleetError, match=message):
        run(folder / "c.toml", folder / "out", workers=0, quiet=True)
    (folder / "t.parquet").write_bytes(b"PAR1" * 5)
    with pytest.raises(FleetError, match="t.parquet: is no"):
        run(folder / "c.toml", folder / "out", workers=0, quiet=True)


@pytest.mark.parametrize(("entry", "message"), [("scenes = []", "has both or none of files and table"), ('table = "t.csv"\nfiles = ["one.npy"]', "has both or none of files and table"),
    ('table = "t.csv"\nscenes = ["desk"]', "scenes: are given beside a table"), ("table = 3", "table: is 3; give text"), ('files = ["one.npy"]', "scenes: is missing")])
def test_work_with_a_table_and_more_is_refused(folder, entry, message):
    (folder / "c.toml").write_text(CAMPAIGN.replace('table = "table.csv"', entry))
    with pytest.raises(FleetError, match=message):
        run(folder / "c.toml", folder / "out", workers=0, quiet=True)
