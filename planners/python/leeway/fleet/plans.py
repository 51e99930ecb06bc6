# SPDX-License-Identifier: BSD-3-Clause
"""Kinds of work on whole paths: plans with their audit, and audits of somebody's paths."""
from __future__ import annotations

import time
from typing import Any

import numpy

from .._core import Checker, Outcome, Verdict
from .campaign import REQUIRED, Option, checked, files_of
from .errors import FleetError
from .kinds import CHECKS, Kind, Part, Rows, address_of, bounded, named_pairs, pair_columns, worst
from .looks import least_clearance
from .planners import PLANNER, check_planners, length_of, plan_by
from .seeds import stream_of
from .tables import Column, Words
from .worlds import Worlds

__all__ = ["Audits", "Plans", "look_at_path"]

TRIES = 2000  # random states in search of a free one


def look_at_path(checker: Checker, path: numpy.ndarray, check: str, step: float) -> tuple[float, int, float, float]:
    """(least clearance, its edge and t, share of the length in contact) of dense states."""
    least, edge, place, touching, length = float("inf"), 0, 0.0, 0.0, 0.0
    for i, (a, b) in enumerate(zip(path[:-1], path[1:])):
        toward = numpy.where(checker.wraps, numpy.remainder(b - a + numpy.pi, 2 * numpy.pi) - numpy.pi, b - a)

        def at(t, a=a, toward=toward):
            return a + numpy.asarray(t)[:, None] * toward

        count = int(numpy.ceil(numpy.abs(toward).max() / step)) + 1
        value, t = least_clearance(checker, at, check, count)
        far = float(numpy.sqrt(numpy.square(toward).sum()))
        if value <= 0:
            touching += far * float((checker.clearance(at(numpy.linspace(0, 1, max(3, 4 * count))), check=check, witnesses=False).upper <= 0).mean())
        length += far
        if value < least:
            least, edge, place = value, i, t
    return least, edge, place, touching / length if length > 0 else 0.0


