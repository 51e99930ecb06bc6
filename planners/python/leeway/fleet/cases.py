# SPDX-License-Identifier: BSD-3-Clause
"""Problems of the referee by name: those of a table `problems.toml` in the data folder, which may have any names, and those of leeway-bench planning.

    [[problem]]
    name = "Lab 3 / shelf, left"        # as the lines of paths have it
    urdf = "ours.urdf"                  # files are relative to the folder
    srdf = "ours.srdf"                  # it may be left out, as all below; then paths are of all variables
    scene = "lab 3/shelf.yaml"          # "": no obstacles
    request = "lab 3/left.yaml"         # its start state has the joints outside of the group; "": the robot's default state
    robot = "ours"                      # names of rows in the tables; the stem of the URDF, "problems"
    set = "shelf"
"""
from __future__ import annotations

import pathlib
import unicodedata
from typing import Any, NamedTuple

from .campaign import REQUIRED, Option, checked
from .documents import ONCE, parse_toml, read_text
from .errors import FleetError

__all__ = ["Case", "Cases", "TABLE", "same_name"]

TABLE = "problems.toml"
ALL = "all"  # the set of all problems, in the referee's tables
PROBLEM = {"name": Option(str, REQUIRED), "urdf": Option(str, REQUIRED), "srdf": Option(str, ""), "scene": Option(str, ""), "request": Option(str, ""),
    "robot": Option(str, ""), "set": Option(str, "problems")}


class Case(NamedTuple):
    """Files of a problem; None: it has none."""
    robot: str
    set: str
    urdf: pathlib.Path
    srdf: pathlib.Path | None
    scene: pathlib.Path | None
    request: pathlib.Path | None


def same_name(name: str) -> str:
    """Equal for names that look the same: one letter may be written by one or by two code points."""
    return unicodedata.normalize("NFC", name)


class Cases:
    """The problems of a data folder."""

    def __init__(self, data: pathlib.Path):
        self.data = data
        self.named: dict[str, Case] = {}
        if (data / TABLE).exists():
            self._read(data / TABLE)

    def _read(self, file: pathlib.Path) -> None:
        try:
            given = parse_toml(read_text(file))
        except FleetError:
            raise
        except ValueError as error:
            raise FleetError(file, "", str(error), ONCE if "again in line" in str(error) else "correct the TOML") from None
        places: dict[str, int] = {}
        for i, values in enumerate(checked(file, "", given, {"problem": Option(list, REQUIRED, of=dict)})["problem"]):
            entry = checked(file, f"problem[{i}]", values, PROBLEM)
            name = same_name(entry["name"])
            if name in places:
                raise FleetError(file, f"problem[{places[name]}] and problem[{i}]", f"have the same name {entry['name']!r}", "give each a name of its own")
            if entry["set"] == ALL:
                raise FleetError(file, f"problem[{i}].set", f"is {ALL!r}, the row of all sets", "give another name")
            places[name] = i
            self.named[name] = self._case(entry)

    def _case(self, entry: dict[str, Any]) -> Case:
        def at(key: str) -> pathlib.Path | None:
            return self.data / entry[key] if entry[key] else None

        urdf = self.data / entry["urdf"]
        return Case(entry["robot"] or urdf.stem, entry["set"], urdf, at("srdf"), at("scene"), at("request"))

    def case(self, problem: str) -> Case:
        """A problem of the table, or "panda panda_arm/box_panda/1" of MotionBenchMaker's, "armar3 planner/06" of ARMAR-III's reaches, or "kitchen 04_table"
        of leeway.fleet.reaches."""
        named = self.named.get(same_name(problem))
        if named is not None:
            return named
        robot, _, rest = problem.partition(" ")
        parts, data = rest.split("/"), self.data
        known = "\0" not in problem and all(part not in ("", ".", "..") for part in (*robot.split("/"), *parts))
        if known and robot == "armar3" and len(parts) == 2:
            folder = data / "armar3"
            return Case(robot, "reaches", folder / "armar3.urdf", folder / "armar3.srdf", data / "kit_kitchen" / "scene_cluttered.yaml",
                folder / "reach" / f"{parts[1]}.yaml")
        if known and (data / "reach" / f"{rest}.yaml").exists():
            return Case(robot, "reaches", data / "robot.urdf", data / "robot.srdf", data / "scene.yaml", data / "reach" / f"{rest}.yaml")
        if known and len(parts) == 3 and parts[2].isascii() and parts[2].isdigit():
            folder = data / "mbm" / robot
            place, number = folder / "problems" / parts[1], f"{int(parts[2]):04d}.yaml"
            return Case(robot, parts[1], folder / f"{robot}.urdf", folder / f"{robot}.srdf", place / f"scene{number}", place / f"request{number}")
        raise FleetError(data, problem, "is no problem that the referee knows", f"name its files in {data / TABLE}, or give lines of leeway-bench planning --paths without --zoo")
