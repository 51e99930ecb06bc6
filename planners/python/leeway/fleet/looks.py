# SPDX-License-Identifier: BSD-3-Clause
"""Dense looks at motions, for audits: exact clearances of states only. No certificate of a motion, no bound of motion is used.

A look refutes a proof; it proves nothing. First states with a step between neighbours that no joint exceeds, then more of them
around the lowest places.
"""
from __future__ import annotations

import numpy

from .._core import Checker, Verdict
from ..results import Motions

__all__ = ["least_clearance", "look_at_edges", "look_at_path"]

FINER = 16  # states in place of one step around a low place
PLACES = 4  # low places that are looked at again
ROUNDS = 3
ROUNDING = 1e-9  # metres


def least_clearance(checker: Checker, at, check: str, count: int) -> tuple[float, float]:
    """(least clearance, its t) of a motion: at(t [n]) is its states [n, dof], t in [0, 1]."""
    t = numpy.linspace(0, 1, max(3, count))
    value = checker.clearance(at(t), check=check, witnesses=False).upper
    best, place = float(value.min()), float(t[value.argmin()])
    step = t[1]
    for _ in range(ROUNDS):
        low = t[numpy.argsort(value, kind="stable")[:PLACES]]
        t = numpy.clip((low[:, None] + step * numpy.linspace(-1, 1, 2 * FINER + 1)).ravel(), 0, 1)
        value = checker.clearance(at(t), check=check, witnesses=False).upper
        if value.min() < best:
            best, place = float(value.min()), float(t[value.argmin()])
        step /= FINER
    return best, place


def _states(checker: Checker, a: numpy.ndarray, b: numpy.ndarray):
    toward = b - a
    turns = checker.wraps
    toward = numpy.where(turns, numpy.remainder(toward + numpy.pi, 2 * numpy.pi) - numpy.pi, toward)  # the shorter way
    return lambda t: a + numpy.asarray(t)[:, None] * toward, float(numpy.abs(toward).max())


def look_at_edges(checker: Checker, a, b, found: Motions, chosen: numpy.ndarray, min_d: float, slack: float, check: str, step: float):
    """(least clearance seen, contradiction) of the chosen edges. step: radians or metres of a joint between neighbouring states.

    A contradiction: a state of a FREE edge at min_d or nearer, or nearer than the edge's proved bound; a BLOCKED edge whose state at t is
    farther than min_d; an UNDECIDED one whose state at t is farther than its band.
    """
    least = numpy.full(len(chosen), numpy.nan)
    contradiction = numpy.zeros(len(chosen), bool)
    for i in numpy.flatnonzero(chosen):
        at, longest = _states(checker, a[i], b[i])
        least[i], _ = least_clearance(checker, at, check, int(numpy.ceil(longest / step)) + 1)
        here = float(checker.clearance(at(found.t[i:i + 1]), check=check, witnesses=False).lower[0])
        if found.verdicts[i] == int(Verdict.FREE):
            contradiction[i] = least[i] <= min_d or least[i] < found.lower[i] - ROUNDING
        elif found.verdicts[i] == int(Verdict.BLOCKED):
            contradiction[i] = here > min_d + ROUNDING
        else:
            contradiction[i] = here > (min_d + slack) / 0.9 + ROUNDING
    return least, contradiction


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
