# SPDX-License-Identifier: BSD-3-Clause
"""Kind of work on planning problems: plans with their audit."""
from __future__ import annotations

import time
from typing import Any

import numpy

from .._core import Checker, Outcome
from .campaign import Option, checked
from .kinds import CHECKS, Kind, Part, Rows, address_of, bounded
from .looks import look_at_path
from .planners import PLANNER, check_planners, length_of, plan_by
from .seeds import stream_of
from .tables import Column, Words
from .worlds import Worlds

__all__ = ["Plans"]

TRIES = 2000  # random states in search of a free one


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
