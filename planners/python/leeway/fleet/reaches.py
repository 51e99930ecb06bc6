# SPDX-License-Identifier: BSD-3-Clause
"""Paths for the referee on a folder with one robot, one scene and many requests, as examples/kitchen's kitchen_demo writes them.

    build/bin/kitchen_demo demo
    python -m leeway.fleet.reaches demo paths.jsonl              # leeway, and OMPL's RRTConnect with its default sampled motions
    python -m leeway.fleet referee paths.jsonl --data demo
"""
from __future__ import annotations

import json
import pathlib
import sys
import time

from .._core import Checker, Robot, Scene, whole_number
from .paths import read_group, read_joints, read_states
from .planners import plan_by_ompl

__all__ = ["plan_reaches"]

SAMPLED = "OMPL, sampled at its default"


def _by_leeway(checker: Checker, start, goal, seed: int, seconds: float):
    found = checker.plan(start, goal, seed=seed, seconds=seconds)
    return found.path


def _by_ompl(checker: Checker, start, goal, seed: int, seconds: float):
    """RRTConnect and OMPL's simplification; states are checked by leeway, motions at OMPL's default resolution."""
    return plan_by_ompl(checker, start, goal, seed, seconds=seconds).path


def plan_reaches(folder, out, runs: int = 3, seconds: float = 20.0) -> dict[str, list[int]]:
    """Writes a line for each path: folder has robot.urdf, robot.srdf, scene.yaml and reach/*.yaml. Returns solved and asked runs by planner."""
    folder, runs = pathlib.Path(folder), whole_number("runs", runs, 1)
    robot, scene = Robot(folder / "robot.urdf", folder / "robot.srdf"), Scene(folder / "scene.yaml")
    counts: dict[str, list[int]] = {}
    with open(out, "w") as file:
        for request in sorted((folder / "reach").glob("*.yaml")):
            reference = {name: value for name, value in read_states(request).items() if name in robot.variables}
            checker = Checker(robot, scene, group=read_group(request), reference=reference)
            start, goal = read_joints(request, "", checker.variables)
            for run in range(1, runs + 1):
                for name, plan in (("leeway", _by_leeway), (SAMPLED, _by_ompl)):
                    clock = time.process_time()
                    path = plan(checker, start, goal, run, seconds)
                    spent = time.process_time() - clock
                    count = counts.setdefault(name, [0, 0])
                    count[1] += 1
                    if path is not None:
                        count[0] += 1
                        file.write(json.dumps({"problem": f"kitchen {request.stem}", "way": name, "run": run, "plan_us": 1e6 * spent, "simplify_us": 0.0,
                            "path": path.tolist(), "joints": checker.variables}) + "\n")
    return counts


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: python -m leeway.fleet.reaches FOLDER PATHS.jsonl")
    for planner, (solved, asked) in plan_reaches(sys.argv[1], sys.argv[2]).items():
        print(f"{planner}: {solved} of {asked} runs solved")
