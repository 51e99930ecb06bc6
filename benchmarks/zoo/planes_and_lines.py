#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Problems in the manner of McVAMP's (arXiv 2604.13323) for any arm; mcvamp.py plans them.

    PYTHONPATH=build/python planes_and_lines.py OUT.json --kind plane --count 100 --robot panda.urdf --srdf panda.srdf [--package panda=FOLDER]

The tips of a random free state and of another one are in one plane, or on one line, along axes of the world, 0.3 to 1.2 m apart. 0 to 90 random cubes of
2 to 5 cm are about the arm; those at its two ends are left out. A problem counts if leeway finds a path without the constraint in a second.
"""
import argparse
import json
import pathlib

import numpy

import leeway


def cubes_of(count, rng):
    """Middle and half edges, as in McVAMP's files."""
    return [[*rng.uniform([-0.8, -0.8, -0.2], [0.8, 0.8, 0.9]).tolist(), *[float(numpy.clip(rng.normal(0.0165, 0.0045), 0.01, 0.025))] * 3] for _ in range(count)]


def problem_of(robot, options, count, rng):
    """One problem along axes of the world, or None if its ends have no path without the constraint."""
    world = leeway.World(robot, group=options.group)
    checker = world.checker
    states = rng.uniform(numpy.maximum(checker.lower, -numpy.pi), numpy.minimum(checker.upper, numpy.pi), (200, checker.dof))
    start = states[checker.is_free(states)][0]
    tip = robot.fk(checker.full_state(start)[:len(robot.variables)])[robot.links.index(options.tip), :3, 3]
    axes = rng.permutation(3)[:2 if options.kind == "plane" else 1]
    way = rng.normal(size=len(axes))
    place = tip.copy()
    place[axes] += way * rng.uniform(0.3, 1.2) / numpy.linalg.norm(way)
    goals = checker.goal_states(options.tip, [*place, 0, 0, 0, 1], angle_tolerance=numpy.pi, count=1, seed=1).states
    if len(goals) == 0:
        return None
    kept = []
    for i, cube in enumerate(cubes_of(count, rng)):
        checker = world.add(f"box{i}", leeway.Shape.box(*(2 * half for half in cube[3:])), cube[:3])
        if (checker.clearance([start, goals[0]]).upper > 0.001).all():
            kept.append(cube)
        else:
            checker = world.remove(f"box{i}")
    if not checker.plan(start, goals[0], seconds=1, seed=1).solved:
        return None
    half = 1e-3 if options.kind == "plane" else 2.5e-3
    return {"cuboid_obstacles": kept, "eef_transforms": [1, 0, 0, 0, *tip.tolist()], "eef_transforms_ref_frame_w_world": [1, 0, 0, 0, 0, 0, 0],
            "problem_start": start.tolist(), "problem_end": goals[0].tolist(), "joint_names": list(checker.variables), "tip_offset": [0, 0, 0],
            "tsr_lower_bound": [-10 if k in axes else -half for k in range(3)], "tsr_upper_bound": [10 if k in axes else half for k in range(3)]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--kind", choices=["plane", "line"], default="plane")
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--robot", required=True)
    parser.add_argument("--srdf", default="")
    parser.add_argument("--group", default="panda_arm")
    parser.add_argument("--tip", default="panda_hand")
    parser.add_argument("--package", action="append", default=[], help="name=folder, for package:// URIs")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    rng, robot = numpy.random.default_rng(options.seed), leeway.Robot(options.robot, options.srdf, packages=options.package)
    problems = []
    while len(problems) < options.count:
        problem = problem_of(robot, options, 10 * (len(problems) % 10), rng)
        problems += [problem] if problem else []
    options.out.write_text(json.dumps(problems), encoding="utf-8")


if __name__ == "__main__":
    main()
