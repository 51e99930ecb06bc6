#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs every robot of the zoo through leeway: info, pairs, check, spherize, plan, audit, and compares with pinocchio + coal.

    .ci/install.sh zoo && benchmarks/zoo/zoo.py --out build/zoo-report
"""
import argparse
import concurrent.futures
import fnmatch
import json
import os
import pathlib
import platform
import subprocess
import sys
import time
import traceback

import descriptions
import page
from stages import RobotRun, Settings

ROOT = pathlib.Path(__file__).resolve().parents[2]


def zoo_folder():
    return ROOT / (os.environ.get("LEEWAY_ZOO_DIR") or "build/zoo")


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--zoo", type=pathlib.Path, default=zoo_folder(),
                        help="folder that .ci/install.sh zoo filled (default: $LEEWAY_ZOO_DIR, else build/zoo)")
    parser.add_argument("--leeway", type=pathlib.Path, default=ROOT / "build" / "bin" / "leeway", help="the program")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "build" / "zoo-report", help="folder of the results")
    parser.add_argument("--only", action="append", default=[], metavar="NAME", help="name, or pattern with * ?; repeatable")
    parser.add_argument("--jobs", type=int, default=1, help="robots at once (default 1: times are then those of a quiet machine)")
    parser.add_argument("--seed", type=int, default=1, help="of states, pairs and plans (default 1)")
    parser.add_argument("--limit", type=float, default=120, metavar="S", help="seconds of one command (default 120)")
    parser.add_argument("--quick", action="store_true", help="fewer states and proofs, no spherize")
    parser.add_argument("--again", action="store_true", help="run what is there once more; else a run goes on where it ended")
    parser.add_argument("--list", action="store_true", help="print names and kinds, and end")
    parser.add_argument("--expect", action="append", default=[], metavar="COLUMN=VALUE",
                        help="exit status 1 unless every robot's row says so; VALUE may be >=N; repeatable")
    return parser.parse_args()


def settings_of(options):
    python = options.zoo / "venv" / "bin" / "python"
    settings = Settings(options.leeway.resolve(), options.out.resolve(), python if python.exists() else None, options.seed,
                        limit=options.limit)
    if options.quick:
        settings.uniform, settings.near_limits, settings.oracle_states = 60, 30, 50
        settings.pairs_budget, settings.pairs_samples, settings.plan_time, settings.spherize = 0.5, 300, 10, False
    return settings


def output_of(command):
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


def cpu():
    try:
        lines = pathlib.Path("/proc/cpuinfo").read_text().splitlines()
        return next(line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


def provenance(options, settings):
    versions = "not installed"
    if settings.oracle_python:
        ask = "import coal, pinocchio; print('pinocchio', pinocchio.__version__, 'coal', coal.__version__)"
        versions = output_of([str(settings.oracle_python), "-c", ask])
    commit = output_of(["git", "rev-parse", "--short", "HEAD"])
    changed = "" if not output_of(["git", "status", "--porcelain", "--untracked-files=no"]) else ", with changes"
    return {"commit": commit + changed, "leeway": output_of([str(settings.leeway), "--version"]), "cpu": cpu(), "cores": os.cpu_count(),
            "jobs": options.jobs, "load": round(os.getloadavg()[0], 1), "python": platform.python_version(), "oracle": versions,
            "seed": options.seed, "quick": options.quick, "date": time.strftime("%Y-%m-%d"),
            "wheels": sorted(path.read_text().split()[0] for path in options.zoo.glob("*/.wheel")),
            "settings": {name: getattr(settings, name) for name in ("uniform", "near_limits", "oracle_states", "pairs_budget",
                                                                    "pairs_samples", "plan_time", "excess", "limit")}}


def run_robot(robot, settings):
    """The row of one robot; a fault of these scripts is a row, too."""
    begin = time.monotonic()
    run = RobotRun(robot, settings)
    try:
        run.all()
    except Exception:
        run.row["fault"] = traceback.format_exc(limit=-3)
    run.row["seconds"] = round(time.monotonic() - begin, 1)
    (run.folder / "row.json").write_text(json.dumps(run.row))
    return run.row


def chosen(robots, patterns):
    if not patterns:
        return robots
    picked = [r for r in robots if any(fnmatch.fnmatch(r.name, p) or r.name == p for p in patterns)]
    for pattern in patterns:
        if not any(fnmatch.fnmatch(r.name, pattern) for r in picked):
            near = [r.name for r in robots if pattern.lower() in r.name.lower()]
            sys.exit(f"zoo.py: --only {pattern}: no such robot; " + (f"there is {', '.join(near)}" if near else "--list names them"))
    return picked


def report_line(row):
    parts = [f"{row['name']}: info {row.get('info')}"]
    for stage in ("pairs", "check", "spherize", "plan", "plan_audit", "plan_own", "plan_own_audit", "oracle"):
        if stage in row and stage not in ("check",):
            parts.append(f"{stage} {row[stage]}")
    if row.get("free") is not None:
        parts.append(f"free {row['free_own']}/{row['free']} of {row['states']}")
    return ", ".join(parts) + f"; {row['seconds']} s"


def broken_expectations(rows, expectations):
    """Rows that differ from the expected ones. `--expect plan=found`, `--expect free>=2`."""
    wrong = []
    for expectation in expectations:
        column, least, value = expectation.partition(">=")
        if not least:
            column, _, value = expectation.partition("=")
        for row in rows:
            seen = row.get(column)
            good = seen is not None and seen >= float(value) if least else str(seen) == value
            if not good:
                wrong.append(f"{row['name']}: {column} is {seen}, expected {expectation}\n{json.dumps(row, indent=1)}")
    return wrong


def crashes(rows):
    return [f"{row['name']}: {key}: {value}" for row in rows for key, value in row.items()
            if isinstance(value, str) and (value.startswith("crash") or key == "fault")]


def main():
    options = arguments()
    robots = descriptions.find(options.zoo)
    if not robots:
        sys.exit(f"zoo.py: {options.zoo}: no robot description; run .ci/install.sh zoo, or name its folder with --zoo")
    robots = chosen(robots, options.only)
    if options.list:
        print("\n".join(f"{robot.name}: {robot.kind}" + (f", {robot.srdfs[0].name}" if robot.srdfs else "") for robot in robots))
        return 0
    if not options.leeway.exists():
        sys.exit(f"zoo.py: {options.leeway}: no such program; build the target leeway, or name it with --leeway")
    settings = settings_of(options)
    settings.out.mkdir(parents=True, exist_ok=True)
    rows = {}
    if not options.again:
        for path in settings.out.glob("files/*/row.json"):
            row = json.loads(path.read_text())
            rows[row["name"]] = row
    waiting = [robot for robot in robots if robot.name not in rows]
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        running = [pool.submit(run_robot, robot, settings) for robot in waiting]
        for done, future in enumerate(concurrent.futures.as_completed(running), 1):
            row = future.result()
            rows[row["name"]] = row
            print(f"{done} of {len(waiting)}  {report_line(row)}", file=sys.stderr, flush=True)
    table = [rows[robot.name] for robot in robots]
    result = {"provenance": provenance(options, settings), "summary": page.summary(table), "rows": table}
    (settings.out / "zoo.json").write_text(json.dumps(result, indent=1))
    page.write_csv(settings.out / "zoo.csv", table, options.zoo)
    page.write_html(settings.out / "zoo.html", result)
    print(page.summary_text(result["summary"]))
    wrong = broken_expectations(table, options.expect) + crashes(table)
    print("\n".join(wrong), file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
