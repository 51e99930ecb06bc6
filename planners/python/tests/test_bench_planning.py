# SPDX-License-Identifier: BSD-3-Clause
"""leeway-bench planning --row --paths on one small problem, and the referee on its file."""
import json
import os
import shutil
import subprocess

import numpy
import pytest

from conftest import FIRST

PROGRAM = os.environ.get("LEEWAY_BENCH", "")
if os.environ.get("LEEWAY_PYTHON_EXTRAS") != "required":
    for name in ("distributed", "pyarrow", "pandas", "matplotlib"):
        pytest.importorskip(name)
from leeway.fleet.referee import referee


@pytest.fixture(scope="module")
def ends(checker):
    """The states "left" and "right" of the SRDF: the desk's things stand between them."""
    return [numpy.array([{"yaw": yaw, "shoulder": 0.9, "elbow": 0.9, "wrist": 0.0}[name] for name in checker.variables]) for yaw in (0.9, -0.9)]


@pytest.fixture(scope="module")
def data(tmp_path_factory, checker, ends):
    """The desk arm in the place of the data's Panda, before its desk."""
    folder = tmp_path_factory.mktemp("data")
    problems = folder / "mbm" / "panda" / "problems" / "desk_panda"
    problems.mkdir(parents=True)
    (folder / "mbm" / "fetch" / "problems").mkdir(parents=True)
    shutil.copy(FIRST / "arm.urdf", folder / "mbm" / "panda" / "panda.urdf")
    srdf = (FIRST / "arm.srdf").read_text()
    assert 'name="arm"' in srdf
    (folder / "mbm" / "panda" / "panda.srdf").write_text(srdf.replace('name="arm"', 'name="panda_arm"').replace('group="arm"', 'group="panda_arm"'))
    shutil.copy(FIRST / "scene.yaml", problems / "scene0001.yaml")
    joints = [{"joint_name": name, "position": float(value)} for name, value in zip(checker.variables, ends[1])]
    (problems / "request0001.yaml").write_text(json.dumps({"group_name": "panda_arm", "goal_constraints": [{"joint_constraints": joints}],
        "start_state": {"joint_state": {"name": ["grip", *checker.variables], "position": [0.0, *map(float, ends[0])]}}}))
    return folder


@pytest.fixture(scope="module")
def lines(data):
    """The paths of the first row and of those that are asked for by name."""
    file = data / "paths.jsonl"
    assert PROGRAM, "LEEWAY_BENCH names no program: build the target leeway-bench, or run the tests by ctest"
    done = subprocess.run([PROGRAM, "planning", "--data", data, "--only", "desk_panda", "--problems", "1", "--runs", "2", "--seconds", "20", "--budget", "0.1",
        "--row", "own states", "--paths", file], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=250)
    assert done.returncode == 0, done.stdout
    return [json.loads(line) for line in file.read_text().splitlines()]


def test_rows_that_were_not_asked_for_are_left_out(lines):
    ways = list(dict.fromkeys(line["way"] for line in lines))
    assert ways[0] == "leeway" and len(ways) > 1 and all("own states" in way for way in ways[1:])
    assert {line["run"] for line in lines} == {1, 2} and {line["problem"] for line in lines} == {"panda panda_arm/desk_panda/1"}


def test_paths_lead_from_start_to_goal_in_the_order_of_their_joints(lines, checker, ends):
    for line in lines:
        path = numpy.array(line["path"])[:, [line["joints"].index(name) for name in checker.variables]]
        assert abs(path[0] - ends[0]).max() < 1e-9 and abs(path[-1] - ends[1]).max() < 1e-9
        assert line["plan_us"] > 0 and (line["way"] != "leeway" or checker.path(path).all_free)


def test_the_referee_says_the_same_as_the_benchmark(lines, data, tmp_path):
    found = referee(data / "paths.jsonl", data, tmp_path / "out")
    rows = found.paths.set_index(["planner", "run"])
    assert len(rows) == len(lines) and found.contradictions == 0 and rows.loc["leeway"]["proved"].all()
    for line in lines:
        assert rows.loc[(line["way"], line["run"]), "contact"] == line["in_contact"]
