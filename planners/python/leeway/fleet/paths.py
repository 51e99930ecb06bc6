# SPDX-License-Identifier: BSD-3-Clause
"""Somebody's paths and trajectories from files: CSV, NumPy, ROS and MoveIt as YAML or JSON, OMPL's matrices, VAMP's arrays.

| ending | content |
|---|---|
| .csv | a header with names of joints in any order; `time`, `velocity:NAME`, `acceleration:NAME` make a trajectory; other columns are ignored |
| .npy, .npz | arrays [n, dof] in the order of the group, such as `numpy.array([state.to_list() for state in path])` of VAMP; .npz: one path each, or `times`, `positions`, perhaps `velocities`, `accelerations` of one trajectory |
| .txt | rows of numbers in the order of the group: OMPL's `printAsMatrix()` |
| .yaml, .json | trajectory_msgs/JointTrajectory, goals of FollowJointTrajectory, moveit_msgs/RobotTrajectory and DisplayTrajectory, and path files of `leeway plan` |
"""
from __future__ import annotations

import csv
import io
import math
import pathlib
import zipfile
import zlib
from typing import Any, NamedTuple

import numpy

from .documents import read_documents, read_text
from .errors import FleetError
from .files import MOST_BYTES, read_regular

__all__ = ["PathData", "once", "read_group", "read_joints", "read_paths", "read_states"]


class PathData(NamedTuple):
    name: str  #: in its file
    positions: numpy.ndarray  #: [n, dof]
    times: numpy.ndarray | None = None
    velocities: numpy.ndarray | None = None
    accelerations: numpy.ndarray | None = None


def once(file, element: str, names: list[str], what: str) -> None:
    """Raises FleetError for a name that is there twice: readers differ in which of them they take."""
    places: dict[str, int] = {}
    for i, name in enumerate(names):
        if name in places:
            raise FleetError(file, element, f"has {name!r} as {what} {places[name] + 1} and again as {what} {i + 1}", "keep one of them")
        places[name] = i


def _ordered(file, name: str, joints: list[str], rows: numpy.ndarray, variables: list[str]) -> numpy.ndarray:
    missing = [variable for variable in variables if variable not in joints]
    if missing:
        raise FleetError(file, name, f"has no joint {', '.join(missing)}", "give all joints of the group, or another group")
    return rows[:, [joints.index(variable) for variable in variables]]


def _in_order(file, name: str, rows: Any, variables: list[str]) -> numpy.ndarray:
    rows = numpy.asarray(rows, float)
    if rows.ndim != 2 or rows.shape[1] != len(variables):
        raise FleetError(file, name, f"has the shape {rows.shape}", f"give rows of {len(variables)} numbers: {', '.join(variables)}")
    return rows


def _from_csv(file: pathlib.Path, variables: list[str]) -> list[PathData]:
    try:
        rows = [row for row in csv.reader(io.StringIO(read_text(file), newline="")) if row]
        names = [name.strip() for name in rows[0]]
        once(file, "header", names, "column")
        values = numpy.array([[float(cell) for cell in row] for row in rows[1:]])
        table = {name: values[:, i] for i, name in enumerate(names)}
    except (IndexError, ValueError, csv.Error) as error:
        if isinstance(error, FleetError):
            raise
        raise FleetError(file, "", f"is no table of numbers under a header: {error}", "correct the file") from None

    def block(prefix: str) -> numpy.ndarray | None:
        chosen = {name[len(prefix):]: column for name, column in table.items() if name.startswith(prefix)}
        missing = [variable for variable in variables if variable not in chosen]
        if prefix and chosen and missing:
            raise FleetError(file, "header", f"has {prefix} columns, but none of {', '.join(missing)}", "give all of the group, or none")
        return _ordered(file, "header", list(chosen), numpy.column_stack(list(chosen.values())), variables) if set(variables) <= set(chosen) else None

    positions = block("")
    if positions is None:
        positions = _ordered(file, "header", names, values, variables)
    return [PathData("", positions, table.get("time"), block("velocity:"), block("acceleration:"))]


def _from_numpy(file: pathlib.Path, variables: list[str]) -> list[PathData]:
    found = _arrays(file)
    if isinstance(found, numpy.ndarray):
        return [PathData("", _in_order(file, "", found, variables))]
    if "times" in found and "positions" in found:
        blocks = [_in_order(file, name, found[name], variables) if name in found else None for name in ("positions", "velocities", "accelerations")]
        return [PathData("", blocks[0], numpy.asarray(found["times"], float), *blocks[1:])]
    return [PathData(name, _in_order(file, name, array, variables)) for name, array in found.items()]


def _arrays(file: pathlib.Path) -> numpy.ndarray | dict[str, numpy.ndarray]:
    """The arrays of a file of NumPy's. A header can promise any number of bytes, so their sum is bounded first."""
    try:
        data = io.BytesIO(read_regular(file))
        if file.suffix == ".npy":
            return numpy.load(data, allow_pickle=False)
        with zipfile.ZipFile(data) as archive:
            once(file, "", archive.namelist(), "array")
            if sum(entry.file_size for entry in archive.infolist()) > MOST_BYTES:
                raise ValueError(f"unpacked it has more than {MOST_BYTES} bytes")
        with numpy.load(data, allow_pickle=False) as arrays:
            return {name: arrays[name] for name in arrays.files}
    except FleetError:
        raise
    except OSError as error:
        raise FleetError(file, "", error.strerror or f"is no array: {error}", "write it by numpy.save() or numpy.savez()") from None
    except (ValueError, EOFError, KeyError, MemoryError, NotImplementedError, RuntimeError, SyntaxError, TypeError, zipfile.BadZipFile, zlib.error) as error:
        raise FleetError(file, "", f"is no array: {error}", "write it by numpy.save() or numpy.savez()") from None


