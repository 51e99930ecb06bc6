# SPDX-License-Identifier: BSD-3-Clause
"""Kind of work on timed trajectories: random ones, or files such as a fleet drove."""
from __future__ import annotations

from typing import Any

import numpy

from .._core import Checker, Verdict
from .campaign import Option, files_of
from .errors import FleetError
from .kinds import CHECKS, Kind, Part, Rows, address_of, bounded, named_pairs, pair_columns, worst
from .looks import least_clearance
from .paths import PathData
from .seeds import key_of, rows_of
from .tables import Column, Words
from .worlds import Worlds

__all__ = ["Trajectories"]


def states_at(path: PathData, times: numpy.ndarray) -> numpy.ndarray:
    """States of the polynomial pieces: quintic with accelerations, cubic with velocities, else straight. By Hermite's formulas, not the
    control points that the proofs use."""
    i = numpy.clip(numpy.searchsorted(path.times, times, side="right") - 1, 0, len(path.times) - 2)
    h = (path.times[i + 1] - path.times[i])[:, None]
    u = (times - path.times[i])[:, None] / h
    p0, p1 = path.positions[i], path.positions[i + 1]
    if path.velocities is None:
        return p0 + u * (p1 - p0)
    v0, v1 = h * path.velocities[i], h * path.velocities[i + 1]
    if path.accelerations is None:
        return (2 * u**3 - 3 * u**2 + 1) * p0 + (u**3 - 2 * u**2 + u) * v0 + (3 * u**2 - 2 * u**3) * p1 + (u**3 - u**2) * v1
    a0, a1 = h * h * path.accelerations[i], h * h * path.accelerations[i + 1]
    return ((1 - 10 * u**3 + 15 * u**4 - 6 * u**5) * p0 + (u - 6 * u**3 + 8 * u**4 - 3 * u**5) * v0
        + (u**2 - 3 * u**3 + 3 * u**4 - u**5) / 2 * a0 + (10 * u**3 - 15 * u**4 + 6 * u**5) * p1
        + (-4 * u**3 + 7 * u**4 - 3 * u**5) * v1 + (u**3 - 2 * u**4 + u**5) / 2 * a1)


