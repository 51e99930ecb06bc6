# SPDX-License-Identifier: BSD-3-Clause
"""The referee: paths that touch something are found, whoever planned them."""
import json
import os
import shutil

import numpy
import pytest

from conftest import FIRST

if os.environ.get("LEEWAY_PYTHON_EXTRAS") != "required":
    for name in ("distributed", "pyarrow", "pandas", "matplotlib"):
        pytest.importorskip(name)
from leeway.fleet import FleetError
from leeway.fleet.__main__ import main
from leeway.fleet.referee import case_of, referee


@pytest.fixture
def data(tmp_path, checker, states):
    """A folder like that of MotionBenchMaker's problems, and a file of paths."""
    folder = tmp_path / "data" / "mbm" / "arm"
    problems = folder / "problems" / "desk_arm"
    problems.mkdir(parents=True)
    shutil.copy(FIRST / "arm.urdf", folder / "arm.urdf")
    shutil.copy(FIRST / "arm.srdf", folder / "arm.srdf")
    shutil.copy(FIRST / "scene.yaml", problems / "scene0001.yaml")
    (problems / "request0001.yaml").write_text(json.dumps({"start_state": {"joint_state": {"name": ["grip"], "position": [0.0]}}}))
    free = states[checker.is_free(states, min_d=0.01)]
    good = checker.plan(free[0], free[1], min_d=0.002).path
    bad = numpy.array([free[0], states[~checker.is_free(states)][0], free[1]])
    lines = [{"problem": "arm arm/desk_arm/1", "way": way, "run": run, "plan_us": 1000.0, "simplify_us": 500.0, "in_contact": contact,
        "path": path[:, ::-1].tolist(), "joints": checker.variables[::-1]}
        for way, run, contact, path in (("certain", 1, False, good), ("hasty", 1, True, bad), ("hasty", 2, False, good))]
    file = tmp_path / "paths.jsonl"
    file.write_text("\n".join(map(json.dumps, lines)))
    return tmp_path / "data", file


def test_paths_in_contact_are_found_and_shown(data, tmp_path):
    folder, file = data
    found = referee(file, folder, tmp_path / "out")
    rows = found.paths.set_index(["planner", "run"])
    assert rows.loc[("hasty", 1), "contact"] and not rows.loc[("hasty", 2), "contact"] and not rows.loc[("certain", 1), "contact"]
    assert 0 < rows.loc[("hasty", 1), "share"] < 1 and rows.loc[("certain", 1), "proved"] and found.contradictions == 0
    whole = found.table[found.table["set"] == "all"].set_index("planner")
    assert whole.loc["hasty", "percent"] == 50 and whole.loc["certain", "in_contact"] == 0 and whole.loc["certain", "median_ms"] == 1.5
    text = found.page.read_text()
    assert "says the same of 3 of 3" in text and "data:image/png" in text and "--program names no leeway" in text
    assert (tmp_path / "out" / "worst_1.yaml").read_text().count("  - [") == 3 and "50.0" in text
    assert (tmp_path / "out" / "worst_1.csv").read_text().startswith("grip,")


def test_a_path_is_judged_by_its_joints_not_their_order(data, tmp_path):
    folder, file = data
    lines = [json.loads(line) for line in file.read_text().splitlines()]
    for line in lines:
        line["path"] = [point[::-1] for point in line["path"]]
        line["joints"] = line["joints"][::-1]
    again = tmp_path / "again.jsonl"
    again.write_text("\n".join(map(json.dumps, lines)))
    first, second = referee(file, folder, tmp_path / "a").paths, referee(again, folder, tmp_path / "b").paths
    assert (first["least"] == second["least"]).all() and (first["contact"] == second["contact"]).all()


def test_reaches_of_a_folder_are_planned_and_judged(tmp_path, checker, states):
    from leeway.fleet.reaches import plan_reaches
    if os.environ.get("LEEWAY_PYTHON_EXTRAS") != "required":
        pytest.importorskip("ompl")
    folder = tmp_path / "demo"
    (folder / "reach").mkdir(parents=True)
    for name, source in (("robot.urdf", "arm.urdf"), ("robot.srdf", "arm.srdf"), ("scene.yaml", "scene.yaml")):
        shutil.copy(FIRST / source, folder / name)
    free = states[checker.is_free(states, min_d=0.02)]
    joints = [{"joint_name": name, "position": float(value)} for name, value in zip(checker.variables, free[1])]
    (folder / "reach" / "01_there.yaml").write_text(json.dumps({"group_name": "arm", "goal_constraints": [{"joint_constraints": joints}],
        "start_state": {"joint_state": {"name": checker.variables, "position": free[0].tolist()}}}))
    counts = plan_reaches(folder, tmp_path / "paths.jsonl", runs=2, seconds=10)
    assert counts["leeway"] == [2, 2] and list(counts) == ["leeway", "OMPL, sampled at its default"]
    found = referee(tmp_path / "paths.jsonl", folder, tmp_path / "out")
    assert found.paths["proved"][found.paths["planner"] == "leeway"].all() and set(found.paths["robot"]) == {"kitchen"}
    assert (found.paths["contact"] != found.paths["proved"]).all() and "own auditor" not in found.page.read_text()


def test_faults_of_its_input_are_located(data, tmp_path, capsys):
    folder, file = data
    with pytest.raises(FleetError, match="is no problem that the referee knows"):
        case_of("arm 7", folder)
    assert main(["referee", str(tmp_path / "none"), "--data", str(folder)]) == 2 and "No such file" in capsys.readouterr().err
    file.write_text("{")
    with pytest.raises(FleetError, match="is no JSON a line"):
        referee(file, folder, tmp_path / "out")
