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
from leeway.fleet.cases import Cases
from leeway.fleet.referee import referee


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
    for name in ("arm 7", "arm a/b/c", "arm ../../1", "arm desk_arm/../1", "", "arm arm/desk_arm/\u0662"):
        with pytest.raises(FleetError, match="is no problem that the referee knows; name its files in .*problems.toml"):
            Cases(folder).case(name)
    assert main(["referee", str(tmp_path / "none"), "--data", str(folder)]) == 2 and "No such file" in capsys.readouterr().err
    file.write_text("{")
    with pytest.raises(FleetError, match="line 1: is no JSON"):
        referee(file, folder, tmp_path / "out")


NAMES = ["Lab 3 / shelf, left", "../../etc/passwd", "/abs", "\u53f0\u6240 <b>1</b> & 'x'", "a\tb \\ \"q\"", "$\\frac$ _x", "kitchen 04", "-", "x" * 3000]


def table_of(names, **more):
    """The table of problems that all are the desk."""
    entries = [{"name": name, "urdf": "mbm/arm/arm.urdf", "srdf": "mbm/arm/arm.srdf", "scene": "mbm/arm/problems/desk_arm/scene0001.yaml", **more} for name in names]
    return "\n".join("[[problem]]\n" + "".join(f"{key} = {json.dumps(value)}\n" for key, value in entry.items()) for entry in entries)


def test_problems_of_a_table_have_any_names(data, tmp_path):
    folder, file = data
    (folder / "problems.toml").write_text(table_of(NAMES, robot="_$\\frac$", set="\u68da / 1"))
    lines = [json.loads(line) for line in file.read_text().splitlines()]
    named = tmp_path / "named.jsonl"
    named.write_text("\n".join(json.dumps({**line, "problem": name, "way": "_" + line["way"] + " $\\frac$"}) for name in NAMES for line in lines))
    found, plain = referee(named, folder, tmp_path / "named"), referee(file, folder, tmp_path / "plain")
    assert found.paths["problem"].nunique() == len(NAMES) and len(found.paths) == 3 * len(NAMES)
    assert sorted(set(found.paths["least"])) == sorted(set(plain.paths["least"])) and found.paths["contact"].sum() == len(NAMES)
    assert "<b>1</b>" not in found.page.read_text()


def test_a_path_of_all_variables_needs_no_groups(data, tmp_path, robot):
    folder, file = data
    (folder / "problems.toml").write_text(table_of(["bare"], srdf=""))
    path = [robot.default_state().tolist()] * 2
    file.write_text(json.dumps({"problem": "bare", "way": "w", "run": 1, "plan_us": 1, "path": path, "joints": robot.variables}))
    assert referee(file, folder, tmp_path / "out").paths["group"].tolist() == [""]


@pytest.mark.parametrize(("names", "message"), [(["a", "b", "a"], r"problem\[0\] and problem\[2\]: have the same name 'a'; give each a name of its own"),
    (["caf\u00e9", "cafe\u0301"], r"problem\[0\] and problem\[1\]: have the same name")])
def test_two_problems_of_one_name_are_named(data, names, message):
    (data[0] / "problems.toml").write_text(table_of(names))
    with pytest.raises(FleetError, match=message):
        Cases(data[0])


@pytest.mark.parametrize(("text", "message"), [('problem = 3', "problem: is 3; give a list"), ('[[problem]]\nname = "a"', r"problem\[0\].urdf: is missing"),
    ('[[problem]]\nname = "a"\nurdf = "x"\nset = "all"', "set: is 'all'"), ('[[problem]]\nname = "a"\nname = "b"', "has name in line 2 and again in line 3; keep one"),
    ("x = " + "[" * 5000, "more than 64 tables")])
def test_mistakes_in_tables_of_problems_are_located(data, text, message):
    (data[0] / "problems.toml").write_text(text)
    with pytest.raises(FleetError, match=f"problems.toml: .*{message}"):
        Cases(data[0])


def test_a_path_that_is_there_twice_is_named_by_both_lines(data, tmp_path):
    folder, file = data
    lines = file.read_text().splitlines()
    file.write_text("\n".join([*lines, "", lines[1]]))
    with pytest.raises(FleetError, match="line 2 and line 5: are both run 1 of hasty on 'arm arm/desk_arm/1'; keep one of them"):
        referee(file, folder, tmp_path / "out")


@pytest.mark.parametrize(("change", "message"), [({"run": True}, "line 1.run: is True; give a whole number"), ({"joints": ["a", 3]}, r"line 1.joints\[1\]: is 3"),
    ({"path": [[1, 2], [3]]}, "line 1: path is no table of numbers"), ({"path": [[0, 0]]}, "line 1: path has the shape"), ({"path": []}, "line 1: path has the shape"),
    ({"path": [[1e400] * 4] * 2}, "line 1: path has"), ({"problem": 7}, "line 1.problem: is 7"), ({"plan_us": None}, "line 1.plan_us: is missing"),
    ({"plan_us": "fast"}, "line 1.plan_us: is 'fast'"), ({"joints": ["a", "b", "c", "d"]}, "joints: are those of no group")])
def test_lines_that_are_no_paths_are_located(data, tmp_path, change, message):
    folder, file = data
    line = {**json.loads(file.read_text().splitlines()[0]), **change}
    file.write_text(json.dumps(line).replace("Infinity", "1e400"))
    with pytest.raises(FleetError, match=message):
        referee(file, folder, tmp_path / "out")


@pytest.mark.parametrize(("line", "message"), [("[1]", "line 1: is no table"), ('{"a": 1, "a": 2}', "line 1: is no JSON: has the key 'a' in line 1 and again in line 1"),
    ("", "has no paths"), ('{"plan_us": NaN}', "NaN")])
def test_lines_of_another_form_are_refused(data, tmp_path, line, message):
    folder, file = data
    file.write_text(line)
    with pytest.raises(FleetError, match=message):
        referee(file, folder, tmp_path / "out")


def test_paths_in_a_pipe_are_refused_and_not_waited_for(data, tmp_path):
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(FleetError, match="pipe: is no regular file; give the file of leeway-bench planning"):
        referee(tmp_path / "pipe", data[0], tmp_path / "out")
