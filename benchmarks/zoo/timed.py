#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Durations of leeway's timing of paths, beside TOPP-RA and Ruckig on the same paths; and which of their trajectories collide.

    PYTHONPATH=build/python timed.py --robot panda.urdf --srdf panda.srdf --limits joint_limits.yaml [--paths 100] [--csv OUT.csv] FOLDER...

FOLDER has sceneNNNN.yaml and requestNNNN.yaml of MotionBenchMaker. leeway plans the paths. Rows, seconds of driving:
rounded   Checker.timed(): jerk limited, corners rounded as far as is proved
stops     the same with a stop at each corner
toppra    time-optimal on a cubic spline through the corners, as others time paths: no limit of the jerk. Judged as it is driven, with cubic pieces every 10 ms
retimed   leeway.retime: toppra on a spline that follows the path so closely that it is proved
ruckig    state to state along each edge, with a stop at each corner (Ruckig needs a server for the states between)
Exit status 1: a trajectory of Checker.timed() is not proved, or exceeds a limit."""
import argparse
import csv
import pathlib
import statistics
import sys
import time

import numpy
import ruckig
import toppra
import yaml
from moveit_like import ends_of
from toppra import algorithm, constraint

import leeway
import leeway.retime

WAYS = ("rounded", "stops", "toppra", "retimed", "ruckig")
toppra.setup_logging("ERROR")


def by_toppra(path, velocity, acceleration):
    """Times, positions, velocities of the fastest motion on a spline through the corners."""
    lengths = numpy.concatenate([[0], numpy.cumsum(numpy.linalg.norm(numpy.diff(path, axis=0), axis=1))])
    spline = toppra.SplineInterpolator(lengths, path, bc_type="clamped" if len(path) < 3 else "not-a-knot")
    limits = [constraint.JointVelocityConstraint(numpy.stack([-velocity, velocity], axis=1)),
        constraint.JointAccelerationConstraint(numpy.stack([-acceleration, acceleration], axis=1))]
    motion = algorithm.TOPPRA(limits, spline, gridpoints=numpy.linspace(0, lengths[-1], max(200, 4 * len(path)))).compute_trajectory(0, 0)
    if motion is None:
        return None
    times = numpy.linspace(0, motion.duration, max(2, int(numpy.ceil(motion.duration / 0.01)) + 1))
    return times, motion(times), motion(times, 1)


def by_ruckig(path, limits):
    """Seconds, with a stop at each corner."""
    engine, total = ruckig.Ruckig(path.shape[1]), 0.0
    given = ruckig.InputParameter(path.shape[1])
    given.max_velocity, given.max_acceleration, given.max_jerk = (list(map(float, limit)) for limit in limits)
    given.synchronization = ruckig.Synchronization.Phase
    for a, b in zip(path[:-1], path[1:]):
        given.current_position, given.target_position = list(a), list(b)
        found = ruckig.Trajectory(path.shape[1])
        engine.calculate(given, found)
        total += found.duration
    return total


def rows_of(folder, robot, given, tally):
    for request in sorted(folder.glob("request*.yaml"))[: given.paths]:
        group, start, goal = ends_of(request)
        scene = leeway.Scene(request.with_name(request.name.replace("request", "scene")))
        checker = leeway.Checker(robot, scene, group=group, reference={n: v for n, v in start.items() if n in robot.variables})
        ends = [numpy.clip([values[name] for name in checker.variables], checker.lower, checker.upper) for values in (start, goal)]
        plan = checker.plan(*ends, seconds=5)
        if plan.outcome != leeway.Outcome.SOLVED:
            continue
        path = plan.path
        of_file = yaml.safe_load(given.limits.read_text())["joint_limits"]
        limits = [numpy.array([of_file[name][key] for name in checker.variables]) for key in ("max_velocity", "max_acceleration", "max_jerk")]
        begin = time.perf_counter()
        rounded = checker.timed(path, joint_limits=given.limits)
        tally["ms"].append(1000 * (time.perf_counter() - begin))
        stops = checker.timed(path, joint_limits=given.limits, path_tolerance=0)
        for timed in (rounded, stops):
            tally["bad"] += not checker.audit_trajectory(*timed, joint_limits=given.limits)["valid"]
        fast = by_toppra(path, *limits[:2])
        tally["collide"] += fast is not None and bool((checker.trajectory(*fast).verdicts == int(leeway.Verdict.BLOCKED)).any())
        try:
            retimed = leeway.retime.retime(checker, path, limits[0], limits[1]).duration
        except ValueError:
            retimed = float("nan")
        yield {"set": folder.name, "request": request.stem, "states": len(path), "rounded": rounded.duration, "stops": stops.duration,
            "toppra": fast[0][-1] if fast else float("nan"), "retimed": retimed, "ruckig": by_ruckig(path, limits)}


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--robot", required=True)
    options.add_argument("--srdf", required=True)
    options.add_argument("--limits", required=True, type=pathlib.Path)
    options.add_argument("--paths", type=int, default=100, help="of each folder, at most")
    options.add_argument("--csv", type=pathlib.Path)
    options.add_argument("folders", nargs="+", type=pathlib.Path)
    given = options.parse_args()
    robot = leeway.Robot(given.robot, given.srdf)
    tally, rows = {"bad": 0, "collide": 0, "ms": []}, []
    for folder in given.folders:
        rows += rows_of(folder, robot, given, tally)
    if given.csv:
        with given.csv.open("w", newline="") as file:
            table = csv.DictWriter(file, fieldnames=("set", "request", "states", *WAYS))
            table.writeheader()
            table.writerows({k: f"{v:.4f}" if isinstance(v, float) else v for k, v in row.items()} for row in rows)
    print(f"{len(rows)} paths; Checker.timed(): {statistics.median(tally['ms']):.2f} ms in the median, {tally['bad']} not proved or beyond a limit; "
          f"toppra: {tally['collide']} collide")
    for way in WAYS:
        kept = [row for row in rows if row[way] == row[way]]
        ratios = [row[way] / row["rounded"] for row in kept]
        print(f"{way:8} {len(kept):4} paths, seconds: median {statistics.median(r[way] for r in kept):.3f}, mean {statistics.mean(r[way] for r in kept):.3f}; "
              f"of rounded: median {statistics.median(ratios):.2f}")
    return 1 if tally["bad"] or not rows else 0


if __name__ == "__main__":
    sys.exit(main())
