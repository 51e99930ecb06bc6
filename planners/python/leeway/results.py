# SPDX-License-Identifier: BSD-3-Clause
"""Results of checks and searches: named tuples of NumPy arrays. Units are metres and radians."""
from __future__ import annotations

import enum
import os
import pathlib
from typing import Any, NamedTuple

import numpy

from ._core import Checker, Outcome, Verdict

Array = numpy.ndarray


class Distance(NamedTuple):
    """Distance of two shapes."""
    lower: float  #: proved: the distance is at least this
    upper: float  #: the distance of the witnesses
    witnesses: Array  #: float64 [2, 3]: a point of each shape, in the world

    def __repr__(self) -> str:
        return f"Distance({self.lower:.6g} <= distance <= {self.upper:.6g} m)"


class DepthKind(enum.IntEnum):
    """The outcome of depth()."""
    APART = 1  #: neither body meets the inside of the other: [0, 0]
    OVERLAP = 2  #: lower <= depth <= upper
    NO_INSIDE = 3  #: neither body has an inside, as surfaces that are not solid


class Depth(NamedTuple):
    """Penetration depth of two shapes."""
    kind: int  #: DepthKind
    lower: float  #: proved: every way out is at least this long
    upper: float  #: a translation of the first shape by upper * normal takes it out; inf if there is none
    normal: Array  #: float64 [3]: unit, world, the way out of the first shape
    witnesses: Array  #: float64 [2, 3]: the deepest point of each shape, in the world

    def __repr__(self) -> str:
        if self.kind != DepthKind.OVERLAP:
            return f"Depth({DepthKind(self.kind).name})"
        return f"Depth({self.lower:.6g} <= depth <= {self.upper:.6g} m)"


class GuardAnswer(NamedTuple):
    """An answer of a Guard about the newest world that was published when it was asked."""
    verdict: Verdict  #: FREE: proved from now to the end; BLOCKED; UNDECIDED: brake, or ask again if the budget ended
    stamp: int  #: of the world; 0: that of the checker at the start
    now: float  #: seconds
    proved_until: float  #: seconds: free from now until then, proved
    time: float  #: seconds: of the contact or the undecided verdict; FREE: the end, of a stop the time at which the robot stands
    pair: tuple[str, str] | None  #: names at `time`: a link, and a link or an object
    lower: float  #: metres: the pair's clearance is at least this; NaN without a pair
    upper: float  #: metres: its clearance; NaN without a pair

    def __repr__(self) -> str:
        of = f", {self.pair[0]} and {self.pair[1]} at {self.time:.6g} s" if self.pair else ""
        return f"GuardAnswer({Verdict(self.verdict).name}, proved until {self.proved_until:.6g} s{of}, world {self.stamp})"


class GuardSpeed(NamedTuple):
    """How fast the robot may go on beside people."""
    scale: float  #: of its speed, proved; 0: none, brake
    separation: float  #: metres that all clearances exceed until the robot stands; NaN without a scale
    until: float  #: seconds: no farther the robot comes before it stands
    stamp: int  #: of the world
    pair: tuple[str, str] | None  #: that forbids the next scale; None: the highest is proved
    proofs: int


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


class Direction(enum.IntEnum):
    """The direction between the nearest points of a pair."""
    NONE = 0  #: the bodies touch, and have no depth: normal and derivatives are 0
    UNIQUE = 1  #: with a tie_width, no other points are as near, or no other way out as short
    TIED = 2  #: other points are as near, such as of parallel faces: the derivatives are a subgradient


class NearPairs(NamedTuple):
    """Pairs of bodies that are near, in one state or in many: rows of all states behind each other, nearest first in each state."""
    offsets: Array  #: int64 [n + 1]: rows of state i are offsets[i] to offsets[i + 1]
    pairs: Array  #: int32 [m, 2]: indices into Checker.names: a link, and a link or an object
    lower: Array  #: float64 [m]: proved, the pair's clearance is at least this
    upper: Array  #: float64 [m]: the clearance of the witnesses; with depth, below 0 in contact
    normals: Array  #: float64 [m, 3]: unit, world: the way out of the first body, apart from the second body to the first
    witnesses: Array  #: float64 [m, 2, 3]: the nearest point of each body, in contact the deepest, in the world
    directions: Array  #: uint8 [m]: Direction
    derivatives: Array | None  #: float64 [m, dof]: of the clearance by each variable; None if not wanted
    bodies: Array  #: int32 [m, 2]: robot body; body or scene shape
    links: Array  #: float64 [n, links] or [links]: proved lower bound of each link's clearances, at most the distance asked

    def rows(self, state: int) -> slice:
        """The rows of one state."""
        return slice(int(self.offsets[state]), int(self.offsets[state + 1]))

    def barrier(self, min_d: float, gain: float, state: int = 0) -> tuple[Array, Array]:
        """(G, h) of a control barrier: velocities with G @ velocity <= h let no clearance fall towards min_d faster than
        gain times (clearance - min_d) per second. G: float64 [rows, dof]; h: float64 [rows], below 0 for pairs nearer than min_d."""
        if self.derivatives is None:
            raise ValueError("barrier(): near() was called with derivatives=False")
        part = self.rows(state)
        return -self.derivatives[part], gain * (self.lower[part] - min_d)

    def __repr__(self) -> str:
        least = f", the nearest {self.upper.min():.6g} m" if self.upper.size else ""
        return f"NearPairs({self.upper.size} of {len(self.offsets) - 1} states{least})"


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


