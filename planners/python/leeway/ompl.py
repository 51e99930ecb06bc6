# SPDX-License-Identifier: BSD-3-Clause
"""Checkers for planners of OMPL's own Python package (`pip install ompl`, 2.0 or later).

    setup = ompl.geometric.SimpleSetup( leeway.ompl.state_space( checker ) )
    leeway.ompl.install( setup.getSpaceInformation(), checker, min_d=0.005 )

Each check of a planner calls Python, some microseconds beside the check itself; Checker.plan() does not. Planners that ask for the last
valid state of a motion (checkMotion with a third argument) get no answer from OMPL's Python.
"""
from __future__ import annotations

import math

import numpy
from ompl import base

from ._core import Checker

__all__ = ["MotionValidator", "StateValidityChecker", "from_array", "install", "state_space", "to_array"]


def state_space(checker: Checker, weights: numpy.ndarray | None = None) -> base.StateSpace:
    """A space with the checker's variables and limits: real numbers, or a compound of those and angles if joints are endless."""
    if not numpy.isfinite(checker.lower).all() or not numpy.isfinite(checker.upper).all():
        raise ValueError(f"state_space: a variable of {checker.variables} has no limits; give the URDF limits for it")
    if not checker.wraps.any():
        return _numbers(checker.lower, checker.upper)
    space = base.CompoundStateSpace()
    for i in range(checker.dof):
        part = base.SO2StateSpace() if checker.wraps[i] else _numbers(checker.lower[i:i + 1], checker.upper[i:i + 1])
        space.addSubspace(part, 1.0 if weights is None else float(weights[i]))
    return space


def _numbers(lower: numpy.ndarray, upper: numpy.ndarray) -> base.RealVectorStateSpace:
    space, bounds = base.RealVectorStateSpace(len(lower)), base.RealVectorBounds(len(lower))
    for i, (low, high) in enumerate(zip(lower, upper)):
        bounds.setLow(i, float(low))
        bounds.setHigh(i, float(high))
    space.setBounds(bounds)
    return space


def to_array(checker: Checker, state: base.State) -> numpy.ndarray:
    """float64 [dof] of a state of state_space()."""
    if not checker.wraps.any():
        return numpy.array([state[i] for i in range(checker.dof)])
    return numpy.array([state[i].value if checker.wraps[i] else state[i][0] for i in range(checker.dof)])


def from_array(checker: Checker, q: numpy.ndarray, state: base.State) -> None:
    """Writes float64 [dof] into a state of state_space()."""
    for i in range(checker.dof):
        if not checker.wraps.any():
            state[i] = float(q[i])
        elif checker.wraps[i]:
            state[i].value = math.remainder(float(q[i]), 2 * math.pi)
        else:
            state[i][0] = float(q[i])


class StateValidityChecker(base.StateValidityChecker):
    """Valid: every clearance is proved above min_d (metres). `count`: states that were checked."""

    def __init__(self, si: base.SpaceInformation, checker: Checker, min_d: float = 0.0, check: str = "both"):
        super().__init__(si)
        self.checker, self.min_d, self.check, self.count = checker, min_d, check, 0

    def isValid(self, state: base.State) -> bool:
        self.count += 1
        return bool(self.checker.is_free(to_array(self.checker, state), min_d=self.min_d, check=self.check))

    def clearance(self, state: base.State) -> float:
        return float(self.checker.clearance(to_array(self.checker, state), check=self.check, witnesses=False).lower)


class MotionValidator(base.MotionValidator):
    """Valid: the whole straight edge is proved FREE; no resolution. `count`: edges that were checked."""

    def __init__(self, si: base.SpaceInformation, checker: Checker, min_d: float = 0.0, slack: float = 1e-3, check: str = "both"):
        super().__init__(si)
        self.checker, self.min_d, self.slack, self.check, self.count = checker, min_d, slack, check, 0

    def checkMotion(self, a: base.State, b: base.State) -> bool:
        self.count += 1
        found = self.checker.edges(to_array(self.checker, a), to_array(self.checker, b), min_d=self.min_d, slack=self.slack, check=self.check)
        return found.all_free


def install(si: base.SpaceInformation, checker: Checker, *, min_d: float = 0.0, slack: float = 1e-3, check: str = "both") -> None:
    """Sets both validity checkers of a space made by state_space()."""
    si.setStateValidityChecker(StateValidityChecker(si, checker, min_d, check))
    si.setMotionValidator(MotionValidator(si, checker, min_d, slack, check))
