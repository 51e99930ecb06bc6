#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Problems of McVAMP (arXiv 2604.13323), planned by Checker.plan_request(): each solved motion is proved at all times.

    PYTHONPATH=build/python mcvamp.py --problems plane_problems.json --robot panda.urdf [--srdf panda.srdf] [--limit 100] [--csv results.csv]

    for file in problems/benchmark/plane_problems problems/benchmark/line_problems problems/benchmark/maze_pen_problems environments/maze/cuboids; do
        curl -fsSLO https://raw.githubusercontent.com/CoMMALab/McVAMP/main/experiments/assets/$file.json
    done

fetches McVAMP's files. The maze needs `--cuboids cuboids.json --orientation`. planes_and_lines.py writes other problems in their manner. The place of the end
effector is constrained and its orientation is free, but for --orientation (the maze). Bounds below --thin are made --thin wide: McVAMP's starts and goals were
projected for another description of the arm, and those of its lines lie up to 10 mm beside them: --project leads both ends to the middle of thin bounds.
Each problem is planned --runs times in this process, and the last run counts, as McVAMP plans one problem after another in a process.
The printed lines: solved share, and medians and 95 % of the milliseconds of the search alone, and of the call, with shortcuts, timing and all proofs; of all
problems, and by the number of obstacles.
"""
import argparse
import csv
import json
import math
import pathlib
import statistics
import tempfile
import time

import numpy

import leeway


PEN = {"radius": 0.01, "length": 0.18, "middle": [0, 0, 0.185]}  # along the hand's z axis: nine balls of 1 cm in McVAMP
TOUCH = ["panda_leftfinger", "panda_rightfinger"]


def in_maze(problem, walls):
    """McVAMP's maze keeps its constraint and its pen in the program (benchmark_maze.cc)."""
    if any(wall.get(turn) for wall in walls for turn in ("roll", "pitch", "yaw")):
        raise SystemExit("a wall of the maze is turned; this reader knows no such walls")
    return {**problem, "cuboid_obstacles": [[*(wall[k] for k in "xyz"), *(wall["d" + k] / 2 for k in "xyz")] for wall in walls],
            "eef_transforms": [0, 1, 0, 0, 0.29276255, -0.55347496, 0.20607783], "eef_transforms_ref_frame_w_world": [1, 0, 0, 0, 0, 0, 0],
            "tsr_lower_bound": [-10.01, -10.01, -0.01, -0.01, -0.01, -10.01], "tsr_upper_bound": [10.01, 10.01, 0.01, 0.01, 0.01, 10.01],
            "attached": {"link_name": "panda_hand", "touch_links": TOUCH, **PEN}}


def scene_of(problem):
    boxes = [f"    - {{id: box{i}, primitives: [{{type: box, dimensions: {[2 * half for half in box[3:]]}}}], "
             f"primitive_poses: [{{position: {box[:3]}, orientation: [0, 0, 0, 1]}}]}}\n" for i, box in enumerate(problem["cuboid_obstacles"])]
    pen = problem.get("attached")
    attached = (f"robot_state:\n  attached_collision_objects:\n    - {{link_name: {pen['link_name']}, touch_links: {json.dumps(pen['touch_links'])}, object: "
                f"{{id: pen, primitives: [{{type: cylinder, dimensions: [{pen['length']}, {pen['radius']}]}}], primitive_poses: [{{position: {pen['middle']}}}]}}}}\n"
                if pen else "")
    return "name: mcvamp\nworld:\n  collision_objects:" + ("\n" + "".join(boxes) if boxes else " []\n") + attached


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
    limits = {"position_constraints": [{
        "link_name": options.tip, "target_point_offset": dict(zip("xyz", problem.get("tip_offset", options.offset))), "constraint_region": region}]}
    turns = [min(upper, math.pi) for upper in problem["tsr_upper_bound"][3:]]
    if options.orientation and min(turns) < math.pi:
        limits["orientation_constraints"] = [{"link_name": options.tip, "orientation": dict(zip("xyzw", (x, y, z, w))), "parameterization": 0,
                                              **{f"absolute_{axis}_axis_tolerance": turn for axis, turn in zip("xyz", turns)}}]
    return {
        "group_name": options.group,
        "start_state": {"joint_state": {"name": joints, "position": problem["problem_start"]}},
        "goal_constraints": [{"joint_constraints": goal}],
        "path_constraints": limits}