class Trajectories(Kind):
    """Proofs of timed trajectories at all times. Without files: random ones of cubic pieces, at rest at both ends. A row is a trajectory."""
    block = 4
    options = {"rows": Option(int, 100, 1), "files": Option(list, []), **CHECKS, "slack": Option(float, 1e-3, 1e-9), "pieces": Option(int, 4, 1),
        "length": Option(float, 1.0, 1e-6), "speed": Option(float, 1.0, 1e-6), "audit": Option(float, 0.0, 0, (), 1), "audit_step": Option(float, 0.01, 1e-6)}

    def prepare(self, campaign, element: str, entry: dict[str, Any]) -> dict[str, Any]:
        if entry["files"] and len(entry["robots"]) != 1:
            raise FleetError(campaign.file, f"{element}.robots", "are not one", "give the robot of these trajectories")
        return {"files": files_of(campaign, f"{element}.files", entry["files"])}

    def count(self, entry, extra, worlds, robot) -> int:
        extra["paths"] = []
        if not extra["files"]:
            return entry["rows"]
        checker = worlds.checker_of(robot, worlds.problem("", 0)[0])
        for file in extra["files"]:
            for i, path in enumerate(worlds.paths(file, checker.variables)):
                if path.times is None or len(path.times) != len(path.positions) or not (numpy.diff(path.times) > 0).all():
                    raise FleetError(worlds.folder / file, path.name, "has no rising times", "give a trajectory, or the kind audit")
                extra["paths"].append([file, i, path.name])
        return len(extra["paths"])

    def columns(self, part: Part, worlds: Worlds) -> list[Column]:
        checker = worlds.checker(part.robot, "", 0)
        if not part.extra["paths"]:
            bounded(checker, part.robot)
        return [Column("scene", "int32", "", "index into the part's scenes"), Column("file", "string", "", "of the trajectory; empty if random"),
            Column("path", "string", "", "its name in the file"), Column("duration", "double", "s", ""),
            Column("positions", "list", "rad or m", "random trajectories: states at their points one after the other"),
            Column("times", "list", "s", "random trajectories: of the points"),
            Column("verdict", "uint8", "", "of all pieces: 1 FREE, 2 BLOCKED, 3 UNDECIDED"),
            Column("time", "double", "s", "of the first colliding or undecided state; the duration if FREE"),
            Column("proved_until", "double", "s", "all before is proved"),
            Column("lower", "double", "m", "proved lower bound of all clearances of a FREE trajectory; else 0"),
            Column("clearance", "double", "m", "of the deciding pair; infinite if FREE"), *pair_columns("the deciding pair"),
            Column("audited", "bool", "", "dense states were looked at"), Column("least", "double", "m", "least clearance of dense states, or NaN"),
            Column("contradiction", "bool", "", "a dense state refutes the verdict")]

    def _random(self, part: Part, checker: Checker, numbers: numpy.ndarray) -> PathData:
        o, dof = part.options, checker.dof
        span = checker.upper - checker.lower
        q = [checker.lower + numbers[:dof] * span]
        for k in range(o["pieces"]):
            toward = checker.lower + numbers[(k + 1) * dof:(k + 2) * dof] * span - q[-1]
            q.append(q[-1] + toward * min(1.0, o["length"] / max(1e-300, float(numpy.sqrt(numpy.square(toward).sum())))))
        positions = numpy.array(q)
        steps = numpy.maximum(numpy.abs(numpy.diff(positions, axis=0)).max(axis=1) / o["speed"], 1e-3)
        times = numpy.concatenate([[0.0], numpy.cumsum(steps)])
        velocities = numpy.zeros_like(positions)
        velocities[1:-1] = (positions[2:] - positions[:-2]) / (times[2:] - times[:-2])[:, None]
        return PathData("", positions, times, velocities)

    def _row(self, part: Part, checker: Checker, scene: int, path: PathData, look: bool) -> dict[str, Any]:
        o = part.options
        found = checker.trajectory(path.times, path.positions, path.velocities, path.accelerations, min_d=o["min_d"], slack=o["slack"], check=o["check"])
        verdict, free = worst(found.verdicts), int(Verdict.FREE)
        first = int(numpy.flatnonzero(found.verdicts != free)[0]) if verdict != free else len(found.verdicts) - 1
        steps = numpy.diff(path.times)
        begin, duration = path.times[first] - path.times[0], float(path.times[-1] - path.times[0])
        row = {"scene": scene, "duration": duration, "verdict": verdict, "time": float(begin + found.t[first] * steps[first]),
            "proved_until": float(begin + found.proved_until[first] * steps[first]), "lower": float(found.lower.min()) if verdict == free else 0.0,
            "clearance": float(found.clearance[first]), "pair": found.pairs[first], "audited": look, "least": numpy.nan, "contradiction": False}
        if look:
            count = int(numpy.ceil(numpy.abs(numpy.diff(path.positions, axis=0)).max(axis=1).sum() / o["audit_step"])) + 1
            row["least"], _ = least_clearance(checker, lambda t: states_at(path, path.times[0] + t * duration), o["check"], count)
            row["contradiction"] = verdict == free and (row["least"] <= o["min_d"] or row["least"] < row["lower"] - 1e-9)
        return row

    def make(self, part: Part, worlds: Worlds, scene: int, begin: int, end: int) -> Rows:
        checker, given = worlds.checker(part.robot, *part.scenes[scene]), part.extra["paths"]
        numbers = rows_of(key_of(*address_of(part, worlds, scene)), begin, end, (part.options["pieces"] + 1) * checker.dof + 1)
        if given:
            paths = [worlds.paths(file, checker.variables)[index] for file, index, _ in given[begin:end]]
        else:
            paths = [self._random(part, checker, row) for row in numbers]
        rows = [self._row(part, checker, scene, path, row[-1] < part.options["audit"]) for path, row in zip(paths, numbers)]
        values: dict[str, Any] = {name: numpy.array([row[name] for row in rows]) for name in rows[0] if name != "pair"}
        place = numpy.arange(len(rows), dtype="<i4")
        values.update(file=Words(place, [entry[0] for entry in given[begin:end]] or [""] * len(rows)),
            path=Words(place, [entry[2] for entry in given[begin:end]] or [""] * len(rows)),
            positions=[[] if given else path.positions.ravel() for path in paths], times=[[] if given else path.times for path in paths],
            **named_pairs(checker, numpy.array([row["pair"] for row in rows])))
        return Rows(values, {})
