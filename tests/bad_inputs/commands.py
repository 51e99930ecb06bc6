# SPDX-License-Identifier: BSD-3-Clause
"""Every command of the program over good files, for the guard: what it writes, and where."""
from cases import EDGES, MODEL, PAIRS, SPHERIZE, STATES, WORLD, Case
from readers import JOINT_LIMITS, STEPS, TIMED_TABLE, TRAJECTORY

MOTION = {"motion.csv": TIMED_TABLE, "motion.yaml": TRAJECTORY, "limits.yaml": JOINT_LIMITS, "steps.yaml": STEPS}
TIME = "--budget 0 --samples 50"


def command_cases():
    commands = {
        "help": "--help-all",
        "version": "--version",
        "info": f"info {WORLD} --json info.json",
        "check": f"check {WORLD} --states states.csv --out out.csv",
        "check to standard output": f"check {WORLD} --states states.csv",
        "check without cache": f"check {WORLD} --states states.csv --no-cache --out out.csv",
        "check with a cache of its own": f"check {WORLD} --states states.csv --cache cache --out out.csv",
        "check of a table by standard input": f"check {WORLD} --states - --out out.csv <states.csv",
        "edge": f"edge {WORLD} --edges edges.csv --out out.csv",
        "plan": f"plan {WORLD} --request request.yaml --out out.yaml --report report.json --trajectory timed.yaml --joint-limits limits.yaml",
        "plan by another planner": f"plan {WORLD} --request request.yaml --planner RRTConnect --out out.yaml",
        "audit of a path": f"audit {WORLD} --path path.yaml --report report.json --profile profile.csv",
        "audit of a trajectory": f"audit {WORLD} --trajectory motion.yaml --report report.json --profile profile.csv",
        "audit of steps": f"audit {WORLD} --steps steps.yaml --report report.json",
        "pairs": f"{PAIRS} --json pairs.json",
        "spherize": SPHERIZE,
        "tune": f"tune {WORLD} --states 20 --edges 5 --rate 1 --csv tune.csv --json tune.json",
        "cache": "cache --cache cache --json cache.json",
        "default cache": "cache --json cache.json",
        "view": f"view {WORLD} --states states.csv --out page.html",
        "check, view": f"info {MODEL} --visual --json info.json",
    }
    return [Case(f"command: {name}", command, MOTION, (0, 1) if "cache" != name else (2,)) for name, command in commands.items()]


__all__ = ["command_cases", "EDGES", "STATES"]
