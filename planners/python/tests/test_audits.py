# SPDX-License-Identifier: BSD-3-Clause
"""Audits, pairs and tuning: equal to the program's reports in all digits, limits included."""
import json
import os
import subprocess

import numpy
import pytest

import leeway
import leeway.tune
from conftest import FIRST

ARM = ["--robot", str(FIRST / "arm.urdf"), "--srdf", str(FIRST / "arm.srdf")]
SCENE = ["--scene", str(FIRST / "scene.yaml"), "--group", "arm"]
JOINTS = ["yaw", "shoulder", "elbow", "wrist"]
CLOCKS = {"seconds", "proof_seconds", "seconds_spent", "measured_us"}  # times of a run, the only numbers that may differ
BESIDE = {"notices"}  # a report of the program has them beside its audit


def without_clocks(value):
    if isinstance(value, dict):
        return {key: without_clocks(entry) for key, entry in value.items() if key not in CLOCKS | BESIDE}
    return [without_clocks(entry) for entry in value] if isinstance(value, list) else value


@pytest.fixture(scope="module")
def program(tmp_path_factory):
    """program(subcommand, arguments, option, statuses): the report that the program writes by `option`."""
    path = os.environ.get("LEEWAY_PROGRAM")
    if not path:
        pytest.fail("LEEWAY_PROGRAM names no program: build the target leeway, or run the tests by ctest")
    folder = tmp_path_factory.mktemp("reports")

    def run(command, arguments, option="--report", statuses=(0, 1)):
        report = folder / "report.json"
        report.unlink(missing_ok=True)
        ended = subprocess.run([path, command, *ARM, "--no-cache", *map(str, arguments), option, str(report)], capture_output=True, text=True)
        assert ended.returncode in statuses, ended.stderr
        return json.loads(report.read_text())

    return run


@pytest.fixture(scope="module")
def standing(robot, scene):
    """Joints that no file names stand at 0, as the program has them."""
    return leeway.Checker(robot, scene, group="arm", reference={name: 0.0 for name in [*JOINTS, "grip"]}, min_d=0.0)


def path_text(points):
    return "group: arm\njoint_names: [wrist, elbow, shoulder, yaw]\npoints:\n" + "".join(f"  - positions: {list(p[::-1])}\n" for p in points)


PATHS = {
    "over the desk": [[0.9, 0.9, 0.9, 0.0], [0.0, -0.6, 1.6, 0.6], [-0.9, 0.9, 0.9, 0.0]],
    "through things": [[0.9, 0.9, 0.9, 0.0], [-0.9, 0.9, 0.9, 0.0]],
    "beyond limits": [[0.0, -0.6, 1.6, 0.6], [0.0, -0.6, 2.7, 0.6]],
    "one state": [[0.0, -0.6, 1.6, 0.6]],
}


@pytest.mark.parametrize("name", PATHS)
@pytest.mark.parametrize("check, what", [("both", []), ("environment", ["--what", "env"])])
def test_an_audit_differs_from_the_programs(name, check, what, program, standing, tmp_path):
    file = tmp_path / "path.yaml"
    file.write_text(path_text(PATHS[name]))
    told = program("audit", [*SCENE, "--path", file, "--min-d", 0.003, "--resolution", 0.001, *what])["audit"]
    for given in (file, str(file), numpy.array(PATHS[name])):
        found = standing.audit(given, min_d=0.003, resolution=0.001, check=check)
        assert without_clocks(found) == without_clocks(told)
    assert found["valid"] == (name in ("over the desk", "one state")), found["problems"]


def message(points, **more):
    return {"joint_names": JOINTS, "points": [
        {"positions": p, "time_from_start": {"sec": int(t), "nanosec": round(1e9 * (t % 1))}, **{key: list(values[i]) for key, values in more.items()}}
        for i, (t, p) in enumerate(points)]}


LEFT, HOME, RIGHT = [0.9, 0.9, 0.9, 0.0], [0.0, -0.6, 1.6, 0.6], [-0.9, 0.9, 0.9, 0.0]
REST = numpy.zeros((3, 4))
SWING = numpy.array([[0.1, -0.4, 0.2, 0.0], [0.3, 0.2, -0.5, 0.1], [0.0, 0.1, 0.0, 0.2]])
TRAJECTORIES = {
    "linear": message([(0, LEFT), (1.5, HOME), (3, RIGHT)]),
    "cubic": message([(0, LEFT), (1.5, HOME), (3, RIGHT)], velocities=SWING),
    "quintic": message([(0, LEFT), (1.5, HOME), (3, RIGHT)], velocities=REST, accelerations=SWING),
    "too fast": message([(0, LEFT), (0.25, HOME), (0.5, RIGHT)], velocities=REST, accelerations=REST),
    "beyond its limit": message([(0, HOME), (1, [0.0, -0.6, 2.9, 0.6])]),
    "blocked": message([(0, LEFT), (2, RIGHT)]),
    "a gap between two": {"model_id": "", "trajectory": [{"joint_trajectory": message([(0, LEFT), (2, HOME)])},
        {"joint_trajectory": message([(0, RIGHT), (2, HOME)])}]},
}
TOLD = {"cubic": ("velocity", "acceleration"), "quintic": ("velocity", "acceleration"), "too fast": ("velocity", "acceleration"),
    "beyond its limit": ("position",), "blocked": ("velocity",), "a gap between two": ("end of the one before",)}