def _seconds(point: dict[str, Any]) -> float:
    time = point.get("time_from_start", 0.0)
    if isinstance(time, dict):
        return float(time.get("sec", time.get("secs", 0))) + 1e-9 * float(time.get("nanosec", time.get("nsecs", 0)))
    return float(time)


def _messages(value: Any) -> list[dict[str, Any]]:
    """All tables with joint_names and points, wherever they are."""
    if isinstance(value, dict):
        if value.get("joint_names") and value.get("points"):
            return [value]
        return [found for entry in value.values() for found in _messages(entry)]
    return [found for entry in value for found in _messages(entry)] if isinstance(value, list) else []


def _from_message(file: pathlib.Path, variables: list[str]) -> list[PathData]:
    out: list[PathData] = []
    for message in _messages(read_documents(file)):
        i, points, joints = len(out), message["points"], message["joint_names"]
        if not isinstance(points, list) or not isinstance(joints, list) or not all(isinstance(joint, str) for joint in joints):
            raise FleetError(file, f"trajectory {i}", "has no list of points, or no list of joint_names", "correct the file")
        once(file, f"joint_names of trajectory {i}", joints, "joint")
        if not all(isinstance(point, dict) == isinstance(points[0], dict) for point in points):
            raise FleetError(file, f"points of trajectory {i}", "are tables and lists", "give all of them in one form")
        if not isinstance(points[0], dict):  # a path of `leeway plan`
            out.append(PathData(str(i), _ordered(file, "points", joints, _in_order(file, "points", points, joints), variables)))
            continue

        def block(key: str) -> numpy.ndarray | None:
            if not all(len(point.get(key) or []) == len(joints) for point in points):
                return None
            return _ordered(file, key, joints, numpy.array([point[key] for point in points], float), variables)

        positions = block("positions")
        if positions is None:
            raise FleetError(file, f"points of trajectory {i}", "lack positions", "give each point one position for each joint")
        times = numpy.array([_seconds(point) for point in points])
        out.append(PathData(str(i), positions, times if (numpy.diff(times) > 0).all() else None, block("velocities"), block("accelerations")))
    if not out:
        raise FleetError(file, "", "has no joint_names with points", "give a JointTrajectory, or a message that holds one")
    return out


READERS = {".csv": _from_csv, ".npy": _from_numpy, ".npz": _from_numpy, ".yaml": _from_message, ".yml": _from_message, ".json": _from_message}


def read_paths(file, variables: list[str]) -> list[PathData]:
    """The paths of a file for a group's variables. Raises FleetError for one without rows, or with a number that is not finite."""
    file = pathlib.Path(file)
    try:
        if file.suffix == ".txt":
            found = [PathData("", _in_order(file, "", numpy.loadtxt(io.StringIO(read_text(file)), ndmin=2), variables))]
        elif file.suffix in READERS:
            found = READERS[file.suffix](file, variables)
        else:
            raise FleetError(file, "", f"ends in {file.suffix!r}", f"give one of .txt, {', '.join(READERS)}")
    except OSError as error:
        raise FleetError(file, "", error.strerror or str(error), "correct the path") from None
    except (ValueError, TypeError, OverflowError) as error:
        if isinstance(error, FleetError):
            raise
        raise FleetError(file, "", f"is no table of numbers: {error}", "correct the file") from None
    for path in found:
        if len(path.positions) < 2 or not numpy.isfinite(path.positions).all():
            raise FleetError(file, path.name, "has fewer than two states, or a number that is not finite", "correct the file")
    return found


def read_states(file) -> dict[str, float]:
    """The start state of a MoveIt motion plan request, by joint."""
    state = _request(pathlib.Path(file), "start_state")["start_state"]["joint_state"]
    return dict(zip(state["name"], map(float, state["position"])))


def read_group(file) -> str:
    """The group of a MoveIt motion plan request."""
    return str(_request(pathlib.Path(file), "group_name").get("group_name", ""))


def _request(file: pathlib.Path, element: str) -> dict[str, Any]:
    found = read_documents(file)
    try:
        (request,) = found
        state = request["start_state"]["joint_state"]
        names, values = state["name"], state["position"]
        if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
            raise ValueError("name is no list of names")
        if not isinstance(values, list) or len(values) != len(names) or not all(math.isfinite(float(value)) for value in values):
            raise ValueError(f"position is no list of {len(names)} finite numbers, one for each name")
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        raise FleetError(file, element, f"is no request with a start state: {error!r}", "give a start_state with a joint_state") from None
    once(file, "start_state.joint_state.name", names, "joint")
    return request


def read_joints(file, element: str, variables: list[str]) -> tuple[numpy.ndarray, numpy.ndarray]:
    """(start, goal) of a MoveIt motion plan request whose goal is given by joints."""
    file = pathlib.Path(file)
    request, start = _request(file, element), read_states(file)
    try:
        constraints = request["goal_constraints"][0]["joint_constraints"]
        once(file, "goal_constraints[0].joint_constraints", [entry["joint_name"] for entry in constraints], "joint")
        goal = {entry["joint_name"]: entry["position"] for entry in constraints}
        return numpy.array([start[name] for name in variables], float), numpy.array([goal.get(name, start[name]) for name in variables], float)
    except (KeyError, IndexError, TypeError, ValueError) as error:
        if isinstance(error, FleetError):
            raise
        raise FleetError(file, element, f"is no request with joint constraints: {error!r}", "give joint_constraints for the group") from None
