# SPDX-License-Identifier: BSD-3-Clause
"""Generators of scenes: kitchens, shelves, and variations of a nominal problem. Equal seeds give equal scenes, so nobody downloads any.

A parameter is a number, or [low, high]: then each scene draws its own. Metres and radians; z is up, and a robot stands at the origin and
looks along x.
"""
from __future__ import annotations

import math
import pickle
from typing import Any

import numpy

from .._core import Scene, Shape
from .campaign import shown
from .errors import FleetError, named
from .paths import read_joints
from .seeds import stream_of

__all__ = ["GENERATORS", "check_generator", "generate"]

SHELVES = {"distance": [0.5, 0.75], "turn": [-0.6, 0.6], "width": [0.7, 1.2], "depth": [0.25, 0.4], "height": [1.0, 1.6], "board": [0.018, 0.03],
    "boards": [3, 5], "base": [-0.3, 0.1], "items": [4, 12], "item_radius": [0.02, 0.06], "item_height": [0.06, 0.28]}
KITCHEN = {"distance": [0.5, 0.7], "length": [1.6, 2.8], "depth": [0.55, 0.65], "counter": [0.1, 0.4], "top": [0.03, 0.05], "gap": [0.45, 0.6],
    "cupboard_depth": [0.3, 0.4], "cupboard_height": [0.5, 0.7], "door": [0.0, 2.2], "open_doors": [0, 2], "tap": [0.2, 0.35], "items": [4, 14],
    "item_radius": [0.02, 0.07], "item_height": [0.04, 0.3], "table": [0, 1], "table_height": [0.0, 0.3]}
VARIATION = {"object_shift": 0.02, "object_turn": 0.2, "base_shift": 0.05, "base_turn": 0.1, "min_d": 0.0, "tries": 50, "most_nodes": 20000}


