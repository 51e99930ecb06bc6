# SPDX-License-Identifier: BSD-3-Clause
"""Robots, scenes and checkers of a campaign, made once in each process from the files and seeds that its plan names."""
from __future__ import annotations

import collections
import hashlib
import pathlib
import threading
from typing import Any, Callable

import numpy

from .._core import Checker, Robot, Scene
from .documents import regular
from .files import digest_of_file
from .errors import FleetError
from .paths import PathData, read_paths, read_states
from .scenes import generate

__all__ = ["Worlds", "robot_of", "scene_digest"]

MOST_CHECKERS = 16  # kept in a process; neighbouring rows are of one scene


def robot_of(folder: pathlib.Path, entry: dict[str, Any]) -> Robot:
    """Reads a robot of a campaign."""
    return Robot(regular(folder / entry["urdf"]), regular(folder / entry["srdf"]) if entry["srdf"] else "", packages=[str(folder / p) for p in entry["packages"]])


def scene_digest(scene: Scene) -> str:
    """SHA-256 of the objects' names, shapes and poses."""
    digest = hashlib.sha256()
    for name in scene.objects:
        digest.update(name.encode() + b"\0")
        for shape, pose in scene.shapes(name):
            digest.update(shape.digest.encode() + numpy.ascontiguousarray(pose).tobytes())
    return digest.hexdigest()


def _kept(cache: collections.OrderedDict, key: tuple, make: Callable[[], Any]) -> Any:
    """The entry of the key, made if it is not there; the one that nobody asked for the longest leaves a full cache."""
    if key not in cache:
        cache[key] = make()
        if len(cache) > MOST_CHECKERS:
            cache.popitem(last=False)
    cache.move_to_end(key)
    return cache[key]


class Worlds:
    """Robots, scenes and checkers of a plan: functions of the plan and of the campaign's files. Threads may share them."""

    def __init__(self, plan: dict[str, Any], folder):
        self.plan, self.folder = plan, pathlib.Path(folder)
        self._robots: dict[str, Robot] = {}
        self._scenes: collections.OrderedDict = collections.OrderedDict()
        self._checkers: collections.OrderedDict = collections.OrderedDict()
        self._paths: collections.OrderedDict = collections.OrderedDict()
        self._starts: collections.OrderedDict = collections.OrderedDict()
        self._lock = threading.RLock()

    def robot(self, name: str) -> Robot:
        with self._lock:
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
        with self._lock:
            return _kept(self._scenes, (name, instance), lambda: self._make_scene(name, instance))

    def _make_scene(self, name: str, instance: int) -> tuple[Scene, Any]:
        if not name:
            return Scene(), None
        entry = self.plan["campaign"]["scenes"].get(name) or {"file": name, "generator": "", "packages": []}  # a table names files
        if entry["generator"]:
            return generate(self, name, entry, instance)
        scene = Scene(regular(self.folder / entry["file"]), packages=[str(self.folder / p) for p in entry["packages"]])
        expected = self.plan["inputs"]["scenes"].get(name)
        if expected is not None and scene_digest(scene) != expected:
            raise FleetError(self.folder / entry["file"], "", "is another scene than the manifest's",
                "put the old files back, or give another --out folder")
        return scene, None

    def paths(self, file: str, variables: list[str]) -> list[PathData]:
        """Somebody's paths, for these variables."""
        with self._lock:
            return _kept(self._paths, (file, *variables), lambda: self._read_paths(file, variables))

    def check_file(self, file: str) -> None:
        """Raises FleetError if a file of the work is not that of the plan."""
        expected = self.plan["inputs"].get("files", {}).get(file)
        if expected is not None and digest_of_file(regular(self.folder / file)) != expected:
            raise FleetError(self.folder / file, "", "is another file than the manifest's", "put the old file back, or give another --out folder")

    def _read_paths(self, file: str, variables: list[str]) -> list[PathData]:
        self.check_file(file)
        return read_paths(self.folder / file, variables)

    def start(self, file: str, robot: str) -> dict[str, float]:
        """The robot's joints in the start state of a request."""
        with self._lock:
            return _kept(self._starts, (file, robot), lambda: self._read_start(file, robot))

    def _read_start(self, file: str, robot: str) -> dict[str, float]:
        self.check_file(file)
        found = {name: value for name, value in read_states(self.folder / file).items() if name in self.robot(robot).variables}
        if not found:
            raise FleetError(self.folder / file, "start_state", f"has no joint of the robot {robot}", "give a request of this robot")
        return found

    def checker_of(self, robot: str, scene: Scene, start: dict[str, float] | None = None) -> Checker:
        """start: of the joints outside of the group, before the robot's reference."""
        entry = self.plan["campaign"]["robots"][robot]
        return Checker(self.robot(robot), scene, group=entry["group"], reference={**entry["reference"], **(start or {})} or None)

    def checker(self, robot: str, name: str, instance: int, start: str = "") -> Checker:
        """start: the file of a request, or ""."""
        with self._lock:
            return _kept(self._checkers, (robot, name, instance, start),
                lambda: self.checker_of(robot, self.problem(name, instance)[0], self.start(start, robot) if start else None))
