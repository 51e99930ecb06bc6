#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""How many planned paths collide when a controller drives them?

Each path of `leeway plan` is parametrised as MoveIt's default pipeline does it: corners become arcs that stay within 0.1 rad of
them, velocities and accelerations keep their limits (Kunz, Stilman, Time-Optimal Trajectory Generation for Path Following with
Bounded Acceleration and Velocity, RSS 2012), and the result is sampled every 0.1 s. It is accepted if these points are free.
`leeway audit --trajectory` then judges the motion that ROS 2's joint_trajectory_controller makes of the points, at all times, and
`leeway audit --path --corner-blend 0.1` the path with all roundings of that depth, before any of that.

    benchmarks/driven/driven.py [--leeway build/bin/leeway] [--data ../shared/data] [--problems N] [--interpolation auto] [--csv FILE]

The limits are the velocities of the URDF and --acceleration (MoveIt takes 1 rad/s^2 where no joint_limits.yaml gives any).
Needs Python 3 and PyYAML.
"""
import argparse
import csv
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

import yaml

HERE = pathlib.Path(__file__).resolve().parent
ROBOTS = {"panda": "panda_arm", "fetch": "arm_with_torso"}
DEVIATION, INTERVAL, STEP = 0.1, 0.1, 2e-3  # radians, seconds, radians along the path


def subtract(a, b):
    return [x - y for x, y in zip(a, b)]


def norm(a):
    return math.sqrt(sum(x * x for x in a))


def along(a, direction, length):
    return [x + length * d for x, d in zip(a, direction)]


class Line:
    def __init__(self, a, b):
        self.a, self.length = a, norm(subtract(b, a))
        self.direction = [x / self.length for x in subtract(b, a)] if self.length > 0 else [0.0] * len(a)

    def at(self, s):
        return along(self.a, self.direction, s), self.direction, [0.0] * len(self.a)


class Arc:
    """From the line that ends in `corner` with direction y1 to the one that leaves it with y2, `cut` before and behind it."""

    def __init__(self, corner, y1, y2, cut, angle):
        self.radius = cut / math.tan(angle / 2)
        bisector = subtract(y2, y1)
        middle = [x / norm(bisector) for x in bisector]
        self.center = along(corner, middle, self.radius / math.cos(angle / 2))
        start = along(corner, y1, -cut)
        self.x = [v / self.radius for v in subtract(start, self.center)]
        self.y, self.length = y1, angle * self.radius

    def at(self, s):
        c, d = math.cos(s / self.radius), math.sin(s / self.radius)
        position = [m + self.radius * (c * x + d * y) for m, x, y in zip(self.center, self.x, self.y)]
        tangent = [-d * x + c * y for x, y in zip(self.x, self.y)]
        return position, tangent, [-(c * x + d * y) / self.radius for x, y in zip(self.x, self.y)]


def blended(points):
    """Lines and arcs. Arcs take at most half of a line, and leave their corner by at most DEVIATION."""
    points = [p for i, p in enumerate(points) if i == 0 or norm(subtract(p, points[i - 1])) > 1e-9]
    pieces, begin = [], points[0]
    for a, corner, b in zip(points, points[1:], points[2:]):
        before, behind = Line(a, corner), Line(corner, b)
        cosine = max(-1.0, min(1.0, sum(x * y for x, y in zip(before.direction, behind.direction))))
        angle = math.acos(cosine)
        if angle < 1e-6 or angle > math.pi - 1e-6:
            continue
        cut = DEVIATION * math.sin(angle / 2) / (1 - math.cos(angle / 2))
        cut = min(cut, before.length / 2, behind.length / 2)
        pieces.append(Line(begin, along(corner, before.direction, -cut)))
        pieces.append(Arc(corner, before.direction, behind.direction, cut, angle))
        begin = along(corner, behind.direction, cut)
    return [piece for piece in pieces + [Line(begin, points[-1])] if piece.length > 1e-9]


def parametrised(points, velocities, acceleration):
    """[(position, velocity, acceleration)] every INTERVAL seconds, as fast as the limits allow."""
    rows = []
    for piece in blended(points):
        count = max(1, math.ceil(piece.length / STEP))
        rows += [(piece.length / count, piece.at(piece.length * k / count)) for k in range(count)]
    rows.append((0.0, piece.at(piece.length)))
    speed = []  # squared, along the path
    for _, (_, first, second) in rows:
        most = min((v / abs(d)) ** 2 for v, d in zip(velocities, first) if abs(d) > 1e-12)
        bends = [acceleration / abs(c) for c in second if abs(c) > 1e-12]
        speed.append(min([most] + [0.5 * x for x in bends]))  # half of the acceleration is left for the tangent
    speed[0] = speed[-1] = 0.0

    def room(i):  # acceleration along the path that is left
        _, (_, first, second) = rows[i]
        return min((acceleration - abs(c) * speed[i]) / abs(d) for d, c in zip(first, second) if abs(d) > 1e-12)

    for i in range(len(rows) - 1):
        speed[i + 1] = min(speed[i + 1], speed[i] + 2 * rows[i][0] * room(i))
    for i in range(len(rows) - 1, 0, -1):
        speed[i - 1] = min(speed[i - 1], speed[i] + 2 * rows[i - 1][0] * room(i))
    times = [0.0]
    for i in range(len(rows) - 1):
        times.append(times[-1] + 2 * rows[i][0] / max(1e-9, math.sqrt(speed[i]) + math.sqrt(speed[i + 1])))
    out, i = [], 0
    count = max(1, math.ceil(times[-1] / INTERVAL))
    for k in range(count + 1):
        t = min(k * INTERVAL, times[-1])
        while i + 2 < len(rows) and times[i + 1] <= t:
            i += 1
        width = times[i + 1] - times[i]
        u, pull = t - times[i], (math.sqrt(speed[i + 1]) - math.sqrt(speed[i])) / width
        s = math.sqrt(speed[i]) * u + 0.5 * pull * u * u
        rate = math.sqrt(speed[i]) + pull * u
        _, (p, d, c) = rows[i]
        q = rows[-1][1][0] if k == count else [a + b * s + 0.5 * e * s * s for a, b, e in zip(p, d, c)]
        out.append((t, q, [b * rate for b in d], [b * pull + e * rate * rate for b, e in zip(d, c)]))
    return out


class Problem:
    def __init__(self, options, robot, scene, request, folder):
        self.leeway, self.folder, self.interpolation = options.leeway, folder, options.interpolation
        data = options.data
        model = data / "mbm" / robot
        self.model = ["--robot", model / f"{robot}.urdf", "--srdf", model / f"{robot}.srdf", "--scene", scene]
        self.group, self.request = ROBOTS[robot], request
        joints = xml.etree.ElementTree.parse(model / f"{robot}.urdf").getroot().findall("joint")
        self.velocity = {j.get("name"): float(j.find("limit").get("velocity")) for j in joints if j.find("limit") is not None}

    def run(self, *arguments):
        done = subprocess.run([str(x) for x in (self.leeway, *arguments)], capture_output=True, text=True)
        if done.returncode == 2:
            raise RuntimeError(done.stderr.strip().splitlines()[-1])
        return done.returncode

    def judge(self, acceleration):
        """unsolved (or an end is in contact), refused (a point is in contact), free, undecided or blocked; and the report on roundings."""
        path_file, table, goal, report = (self.folder / n for n in ("path.yaml", "points.csv", "goal.json", "report.json"))
        try:
            if self.run("plan", *self.model, "--request", self.request, "--time", 5, "--out", path_file) != 0:
                return "unsolved", None
        except RuntimeError as error:
            if "in contact" in str(error):  # an end of the request
                return "unsolved", None
            raise
        group = ["--group", self.group, "--report", report]
        self.run("audit", *self.model, *group, "--path", path_file, "--corner-blend", DEVIATION)
        rounded = json.loads(report.read_text())["roundings"]
        path = yaml.safe_load(path_file.read_text())
        names = path["joint_names"]
        trajectory = parametrised([p["positions"] for p in path["points"]], [self.velocity[n] for n in names], acceleration)
        with open(table, "w", newline="") as out:
            csv.writer(out).writerows([names] + [q for _, q, _, _ in trajectory])
        common = [*self.model, "--group", self.group]
        if self.run("check", *common, "--request", self.request, "--states", table, "--out", self.folder / "states.csv") != 0:
            return "refused", rounded
        points = [
            dict(positions=q, velocities=v, accelerations=a, time_from_start=t) for t, q, v, a in trajectory
        ]
        start = path["start_state"]
        goal.write_text(json.dumps(dict(start_state=start, joint_trajectory=dict(joint_names=names, points=points))))
        self.run("audit", *common, "--trajectory", goal, "--report", report, "--interpolation", self.interpolation)
        return json.loads(report.read_text())["audit"]["verdict"].lower(), rounded


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--leeway", type=pathlib.Path, default=HERE.parent.parent / "build/bin/leeway")
    parser.add_argument("--data", type=pathlib.Path, default=HERE.parent.parent.parent / "shared/data")
    parser.add_argument("--problems", type=int, default=15, help="of each of the seven sets of each robot (default 15)")
    parser.add_argument("--acceleration", type=float, default=1.0, help="rad/s^2, of every joint (default 1)")
    parser.add_argument("--interpolation", default="auto", help="auto (quintic), linear, cubic or quintic between the points")
    parser.add_argument("--csv", type=pathlib.Path, help="a row for each problem")
    options = parser.parse_args()
    if not (options.data / "mbm").is_dir():
        print(f"there is no folder mbm in {options.data}; name it by --data", file=sys.stderr)
        return 77
    rows, seconds = [], []
    with tempfile.TemporaryDirectory() as folder:
        for robot in ROBOTS:
            for problems in sorted((options.data / "mbm" / robot / "problems").iterdir()):
                for request in sorted(problems.glob("request*.yaml"))[: options.problems]:
                    scene = request.with_name(request.name.replace("request", "scene"))
                    problem = Problem(options, robot, scene, request, pathlib.Path(folder))
                    verdict, rounded = problem.judge(options.acceleration)
                    rows.append((robot, problems.name, request.stem, verdict, rounded["verdict"].lower() if rounded else ""))
                    seconds += [rounded["seconds"]] if rounded and rounded["verdict"] == "FREE" else []
    for robot in ROBOTS:
        verdicts = [row[3] for row in rows if row[0] == robot]
        accepted = sum(v in ("free", "undecided", "blocked") for v in verdicts)
        print(
            f"{robot}: {len(verdicts)} problems, {verdicts.count('unsolved')} unsolved; of {len(verdicts) - verdicts.count('unsolved')} "
            f"paths {verdicts.count('refused')} have a point in contact, {accepted} are accepted; of these {verdicts.count('blocked')} "
            f"collide as driven, {verdicts.count('undecided')} are undecided, {verdicts.count('free')} are proved free"
        )
    rounded = [row[4] for row in rows]
    wrong = sum(row[4] == "free" and row[3] == "refused" for row in rows)
    print(
        f"roundings by {DEVIATION}: {rounded.count('free')} paths are free with all of them, {rounded.count('blocked')} collide with one, "
        f"{rounded.count('undecided')} are undecided; a free one takes {1e3 * sum(seconds) / max(1, len(seconds)):.2f} ms; "
        f"{wrong} of the free ones have a rounded point in contact"
    )
    if options.csv:
        with open(options.csv, "w", newline="") as out:
            csv.writer(out).writerows([("robot", "set", "problem", "verdict", "roundings"), *rows])
    return 0


if __name__ == "__main__":
    sys.exit(main())
