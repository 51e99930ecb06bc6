#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Paths of OMPL's RRTConnect that are checked as MoveIt checks them, judged by the referee.

    PYTHONPATH=build/python moveit_like.py --robot panda.urdf --srdf panda.srdf [--paths 100] [--fraction 0.005] [--csv OUT.csv] FOLDER...

FOLDER has sceneNNNN.yaml and requestNNNN.yaml of MotionBenchMaker. A motion is valid if its end is, and the states between that cut it into pieces of at most
`fraction` of the space's extent: MoveIt's longest_valid_segment_fraction, its default 0.005, in MoveIt's metric, which adds the distances of all
joints. Found paths are simplified by OMPL, as MoveIt does it. States are checked by leeway, exactly: what is wrong in a path is the sampling alone.
Prints a row for each folder. Exit status 1: no path was found."""
import argparse
import csv
import math
import pathlib
import sys

import numpy
import yaml
from ompl import base, geometric, util

import leeway
import leeway.ompl

COLUMNS = ("set", "problems", "paths", "collide", "worst_depth_mm", "worst_percent", "proved", "undecided", "mean_states_of_a_motion")


class DiscreteValidator(base.MotionValidator):
    def __init__(self, si, checker, fraction):
        super().__init__(si)
        self.checker, self.motions, self.states = checker, 0, 0
        extent = numpy.where(checker.wraps, math.pi, checker.upper - checker.lower)
        self.longest = fraction * extent.sum()

    def checkMotion(self, a, b):
        a, b = (leeway.ompl.to_array(self.checker, q) for q in (a, b))
        way = b - a
        way = numpy.where(self.checker.wraps, numpy.remainder(way + math.pi, 2 * math.pi) - math.pi, way)
        pieces = max(1, math.ceil(numpy.abs(way).sum() / self.longest))
        self.motions, self.states = self.motions + 1, self.states + pieces
        return bool(self.checker.is_free(a + numpy.linspace(0, 1, pieces + 1)[1:, None] * way).all())


def ends_of(request):
    """Group, start and goal by joint name."""
    given = yaml.safe_load(request.read_text())
    start = given["start_state"]["joint_state"]
    goal = {j["joint_name"]: j["position"] for j in given["goal_constraints"][0]["joint_constraints"]}
    return given["group_name"], dict(zip(start["name"], start["position"])), goal


def path_of(checker, start, goal, given, seconds):
    """[n, dof] of a simplified path, or None; and the validator."""
    setup = geometric.SimpleSetup(leeway.ompl.state_space(checker))
    si = setup.getSpaceInformation()
    validator = DiscreteValidator(si, checker, given.fraction)
    si.setStateValidityChecker(leeway.ompl.StateValidityChecker(si, checker))
    si.setMotionValidator(validator)
    ends = []
    for values in (start, goal):
        state = si.getStateSpace().allocState()
        q = numpy.array([values[name] for name in checker.variables])
        # Some goals are beyond a limit by rounding
        leeway.ompl.from_array(checker, numpy.where(checker.wraps, q, numpy.clip(q, checker.lower, checker.upper)), state)
        ends.append(state)
    if not all(si.isValid(state) for state in ends):
        return None, validator
    setup.setStartAndGoalStates(*ends)
    setup.setPlanner(geometric.RRTConnect(si))
    solved = setup.solve(seconds)
    if not solved or not setup.haveExactSolutionPath():
        return None, validator
    setup.simplifySolution()
    if not setup.getSolutionPath().check():  # MoveIt asks again, and refuses those
        return None, validator
    return numpy.array([leeway.ompl.to_array(checker, q) for q in setup.getSolutionPath().getStates()]), validator


def judged(folder, robot, given, paths):
    row = dict.fromkeys(COLUMNS, 0) | {"set": folder.name}
    motions = states = 0
    for request in sorted(folder.glob("request*.yaml"))[:paths]:
        group, start, goal = ends_of(request)
        scene = leeway.Scene(request.with_name(request.name.replace("request", "scene")))
        reference = {name: value for name, value in start.items() if name in robot.variables}
        checker = leeway.Checker(robot, scene, group=group, reference=reference)
        row["problems"] += 1
        path, validator = path_of(checker, start, goal, given, 10)
        motions, states = motions + validator.motions, states + validator.states
        if path is None:
            continue
        [ruling] = checker.referee(path, policy="collision")
        row["paths"] += 1
        row[{"BLOCKED": "collide", "FREE": "proved"}.get(ruling["verdict"], "undecided")] += 1
        if ruling["verdict"] == "BLOCKED":
            row["worst_depth_mm"] = max(row["worst_depth_mm"], 1000 * max(0, ruling["worst"].get("depth", [0, 0])[0]))
            row["worst_percent"] = max(row["worst_percent"], colliding_share(checker, path))
    row["mean_states_of_a_motion"] = states / max(1, motions)
    return row


def colliding_share(checker, path):
    """Percent of the path's length that is in contact, of 20,000 states."""
    lengths = numpy.abs(numpy.diff(path, axis=0)).sum(axis=1)
    at = numpy.interp(numpy.linspace(0, lengths.sum(), 20000), numpy.concatenate([[0], numpy.cumsum(lengths)]), numpy.arange(len(path)))
    k = numpy.minimum(at.astype(int), len(path) - 2)
    return 100 * (1 - checker.is_free(path[k] + (at - k)[:, None] * (path[k + 1] - path[k])).mean())


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--robot", required=True)
    options.add_argument("--srdf", required=True)
    options.add_argument("--paths", type=int, default=100, help="in all")
    options.add_argument("--fraction", type=float, default=0.005)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--csv", type=pathlib.Path)
    options.add_argument("folders", nargs="+", type=pathlib.Path)
    given = options.parse_args()
    util.setLogLevel(util.LogLevel.LOG_ERROR)
    util.RNG.setSeed(given.seed)
    robot = leeway.Robot(given.robot, srdf=given.srdf)
    rows, each = [], math.ceil(given.paths / len(given.folders))
    print("|", " | ".join(name.replace("_", " ") for name in COLUMNS), "|\n|" + "---|" * len(COLUMNS))
    for folder in given.folders:
        rows.append(judged(folder, robot, given, each))
        print("|", " | ".join(f"{rows[-1][name]:.3g}" if isinstance(rows[-1][name], float) else str(rows[-1][name]) for name in COLUMNS), "|", flush=True)
    print(f"{sum(r['paths'] for r in rows)} paths, {sum(r['collide'] for r in rows)} collide, {sum(r['proved'] for r in rows)} are proved free")
    if given.csv:
        is_new = not given.csv.exists()
        with given.csv.open("a", newline="") as file:
            out = csv.writer(file)
            if is_new:
                out.writerow(["robot", "fraction", *COLUMNS])
            for row in rows:
                out.writerow([robot.name, given.fraction, *(f"{row[n]:.4g}" if isinstance(row[n], float) else row[n] for n in COLUMNS)])
    return int(sum(r["paths"] for r in rows) == 0)


if __name__ == "__main__":
    sys.exit(main())
