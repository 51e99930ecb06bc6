# SPDX-License-Identifier: BSD-3-Clause
"""Fast trajectories along proved paths: time-optimal by toppra (`pip install leeway-robotics[retime]`), then proved as they are driven.

    trajectory = leeway.retime.retime( checker, plan.path, velocity=1.0, acceleration=2.0 )
    trajectory.times, trajectory.positions, trajectory.velocities       # to a joint trajectory controller

A spline through the corners of a path leaves its proved edges. So the result is judged anew: Checker.trajectory() proves the cubic pieces
between its points at all times. Where that fails, the spline gets more points of the path and follows it more closely.
"""
from __future__ import annotations

from typing import NamedTuple

import numpy
import toppra
from toppra import algorithm, constraint

from ._core import Checker
from .results import Motions

__all__ = ["Trajectory", "limits_kept", "retime"]

toppra.setup_logging("ERROR")


class Trajectory(NamedTuple):
    """A timed trajectory with cubic pieces between its points."""
    times: numpy.ndarray  #: float64 [n], seconds
    positions: numpy.ndarray  #: float64 [n, dof]
    velocities: numpy.ndarray  #: float64 [n, dof]
    proof: Motions  #: of its n - 1 pieces; all FREE
    spacing: float  #: radians or metres between the points of the path that the spline goes through

    @property
    def duration(self) -> float:
        return float(self.times[-1])

    def __repr__(self) -> str:
        return f"Trajectory({len(self.times)} points, {self.duration:.3g} s, proved clearance above {self.proof.lower.min():.4g} m)"


def _unwrapped(checker: Checker, path: numpy.ndarray) -> numpy.ndarray:
    """Endless joints take the shorter way from state to state, without jumps."""
    out = numpy.array(path, float)
    for i in numpy.flatnonzero(checker.wraps):
        out[:, i] = numpy.unwrap(out[:, i])
    return out


def _with_points(path: numpy.ndarray, spacing: float) -> tuple[numpy.ndarray, numpy.ndarray]:
    """(lengths along the path, states): its corners, and points at most `spacing` apart between them."""
    rows, lengths = [path[0]], [0.0]
    for a, b in zip(path[:-1], path[1:]):
        length = float(numpy.linalg.norm(b - a))
        count = max(1, int(numpy.ceil(length / spacing))) if length > 0 else 0
        for k in range(1, count + 1):
            rows.append(a + (b - a) * k / count)
            lengths.append(lengths[-1] + length / count)
    return numpy.array(lengths), numpy.array(rows)


def _extremes(times: numpy.ndarray, p: numpy.ndarray, v: numpy.ndarray) -> tuple[numpy.ndarray, numpy.ndarray]:
    """Largest speed and acceleration of each variable over the cubic pieces, by formula."""
    h = numpy.diff(times)[:, None]
    slope = numpy.diff(p, axis=0) / h
    a0, a1 = (6 * slope - 4 * v[:-1] - 2 * v[1:]) / h, (-6 * slope + 2 * v[:-1] + 4 * v[1:]) / h
    with numpy.errstate(divide="ignore", invalid="ignore"):
        top = numpy.where(a0 * a1 < 0, a0 / (a0 - a1), 0.0)  # share of the piece at which the acceleration is 0
    middle = v[:-1] + h * (a0 * top + (a1 - a0) * top**2 / 2)
    speed = numpy.maximum(numpy.abs(v).max(axis=0), numpy.abs(middle).max(axis=0))
    return speed, numpy.maximum(numpy.abs(a0).max(axis=0), numpy.abs(a1).max(axis=0))


def limits_kept(trajectory: Trajectory, velocity: numpy.ndarray, acceleration: numpy.ndarray, share: float = 1 + 1e-9) -> bool:
    """The cubic pieces keep these limits at all times."""
    speed, pull = _extremes(trajectory.times, trajectory.positions, trajectory.velocities)
    return bool((speed <= velocity * share).all() and (pull <= acceleration * share).all())


def _timed(path: numpy.ndarray, spacing: float, velocity: numpy.ndarray, acceleration: numpy.ndarray, step: float):
    """(times, positions, velocities) of the fastest motion along a spline; slowed where cubic pieces would exceed a limit."""
    lengths, rows = _with_points(path, spacing)
    spline = toppra.SplineInterpolator(lengths, rows, bc_type="clamped" if len(rows) < 3 else "not-a-knot")
    symmetric = [constraint.JointVelocityConstraint(numpy.stack([-velocity, velocity], axis=1)),
        constraint.JointAccelerationConstraint(numpy.stack([-acceleration, acceleration], axis=1))]
    grid = numpy.linspace(0, lengths[-1], max(200, 4 * len(lengths)))
    motion = algorithm.TOPPRA(symmetric, spline, gridpoints=grid, parametrizer="ParametrizeConstAccel").compute_trajectory(0, 0)
    if motion is None:
        return None
    times = numpy.linspace(0, motion.duration, max(2, int(numpy.ceil(motion.duration / step)) + 1))
    p, v = motion(times), motion(times, 1)
    p[0], p[-1], v[0], v[-1] = path[0], path[-1], 0, 0
    speed, pull = _extremes(times, p, v)
    slower = max(1.0, float((speed / velocity).max()), float(numpy.sqrt((pull / acceleration).max()))) * (1 + 1e-12)
    return times * slower, p, v / slower


def retime(checker: Checker, path: numpy.ndarray, velocity, acceleration, *, min_d: float = 0.0, slack: float = 1e-3, step: float = 0.02,
           spacing: float | None = None, attempts: int = 8, threads: int = 1) -> Trajectory:
    """The fastest proved trajectory along a path that this method finds, at rest at both ends.

    path: float64 [n, dof], as Checker.plan() returns it. velocity, acceleration: limits, numbers or [dof]; rad/s, m/s and their squares.
    min_d, slack: metres, as for Checker.trajectory(). step: seconds between its points, about. spacing: radians or metres between points
    of the path that the first spline goes through, None = a quarter of the path; each attempt halves it.
    Raises ValueError if no attempt is proved: then drive the path with a stop at each corner.
    """
    states = _unwrapped(checker, numpy.atleast_2d(path))
    velocity = numpy.broadcast_to(numpy.asarray(velocity, float), (checker.dof,)).copy()
    acceleration = numpy.broadcast_to(numpy.asarray(acceleration, float), (checker.dof,)).copy()
    if not ((velocity > 0).all() and (acceleration > 0).all()):
        raise ValueError("retime: velocity and acceleration limits must be above 0")
    length = float(numpy.linalg.norm(numpy.diff(states, axis=0), axis=1).sum())
    if not length > 0:
        raise ValueError("retime: the path has no length")
    spacing = length / 4 if spacing is None else spacing
    verdict = "toppra found no motion"
    for _ in range(attempts):
        found = _timed(states, spacing, velocity, acceleration, step)
        if found is not None:
            inside = (found[1] >= checker.lower).all() and (found[1] <= checker.upper).all() if not checker.wraps.any() else True
            proof = checker.trajectory(*found, min_d=min_d, slack=slack, threads=threads)
            if proof.all_free and inside:
                return Trajectory(*found, proof, spacing)
            verdict = repr(proof) if inside else "it leaves the joint limits"
        spacing, step = spacing / 2, step / 1.4
    raise ValueError(f"retime: no proof after {attempts} attempts, the last: {verdict}; allow more clearance, or stop at the corners")
