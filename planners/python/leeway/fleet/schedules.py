# SPDX-License-Identifier: BSD-3-Clause
"""Kind of work on world files: are all motions of several robots and objects on one clock free, at all times?"""
from __future__ import annotations

import hashlib
import pathlib
from typing import Any

import numpy

from .._core import TimedWorld, Verdict
from .campaign import Option, files_of
from .documents import regular
from .errors import FleetError
from .files import digest_of_file
from .kinds import CHECKS, Kind, Part, Rows, pair_columns
from .tables import Column, Words
from .worlds import Worlds

__all__ = ["Schedules"]

INFINITY = float("inf")


def _digest(world: TimedWorld, folder: pathlib.Path) -> str:
    """SHA-256 of the one robot, its meshes with it, and of all files that the world names. Folders do not matter."""
    digest = hashlib.sha256(world.digest.encode())
    for name in world.files:
        digest.update(digest_of_file(folder / name).encode())
    return digest.hexdigest()


class Schedules(Kind):
    """A row is a world file. No pair tables are made: how many there are depends on the machine."""

    in_scenes = of_robots = False
    block = 1
    options = {"files": Option(list, []), "packages": Option(list, []), **CHECKS, "slack": Option(float, 1e-3, 1e-9), "start": Option(float, 0.0),
        "end": Option(float, INFINITY), "contact_resolution": Option(float, 0.0, 0)}

    def prepare(self, campaign, element: str, entry: dict[str, Any]) -> dict[str, Any]:
        files = files_of(campaign, f"{element}.files", entry["files"])
        if not files:
            raise FleetError(campaign.file, f"{element}.files", "is missing", "name world files")
        if not entry["start"] <= entry["end"]:
            raise FleetError(campaign.file, f"{element}.end", f"is before start, {entry['start']}", "give a later time")
        return {"files": files}

    def count(self, entry, extra, worlds, robot) -> int:
        return len(extra["files"])

    def columns(self, part: Part, worlds: Worlds) -> list[Column]:
        return [Column("scene", "int32", "", "0"), Column("file", "string", "", "the world"),
            Column("digest", "string", "", "of its robots and objects with their meshes, and of all files that it names"),
            Column("end", "double", "s", "of the interval"), Column("verdict", "uint8", "", "1 FREE, 2 BLOCKED, 3 UNDECIDED"),
            Column("time", "double", "s", "of the contact or undecided state; the end if FREE"),
            Column("proved_until", "double", "s", "all before is proved"),
            Column("by_unknown_motion", "bool", "", "apart on the tracks, by no more than an unknown motion may have come nearer"),
            Column("lower", "double", "m", "proved lower bound of all clearances of a FREE schedule; else 0"),
            Column("clearance", "double", "m", "of the deciding pair; infinite if FREE"), *pair_columns("the deciding pair"),
            Column("states", "int64", "1", "at which distances were measured")]

    def _row(self, part: Part, worlds: Worlds, file: str) -> dict[str, Any]:
        o = part.options
        worlds.check_file(file)
        world = TimedWorld(str(regular(worlds.folder / file)), packages=[str(worlds.folder / p) for p in o["packages"]], proof_seconds=0.0)
        # a loop, or a part that only may move, has no end of its own
        end = float(o["end"]) if float(o["end"]) < INFINITY else max(world.duration, o["start"])
        found = world.prove(start=o["start"], end=end, min_d=o["min_d"], slack=o["slack"], check=o["check"], contact_resolution=o["contact_resolution"])
        hit = found.get("violation") or {"time": end, "by_unknown_motion": False, "clearance": INFINITY, "pair": ("", "")}
        return {"digest": _digest(world, worlds.folder), "end": end, "verdict": int(Verdict[found["verdict"]]), "time": hit["time"],
            "proved_until": found["proved_until"], "by_unknown_motion": hit["by_unknown_motion"], "lower": found["lower_bound"],
            "clearance": hit["clearance"], "first": hit["pair"][0], "second": hit["pair"][1], "states": found["states"]}

    def make(self, part: Part, worlds: Worlds, scene: int, begin: int, end: int) -> Rows:
        files = part.extra["files"][begin:end]
        rows = [self._row(part, worlds, file) for file in files]
        place = numpy.arange(len(rows), dtype="<i4")
        words = {name: Words(place, [row[name] for row in rows]) for name in ("digest", "first", "second")}
        values = {name: numpy.array([row[name] for row in rows]) for name in rows[0] if name not in words}
        return Rows({"scene": numpy.zeros(len(rows), "<i4"), "file": Words(place, files), **values, **words}, {})