LIMITS = """joint_limits:
  yaw: {has_velocity_limits: true, max_velocity: 0.7, has_acceleration_limits: true, max_acceleration: 0.9}
  elbow: {has_velocity_limits: false, has_acceleration_limits: true, max_acceleration: 2.5}
"""
SAME_LIMITS = {"yaw": {"max_velocity": 0.7, "max_acceleration": 0.9}, "elbow": {"max_acceleration": 2.5}}


@pytest.mark.parametrize("name", TRAJECTORIES)
def test_an_audit_of_a_trajectory_differs_from_the_programs(name, program, standing, tmp_path):
    file, limits = tmp_path / "trajectory.json", tmp_path / "joint_limits.yaml"
    file.write_text(json.dumps(TRAJECTORIES[name]))
    limits.write_text(LIMITS)
    plain = program("audit", [*SCENE, "--trajectory", file])["audit"]
    assert without_clocks(standing.audit_trajectory(file)) == without_clocks(plain)
    told = program("audit", [*SCENE, "--trajectory", file, "--joint-limits", limits, "--min-d", 0.002, "--tolerance", 0.001])["audit"]
    for given in (limits, SAME_LIMITS):
        found = standing.audit_trajectory(file, joint_limits=given, min_d=0.002, tolerance=[0.001] * 4)
        assert without_clocks(found) == without_clocks(told)
    text = " ".join(found["problems"])
    assert found["verdict"] == ("BLOCKED" if name in ("blocked", "beyond its limit") else "FREE")
    for word in ("velocity", "acceleration", "position", "end of the one before"):
        assert (word in text) == (word in TOLD.get(name, ())), (word, text)


def told_of(report, *parts):
    """Each part is in a notice of its own."""
    lines = list(report["notices"])
    for part in parts:
        found = [line for line in lines if part in line]
        assert found, (part, lines)
        lines.remove(found[0])
    assert not lines


def test_what_an_audit_leaves_out_is_not_told(program, standing, tmp_path):
    file, limits = tmp_path / "trajectory.json", tmp_path / "joint_limits.yaml"
    trajectory = message([(0.5, LEFT), (2, HOME)])  # from where to its first point?
    trajectory["points"][0]["effort"] = [1, 2, 3, 4]
    file.write_text(json.dumps(trajectory))
    limits.write_text("joint_limits:\n  yaww: {has_velocity_limits: true, max_velocity: 1}\n"
                      "  yaw: {has_velocity_limits: false, max_velocity: 2, max_position: 3}\n")
    parts = ("first point comes after 0.5 s", "effort", "joint_limits.yaww", "max_position", "max_velocity")
    told_of(standing.audit_trajectory(file, joint_limits=limits), *parts)
    lines = " ".join(program("audit", [*SCENE, "--trajectory", file, "--joint-limits", limits])["notices"])
    assert all(part in lines for part in parts)
    told_of(standing.audit_trajectory([0, 1], [HOME, LEFT], joint_limits={"elbwo": {"max_velocity": 1}}), "joint_limits.elbwo")
    told_of(standing.audit_trajectory([0, 1], [HOME, LEFT]))


def test_a_path_file_is_read_in_part(program, standing, tmp_path):
    file = tmp_path / "path.yaml"
    text = path_text(PATHS["over the desk"])
    file.write_text("min_d: 0.003\nplanned_by: hand\nstart_state: {joint_state: {name: [grip, tail], position: [0.0, 1.0]}}\n" + text)
    found = standing.audit(file, resolution=0.001)
    told_of(found, "planned_by", "tail")
    told_of(standing.audit_roundings(file, 0.01), "planned_by", "tail")
    told = program("audit", [*SCENE, "--path", file, "--resolution", 0.001])
    assert without_clocks(told["audit"]) == without_clocks(found) == without_clocks(standing.audit(file, min_d=0.003, resolution=0.001))
    assert found["min_d"] == 0.003 and len(told["notices"]) >= 2
    file.write_text("start_state: {joint_state: {name: [grip], position: [0.04]}}\n" + text)
    for audit in (standing.audit, lambda path: standing.audit_roundings(path, 0.01)):
        with pytest.raises(leeway.InputError, match="grip is at 0.04"):
            audit(file)


@pytest.mark.parametrize("check, what", [("environment", "env"), ("self", "self")])
def test_what_is_checked_of_a_trajectory_differs_from_the_programs(check, what, program, standing, tmp_path):
    """The way through things meets the scene, and not the robot."""
    file = tmp_path / "trajectory.json"
    file.write_text(json.dumps(TRAJECTORIES["blocked"]))
    told = program("audit", [*SCENE, "--trajectory", file, "--what", what])["audit"]
    found = standing.audit_trajectory(file, check=check)
    assert without_clocks(found) == without_clocks(told)
    assert found["verdict"] == ("BLOCKED" if check == "environment" else "FREE")


