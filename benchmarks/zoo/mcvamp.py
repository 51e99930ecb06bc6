#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Plane and line problems of McVAMP (arXiv 2604.13323), planned by `leeway plan --request`: each solved motion is proved at all times.

    mcvamp.py --problems plane_problems.json --robot panda.urdf [--srdf panda.srdf] [--limit 100] [--csv results.csv]
    PYTHONPATH=build/python mcvamp.py --make 100 --kind plane --problems made.json --robot panda.urdf ...

--make writes problems in the manner of theirs to the file, and then plans them: random states whose tips are in one plane or on one line through it, 0.3 to
1.2 m apart, and 0 to 90 random cubes of 2 to 5 cm about the arm, of which those at the ends are left out. A problem counts if leeway finds a path without the
constraint in a second. Theirs are those of github.com/CoMMALab/McVAMP, experiments/assets/problems/benchmark, which you fetch. As there, the place of the end effector is
constrained and its orientation is free. Bounds below --thin are made --thin wide: starts and goals were projected for another description of the arm.
The printed line: solved share, and medians and 95 % of the seconds of planning, shortcuts and timing with all proofs.
"""
import argparse
import csv
import json
import pathlib
import statistics
import subprocess
import tempfile

import numpy


def scene_of(problem):
    boxes = [f"    - {{id: box{i}, primitives: [{{type: box, dimensions: {[2 * half for half in box[3:]]}}}], "
             f"primitive_poses: [{{position: {box[:3]}, orientation: [0, 0, 0, 1]}}]}}\n" for i, box in enumerate(problem["cuboid_obstacles"])]
    return "name: mcvamp\nworld:\n  collision_objects:" + ("\n" + "".join(boxes) if boxes else " []\n")


def request_of(problem, options):
    """Bounds are about the middle of a box whose axes are those of the end effector's pose; quaternions there begin with w."""
    w, x, y, z, *place = problem["eef_transforms"]
    if any(abs(value - wanted) > 1e-6 for value, wanted in zip(problem["eef_transforms_ref_frame_w_world"], (1, 0, 0, 0, 0, 0, 0))):
        raise SystemExit("a frame of a problem is not the world; this reader knows no other")
    size = [max(upper - lower, 2 * options.thin) for lower, upper in zip(problem["tsr_lower_bound"][:3], problem["tsr_upper_bound"][:3])]
    joints = problem.get("joint_names") or [options.joint.format(i) for i in range(1, len(problem["problem_start"]) + 1)]
    goal = [{"joint_name": name, "position": value} for name, value in zip(joints, problem["problem_end"])]
    region = {"primitives": [{"type": "box", "dimensions": size}],
              "primitive_poses": [{"position": place, "orientation": [x, y, z, w]}]}
    return json.dumps({
        "group_name": options.group,
        "start_state": {"joint_state": {"name": joints, "position": problem["problem_start"]}},
        "goal_constraints": [{"joint_constraints": goal}],
        "path_constraints": {"position_constraints": [{
            "link_name": options.tip, "target_point_offset": dict(zip("xyz", options.offset)), "constraint_region": region}]}})


def plan(number, problem, options, folder):
    (folder / "scene.yaml").write_text(scene_of(problem), encoding="utf-8")
    (folder / "request.yaml").write_text(request_of(problem, options), encoding="utf-8")
    report = folder / "report.json"
    report.unlink(missing_ok=True)
    command = [options.leeway, "plan", "--robot", options.robot, "--scene", folder / "scene.yaml", "--request", folder / "request.yaml",
               "--trajectory", folder / "plan.json", "--report", report, "--time", str(options.time), *(["--srdf", options.srdf] if options.srdf else []), *(word for name in options.package for word in ("--package-path", name))]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    row = {"problem": number, "obstacles": len(problem["cuboid_obstacles"]), "solved": run.returncode == 0}
    if not report.exists():
        return {**row, "status": run.stderr.strip().splitlines()[-1] if run.stderr else "no answer"}
    answer = json.loads(report.read_text(encoding="utf-8"))
    return {**row, "status": answer["status"], "seconds": sum(answer["seconds"].values()),
            "length": answer.get("path", {}).get("length"), "duration": answer.get("duration")}


def cubes_of(count, rng):
    """Middle and half edges, as in McVAMP's files."""
    return [[*rng.uniform([-0.8, -0.8, -0.2], [0.8, 0.8, 0.9]).tolist(), *[float(numpy.clip(rng.normal(0.0165, 0.0045), 0.01, 0.025))] * 3] for _ in range(count)]


def problem_of(leeway, robot, options, count, rng):
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
            "problem_start": start.tolist(), "problem_end": goals[0].tolist(), "joint_names": list(checker.variables),
            "tsr_lower_bound": [-10 if k in axes else -half for k in range(3)], "tsr_upper_bound": [10 if k in axes else half for k in range(3)]}


def make(options):
    import leeway
    rng, robot = numpy.random.default_rng(options.seed), leeway.Robot(options.robot, options.srdf, packages=options.package)
    options.offset, problems = [0, 0, 0], []
    while len(problems) < options.make:
        problem = problem_of(leeway, robot, options, 10 * (len(problems) % 10), rng)
        problems += [problem] if problem else []
    options.problems.write_text(json.dumps(problems), encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--problems", required=True, type=pathlib.Path)
    parser.add_argument("--robot", required=True)
    parser.add_argument("--srdf", default="")
    parser.add_argument("--group", default="panda_arm")
    parser.add_argument("--joint", default="panda_joint{}", help="names of joints, with {} for 1, 2, ...")
    parser.add_argument("--tip", default="panda_hand")
    parser.add_argument("--offset", type=float, nargs=3, default=[0, 0, 0.105], help="of the end effector in the tip's frame")
    parser.add_argument("--thin", type=float, default=1e-3, help="metres: half of the least width")
    parser.add_argument("--time", type=float, default=10, help="seconds for each")
    parser.add_argument("--limit", type=int, default=None)
    parser.add_argument("--leeway", default="build/bin/leeway")
    parser.add_argument("--csv", type=pathlib.Path, default=None)
    parser.add_argument("--make", type=int, default=0, help="write so many problems first")
    parser.add_argument("--kind", choices=["plane", "line"], default="plane", help="of --make")
    parser.add_argument("--seed", type=int, default=1, help="of --make")
    parser.add_argument("--package", action="append", default=[], help="name=folder, for package:// URIs")
    options = parser.parse_args()
    if options.make:
        make(options)
    problems = json.loads(options.problems.read_text(encoding="utf-8"))[:options.limit]
    with tempfile.TemporaryDirectory() as folder:
        rows = [plan(number, problem, options, pathlib.Path(folder)) for number, problem in enumerate(problems)]
    if options.csv:
        with options.csv.open("w", newline="", encoding="utf-8") as out:
            writer = csv.DictWriter(out, ["problem", "obstacles", "solved", "status", "seconds", "length", "duration"])
            writer.writeheader()
            writer.writerows(rows)
    seconds = sorted(row["seconds"] for row in rows if row["solved"])
    print(f"{len(seconds)} of {len(rows)} solved" + (f"; seconds: median {statistics.median(seconds):.4f}, "
          f"95 % {seconds[min(len(seconds) - 1, int(0.95 * len(seconds)))]:.4f}" if seconds else ""))
    for status in sorted({row["status"] for row in rows if not row["solved"]}):
        print(f"  {sum(row['status'] == status for row in rows if not row['solved'])}: {status}")


if __name__ == "__main__":
    main()
