#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Hunts for wrong derivatives of Checker.near(): each row of random states against differences of certified distances.

    PYTHONPATH=build/python python3 benchmarks/zoo/near_derivatives.py [--states N] [--distance D] [--seed S] ROBOT...

For each state q and a random direction v of length 1, with slope s = derivatives @ v and steps h = 1e-3 of the row's distance:

  above     clearance( q + h v ) <= clearance( q ) + s h + curve: a property of every subgradient of a least distance, ridges or not
  slope     s and the differences at h and 2 h, extrapolated, agree to 1e-6 of the fastest point's speed, and to the error of intervals of
            width w at distance d: 3 w / h of the differences, sqrt( 2 w / d ) of the direction (core/docs/near.md)
  bend      they do not, but s changes by more between q - 2 h v and q + 2 h v: the nearest feature changes there

Rows of two states are the same if their bodies are. Exit status 1: a row keeps neither `slope` nor `bend`, or not `above`."""
import argparse
import sys

import numpy

import leeway

AGREE = 1e-6
STEPS = (-2, -1, 1, 2)


def random_states(checker, count, rng):
    low = numpy.where(numpy.isfinite(checker.lower), checker.lower, -numpy.pi)
    high = numpy.where(numpy.isfinite(checker.upper), checker.upper, numpy.pi)
    return rng.uniform(low, high, (count, checker.dof))


def unit(rng, checker, count):
    v = rng.normal(size=(count, checker.dof))
    return v / numpy.linalg.norm(v, axis=1, keepdims=True)


class Tally:
    def __init__(self):
        self.rows = self.slope = self.bend = self.tied = 0
        self.worst, self.wrong = 0.0, []

    def __str__(self):
        return (f"{self.rows} rows ({self.tied} tied): slope {self.slope}, bend {self.bend}, wrong {len(self.wrong)}; "
                f"worst slope {self.worst:.1g}")


def keyed(near, state):
    rows = near.rows(state)
    return {tuple(map(int, bodies)) + (bool(self_pair),): k for k, (bodies, self_pair) in
            enumerate(zip(near.bodies[rows], near.pairs[rows, 1] < near.links.shape[1]), rows.start)}


def look_at_row(tally, near, around, v, h, speed, name):
    """@param near arrays and row at q; around: the same at the steps of h"""
    arrays, row = near
    clearance, slope = arrays.upper[row], arrays.derivatives[row] @ v
    values = [a.upper[k] for a, k in around]
    slopes = [a.derivatives[k] @ v for a, k in around]
    width = 1e-13 + max(float(a.upper[k] - a.lower[k]) for a, k in [near, *around])
    noise = 3 * width / h + numpy.sqrt(2 * width / clearance) * speed
    tally.rows += 1
    for step, value in zip(STEPS, values):
        if value > clearance + step * h * slope + 2 * (step * h * speed)**2 / clearance + width + abs(step) * h * noise:
            tally.wrong.append(f"{name}: above by {value - clearance - step * h * slope:.3g} at step {step}")
    if arrays.directions[row] == leeway.Direction.TIED:
        tally.tied += 1
        return
    difference = (8 * (values[2] - values[1]) - (values[3] - values[0])) / (12 * h)
    error = abs(difference - slope)
    if error <= AGREE * max(speed, 1e-3) + noise:
        tally.slope += 1
        tally.worst = max(tally.worst, error / max(speed, 1e-3))
    elif error <= max(slopes + [slope]) - min(slopes + [slope]) + noise:
        tally.bend += 1
    else:
        tally.wrong.append(f"{name}: slope {slope:.9g}, differences {difference:.9g}, h {h:.3g}")


def hunt(file, count, distance, seed):
    robot = leeway.Robot(file)
    checker = leeway.Checker(robot)
    rng = numpy.random.default_rng(seed)
    tally = Tally()
    for begin in range(0, count, 500):
        states = random_states(checker, min(500, count - begin), rng)
        ways = unit(rng, checker, len(states))
        near = checker.near(states, distance, tie_width=1e-9)
        least = numpy.full(len(states), numpy.inf)
        of_row = numpy.repeat(numpy.arange(len(states)), numpy.diff(near.offsets))
        apart = near.directions != leeway.Direction.NONE
        numpy.minimum.at(least, of_row[apart], near.upper[apart])
        h = 1e-3 * numpy.clip(least, 1e-5, distance)
        around = [checker.near(states + (step * h)[:, None] * ways, 1.1 * distance) for step in STEPS]
        for i in range(len(states)):
            there = [keyed(a, i) for a in around]
            for key, k in keyed(near, i).items():
                if not apart[k] or not all(key in rows for rows in there) or near.upper[k] < 1e-5:
                    continue
                speed = numpy.abs(near.derivatives[k]).sum() + 1
                look_at_row(tally, (near, k), [(a, rows[key]) for a, rows in zip(around, there)], ways[i], h[i], speed,
                            f"{file} seed {seed} state {begin + i} bodies {key}")
    return tally


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--states", type=int, default=200, help="of each robot")
    options.add_argument("--distance", type=float, default=0.1, help="metres: rows below it")
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("robots", nargs="+", help="files of robots, in any format")
    given = options.parse_args()
    wrong = 0
    for file in given.robots:
        tally = hunt(file, given.states, given.distance, given.seed)
        print(f"{file}: {tally}", flush=True)
        for line in tally.wrong[:5]:
            print(f"  {line}")
        wrong += len(tally.wrong)
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
