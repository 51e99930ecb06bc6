#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Certificates of planning problems: sizes, windows, times of writing and of both checkers.

    certificates.py --leeway build/bin/leeway --checker build/bin/check_certificate [--problems N] ROBOT.urdf ROBOT.srdf FOLDER...

FOLDER has sceneNNNN.yaml and requestNNNN.yaml of MotionBenchMaker. Prints a row for each folder: medians and largest values. Exit status 1: a checker
refuses a certificate."""
import argparse
import importlib.util
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile
import time

SOURCE = pathlib.Path(__file__).resolve().parents[2] / "planners" / "certify" / "check_certificate.py"
spec = importlib.util.spec_from_file_location("check_certificate", SOURCE)
check = importlib.util.module_from_spec(spec)
spec.loader.exec_module(check)
TOLD = re.compile(r"(\d+) pairs proved in (\d+) windows, (\d+) bytes, of which (\d+) are the proof, made in (\d+) ms")


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


def seconds_of(call):
    begin = time.perf_counter()
    result = call()
    return result, time.perf_counter() - begin


def one(given, model, scene, request, folder):
    """Row of numbers, or None without a path."""
    file = folder / "c.lwc"
    file.unlink(missing_ok=True)
    run = subprocess.run([given.leeway, "plan", *model, "--scene", scene, "--request", request, "--out", folder / "path.yaml", "--certificate", file],
        capture_output=True, text=True, check=False)
    told = TOLD.search(run.stdout)
    if run.returncode != 0 or not told:
        return None
    pairs, windows, size, proof, made = map(int, told.groups())
    c, c_seconds = seconds_of(lambda: subprocess.run([given.checker, file], capture_output=True, check=False).returncode)

    def by_python():
        content = check.Reader(file.read_bytes()).content()
        counting = Counting(check.Model(content), content)
        counting.run()
        return counting.kinds

    kinds, python_seconds = seconds_of(by_python)
    if c != 0:
        raise SystemExit(f"{request}: the checker in C says {c}")
    return {"kB": size / 1000, "proof kB": proof / 1000, "pairs": pairs, "windows": windows, "directions %": 100 * kinds["directions"] / windows,
        "written ms": made, "C ms": 1000 * c_seconds, "Python s": python_seconds}


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
    head = False
    with tempfile.TemporaryDirectory() as scratch:
        for folder in given.folders:
            rows, asked = [], sorted(folder.glob("request*.yaml"))[:given.problems]
            for request in asked:
                scene = request.with_name(request.name.replace("request", "scene"))
                row = one(given, ["--robot", given.robot, "--srdf", given.srdf], scene, request, pathlib.Path(scratch))
                rows += [row] if row else []
            if rows and not head:
                head = print("| problems | certified |", " | ".join(f"{name}, median (largest)" for name in rows[0]), "|") is None
                print("|---|---|" + "---|" * len(rows[0]))
            cells = [f"{statistics.median(r[name] for r in rows):.3g} ({max(r[name] for r in rows):.3g})" for name in (rows[0] if rows else [])]
            print(f"| {folder.name} | {len(rows)} of {len(asked)} |", " | ".join(cells), "|", flush=True)


if __name__ == "__main__":
    main()
