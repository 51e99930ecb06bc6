# SPDX-License-Identifier: BSD-3-Clause
"""Planners by name: leeway's own, and those of OMPL's Python package (`pip install ompl`) with states and motions that leeway checks.

Equal seeds give equal paths. OMPL draws the seeds of all random numbers from one generator of the process, so one plan at a time is made
there; no clock ends it. Left out: PRM, PRMstar and SORRTstar, which did not end by this condition, and AORRTC, whose paths in OMPL 2.0.1 have
no length and do not lead to the goal.
"""
from __future__ import annotations

import importlib.metadata
import threading
from typing import Any, NamedTuple

import numpy

from .._core import Checker, Outcome
from .campaign import REQUIRED, Option
from .errors import FleetError

__all__ = ["PLANNER", "Planned", "check_planners", "length_of", "plan_by", "plan_by_ompl"]

OMPL = ("RRTConnect", "RRT", "RRTstar", "InformedRRTstar", "BITstar", "FMT", "BFMT", "LBKPIECE1", "BKPIECE1", "KPIECE1")
ASK_FOR_LAST_VALID = ("KPIECE1",)  # of a motion, which a validator written in Python cannot tell OMPL
WITHOUT_RANGE = ("BITstar", "FMT", "BFMT")
PLANNER = {"name": Option(str, REQUIRED), "algorithm": Option(str, "leeway", None, ("leeway", *OMPL)), "range": Option(float, 0.0, 0),
    "smooth": Option(bool, True), "optimize_samples": Option(int, 0, 0), "motions": Option(str, "proved", None, ("proved", "sampled")),
    "resolution": Option(float, 0.01, 1e-6)}
NEAR = 1e-9  # of the ends, radians or metres
_ONE_AT_A_TIME = threading.Lock()


class Planned(NamedTuple):
    outcome: str  #: of leeway.Outcome
    path: numpy.ndarray | None
    raw_length: float  #: before it was smoothed
    samples: int  #: leeway: drawn; OMPL: iterations
    edge_checks: int  #: proofs asked for
    state_checks: int  #: asked for by OMPL


def length_of(checker: Checker, path: numpy.ndarray) -> float:
    """Euclidean; endless joints go the shorter way."""
    step = numpy.diff(path, axis=0)
    step = numpy.where(checker.wraps, numpy.remainder(step + numpy.pi, 2 * numpy.pi) - numpy.pi, step)
    return float(numpy.sqrt(numpy.square(step).sum(axis=1)).sum())


def _version() -> str | None:
    try:
        return importlib.metadata.version("ompl")
    except importlib.metadata.PackageNotFoundError:
        return None


def check_planners(file, element: str, planners: list[dict[str, Any]]) -> dict[str, str]:
    """Versions of packages that the planners need. Raises FleetError for options that do not go together."""
    if not planners:
        raise FleetError(file, element, "is empty", "give { name = \"leeway\" }")
    names = [planner["name"] for planner in planners]
    needed: dict[str, str] = {}
    for i, planner in enumerate(planners):
        place, algorithm = f"{element}[{i}]", planner["algorithm"]
        if names.count(planner["name"]) > 1:
            raise FleetError(file, f"{place}.name", f"{planner['name']!r} is there twice", "give each planner a name of its own")
        if algorithm == "leeway":
            if planner["motions"] != "proved":
                raise FleetError(file, f"{place}.motions", "is 'sampled', and leeway's planner proves its motions", "give an algorithm of OMPL")
            continue
        if planner["optimize_samples"]:
            raise FleetError(file, f"{place}.optimize_samples", f"is no option of {algorithm}", "leave it out; RRTstar and BITstar optimize")
        if planner["range"] and algorithm in WITHOUT_RANGE:
            raise FleetError(file, f"{place}.range", f"is no option of {algorithm}", "leave it out")
        if planner["motions"] == "proved" and algorithm in ASK_FOR_LAST_VALID:
            raise FleetError(file, f"{place}.motions", f"cannot be 'proved' with {algorithm}, which asks for the last valid state of a motion",
                "give motions = \"sampled\", or RRTConnect")
        version = _version()
        if version is None:
            raise FleetError(file, f"{place}.algorithm", f"{algorithm} is OMPL's, and its Python package is not there", "pip install ompl")
        needed["ompl"] = version
    return needed


