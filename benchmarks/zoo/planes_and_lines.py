#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Problems in the manner of McVAMP's (arXiv 2604.13323) for any arm; mcvamp.py plans them.

    PYTHONPATH=build/python planes_and_lines.py OUT.json --kind plane --count 100 --robot panda.urdf --srdf panda.srdf [--package panda=FOLDER]

plane, line   The tips of a random free state and of another one are in one plane, or on one line, along axes of the world, 0.3 to 1.2 m apart.
sweep         A point 10.5 cm beyond the tip goes 1.3 m along a line in front of the arm. All problems have the same ends, hand down, and other cubes.
maze          A hand with a pen of 18 cm keeps its height and looks down, and the pen is between the walls of a random maze of 8 x 3 cells, which all problems
              share. Ends are in random cells, in random branches of the inverse kinematics: nothing says that a way leads from one branch to the other.

In all but the maze random cubes of 2 to 5 cm are about the arm, 0 to 90 in steps of 10; those at the ends are left out, and a problem counts if leeway
finds a path without the constraint in a second. `--like line_problems.json` takes ends and constraint from the first problem of McVAMP's file.
"""
import argparse
import itertools
import json
import pathlib

import numpy

import leeway
from mcvamp import PEN, TOUCH, tip_pose

DOWN = [1, 0, 0, 0]  # quaternion x y z w
MAZE = numpy.array([[0.2, -0.65], [0.65, 0.65]])  # corners on the table
CELLS = (3, 8)
WALL = [0.012, 0.1]  # thickness, height
FREE = [1000, 1000, 1000]  # turns without a bound
OFFSET = [0, 0, 0.105]  # of the point of a sweep
HEIGHT = 0.311  # of the tip: its pen ends 36 mm above the table


def cubes_of(count, rng):
    """Middle and half edges, as in McVAMP's files."""
    return [[*rng.uniform([-0.8, -0.8, -0.2], [0.8, 0.8, 0.9]).tolist(), *[float(numpy.clip(rng.normal(0.0165, 0.0045), 0.01, 0.025))] * 3] for _ in range(count)]


def problem_of(checker, ends, pose, bounds, **more):
    """pose: of the box, w x y z and place; bounds: half sizes and turns of the box."""
    return {"eef_transforms": pose, "eef_transforms_ref_frame_w_world": [1, 0, 0, 0, 0, 0, 0],
            "problem_start": ends[0].tolist(), "problem_end": ends[1].tolist(), "joint_names": list(checker.variables), "tip_offset": [0, 0, 0],
            "tsr_lower_bound": [-bound for bound in bounds], "tsr_upper_bound": bounds, **more}


def between_states(robot, checker, options, rng):
    """The tips of two states in a plane or on a line along axes of the world; None if there is no second state."""
    states = rng.uniform(numpy.maximum(checker.lower, -numpy.pi), numpy.minimum(checker.upper, numpy.pi), (200, checker.dof))
    start = states[checker.is_free(states)][0]
    tip = tip_pose(robot, checker, options.tip, start)[:3, 3]
    axes = rng.permutation(3)[:2 if options.kind == "plane" else 1]
    way = rng.normal(size=len(axes))
    place = tip.copy()
    place[axes] += way * rng.uniform(0.3, 1.2) / numpy.linalg.norm(way)
    goals = checker.goal_states(options.tip, [*place, 0, 0, 0, 1], angle_tolerance=numpy.pi, count=1, seed=1).states
    half = 1e-3 if options.kind == "plane" else 2.5e-3
    bounds = [10 if k in axes else half for k in range(3)] + FREE
    return problem_of(checker, (start, goals[0]), [1, 0, 0, 0, *tip.tolist()], bounds) if len(goals) else None


def sweep_of(checker, options):
    """From the left to the right, hand down, in the branch that is nearest."""
    left, right = (checker.goal_states(options.tip, [0.35, y, 0.24 + OFFSET[2], *DOWN], count=40, seed=1).states for y in (0.65, -0.65))
    distances = numpy.linalg.norm(left[:, None] - right[None], axis=2)
    i, k = numpy.unravel_index(distances.argmin(), distances.shape)
    return problem_of(checker, (left[i], right[k]), [1, 0, 0, 0, 0.35, 0.65, 0.24], [2.5e-3, 10, 2.5e-3] + FREE, tip_offset=OFFSET)


def among_cubes(robot, options, problem, count, rng):
    """The problem with random cubes, or None if its ends have no path without the constraint."""
    world = leeway.World(robot, group=options.group)
    checker = world.checker
    ends = problem["problem_start"], problem["problem_end"]
    kept = []
    for i, cube in enumerate(cubes_of(count, rng)):
        checker = world.add(f"box{i}", leeway.Shape.box(*(2 * half for half in cube[3:])), cube[:3])
        if (checker.clearance(ends).upper > 0.001).all():
            kept.append(cube)
        else:
            checker = world.remove(f"box{i}")
    return {**problem, "cuboid_obstacles": kept} if checker.plan(*ends, seconds=1, seed=1).solved else None


