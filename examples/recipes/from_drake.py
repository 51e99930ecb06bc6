#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""From Drake: its trajectories proved for all times, and a region of its convex optimisation searched for a collision.

    python from_drake.py

`curves()` takes the control points of Bezier curves, which each segment of a PiecewisePolynomial or BsplineTrajectory is. A region
(HPolyhedron) is looked at in samples: one that collides refutes it, and edges between its samples are proved, which samples alone never are.
"""
import math
import pathlib

import numpy
from pydrake.geometry.optimization import HPolyhedron
from pydrake.trajectories import PiecewisePolynomial
from pydrake.common import RandomGenerator

import leeway

first = pathlib.Path(__file__).resolve().parents[1] / "first"


def control_points(trajectory):
    """Bezier control points [segments, degree + 1, dof] of a PiecewisePolynomial of one column."""
    out = []
    for segment in range(trajectory.get_number_of_segments()):
        seconds = trajectory.duration(segment)
        matrix = trajectory.getPolynomialMatrix(segment)
        degree = max(int(p.GetDegree()) for p in matrix.ravel())
        powers = numpy.zeros((degree + 1, len(matrix)))  # of the segment's own time in [0, 1]
        for row, polynomial in enumerate(matrix.ravel()):
            for power, coefficient in enumerate(polynomial.GetCoefficients()):
                powers[power, row] = coefficient * seconds**power
        out.append([sum(math.comb(i, k) / math.comb(degree, k) * powers[k] for k in range(i + 1)) for i in range(degree + 1)])
    return numpy.array(out)


def region_collides(checker, region, samples, seed=1):
    """A state of the region in collision, or None after so many samples."""
    generator, q = RandomGenerator(seed), None
    states = []
    for _ in range(samples):
        q = region.UniformSample(generator, mixing_steps=10) if q is None else region.UniformSample(generator, q, mixing_steps=10)
        states.append(q)
    states = numpy.array(states)
    bad = numpy.flatnonzero(~checker.is_free(states))
    return states[bad[0]] if len(bad) else None


def main():
    checker = leeway.Checker(leeway.Robot(first / "arm.urdf", first / "arm.srdf"), leeway.Scene(first / "scene.yaml"), group="arm")
    left, right = numpy.array([0.9, 0.9, 0.9, 0.0]), numpy.array([-0.9, 0.9, 0.9, 0.0])
    plan = checker.plan(left, right, seconds=5, min_d=0.005)
    assert plan.solved, plan.message
    times = numpy.arange(len(plan.path), dtype=float)
    stops = numpy.zeros_like(plan.path)
    trajectory = PiecewisePolynomial.CubicHermite(times, plan.path.T, stops.T)
    points = control_points(trajectory)
    middle = trajectory.value(0.5).ravel()
    assert numpy.allclose(middle, sum(math.comb(3, i) / 8 * points[0, i] for i in range(4)))
    curves = checker.curves(points)
    print(f"{len(points)} cubics: {curves}; proved at least {curves.lower.min() * 1000:.2f} mm at all times")
    assert curves.all_free
    wrong = checker.curves(control_points(PiecewisePolynomial.FirstOrderHold([0.0, 1.0], numpy.array([left, right]).T)))
    assert not wrong.all_free, "the straight way leads through the lamp"
    around_left = HPolyhedron.MakeBox(left - 0.02, left + 0.02)
    across = HPolyhedron.MakeBox(numpy.minimum(left, right) - 0.01, numpy.maximum(left, right) + 0.01)
    assert region_collides(checker, around_left, 1000) is None
    found = region_collides(checker, across, 1000)
    print(f"a box of states from left to right holds the colliding state {numpy.round(found, 3)}")
    assert found is not None


if __name__ == "__main__":
    main()
