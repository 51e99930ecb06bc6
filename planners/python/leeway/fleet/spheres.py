# SPDX-License-Identifier: BSD-3-Clause
"""Kind of work on spherised models: do their spheres contain the robot's links, and by how much do they not?"""
from __future__ import annotations

from typing import Any

import numpy

from .._core import Robot, check_spheres
from .campaign import Option
from .documents import read_documents, regular
from .errors import FleetError
from .kinds import Kind, Part, Rows
from .tables import Column, Words
from .worlds import Worlds

__all__ = ["Spheres", "read_spheres"]


def _of_urdf(robot: Robot, file) -> dict[str, numpy.ndarray]:
    out = {}
    for link, placed in robot.collision.items():
        balls = []
        for shape, pose in placed:
            if shape.type == "spheres":
                balls += [[*(pose[:3, :3] @ centre + pose[:3, 3]), radius] for centre, radius in zip(shape.vertices, shape.radii)]
            elif shape.type == "sphere":
                balls.append([*pose[:3, 3], shape.bounds[1, 0]])
            else:
                raise FleetError(file, f"link {link}", f"has a {shape.type}", "give a URDF whose collision shapes are spheres")
        out[link] = numpy.array(balls).reshape(-1, 4)
    return out


def _of_table(value: Any, file) -> dict[str, numpy.ndarray]:
    """cuRobo's YAML, {link: [{center, radius}]} perhaps below robot_cfg.kinematics.collision_spheres; or {link: [[x, y, z, r]]}."""
    for key in ("robot_cfg", "kinematics", "collision_spheres", "links"):
        if isinstance(value, dict) and isinstance(value.get(key), dict):
            value = value[key]
    try:
        return {link: numpy.array([[*ball["center"], ball["radius"]] if isinstance(ball, dict) else ball for ball in balls], float).reshape(-1, 4)
            for link, balls in value.items()}
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise FleetError(file, "", f"is no table of spheres: {error!r}", "give {link: [[x, y, z, radius], ...]}") from None


def read_spheres(file) -> dict[str, numpy.ndarray]:
    """float64 [n, 4] by link, in its frame: of a URDF, of cuRobo's YAML, or of JSON {link: [[x, y, z, radius], ...]}."""
    if file.suffix in (".json", ".yaml", ".yml"):
        found = read_documents(file)
        if len(found) != 1:
            raise FleetError(file, "", f"holds {len(found)} documents", "give one table of spheres")
        return _of_table(found[0], file)
    return _of_urdf(Robot(regular(file)), file)


class Spheres(Kind):
    """A row is a link with collision geometry. The robot's entry names its spheres."""

    in_scenes = False
    block = 1
    options = {"close_holes": Option(float, 0.002, 0)}

    def prepare(self, campaign, element: str, entry: dict[str, Any]) -> dict[str, Any]:
        for robot in entry["robots"]:
            if not campaign.values["robots"][robot]["spheres"]:
                raise FleetError(campaign.file, f"robots.{robot}.spheres", "is missing", "give a spherised URDF, cuRobo's YAML, or JSON")
        return {}

    def count(self, entry, extra, worlds, robot) -> int:
        extra["links"] = [link for link, placed in worlds.robot(robot).collision.items() if placed]
        return len(extra["links"])

    def columns(self, part: Part, worlds: Worlds) -> list[Column]:
        return [Column("scene", "int32", "", "0"), Column("link", "string", "", ""), Column("shapes", "int64", "1", "collision shapes of the link"),
            Column("spheres", "int64", "1", "of the model"), Column("encloses", "bool", "", "proved: the spheres contain the link"),
            Column("uncovered", "double", "m", "distance from all spheres to a part of the link; 0 if they contain it"),
            *[Column(f"{axis}_uncovered", "double", "m", f"{axis} of that part in the link's frame") for axis in "xyz"],
            Column("excess", "double", "m", "proved: no point of a sphere is farther from the link"),
            Column("excess_attained", "double", "m", "measured at a point of a sphere"), Column("open_shells", "int64", "1", "meshes with holes: their inside does not count")]

    def make(self, part: Part, worlds: Worlds, scene: int, begin: int, end: int) -> Rows:
        robot = worlds.robot(part.robot)
        given = read_spheres(worlds.folder / worlds.plan["campaign"]["robots"][part.robot]["spheres"])
        links, rows = part.extra["links"][begin:end], []
        for link in links:
            placed, balls = robot.collision[link], given.get(link, numpy.empty((0, 4)))
            bare = {"encloses": False, "uncovered": numpy.inf, "uncovered_at": numpy.full(3, numpy.nan), "excess": numpy.nan, "excess_attained": numpy.nan, "open_shells": 0}
            report = check_spheres(placed, balls, close_holes=part.options["close_holes"]) if len(balls) else bare
            rows.append({"shapes": len(placed), "spheres": len(balls), **report})
        values: dict[str, Any] = {name: numpy.array([row[name] for row in rows])
            for name in ("shapes", "spheres", "encloses", "uncovered", "excess", "excess_attained", "open_shells")}
        places = numpy.array([row["uncovered_at"] for row in rows])
        values.update(scene=numpy.zeros(len(rows), "<i4"), link=Words(numpy.arange(len(rows), dtype="<i4"), links),
            **{f"{axis}_uncovered": places[:, i] for i, axis in enumerate("xyz")})
        return Rows(values, {})
