#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Certificates of planning problems: sizes, windows, times of writing and of both checkers.

    PYTHONPATH=build/python certificates.py --leeway build/bin/leeway --checker build/bin/check_certificate [--problems N] ROBOT.urdf ROBOT.srdf FOLDER...

FOLDER has sceneNNNN.yaml and requestNNNN.yaml of MotionBenchMaker. Prints a row for each folder: medians, and the largest values. `search`: of `leeway plan`,
with its simplification, the best of five. `first`: the first certificate of a checker, which makes the model; `next`: the median of nine others of the
same path; both are processor's time. `program`: how much longer `leeway plan` takes with --certificate, the best of five runs each. The proof has spheres and directions (planes); no tables. Exit status 1: a checker refuses a certificate."""
import argparse
import importlib.util
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import yaml

import leeway

SOURCE = pathlib.Path(__file__).resolve().parents[2] / "planners" / "certify" / "check_certificate.py"
spec = importlib.util.spec_from_file_location("check_certificate", SOURCE)
check = importlib.util.module_from_spec(spec)
spec.loader.exec_module(check)


class Counting(check.Proof):
    """Counts the tests by their kind."""

    def __init__(self, model, content):
        super().__init__(model, content)
        self.kinds = {"spheres": 0, "directions": 0}

    def spheres(self, a, b, window):
        self.kinds["spheres"] += 1
        super().spheres(a, b, window)

    def plane(self, a, b, window, n):
        self.kinds["directions"] += 1
        super().plane(a, b, window, n)


def seconds_of(call, clock=time.perf_counter):
    begin = clock()
    result = call()
    return result, clock() - begin


def one(given, robot, request, folder):
    """Row of numbers, or None without a path."""
    file, path, report = folder / "c.lwc", folder / "path.yaml", folder / "report.json"
    scene = request.with_name(request.name.replace("request", "scene"))
    path.unlink(missing_ok=True)
    plan = [given.leeway, "plan", "--robot", given.robot, "--srdf", given.srdf, "--scene", scene, "--request", request, "--out", path, "--report", report]
    search, program = [], {True: [], False: []}
    for _ in range(5):
        for with_certificate in (False, True):
            more = ["--certificate", file] if with_certificate else []
            program[with_certificate].append(seconds_of(lambda: subprocess.run(plan + more, capture_output=True, check=False))[1])
        if not path.exists():
            return None
        took = json.loads(report.read_text())["seconds"]
        search.append(sum(took[name] for name in ("plan", "certify", "simplify")))
    asked = yaml.safe_load(request.read_text())
    planned = yaml.safe_load(path.read_text())
    start = planned["start_state"]["joint_state"]
    checker = leeway.Checker(robot, leeway.Scene(scene), group=asked["group_name"], reference=dict(zip(start["name"], start["position"])))
    order = [planned["joint_names"].index(name) for name in checker.variables]
    points = [[point["positions"][i] for i in order] for point in planned["points"]]
    try:
        data, first = seconds_of(lambda: checker.certificate(points), time.thread_time)
    except leeway.InputError:
        return None
    following = statistics.median(seconds_of(lambda: checker.certificate(points), time.thread_time)[1] for _ in range(9))
    file.write_bytes(data)
    c, c_seconds = seconds_of(lambda: subprocess.run([given.checker, file], capture_output=True, check=False).returncode)

    def by_python():
        content = check.Reader(data).content()
        counting = Counting(check.Model(content), content)
        counting.run()
        return counting.kinds, len(content["proof"]) // 2

    (kinds, proof), python_seconds = seconds_of(by_python)
    if c != 0:
        raise SystemExit(f"{request}: the checker in C says {c}")
    windows = sum(kinds.values())
    return {"kB": len(data) / 1000, "proof kB": proof / 1000, "windows": windows, "spheres %": 100 * kinds["spheres"] / windows,
        "directions %": 100 * kinds["directions"] / windows, "search ms": 1000 * min(search),
        "first ms": 1000 * first, "next ms": 1000 * following, "program %": 100 * (min(program[True]) / min(program[False]) - 1), "C ms": 1000 * c_seconds, "Python s": python_seconds}


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--leeway", required=True)
    options.add_argument("--checker", required=True)
    options.add_argument("--problems", type=int, default=10)
    options.add_argument("robot")
    options.add_argument("srdf")
    options.add_argument("folders", nargs="+", type=pathlib.Path)
    given = options.parse_args()
    sys.setrecursionlimit(10000)
    head, robot = False, leeway.Robot(given.robot, srdf=given.srdf)
    with tempfile.TemporaryDirectory() as scratch:
        for folder in given.folders:
            rows, asked = [], sorted(folder.glob("request*.yaml"))[:given.problems]
            for request in asked:
                row = one(given, robot, request, pathlib.Path(scratch))
                rows += [row] if row else []
            if rows and not head:
                head = print("| problems | certified |", " | ".join(rows[0]), "|") is None
                print("|---|---|" + "---|" * len(rows[0]))
            cells = [f"{statistics.median(r[name] for r in rows):.3g} ({max(r[name] for r in rows):.3g})" for name in (rows[0] if rows else [])]
            print(f"| {folder.name} | {len(rows)} of {len(asked)} |", " | ".join(cells), "|", flush=True)


if __name__ == "__main__":
    main()