def walls_of(rng):
    """Middles and half edges of the walls of a random spanning tree of cells."""
    size = (MAZE[1] - MAZE[0]) / CELLS
    parts = {(i, k): (i, k) for i in range(CELLS[0]) for k in range(CELLS[1])}

    def part(cell):
        while parts[cell] != cell:
            cell = parts[cell]
        return cell

    sides = [((i, k), (i + di, k + dk)) for i in range(CELLS[0]) for k in range(CELLS[1]) for di, dk in ((1, 0), (0, 1)) if i + di < CELLS[0] and k + dk < CELLS[1]]
    walls = []
    for number in rng.permutation(len(sides)):
        a, b = sides[number]
        if part(a) != part(b):
            parts[part(a)] = part(b)
            continue
        middle = MAZE[0] + size * (numpy.add(a, b) / 2 + 0.5)
        across = numpy.subtract(b, a)
        half = numpy.where(across == 1, WALL[0] / 2, size / 2 + WALL[0] / 2)
        walls.append([*middle.tolist(), WALL[1] / 2, *half.tolist(), WALL[1] / 2])
    for axis in (0, 1):
        for side in (0, 1):
            middle, half = MAZE.mean(axis=0), (MAZE[1] - MAZE[0]) / 2 + WALL[0] / 2
            middle[axis], half[axis] = MAZE[side][axis], WALL[0] / 2
            walls.append([*middle.tolist(), WALL[1] / 2, *half.tolist(), WALL[1] / 2])
    return walls


def maze_problems(robot, options, rng):
    """Problems of one maze; a height and a tilt of 0.01 m and rad, as in McVAMP's."""
    walls = walls_of(rng)
    world = leeway.World(robot, group=options.group)
    for i, wall in enumerate(walls):
        world.add(f"wall{i}", leeway.Shape.box(*(2 * half for half in wall[3:])), wall[:3])
    world.add("pen", leeway.Shape.cylinder(PEN["radius"], PEN["length"]), [0, 0, -5])
    checker = world.attach_at("pen", options.tip, PEN["middle"], options.touch)
    cells = MAZE[0] + (MAZE[1] - MAZE[0]) / CELLS * (numpy.stack(numpy.indices(CELLS), axis=-1).reshape(-1, 2) + 0.5)
    while True:
        ends = []
        for cell in cells[rng.choice(len(cells), 2, replace=False)]:
            turn = rng.uniform(-numpy.pi, numpy.pi) / 2
            pose = [*cell, HEIGHT, numpy.cos(turn), numpy.sin(turn), 0, 0]
            ends.append(checker.goal_states(options.tip, pose, count=8, seed=int(rng.integers(1000000))).states)
        if all(len(states) for states in ends):
            yield problem_of(checker, [rng.choice(states) for states in ends], [0, 1, 0, 0, 0, 0, HEIGHT], [10, 10, 0.01, 0.01, 0.01, 1000],
                             cuboid_obstacles=walls, attached={"link_name": options.tip, "touch_links": options.touch, **PEN})


def cube_problems(robot, options, rng):
    checker = leeway.Checker(robot, group=options.group)
    shared = json.loads(options.like.read_text(encoding="utf-8"))[0] if options.like else sweep_of(checker, options) if options.kind == "sweep" else None
    count = 0
    while True:
        one = shared or between_states(robot, checker, options, rng)
        problem = among_cubes(robot, options, one, 10 * (count % 10), rng) if one else None
        if problem:
            count += 1
            yield problem


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--kind", choices=["plane", "line", "sweep", "maze"], default="plane")
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--robot", required=True)
    parser.add_argument("--srdf", default="")
    parser.add_argument("--group", default="panda_arm")
    parser.add_argument("--tip", default="panda_hand")
    parser.add_argument("--touch", nargs="*", default=TOUCH, help="links that the pen may touch")
    parser.add_argument("--like", type=pathlib.Path, help="a file of McVAMP's")
    parser.add_argument("--package", action="append", default=[], help="name=folder, for package:// URIs")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    rng, robot = numpy.random.default_rng(options.seed), leeway.Robot(options.robot, options.srdf, packages=options.package)
    problems = (maze_problems if options.kind == "maze" else cube_problems)(robot, options, rng)
    options.out.write_text(json.dumps(list(itertools.islice(problems, options.count))), encoding="utf-8")


if __name__ == "__main__":
    main()