class Timed(NamedTuple):
    """A trajectory at rest at both ends, with quintic pieces between its points."""
    times: Array  #: float64 [n]: seconds
    positions: Array  #: float64 [n, dof]
    velocities: Array  #: float64 [n, dof]
    accelerations: Array  #: float64 [n, dof]

    @property
    def duration(self) -> float:
        """Seconds."""
        return float(self.times[-1])

    def __repr__(self) -> str:
        return f"Timed({len(self.times)} points, {self.duration:.3g} s)"


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


class InverseFailure(enum.IntEnum):
    """Why a pose has no state."""
    NONE = 0  #: it has states
    UNREACHABLE = 1  #: no descent came to it, with or without joint limits
    OUT_OF_LIMITS = 2  #: descents came to it outside of the joint limits alone
    IN_COLLISION = 3  #: it has states, none with a clearance proved to be above min_d


class InverseStates(NamedTuple):
    """States that have poses: rows of all poses behind each other, the nearest to the start first, with `check` those above min_d before others."""
    offsets: Array  #: int64 [n + 1]: rows of pose i are offsets[i] to offsets[i + 1]
    states: Array  #: float64 [m, dof]: within the joint limits
    lower: Array | None  #: float64 [m]: proved, every clearance of the state is at least this; None without `check`
    upper: Array | None  #: float64 [m]: the clearance of the nearest pair; None without `check`
    failures: Array  #: uint8 [n]: InverseFailure
    metres: Array  #: float64 [n]: of a pose without states, the distance that the best descent leaves; else 0
    radians: Array  #: float64 [n]: and its angle
    messages: list[str]  #: [n] the reason and a remedy; empty where there is none

    def rows(self, pose: int) -> slice:
        """The rows of one pose."""
        return slice(int(self.offsets[pose]), int(self.offsets[pose + 1]))

    @property
    def counts(self) -> Array:
        """int64 [n]: states of each pose."""
        return numpy.diff(self.offsets)

    @property
    def first(self) -> Array:
        """float64 [n, dof]: the first state of each pose; NaN where there is none."""
        first = numpy.full((len(self.failures), self.states.shape[1]), numpy.nan)
        some = self.counts > 0
        first[some] = self.states[self.offsets[:-1][some]]
        return first

    def __repr__(self) -> str:
        return f"InverseStates({len(self.states)} states of {int((self.counts > 0).sum())} of {len(self.failures)} poses)"


class Line(NamedTuple):
    """A frame's way along lines and arcs: cubics between points, proved. Only a solved one has points."""
    solved: bool
    times: Array  #: float64 [n], seconds
    positions: Array  #: float64 [n, dof]
    velocities: Array  #: float64 [n, dof]
    position_error: float  #: metres, proved for all times: of each coordinate
    angle_error: float  #: radians, proved for all times
    attempts: int
    message: str  #: where it ends, and the reason; empty if solved

    def __repr__(self) -> str:
        return f"Line({len(self.times)} points)" if self.solved else f"Line({self.message.splitlines()[0]})"


class ConstrainedPlan(NamedTuple):
    """A motion that keeps constraints along the path: cubics between points, proved. Only a solved one has points."""
    solved: bool
    times: Array  #: float64 [n], seconds
    positions: Array  #: float64 [n, dof]
    velocities: Array  #: float64 [n, dof]
    mended: float  #: seconds that lead the start to the constraints, which are kept from then on; 0: none
    length: float  #: in joint space, after that
    straight: int  #: pieces of the path
    bent: int
    rests: int  #: stops on the way
    seconds: float  #: of the search
    message: str  #: the reasons without a plan; empty if solved

    def __repr__(self) -> str:
        return f"ConstrainedPlan({len(self.times)} points)" if self.solved else f"ConstrainedPlan({self.message.splitlines()[0]})"


class Sequence(NamedTuple):
    """Motions one after the other: cubics between points, proved. Only a solved one has points."""
    solved: bool
    times: Array  #: float64 [n], seconds
    positions: Array  #: float64 [n, dof]
    velocities: Array  #: float64 [n, dof]
    legs: Array  #: float64 [items, 2]: seconds at which each begins and ends
    failed: int | None  #: the first item to whose end no attempt came
    seconds: float  #: of planning
    message: str  #: the reasons without a plan; empty if solved
    checkers: tuple[Checker, ...] = ()  #: of each item, in its scene: the robot with what it holds

    def __repr__(self) -> str:
        return f"Sequence({len(self.legs)} legs, {len(self.times)} points)" if self.solved else f"Sequence({self.message.splitlines()[0]})"


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
    min_d: float = 0.0  #: metres: every edge keeps more
    slack: float = 0.001  #: metres
    #: with clearance_goal: for "environment" and "self" the least clearance "before" and "after", (proved, measured), the same of the
    #: path without the first and the last tenth of its length ("middle_before", "middle_after"), and that of the "ends"; metres
    clearance: dict[str, Any] | None = None

    @property
    def solved(self) -> bool:
        return self.outcome == Outcome.SOLVED

    def save(self, checker: Checker, file: str | os.PathLike[str]) -> None:
        """Writes the path as `leeway plan --out` does, for `leeway audit --path` and `leeway view --path`. The checker audits it first;
        ValueError if there is no path or it is not valid in this checker's world."""
        if self.path is None:
            raise ValueError(f"save(): the plan has no path: {self.outcome.name}")
        text = checker.path_text(self.path, min_d=self.min_d, slack=self.slack, seed=self.seed)
        pathlib.Path(file).write_text(text, encoding="utf-8")

    def __repr__(self) -> str:
        states = f"{len(self.path)} states, length {self.length:.4g}" if self.path is not None else self.message.strip().split("\n")[0]
        return f"Plan({self.outcome.name} after {self.seconds:.3g} s: {states})"
