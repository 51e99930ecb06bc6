# SPDX-License-Identifier: BSD-3-Clause
"""Kinds of work. A kind makes rows: a pure function of part, scene and row numbers.

Rows are worked on in blocks, each of which begins with a query that was reset: answers do not depend on how blocks are cut into files.
"""
from __future__ import annotations

from typing import Any, NamedTuple

import numpy

from .._core import Checker, Verdict
from .campaign import Option
from .errors import FleetError
from .looks import look_at_edges
from .seeds import key_of, rows_of
from .tables import Column, Words
from .worlds import Worlds

__all__ = ["Edges", "Kind", "Part", "Rows", "States", "bounded", "pair_columns"]

INFINITY = float("inf")


class Part(NamedTuple):
    """One entry of a campaign's work for one robot: rows of the same columns."""
    index: int
    work: int  #: index of the entry
    kind: str
    robot: str
    scenes: list  #: [name, instance] of each; ["", 0]: no obstacles
    rows: int  #: in each scene
    options: dict[str, Any]
    extra: dict[str, Any]  #: files and other data that the kind found when the plan was made


class Rows(NamedTuple):
    values: dict[str, Any]
    measured: dict[str, Any]  #: times: not the same in the next run


class Kind:
    block = 256  #: rows that are worked on together
    in_scenes = True  #: its rows depend on obstacles
    of_robots = True  #: it works on the campaign's robots
    options: dict[str, Option] = {}

    def prepare(self, campaign, element: str, entry: dict[str, Any]) -> dict[str, Any]:
        """Data for Part.extra."""
        return {}

    def count(self, entry: dict[str, Any], extra: dict[str, Any], worlds: Worlds, robot: str) -> int:
        """Rows in each scene."""
        return entry["rows"]

    def columns(self, part: Part, worlds: Worlds) -> list[Column]:
        raise NotImplementedError

    def measured(self, part: Part) -> list[Column]:
        return []

    def make(self, part: Part, worlds: Worlds, scene: int, begin: int, end: int) -> Rows:
        """Rows begin to end of a scene; begin is that of a block."""
        raise NotImplementedError


CHECKS = {"check": Option(str, "both", None, ("both", "environment", "self")), "min_d": Option(float, 0.0, 0)}


def bounded(checker: Checker, robot: str) -> None:
    """Random states need limits."""
    for name, low, high in zip(checker.variables, checker.lower, checker.upper):
        if not (numpy.isfinite(low) and numpy.isfinite(high)):
            raise FleetError(f"robot {robot}", name, "has no limits, so no random states", "give the URDF limits for it, or another group")


def state_columns(prefix: str, checker: Checker, text: str) -> list[Column]:
    return [Column(f"{prefix}:{name}", "double", "rad or m", f"{text}, joint {name}") for name in checker.variables]


def pair_columns(what: str) -> list[Column]:
    return [Column("first", "string", "", f"link of {what}"), Column("second", "string", "", "the object or link beside it; empty if there is none")]


WITNESSES = [Column(f"{axis}_{of}", "double", "m", f"{axis} of the witness on {of}, in the world; NaN if there is none")
    for of in ("first", "second") for axis in "xyz"]


def named_pairs(checker: Checker, pairs: numpy.ndarray) -> dict[str, Words]:
    names = checker.names.tolist()
    place = numpy.where(pairs < 0, len(names) - 1, pairs).astype("<i4")
    return {"first": Words(place[:, 0], names), "second": Words(place[:, 1], names)}


def split_states(prefix: str, checker: Checker, q: numpy.ndarray) -> dict[str, numpy.ndarray]:
    return {f"{prefix}:{name}": numpy.ascontiguousarray(q[:, i]) for i, name in enumerate(checker.variables)}


def split_points(witnesses: numpy.ndarray) -> dict[str, numpy.ndarray]:
    flat = witnesses.reshape(-1, 6)
    return {column.name: numpy.ascontiguousarray(flat[:, i]) for i, column in enumerate(WITNESSES)}


def address_of(part: Part, worlds: Worlds, scene: int) -> tuple:
    name, instance = part.scenes[scene]
    return (worlds.plan["campaign"]["seed"], part.work, part.robot, name, instance)