def plan_by(planner: dict[str, Any], versions: dict[str, str], checker: Checker, start, goal, seed: int, o: dict[str, Any]) -> Planned:
    """A plan by an entry of the campaign's planners. o: min_d, slack, check, most_nodes."""
    if planner["algorithm"] != "leeway":
        if _version() != versions["ompl"]:
            raise FleetError("ompl", "", f"is {_version()} here, and {versions['ompl']} where the campaign was started", f"pip install ompl=={versions['ompl']}")
        return plan_by_ompl(checker, start, goal, seed, algorithm=planner["algorithm"], proved=planner["motions"] == "proved",
            resolution=planner["resolution"], range_=planner["range"], smooth=planner["smooth"], min_d=o["min_d"], slack=o["slack"], check=o["check"],
            iterations=o["most_nodes"])
    found = checker.plan(start, goal, min_d=o["min_d"], slack=o["slack"], check=o["check"], seed=seed, most_nodes=o["most_nodes"],
        range=planner["range"], smooth=planner["smooth"], optimize_seconds=1e9 if planner["optimize_samples"] else 0.0,
        optimize_samples=max(1, planner["optimize_samples"]))
    return Planned(Outcome(found.outcome).name, found.path, found.raw_length if found.path is not None else numpy.nan, found.statistics["samples"],
        found.statistics["edges"], 0)


def plan_by_ompl(checker: Checker, start, goal, seed: int, *, algorithm: str = "RRTConnect", proved: bool = False, resolution: float = 0.01,
        range_: float = 0.0, smooth: bool = True, min_d: float = 0.0, slack: float = 1e-3, check: str = "both", iterations: int | None = None,
        seconds: float | None = None) -> Planned:
    """A plan by OMPL. proved: edges are proved by leeway; else states along them, `resolution` (share of the space) apart. Looks at its
    condition of termination are its iterations; one of iterations and seconds bounds the search."""
    from ompl import base, geometric, util

    from .. import ompl as bridge
    with _ONE_AT_A_TIME:
        util.setLogLevel(util.LOG_NONE)
        util.RNG.setSeed(seed)
        setup = geometric.SimpleSetup(bridge.state_space(checker))
        information = setup.getSpaceInformation()
        states, motions = bridge.StateValidityChecker(information, checker, min_d, check), bridge.MotionValidator(information, checker, min_d, slack, check)
        information.setStateValidityChecker(states)
        information.setStateValidityCheckingResolution(resolution)
        if proved:
            information.setMotionValidator(motions)
        ends = [information.getStateSpace().allocState() for _ in range(2)]
        for state, q in zip(ends, (start, goal)):
            bridge.from_array(checker, q, state)
        setup.setStartAndGoalStates(*ends)
        planner = getattr(geometric, algorithm)(information)
        if range_:
            planner.setRange(range_)
        setup.setPlanner(planner)
        looks = [0]

        def enough() -> bool:
            looks[0] += 1
            return looks[0] > iterations

        setup.solve(seconds if iterations is None else base.PlannerTerminationCondition(enough))
        path, raw = None, numpy.nan
        if setup.haveExactSolutionPath():
            path = _states_of(bridge, checker, setup.getSolutionPath())
            raw = length_of(checker, path)
            if smooth:
                setup.simplifySolution(0.0)  # 0: no clock
                path = _states_of(bridge, checker, setup.getSolutionPath())
            if length_of(checker, numpy.array([start, path[0]])) > NEAR or length_of(checker, numpy.array([path[-1], goal])) > NEAR:
                path, raw = None, numpy.nan
        ended = Outcome.SOLVED if path is not None else Outcome.NODES_FULL if iterations and looks[0] > iterations else Outcome.UNKNOWN
        return Planned(ended.name, path, raw, looks[0], motions.count, states.count)


def _states_of(bridge, checker: Checker, path) -> numpy.ndarray:
    return numpy.array([bridge.to_array(checker, path.getState(i)) for i in range(path.getStateCount())])
