# SPDX-License-Identifier: BSD-3-Clause
"""Plans as logs of OMPL's benchmarks, for Planner Arena: OMPL's own script `ompl_benchmark_statistics` makes its SQLite database of them.

    leeway.fleet.arena.write_logs( "results", "logs" )        # then: ompl_benchmark_statistics logs/*.log -d plans.db
"""
from __future__ import annotations

import pathlib

import numpy

from .errors import FleetError
from .manifest import read_manifest
from .plan import Part, parts_of
from .reporting import frame_of

__all__ = ["write_logs"]

STATUSES = ["Unknown status", "Invalid start", "Invalid goal", "Unrecognized goal type", "Timeout", "Approximate solution", "Exact solution", "Crash", "Abort"]
OF_OUTCOME = {"SOLVED": 6, "NO_START": 1, "NO_GOAL": 2, "TIMED_OUT": 4, "NODES_FULL": 4, "CANCELLED": 8}


def _log(plan, part: Part, name: str, rows) -> str:
    planners = sorted(set(rows["planner"].astype(str)))
    runs = int(rows.groupby("planner", observed=True).size().max())
    lines = ["OMPL version 1.7.0", f"Experiment {name}", "0 experiment properties", "Running on leeway.fleet", "Starting at 2000-01-01 00:00:00", "<<<|",
        f"leeway {plan['leeway']}, robot {part.robot}, options {part.options}", "|>>>", "<<<|", "", "|>>>",
        f"{plan['campaign']['seed']} is the random seed", "0 seconds per run", "0 MB per run", f"{runs} runs per planner",
        f"{rows['seconds'].sum():.6f} seconds spent to collect the data", "1 enum type", "status|" + "|".join(STATUSES), f"{len(planners)} planners"]
    for planner in planners:
        mine = rows[rows["planner"] == planner]
        lines += [f"geometric_{planner}", "0 common properties", "6 properties for each run", "status ENUM", "solved BOOLEAN", "time REAL", "solution length REAL",
            "solution clearance REAL", "graph states INTEGER", f"{len(mine)} runs"]
        for row in mine.itertuples():
            numbers = ["" if numpy.isnan(x) else f"{x:.9g}" for x in (row.seconds, row.length, row.least)]
            lines.append("; ".join([str(OF_OUTCOME.get(row.outcome, 0)), str(int(row.outcome == "SOLVED")), *numbers, str(row.samples)]) + "; ")
        lines.append(".")
    return "\n".join(lines) + "\n"


def write_logs(folder, out) -> list[pathlib.Path]:
    """One log for each robot and scene with plans. Raises FleetError if the campaign has none."""
    plan, _ = read_manifest(folder)
    out, written = pathlib.Path(out), []
    for part in parts_of(plan):
        if part.kind != "plans":
            continue
        frame = frame_of(folder, part).assign(seconds=frame_of(folder, part, times=True)["seconds"])
        for scene, rows in frame.groupby("scene"):
            label, instance = part.scenes[scene]
            name = f"{part.robot}_{label or 'empty'}_{instance}"
            out.mkdir(parents=True, exist_ok=True)
            written.append(out / f"{part.index:02d}_{name}.log")
            written[-1].write_text(_log(plan, part, name, rows))
    if not written:
        raise FleetError(folder, "", "has no plans", "add work of the kind plans")
    return written
