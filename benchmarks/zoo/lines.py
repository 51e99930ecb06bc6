#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Random lines of fifteen arms: the share that Checker.plan_line() finds of those for which a dense search finds one, and its times.

    PYTHONPATH=build/python build/zoo/venv/bin/python benchmarks/zoo/lines.py [--lines N] [--only NAME] [--csv OUT.csv]

A line begins at the pose of a random free state, in any state, goes 0.2 to 1 m in a random direction and turns by up to 0.3 rad about each axis.
Deviations are proved to be below 0.1 mm in each coordinate and 0.1 degrees (0.0017 rad), and the arm free of itself.

The dense search knows no cubics: at stations every 10 mm it keeps free states on the line, each within 0.2 rad of a kept one before, from two
sources: each kept state led to the next station by leeway.Inverse, and random states there. A line that it finds need not be one for
continuous motion: the other way round, each line that plan_line() finds is proved. Exit status 1: a line is found without its proof."""
import argparse
import sys
import time

import numpy
import arms

import leeway

NEAR = 0.2  # rad or m of each joint, from station to station
KEPT = 150  # states of a station at most


def turn_of(vector):
    """Rotation matrix of a rotation vector."""
    angle = numpy.linalg.norm(vector)
    x, y, z = vector / angle if angle > 0 else (0, 0, 0)
    cross = numpy.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return numpy.eye(3) + numpy.sin(angle) * cross + (1 - numpy.cos(angle)) * cross @ cross


def vector_of(turn):
    angle = numpy.arccos(numpy.clip((numpy.trace(turn) - 1) / 2, -1, 1))
    axis = numpy.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    return angle * axis / max(numpy.linalg.norm(axis), 1e-12)


def stations_of(begin, end, count):
    way = vector_of(begin[:3, :3].T @ end[:3, :3])
    poses = numpy.tile(begin, (count + 1, 1, 1))
    for i, share in enumerate(numpy.linspace(0, 1, count + 1)):
        poses[i, :3, :3] = begin[:3, :3] @ turn_of(share * way)
        poses[i, :3, 3] = begin[:3, 3] + share * (end[:3, 3] - begin[:3, 3])
    return poses


class Lines:
    def __init__(self, arm):
        self.arm = arm
        self.robot, self.checker = arm.load(self_collision=True)
        self.inverse = leeway.Inverse(self.checker, arm.tip)
        none = ~(self.checker.upper - self.checker.lower < 100)
        self.lower = numpy.where(none, -numpy.pi, self.checker.lower)
        self.upper = numpy.where(none, numpy.pi, self.checker.upper)
        self.circles = none

    def random_line(self, rng):
        while True:
            q = rng.uniform(self.lower, self.upper)
            if self.checker.is_free(q):
                break
        begin = self.robot.fk(self.checker.full_state(q))[self.robot.links.index(self.arm.tip)]
        end = begin.copy()
        direction = rng.normal(size=3)
        end[:3, 3] += rng.uniform(0.2, 1) * direction / numpy.linalg.norm(direction)
        end[:3, :3] = begin[:3, :3] @ turn_of(rng.uniform(-0.3, 0.3, 3))
        return begin, end

    def free_states(self, pose, count, seed):
        found = self.inverse.solve(pose, count=count, searches=4 * count, apart=0.03, seed=seed, threads=0)
        return found.states[self.checker.is_free(found.states, threads=0)] if len(found.states) else found.states

    def apart(self, a, b):
        """[len(a), len(b)]: the largest difference of a joint."""
        step = a[:, None] - b[None]
        step[..., self.circles] = numpy.remainder(step[..., self.circles] + numpy.pi, 2 * numpy.pi) - numpy.pi
        return abs(step).max(axis=2)

    def dense_search(self, begin, end):
        count = int(numpy.ceil(numpy.linalg.norm(end[:3, 3] - begin[:3, 3]) / 0.01))
        poses = stations_of(begin, end, count)
        if any(len(self.free_states(pose, KEPT, 1)) == 0 for pose in poses[[-1, count // 2, count // 4, 3 * count // 4]]):
            return False
        kept = self.free_states(poses[0], KEPT, 2)
        for i in range(1, count + 1):
            if len(kept) == 0:
                return False
            led = self.inverse.solve(numpy.tile(poses[i], (len(kept), 1, 1)), kept, count=1, threads=0).first
            led = led[~numpy.isnan(led[:, 0])]
            some = [led] if i % 5 else [led, self.free_states(poses[i], KEPT, i)]
            states = numpy.concatenate(some)
            states = states[self.apart(states, kept).min(axis=1) < NEAR]
            states = states[self.checker.is_free(states, threads=0)] if len(states) else states
            chosen = []  # one of those that are alike
            for state in states:
                if not chosen or self.apart(state[None], numpy.array(chosen)).min() > 0.02:
                    chosen.append(state)
            kept = numpy.array(chosen[:KEPT]).reshape(-1, self.checker.dof)
        return len(kept) > 0


def look_at(arm, given, row):
    lines = Lines(arm)
    rng = numpy.random.default_rng(given.seed)
    limits = {"velocity": numpy.full(lines.checker.dof, 1.0), "acceleration": numpy.full(lines.checker.dof, 2.0)}
    times, slow, cubics, attempts, stops, bad = [], [], [], [], {}, 0
    row.update(joints=lines.checker.dof, lines=given.lines, found=0, missed=0)
    for i in range(given.lines):
        begin, end = lines.random_line(rng)
        clock = time.process_time()
        line = lines.checker.plan_line(arm.tip, [begin, end], check="self", seed=i, **limits)
        milliseconds = 1000 * (time.process_time() - clock)
        if line.solved:
            row["found"] += 1
            times.append(milliseconds)
            cubics.append(len(line.times) - 1)
            attempts.append(line.attempts)
            bad += not (line.position_error <= 1e-4 and line.angle_error <= 0.0017)
            continue
        slow.append(milliseconds)
        if not given.no_search and lines.dense_search(begin, end):
            row["missed"] += 1
            reason = line.message.split(";")[0][:70]
            stops[reason] = stops.get(reason, 0) + 1
            if given.show:
                print(f"  line {i}: {line.message}", flush=True)
    row["share"] = row["found"] / max(row["found"] + row["missed"], 1)
    for name, values in (("ms", times), ("ms_of_others", slow), ("cubics", cubics), ("attempts", attempts)):
        if values:
            row[f"{name}_median"], row[f"{name}_95"] = (float(numpy.percentile(values, share)) for share in (50, 95))
    return bad


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--lines", type=int, default=500, help="of each arm")
    parser.add_argument("--only", default="", help="part of an arm's name")
    parser.add_argument("--seed", type=int, default=44)
    parser.add_argument("--no-search", action="store_true", help="times alone")
    parser.add_argument("--show", action="store_true", help="reasons of lines that are missed")
    parser.add_argument("--csv", help="file of all figures")
    given = parser.parse_args()
    rows, bad = [], 0
    for arm in arms.ARMS:
        if given.only.lower() in arm.name.lower():
            row = {"arm": arm.name}
            bad += look_at(arm, given, row)
            rows.append(row)
            arms.say(row)
    arms.write(rows, given.csv)
    return int(bad > 0)


if __name__ == "__main__":
    sys.exit(main())