def turned(angle: float, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> numpy.ndarray:
    """A pose: a turn about z, then a shift."""
    c, s = math.cos(angle), math.sin(angle)
    return numpy.array([[c, -s, 0, x], [s, c, 0, y], [0, 0, 1, z], [0, 0, 0, 1.0]])


class _Room:
    """Objects by name in a frame before the robot."""

    def __init__(self, frame: numpy.ndarray):
        self.scene, self.frame = Scene(), frame

    def box(self, name: str, size, centre, turn: float = 0.0, pivot=(0.0, 0.0)) -> None:
        """A box by its edges; turned about an upright axis at pivot."""
        about = turned(0, pivot[0], pivot[1]) @ turned(turn) @ turned(0, -pivot[0], -pivot[1])
        self.scene.add(name, Shape.box(*map(float, size)), self.frame @ about @ turned(0, *centre))

    def item(self, name: str, stream, x: float, y: float, z: float, drawn) -> None:
        """A can, a box or a ball that stands at x, y on the height z."""
        radius, height, turn = drawn("item_radius"), drawn("item_height"), stream.uniform(0, 2 * math.pi)
        kind = stream.integer(0, 2)
        if kind == 0:
            shape, half = Shape.cylinder(radius, height), height / 2
        elif kind == 1:
            shape, half = Shape.box(2 * radius, radius, height), height / 2
        else:
            shape, half = Shape.sphere(radius), radius
        self.scene.add(name, shape, self.frame @ turned(turn, x, y, z + half + 1e-3))


def _drawer(stream, ranges: dict[str, Any]):
    def drawn(name: str) -> float:
        value = ranges[name]
        if not isinstance(value, list):
            return float(value)
        whole = all(isinstance(end, int) for end in value)
        return float(stream.integer(*value)) if whole else stream.uniform(*map(float, value))
    return drawn


def _shelves(worlds, name, drawn, stream) -> tuple[Scene, Any]:
    width, depth, height, board, base = (drawn(key) for key in ("width", "depth", "height", "board", "base"))
    room = _Room(turned(drawn("turn")) @ turned(0, drawn("distance") + depth / 2))
    count = int(drawn("boards"))
    room.box("back", (board, width, height), (depth / 2, 0, base + height / 2))
    for side in (-1, 1):
        room.box("left side" if side > 0 else "right side", (depth, board, height), (0, side * width / 2, base + height / 2))
    levels = [base + board / 2 + (height - board) * k / (count - 1 if count > 1 else 1) for k in range(count)]
    for k, z in enumerate(levels):
        room.box(f"board {k}", (depth, width - board, board), (0, 0, z))
    for k in range(int(drawn("items"))):
        z = levels[stream.integer(0, count - 1)] + board / 2
        room.item(f"item {k}", stream, stream.uniform(-0.3, 0.2) * depth, stream.uniform(-0.42, 0.42) * width, z, drawn)
    return room.scene, None


def _kitchen(worlds, name, drawn, stream) -> tuple[Scene, Any]:
    length, depth, counter, top, gap = (drawn(key) for key in ("length", "depth", "counter", "top", "gap"))
    deep, high = drawn("cupboard_depth"), drawn("cupboard_height")
    room = _Room(turned(0, drawn("distance") + depth / 2))
    room.box("wall", (0.05, length + 1, 2.6), (depth / 2 + 0.026, 0, 0.5))
    room.box("top", (depth, length, top), (0, 0, counter - top / 2))
    below = counter - top
    room.box("carcass", (depth - 0.05, length, below + 0.5), (0.025, 0, (below - 0.5) / 2 - 1e-3))
    inner = (depth - deep) / 2
    shelf = counter + gap
    for part, (size, z) in {"cupboard floor": (0.018, 0.009), "cupboard board": (0.018, high / 2), "cupboard roof": (0.018, high - 0.009)}.items():
        room.box(part, (deep, length, size), (inner, 0, shelf + z))
    doors = max(2, round(length / 0.5))
    wide = length / doors
    opened = {stream.integer(0, doors - 1) for _ in range(int(drawn("open_doors")))}
    for k in range(doors):
        y = -length / 2 + wide * k
        front = inner - deep / 2 - 0.01
        angle = drawn("door") if k in opened else 0.0
        room.box(f"door {k}", (0.018, wide - 0.004, high), (front, y + wide / 2, shelf + high / 2), -angle, (front, y))
        room.box(f"partition {k}", (deep - 0.02, 0.018, high - 0.04), (inner + 0.01, y + 0.009, shelf + high / 2))
    tap = stream.uniform(-0.3, 0.3) * length
    rise = drawn("tap")
    room.box("tap", (0.03, 0.03, rise), (depth / 2 - 0.1, tap, counter + rise / 2))
    room.box("spout", (0.16, 0.025, 0.025), (depth / 2 - 0.18, tap, counter + rise))
    for k in range(int(drawn("items"))):
        y = stream.uniform(-0.45, 0.45) * length
        if stream.uniform() < 0.6:
            room.item(f"item {k}", stream, stream.uniform(-0.4, 0.3) * depth, y, counter, drawn)
        else:
            room.item(f"item {k}", stream, inner + stream.uniform(-0.3, 0.3) * deep, y, shelf + 0.018, drawn)
    if drawn("table") >= 1:
        z = drawn("table_height")
        at = (stream.uniform(-0.9, -0.6) - depth / 2, stream.choice_sign() * stream.uniform(0.7, 0.9))
        room.box("table", (0.7, 0.9, 0.03), (*at, z), stream.uniform(-0.3, 0.3), at)
    return room.scene, None


def _moved(scene: Scene, name: str, motion: numpy.ndarray) -> None:
    placed = [(shape, motion @ pose) for shape, pose in scene.shapes(name)]
    scene.remove(name)
    scene.add(name, placed, None)


def _reached(checker, parameters, goal: numpy.ndarray, robot, motions: dict[str, numpy.ndarray], attempt: int, min_d: float):
    """States in which the goal's link stands to its object (without one: to the world) as in the nominal problem; the nominal goal if no link is given."""
    link = parameters.get("goal_link")
    if link is None:
        return [goal]
    nominal = robot.fk(checker.full_state(goal)[:len(robot.variables)])[robot.links.index(link)]
    found = checker.goal_states(link, motions[parameters.get("goal_object", "")] @ nominal, count=4, seed=1 + attempt, min_d=min_d)
    return list(found.states)


def _variation(worlds, name, drawn, stream, parameters) -> tuple[Scene, Any]:
    """Poses of objects and of the base sampled until start and goal are free and a path between them is proved."""
    file, robot = f"scenes.{name}", parameters["robot"]
    if robot not in worlds.plan["campaign"]["robots"]:
        raise FleetError("campaign", f"{file}.parameters.robot", f"is {robot!r}", "name a robot of the campaign")
    nominal = Scene(str(worlds.folder / parameters["scene"]))
    for key, known in (("goal_link", worlds.robot(robot).links), ("goal_object", nominal.objects)):
        if key in parameters and parameters[key] not in known:
            raise FleetError("campaign", f"{file}.parameters.{key}", f"is {parameters[key]!r}", f"give one of {', '.join(known)}")
    variables = worlds.checker_of(robot, Scene()).variables
    start, goal = read_joints(worlds.folder / parameters["request"], f"{file}.request", variables)
    min_d = drawn("min_d")
    for attempt in range(int(drawn("tries"))):
        scene = pickle.loads(pickle.dumps(nominal))
        far, turn = drawn("base_shift"), drawn("base_turn")
        base = numpy.linalg.inv(turned(turn * stream.uniform(-1, 1), *(far * stream.uniform(-1, 1, size=2)), 0.0))
        motions = {"": base}
        for each in nominal.objects:
            centre = numpy.mean([pose[:3, 3] for _, pose in nominal.shapes(each)], axis=0)
            about = turned(0, *centre) @ turned(drawn("object_turn") * stream.uniform(-1, 1)) @ turned(0, *-centre)
            motions[each] = base @ turned(0, *(drawn("object_shift") * stream.uniform(-1, 1, size=2)), 0.0) @ about
            _moved(scene, each, motions[each])
        checker = worlds.checker_of(robot, scene)
        if not checker.is_free(start, min_d=min_d):
            continue
        for end in _reached(checker, parameters, goal, worlds.robot(robot), motions, attempt, min_d):
            if checker.is_free(end, min_d=min_d) and checker.plan(start, end, min_d=min_d, most_nodes=int(drawn("most_nodes")), smooth=False).solved:
                return scene, (robot, start, numpy.asarray(end))
    raise FleetError("campaign", file, f"has no feasible variation in {int(drawn('tries'))} tries", "give smaller shifts and turns, or more tries")


GENERATORS = {"shelves": (_shelves, SHELVES), "kitchen": (_kitchen, KITCHEN), "variations": (_variation, VARIATION)}


def _is_range(value: Any) -> bool:
    numbers = value if isinstance(value, list) else [value]
    fits = len(numbers) in (1, 2) and all(isinstance(n, (int, float)) and not isinstance(n, bool) and math.isfinite(n) for n in numbers)
    return fits and numbers[0] <= numbers[-1] and isinstance(value, list) == (len(numbers) == 2)


def check_generator(file, name: str, entry: dict[str, Any]) -> None:
    """Raises FleetError for a generator or a parameter that is not known."""
    if entry["generator"] not in GENERATORS:
        raise FleetError(file, f"scenes.{name}.generator", f"is {entry['generator']!r}", f"give one of {', '.join(GENERATORS)}")
    make, ranges = GENERATORS[entry["generator"]]
    needed = ("scene", "request", "robot") if make is _variation else ()
    texts = (*needed, "goal_link", "goal_object") if make is _variation else ()
    for key in needed:
        if not isinstance(entry["parameters"].get(key), str):
            raise FleetError(file, f"scenes.{name}.parameters.{key}", "is missing", "variations need scene, request and robot")
    for key, value in entry["parameters"].items():
        if key not in ranges and key not in texts:
            raise FleetError(file, f"scenes.{name}.parameters.{key}", "is no known parameter", f"known are {', '.join([*ranges, *texts])}")
        if not (isinstance(value, str) if key in texts else _is_range(value)):
            raise FleetError(file, f"scenes.{name}.parameters.{key}", f"is {shown(value)}", "give text in quotes" if key in texts else "give a number or [low, high]")


def generate(worlds, name: str, entry: dict[str, Any], instance: int) -> tuple[Scene, Any]:
    """(scene, nominal problem (robot, start, goal) or None) number `instance` of a generator."""
    make, ranges = GENERATORS[entry["generator"]]
    stream = stream_of(entry["seed"], entry["generator"], name, instance)
    drawn = _drawer(stream, {**ranges, **entry["parameters"]})
    with named("campaign", f"scenes.{name}, number {instance}"):
        if make is _variation:
            return _variation(worlds, name, drawn, stream, entry["parameters"])
        return make(worlds, name, drawn, stream)