class States(Kind):
    """Certified clearances of uniform random states."""
    options = {"rows": Option(int, 1000, 1), **CHECKS, "max_d": Option(float, INFINITY, 0), "alpha": Option(float, 0.0, 0, (), 0.99),
        "witnesses": Option(bool, True)}

    def columns(self, part: Part, worlds: Worlds) -> list[Column]:
        checker = worlds.checker(part.robot, "", 0)
        bounded(checker, part.robot)
        return [Column("scene", "int32", "", "index into the part's scenes"), *state_columns("q", checker, "state"),
            Column("lower", "double", "m", "proved: every clearance is at least this"),
            Column("upper", "double", "m", "clearance of the pair: the least is at most this"),
            *pair_columns("the nearest pair"), *(WITNESSES if part.options["witnesses"] else [])]

    def make(self, part: Part, worlds: Worlds, scene: int, begin: int, end: int) -> Rows:
        checker = worlds.checker(part.robot, *part.scenes[scene])
        numbers = rows_of(key_of(*address_of(part, worlds, scene)), begin, end, checker.dof)
        q = checker.lower + numbers * (checker.upper - checker.lower)
        o = part.options
        found = checker.clearance(q, check=o["check"], min_d=o["min_d"], max_d=float(o["max_d"]), alpha=o["alpha"], witnesses=o["witnesses"])
        values = {"scene": numpy.full(len(q), scene, "<i4"), **split_states("q", checker, q), "lower": found.lower, "upper": found.upper,
            **named_pairs(checker, found.pairs)}
        return Rows({**values, **(split_points(found.witnesses) if o["witnesses"] else {})}, {})


class Edges(Kind):
    """Verdicts of straight edges, and dense looks at a share of them."""
    block = 16
    options = {"rows": Option(int, 1000, 1), **CHECKS, "slack": Option(float, 1e-3, 1e-9), "length": Option(float, 0.0, 0),
        "proved_until": Option(bool, False), "audit": Option(float, 0.0, 0, (), 1), "audit_step": Option(float, 0.01, 1e-6)}

    def columns(self, part: Part, worlds: Worlds) -> list[Column]:
        checker = worlds.checker(part.robot, "", 0)
        bounded(checker, part.robot)
        looked = [Column("audited", "bool", "", "dense states were looked at"),
            Column("least", "double", "m", "the least clearance that they had; NaN if none were looked at"),
            Column("contradiction", "bool", "", "a state refutes the verdict")]
        return [Column("scene", "int32", "", "index into the part's scenes"), *state_columns("a", checker, "begin"), *state_columns("b", checker, "end"),
            Column("verdict", "uint8", "", "1 FREE, 2 BLOCKED, 3 UNDECIDED"),
            Column("t", "double", "1", "share of the edge at its colliding or undecided state; 1 if FREE"),
            Column("proved_until", "double", "1", "all of [0, proved_until] is proved; 1 if FREE"),
            Column("lower", "double", "m", "proved lower bound of all clearances of a FREE edge; else 0"),
            Column("clearance", "double", "m", "of the deciding pair at t; infinite if FREE"), *pair_columns("the deciding pair"),
            *(looked if part.options["audit"] > 0 else [])]

    def ends(self, part: Part, worlds: Worlds, checker: Checker, scene: int, begin: int, end: int):
        """(a, b, numbers in [0, 1) for the choice of edges to look at)"""
        dof = checker.dof
        numbers = rows_of(key_of(*address_of(part, worlds, scene)), begin, end, 2 * dof + 2)
        span = checker.upper - checker.lower
        a, b = checker.lower + numbers[:, :dof] * span, checker.lower + numbers[:, dof:2 * dof] * span
        if part.options["length"] > 0:  # on the way to b
            far = numpy.maximum(numpy.sqrt(numpy.square(b - a).sum(axis=1)), 1e-300)
            b = a + (b - a) * numpy.minimum(1, part.options["length"] * numbers[:, 2 * dof] / far)[:, None]
        return a, b, numbers[:, 2 * dof + 1]

    def make(self, part: Part, worlds: Worlds, scene: int, begin: int, end: int) -> Rows:
        checker = worlds.checker(part.robot, *part.scenes[scene])
        o = part.options
        a, b, choice = self.ends(part, worlds, checker, scene, begin, end)
        found = checker.edges(a, b, min_d=o["min_d"], slack=o["slack"], check=o["check"], proved_until=o["proved_until"])
        values = {"scene": numpy.full(len(a), scene, "<i4"), **split_states("a", checker, a), **split_states("b", checker, b),
            "verdict": found.verdicts, "t": found.t, "proved_until": found.proved_until, "lower": found.lower, "clearance": found.clearance,
            **named_pairs(checker, found.pairs)}
        if o["audit"] > 0:
            audited = choice < o["audit"]
            least, contradiction = look_at_edges(checker, a, b, found, audited, o["min_d"], o["slack"], o["check"], o["audit_step"])
            values.update(audited=audited, least=least, contradiction=contradiction)
        return Rows(values, {})


def worst(verdicts: numpy.ndarray) -> int:
    """BLOCKED before UNDECIDED before FREE."""
    for verdict in (Verdict.BLOCKED, Verdict.UNDECIDED):
        if (verdicts == int(verdict)).any():
            return int(verdict)
    return int(Verdict.FREE)
