#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Certificates of random motions of many robots, checked by both checkers.

    honest.py --leeway build/bin/leeway --checker build/bin/check_certificate [--motions N] [--limit S] ROBOT.urdf[,ROBOT.srdf,GROUP] ...

For each robot paths between random states, and their trajectories with a tolerance. An SRDF of `leeway pairs` is made where none is given. Exit status 1:
a certificate is refused, or the checkers say different things. Motions that are not proved have no certificate: their reasons are counted."""
import argparse
import collections
import pathlib
import subprocess
import sys
import tempfile
import time

CHECK = pathlib.Path(__file__).resolve().parents[2] / "planners" / "certify" / "check_certificate.py"


def said(command, limit=120):
    try:
        run = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False, timeout=limit)
        return run.returncode, run.stdout.strip(), run.stderr.strip()
    except subprocess.TimeoutExpired:
        return -1, "", "takes too long"


def model_of(given, robot, folder):
    urdf, srdf, group = (robot.split(",") + ["", ""])[:3]
    folders = [one for one in list(pathlib.Path(urdf).resolve().parents)[1:4] if one != one.parent]
    model = ["--robot", urdf, "--missing-meshes", "skip", *(word for one in folders for word in ("--package-path", one))]
    if not srdf:
        srdf = folder / "made.srdf"
        srdf.unlink(missing_ok=True)
        said([given.leeway, "pairs", *model, "--budget", "2", "--samples", "300", "--out", srdf])
        if not srdf.exists():
            return None
    return [*model, "--srdf", srdf, "--no-cache", *(["--group", group] if group else [])]


def certificates(given, model, seed, folder):
    """Files, and why there are fewer than two."""
    files = [folder / "path.lwc", folder / "trajectory.lwc"]
    for file in [*files, folder / "t.json"]:
        file.unlink(missing_ok=True)
    plan = said([given.leeway, "plan", *model, "--start", "random", "--goal", "random", "--seed", seed, "--time", "3", "--out", folder / "p.yaml",
        "--trajectory", folder / "t.json", "--certificate", files[0]])
    if not (folder / "t.json").exists():
        return [file for file in files if file.exists()], plan[2].splitlines()[-1:] or plan[1].splitlines()[-1:]
    audit = said([given.leeway, "audit", *model, "--trajectory", folder / "t.json", "--tolerance", "0.0005", "--certificate", files[1]])
    return [file for file in files if file.exists()], audit[2].splitlines()[-1:]


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--leeway", required=True)
    options.add_argument("--checker", required=True)
    options.add_argument("--motions", type=int, default=10)
    options.add_argument("--limit", type=float, default=3600, help="seconds for all")
    options.add_argument("robots", nargs="+")
    given = options.parse_args()
    total, wrong, used, begin = 0, 0, 0, time.monotonic()
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        for robot in given.robots:
            if time.monotonic() - begin > given.limit:
                break
            model, accepted, reasons, seconds = model_of(given, robot, folder), 0, collections.Counter(), [0.0, 0.0]
            for seed in range(1, given.motions + 1 if model else 0):
                if time.monotonic() - begin > given.limit:
                    break
                files, why = certificates(given, model, seed, folder)
                reasons.update(line.split(": ")[-1][:60] for line in why if len(files) < 2)
                for file in files:
                    at = time.monotonic()
                    c = said([given.checker, file])
                    seconds[0] += time.monotonic() - at
                    at = time.monotonic()
                    python = said([sys.executable, CHECK, file])
                    seconds[1] += time.monotonic() - at
                    accepted += c[0] == 0 and python[0] == 0 and c[1] == python[1]
                    if c[0] != 0 or c[1] != python[1]:
                        wrong += 1
                        print(f"WRONG {robot} seed {seed} {file.name}: C {c}, Python {python}", flush=True)
            total, used = total + accepted, used + (accepted > 0)
            print(f"{pathlib.Path(robot.partition(',')[0]).name}: {accepted} accepted by both, C {seconds[0]:.2f} s, Python {seconds[1]:.1f} s in all; {dict(reasons.most_common(2))}", flush=True)
    print(f"{total} certificates of {used} robots accepted by both, {wrong} wrong")
    return int(wrong > 0 or total == 0)


if __name__ == "__main__":
    sys.exit(main())
