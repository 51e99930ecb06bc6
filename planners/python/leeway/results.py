# SPDX-License-Identifier: BSD-3-Clause
"""Results of checks and searches: named tuples of NumPy arrays. Units are metres and radians."""
from __future__ import annotations

from typing import Any, NamedTuple

import numpy

from ._core import Outcome, Verdict

Array = numpy.ndarray


class Distance(NamedTuple):
    """Distance of two shapes."""
    lower: float  #: proved: the distance is at least this
    upper: float  #: the distance of the witnesses
    witnesses: Array  #: float64 [2, 3]: a point of each shape, in the world

    def __repr__(self) -> str:
        return f"Distance({self.lower:.6g} <= distance <= {self.upper:.6g} m)"


class Clearances(NamedTuple):
    """Clearances of states. For one state the arrays have no first axis."""
    lower: Array  #: float64 [n]: proved, every clearance of the state is at least this
    upper: Array  #: float64 [n]: the clearance of the pair
    pairs: Array  #: int32 [n, 2]: indices into Checker.names; -1 if none is near
    witnesses: Array | None  #: float64 [n, 2, 3]: a point on each of the pair, in the world; NaN if none is near

    def __repr__(self) -> str:
        if self.lower.ndim == 0:
            return f"Clearances({float(self.lower):.6g} <= clearance <= {float(self.upper):.6g} m)"
        least = f", the least {self.lower.min():.6g} to {self.upper.min():.6g} m" if self.lower.size else ""
        return f"Clearances(of {self.lower.size} states{least})"


class Motions(NamedTuple):
    """Checked motions: edges, curves, or pieces of a trajectory."""
    verdicts: Array  #: uint8 [n]: Verdict
    t: Array  #: float64 [n]: share of the motion at its colliding or undecided state; 1 if FREE
    lower: Array  #: float64 [n]: proved lower bound of all clearances along a FREE motion; else 0
    proved_until: Array  #: float64 [n]: all of [0, proved_until] is proved; 1 if FREE, 0 if not wanted
    pairs: Array  #: int32 [n, 2]: the deciding pair, indices into Checker.names; -1 if FREE
    clearance: Array  #: float64 [n]: of that pair at t; inf if FREE
    witnesses: Array  #: float64 [n, 2, 3]: a point on each of that pair, in the world; NaN if FREE

    @property
    def free(self) -> Array:
        """bool [n]: the motion is FREE."""
        return self.verdicts == int(Verdict.FREE)

    @property
    def all_free(self) -> bool:
        """Every motion is FREE."""
        return bool(self.free.all())

    def __repr__(self) -> str:
        counts = ", ".join(f"{int((self.verdicts == int(v)).sum())} {v.name}" for v in (Verdict.FREE, Verdict.BLOCKED, Verdict.UNDECIDED))
        return f"Motions({counts})"


class LinkSpheres(NamedTuple):
    """Spheres that enclose a link."""
    spheres: Array  #: float64 [n, 4]: x, y, z and radius in the link's frame
    excess: float  #: proved: no point of a sphere is farther from the link
    encloses: bool  #: proved


class GoalStates(NamedTuple):
    """States that reach a pose, each proved free."""
    states: Array  #: float64 [k, dof]
    message: str  #: the reason if there is none

    def __repr__(self) -> str:
        return f"GoalStates({len(self.states)} states{'; ' + self.message if self.message else ''})"


class Plan(NamedTuple):
    """Result of a search. Only Outcome.SOLVED has a path; no other outcome says that there is none."""
    outcome: Outcome
    path: Array | None  #: float64 [n, dof]: states joined by straight edges, each proved FREE
    length: float  #: Euclidean, radians and metres alike
    raw_length: float  #: before smoothing
    seconds: float  #: of the clock
    seed: int  #: with it and threads=1 the call gives the same path
    message: str  #: reasons without a path; empty if SOLVED
    statistics: dict[str, Any]
    improvements: Array  #: float64 [k, 2]: seconds and length, with optimize_seconds

    @property
    def solved(self) -> bool:
        return self.outcome == Outcome.SOLVED

    def __repr__(self) -> str:
        states = f"{len(self.path)} states, length {self.length:.4g}" if self.path is not None else self.message.strip().split("\n")[0]
        return f"Plan({self.outcome.name} after {self.seconds:.3g} s: {states})"