class Plans(Kind):
    """Planning problems between random free states, or a scene's nominal one, each by every planner; dense looks at the paths."""
    block = 4
    options = {"rows": Option(int, 10, 1), **CHECKS, "slack": Option(float, 1e-3, 1e-9), "planners": Option(list, [{"name": "leeway"}], of=dict),
        "most_nodes": Option(int, 20000, 1), "audit_step": Option(float, 0.01, 1e-6)}

    def prepare(self, campaign, element: str, entry: dict[str, Any]) -> dict[str, Any]:
        planners = [checked(campaign.file, f"{element}.planners[{i}]", given, PLANNER) for i, given in enumerate(entry["planners"])]
        return {"planners": planners, "versions": check_planners(campaign.file, f"{element}.planners", planners)}

    def count(self, entry, extra, worlds, robot) -> int:
        return entry["rows"] * len(extra["planners"])

    def columns(self, part: Part, worlds: Worlds) -> list[Column]:
        bounded(worlds.checker(part.robot, "", 0), part.robot)
        return [Column("scene", "int32", "", "index into the part's scenes"), Column("problem", "int64", "", "number in the scene"),
            Column("planner", "string", "", "of the campaign"), Column("outcome", "string", "", "of leeway.Outcome; only SOLVED has a path"),
            Column("length", "double", "rad or m", "Euclidean, of the path"), Column("raw_length", "double", "rad or m", "before smoothing"),
            Column("samples", "int64", "1", "that the search drew; of OMPL's planners iterations"),
            Column("edge_checks", "int64", "1", "proofs that the search asked for; 0 with sampled motions"),
            Column("state_checks", "int64", "1", "states that a planner of OMPL asked for; 0 of leeway's"),
            Column("start", "list", "rad or m", "state of the group"), Column("goal", "list", "rad or m", "state of the group"),
            Column("path", "list", "rad or m", "states of the group one after the other"),
            Column("least", "double", "m", "least clearance of dense states; NaN without a path"),
            Column("contact", "bool", "", "a dense state is at min_d or nearer"), Column("proved", "bool", "", "all edges of the path are proved FREE"),
            Column("contradiction", "bool", "", "a dense state refutes a proof")]

    def measured(self, part: Part) -> list[Column]:
        return [Column("seconds", "double", "s", "processor time of the search and smoothing")]

    def _free(self, checker: Checker, stream, part: Part) -> numpy.ndarray | None:
        for _ in range(TRIES // 50):
            q = stream.uniform(checker.lower, checker.upper, (50, checker.dof))
            free = numpy.flatnonzero(checker.is_free(q, min_d=part.options["min_d"], check=part.options["check"]))
            if len(free):
                return q[free[0]]
        return None

    def _ends(self, part: Part, worlds: Worlds, checker: Checker, scene: int, problem: int):
        name, instance = part.scenes[scene]
        nominal = worlds.problem(name, instance)[1]
        if nominal is not None and nominal[0] == part.robot:
            return nominal[1], nominal[2]
        stream = stream_of(*address_of(part, worlds, scene), problem)
        return self._free(checker, stream, part), self._free(checker, stream, part)

    def make(self, part: Part, worlds: Worlds, scene: int, begin: int, end: int) -> Rows:
        checker, o = worlds.checker(part.robot, *part.scenes[scene]), part.options
        rows = [self._row(part, worlds, checker, scene, row, o) for row in range(begin, end)]
        columns = [column.name for column in self.columns(part, worlds)]
        values: dict[str, Any] = {name: [row[name] for row in rows] for name in columns}
        for name in ("planner", "outcome"):
            words = sorted(set(values[name]))
            values[name] = Words(numpy.array([words.index(word) for word in values[name]], "<i4"), words)
        for column in self.columns(part, worlds):
            if column.type not in ("string", "list"):
                values[column.name] = numpy.array(values[column.name])
        return Rows(values, {"seconds": numpy.array([row["seconds"] for row in rows])})

    def _row(self, part: Part, worlds: Worlds, checker: Checker, scene: int, row: int, o: dict[str, Any]) -> dict[str, Any]:
        problem, which = divmod(row, len(part.extra["planners"]))
        planner = part.extra["planners"][which]
        start, goal = self._ends(part, worlds, checker, scene, problem)
        out = {"scene": scene, "problem": problem, "planner": planner["name"], "outcome": Outcome.NO_START.name, "length": numpy.nan,
            "raw_length": numpy.nan, "samples": 0, "edge_checks": 0, "state_checks": 0, "start": [] if start is None else start,
            "goal": [] if goal is None else goal, "path": [], "least": numpy.nan, "contact": False, "proved": False, "contradiction": False,
            "seconds": numpy.nan}
        if start is None or goal is None:
            return out
        clock = time.process_time()
        found = plan_by(planner, part.extra["versions"], checker, start, goal, 1 + problem, o)
        out.update(seconds=time.process_time() - clock, outcome=found.outcome, samples=found.samples, edge_checks=found.edge_checks,
            state_checks=found.state_checks)
        if found.path is not None:
            least = look_at_path(checker, found.path, o["check"], o["audit_step"])[0]
            contact, proved = least <= o["min_d"], checker.path(found.path, min_d=o["min_d"], slack=o["slack"], check=o["check"]).all_free
            out.update(length=length_of(checker, found.path), raw_length=found.raw_length, path=found.path.ravel(), least=least, contact=contact,
                proved=proved, contradiction=contact and (proved or planner["algorithm"] == "leeway"))
        return out


class Audits(Kind):
    """Somebody's paths: proofs of their edges, and dense looks. A row is a path."""
    block = 4
    options = {"files": Option(list, REQUIRED), **CHECKS, "slack": Option(float, 1e-4, 1e-9), "audit_step": Option(float, 0.01, 1e-6)}

    def prepare(self, campaign, element: str, entry: dict[str, Any]) -> dict[str, Any]:
        if len(entry["robots"]) != 1:
            raise FleetError(campaign.file, f"{element}.robots", "are not one", "give the robot of these paths")
        return {"files": files_of(campaign, f"{element}.files", entry["files"])}

    def count(self, entry, extra, worlds, robot) -> int:
        checker = worlds.checker_of(robot, worlds.problem("", 0)[0])
        extra["paths"] = [[file, i, path.name] for file in extra["files"]
            for i, path in enumerate(worlds.paths(file, checker.variables))]
        return len(extra["paths"])

    def columns(self, part: Part, worlds: Worlds) -> list[Column]:
        return [Column("scene", "int32", "", "index into the part's scenes"), Column("file", "string", "", "of the path"),
            Column("path", "string", "", "its name in the file"), Column("states", "int64", "1", "of the path"),
            Column("length", "double", "rad or m", "Euclidean"), Column("verdict", "uint8", "", "of all edges: 1 FREE, 2 BLOCKED, 3 UNDECIDED"),
            Column("edge", "int64", "", "the first edge that is not FREE; -1 if there is none"), Column("t", "double", "1", "share of it"),
            Column("lower", "double", "m", "proved lower bound of all clearances of a FREE path; else 0"),
            *pair_columns("the deciding pair"), Column("outside", "bool", "", "a state is outside of the joint limits"),
            Column("least", "double", "m", "least clearance of dense states"), Column("contact_share", "double", "1", "share of the length in contact"),
            Column("contradiction", "bool", "", "a dense state refutes the verdict")]

    def make(self, part: Part, worlds: Worlds, scene: int, begin: int, end: int) -> Rows:
        checker, o = worlds.checker(part.robot, *part.scenes[scene]), part.options
        rows = []
        for file, index, name in part.extra["paths"][begin:end]:
            path = worlds.paths(file, checker.variables)[index].positions
            found = checker.path(path, min_d=o["min_d"], slack=o["slack"], check=o["check"])
            verdict = worst(found.verdicts)
            edge = int(numpy.flatnonzero(found.verdicts == verdict)[0]) if verdict != int(Verdict.FREE) else -1
            least, _, _, share = look_at_path(checker, path, o["check"], o["audit_step"])
            lower = float(found.lower.min()) if edge < 0 else 0.0
            outside = (path < checker.lower - 1e-5) | (path > checker.upper + 1e-5)
            rows.append({"scene": scene, "states": len(path), "length": float(numpy.linalg.norm(numpy.diff(path, axis=0), axis=1).sum()),
                "verdict": verdict, "edge": edge, "t": float(found.t[max(0, edge)]), "lower": lower, "outside": bool(outside[:, ~checker.wraps].any()),
                "least": least, "contact_share": share, "contradiction": edge < 0 and (least <= o["min_d"] or least < lower - 1e-9),
                "pair": found.pairs[max(0, edge)]})
        files = [entry[0] for entry in part.extra["paths"][begin:end]]
        names = [entry[2] for entry in part.extra["paths"][begin:end]]
        values: dict[str, Any] = {name: numpy.array([row[name] for row in rows]) for name in rows[0] if name != "pair"}
        values.update(file=Words(numpy.arange(len(rows), dtype="<i4"), files), path=Words(numpy.arange(len(rows), dtype="<i4"), names),
            **named_pairs(checker, numpy.array([row["pair"] for row in rows])))
        return Rows(values, {})