def turned(pose):
    """The rotation of w x y z ..."""
    w, x, y, z = numpy.array(pose[:4]) / numpy.linalg.norm(pose[:4])
    return numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def tip_pose(robot, checker, tip, q):
    """A link's pose in a state of the checker's group, float64 [4, 4]."""
    return robot.fk(checker.full_state(q)[:len(robot.variables)])[robot.links.index(tip)]


def projected(problem, robot, checker, options):
    """Newton steps of the ends' places to the middle of thin bounds."""
    thin = [axis for axis in range(3) if problem["tsr_upper_bound"][axis] < 1]
    axes = turned(problem["eef_transforms"]).T[thin]
    ends = {}
    for key in ("problem_start", "problem_end"):
        q = numpy.array(problem[key], dtype=float)
        for _ in range(20):
            pose = tip_pose(robot, checker, options.tip, q)
            point = pose[:3, :3] @ problem.get("tip_offset", options.offset) + pose[:3, 3]
            q = q - numpy.linalg.pinv(axes @ checker.point_jacobian(q, options.tip, point)) @ (axes @ (point - problem["eef_transforms"][4:]))
        ends[key] = q.tolist()
    return {**problem, **ends}


def plan(number, problem, robot, options, folder):
    row = {"problem": number, "obstacles": len(problem["cuboid_obstacles"]), "solved": False}
    (folder / "scene.yaml").write_text(scene_of(problem), encoding="utf-8")
    checker = leeway.Checker(robot, leeway.Scene(folder / "scene.yaml"), group=options.group)
    if options.project:
        problem = projected(problem, robot, checker, options)
    request = request_of(problem, options)
    try:
        for _ in range(options.runs):
            begin = time.perf_counter()
            found = checker.plan_request(request, seconds=options.time)
            seconds = time.perf_counter() - begin
    except leeway.InputError as error:
        return {**row, "status": str(error)}
    if not found.solved:
        return {**row, "status": found.message.splitlines()[0]}
    return {**row, "solved": True, "status": "solved", "search": found.seconds, "seconds": seconds, "length": found.length, "duration": found.times[-1]}


def percentile(rows, key):
    values = sorted(row[key] for row in rows)
    return values[min(len(values) - 1, int(0.95 * len(values)))]


def summary(rows):
    solved = [row for row in rows if row["solved"]]
    return f"{len(solved)} of {len(rows)} solved" + "".join(
        f"; {name}: median {statistics.median(row[key] for row in solved) * 1e3:.2f} ms, 95 % {percentile(solved, key) * 1e3:.1f} ms"
        for name, key in (("search", "search"), ("all", "seconds")) if solved)


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
    parser.add_argument("--cuboids", type=pathlib.Path, help="walls of McVAMP's maze")
    parser.add_argument("--orientation", action="store_true", help="keep bounds of the orientation, too")
    parser.add_argument("--limit", type=int, default=None)
    parser.add_argument("--project", action="store_true", help="lead starts and goals to the constraint first")
    parser.add_argument("--runs", type=int, default=2, help="of each problem; the last one counts")
    parser.add_argument("--csv", type=pathlib.Path, default=None)
    parser.add_argument("--package", action="append", default=[], help="name=folder, for package:// URIs")
    options = parser.parse_args()
    problems = json.loads(options.problems.read_text(encoding="utf-8"))[:options.limit]
    if options.cuboids:
        walls = json.loads(options.cuboids.read_text(encoding="utf-8"))
        problems = [in_maze(problem, walls) for problem in problems]
    robot = leeway.Robot(options.robot, options.srdf, packages=options.package)
    with tempfile.TemporaryDirectory() as folder:
        rows = [plan(number, problem, robot, options, pathlib.Path(folder)) for number, problem in enumerate(problems)]
    if options.csv:
        with options.csv.open("w", newline="", encoding="utf-8") as out:
            writer = csv.DictWriter(out, ["problem", "obstacles", "solved", "status", "search", "seconds", "length", "duration"])
            writer.writeheader()
            writer.writerows(rows)
    print(summary(rows))
    counts = sorted({row["obstacles"] for row in rows})
    for count in counts if len(counts) > 1 else []:
        print(f"  {count} obstacles: {summary([row for row in rows if row['obstacles'] == count])}")
    for status in sorted({row["status"] for row in rows if not row["solved"]}):
        print(f"  {sum(row['status'] == status for row in rows if not row['solved'])}: {status}")


if __name__ == "__main__":
    main()