def test_arrays_and_files_of_a_trajectory_differ(standing, tmp_path):
    file = tmp_path / "t.csv"
    times, positions = [0, 1.5, 3], numpy.array([LEFT, HOME, RIGHT])
    rows = numpy.column_stack([times, positions, SWING])
    numpy.savetxt(file, rows, delimiter=",", comments="", fmt="%.17g",
        header=",".join(["time", *JOINTS, *("velocity:" + name for name in JOINTS)]))
    from_file = standing.audit_trajectory(file)
    assert without_clocks(standing.audit_trajectory(times, positions, SWING)) == without_clocks(from_file)
    motions = standing.trajectory(times, positions, SWING)
    assert motions.all_free == (from_file["verdict"] == "FREE")


@pytest.mark.parametrize("radius", [0.01, 0.2, 1.5])
def test_roundings_differ_from_the_programs(radius, program, standing, tmp_path):
    file = tmp_path / "path.yaml"
    file.write_text(path_text(PATHS["over the desk"]))
    told = program("audit", [*SCENE, "--path", file, "--corner-blend", radius])["roundings"]
    assert without_clocks(standing.audit_roundings(file, radius)) == without_clocks(told)
    told = program("audit", [*SCENE, "--path", file, "--corner-blend", radius, "--tolerance", 0.3])["roundings"]
    assert without_clocks(standing.audit_roundings(file, radius, tolerance=[0.3] * 4)) == without_clocks(told) and told["verdict"] != "FREE"


@pytest.mark.parametrize("more, settings", [([], {}), (["--never-after", 3000, "--samples", 500, "--seed", 7],
    {"never_after": 3000, "samples": 500, "seed": 7})])
def test_pairs_differ_from_the_programs(more, settings, program, robot, tmp_path):
    srdf = tmp_path / "new.srdf"
    told = program("pairs", ["--budget", 30, "--out", srdf, *more], "--json")
    found = leeway.pairs(robot, seconds=30, srdf=True, **settings)
    assert found.pop("new_srdf") == srdf.read_text()
    assert told["complete"] and without_clocks(found) == without_clocks(told)


@pytest.mark.parametrize("option, target", [([], {}), (["--error", 5], {"error": 0.005}), (["--edge-conservatism", 2], {"conservatism": 0.002}),
    (["--time-per-state", 8], {"microseconds": 8.0})])
def test_tuning_differs_from_the_programs(option, target, program, robot, scene):
    numbers = ["--min-d", 0.001, "--max-d", 0.3, "--states", 60, "--edges", 20, "--seed", 3, "--rate", 1.5]
    told = program("tune", [*SCENE, *numbers, *option], "--json")
    checker = leeway.Checker(robot, scene, group="arm", reference={name: 0.0 for name in [*JOINTS, "grip"]}, min_d=0.001, max_d=0.3)
    found = leeway.tune.tune(checker, min_d=0.001, max_d=0.3, states=60, edges=20, seed=3, rate=1.5, **target)
    assert without_clocks(found.report) == without_clocks(told)
    assert found.met == told["target"]["met"] and len(found.settings) == len(told["settings"])


def test_bad_requests_are_refused(standing, robot, tmp_path):
    with pytest.raises(leeway.InputError, match="no_such"):
        standing.audit(tmp_path / "no_such.yaml")
    with pytest.raises(ValueError, match="path: shape"):
        standing.audit(numpy.zeros((2, 3)))
    with pytest.raises(ValueError, match="none of auto, linear"):
        standing.audit_trajectory([0, 1], [HOME, HOME], interpolation="spline")
    with pytest.raises(ValueError, match="yaw: give max_velocity"):
        standing.audit_trajectory([0, 1], [HOME, HOME], joint_limits={"yaw": {"max_speed": 1}})
    with pytest.raises(ValueError, match="positions: are missing"):
        standing.audit_trajectory([0, 1])
    with pytest.raises(leeway.CoreError):
        standing.audit_roundings([HOME, LEFT], -1)


def test_a_saved_plan_is_audited_as_it_was(program, standing, tmp_path):
    plan = standing.plan([0.9, 0.9, 0.9, 0.0], [-0.9, 0.9, 0.9, 0.0], min_d=0.001, seconds=5)
    assert plan.solved and plan.min_d == 0.001
    file = tmp_path / "path.yaml"
    plan.save(standing, file)
    report = program("audit", [*SCENE, "--path", file])["audit"]
    assert report["valid"] and report["min_d"] == 0.001
    assert without_clocks(report) == without_clocks(standing.audit(file))
    with pytest.raises(ValueError, match="its audit finds"):
        standing.path_text(PATHS["through things"])
    with pytest.raises(ValueError, match="has no path"):
        plan._replace(path=None, outcome=leeway.Outcome.TIMED_OUT).save(standing, file)
