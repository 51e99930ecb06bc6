# SPDX-License-Identifier: BSD-3-Clause
"""Certified clearance and collision checks of robots, and motion planning with proved paths.

    robot = leeway.Robot( "arm.urdf", "arm.srdf" )
    scene = leeway.Scene( "scene.yaml" )
    checker = leeway.Checker( robot, scene, group="arm" )
    lower, upper, pairs, witnesses = checker.clearance( q )     # q: float64 [n, dof]
    plan = checker.plan( start, goal, seconds=1 )

Units are metres and radians. Batches run without the interpreter's lock; threads= spreads them over cores and changes no bit of an
answer. Unusable input raises leeway.Error, which is a ValueError; an error never reads as free.
"""
from ._core import (Checker, Cloud, CoreError, Error, Guard, InputError, Inverse, Margins, Outcome, Padding, Reach, Robot, Scene, Shape, TimedWorld, Verdict, World,
    check_spheres, depth, distance, pairs)
from ._core import version as __version__
from .pages import Page, view
from .results import Clearances, ConstrainedPlan, Depth, DepthKind, Direction, Distance, GoalStates, GuardAnswer, GuardSpeed, InverseFailure, InverseStates, Line, LinkSpheres, Motions, NearPairs, Plan, Sequence, Timed

__all__ = ["Checker", "Clearances", "Cloud", "ConstrainedPlan", "CoreError", "Depth", "DepthKind", "Direction", "Distance", "Error", "GoalStates", "Guard", "GuardAnswer", "GuardSpeed", "InputError", "Inverse", "InverseFailure", "InverseStates", "Line", "LinkSpheres", "Margins", "Motions", "NearPairs", "Outcome", "Padding",
    "Page", "Plan", "Reach", "Robot", "Scene", "Sequence", "Shape", "Timed", "TimedWorld", "Verdict", "World", "__version__", "check_spheres",
    "depth", "distance", "pairs", "view"]
