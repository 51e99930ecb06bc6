# SPDX-License-Identifier: BSD-3-Clause
"""Robots, scenes and checkers of a campaign, made once in each process from the files and seeds that its plan names."""
from __future__ import annotations

import atexit
import collections
import hashlib
import pathlib
from typing import Any

import numpy

from .._core import Checker, Robot, Scene
from .errors import FleetError
from .scenes import generate

__all__ = ["Worlds", "robot_of", "scene_digest"]

MOST_CHECKERS = 16  # kept in a process; neighbouring rows are of one scene


def robot_of(folder: pathlib.Path, entry: dict[str, Any]) -> Robot:
    """Reads a robot of a campaign."""
    return Robot(folder / entry["urdf"], str(folder / entry["srdf"]) if entry["srdf"] else "", packages=[str(folder / p) for p in entry["packages"]])


def scene_digest(scene: Scene) -> str:
    """SHA-256 of the objects' names, shapes and poses."""
    digest = hashlib.sha256()
    for name in scene.objects:
        digest.update(name.encode() + b"\0")
        for shape, pose in scene.shapes(name):
            digest.update(shape.digest.encode() + numpy.ascontiguousarray(pose).tobytes())
    return digest.hexdigest()


class Worlds:
    """Robots, scenes and checkers of a plan: functions of the plan and of the campaign's files."""

    _of_plans: dict[str, "Worlds"] = {}
    atexit.register(_of_plans.clear)  # before the interpreter takes the module down

    def __init__(self, plan: dict[str, Any], folder):
        self.plan, self.folder = plan, pathlib.Path(folder)
        self._robots: dict[str, Robot] = {}
        self._scenes: collections.OrderedDict = collections.OrderedDict()
        self._checkers: collections.OrderedDict = collections.OrderedDict()

    @classmethod
    def of(cls, plan: dict[str, Any], folder) -> "Worlds":
        """This process's worlds of a plan."""
        if plan["id"] not in cls._of_plans:
            cls._of_plans.clear()
            cls._of_plans[plan["id"]] = cls(plan, folder)
        return cls._of_plans[plan["id"]]

    def robot(self, name: str) -> Robot:
        if name not in self._robots:
            entry = self.plan["campaign"]["robots"][name]
            robot = robot_of(self.folder, entry)
            expected = self.plan["inputs"]["robots"].get(name, robot.digest)
            if robot.digest != expected:
                raise FleetError(self.folder / entry["urdf"], "", "is another robot than the manifest's",
                    "put the old files back, or give another --out folder")
            self._robots[name] = robot
        return self._robots[name]

    def problem(self, name: str, instance: int) -> tuple[Scene, Any]:
        """A scene, and the start and goal of its nominal problem, or None."""
        key = (name, instance)
        if key not in self._scenes:
            self._scenes[key] = self._make_scene(name, instance)
            if len(self._scenes) > MOST_CHECKERS:
                self._scenes.popitem(last=False)
        return self._scenes[key]

    def _make_scene(self, name: str, instance: int) -> tuple[Scene, Any]:
        if not name:
            return Scene(), None
        entry = self.plan["campaign"]["scenes"][name]
        if entry["generator"]:
            return generate(self, name, entry, instance)
        scene = Scene(str(self.folder / entry["file"]), packages=[str(self.folder / p) for p in entry["packages"]])
        expected = self.plan["inputs"]["scenes"].get(name)
        if expected is not None and scene_digest(scene) != expected:
            raise FleetError(self.folder / entry["file"], "", "is another scene than the manifest's",
                "put the old files back, or give another --out folder")
        return scene, None

    def checker_of(self, robot: str, scene: Scene) -> Checker:
        entry = self.plan["campaign"]["robots"][robot]
        return Checker(self.robot(robot), scene, group=entry["group"], reference=entry["reference"] or None)

    def checker(self, robot: str, name: str, instance: int) -> Checker:
        key = (robot, name, instance)
        if key not in self._checkers:
            self._checkers[key] = self.checker_of(robot, self.problem(name, instance)[0])
            if len(self._checkers) > MOST_CHECKERS:
                self._checkers.popitem(last=False)
        return self._checkers[key]
