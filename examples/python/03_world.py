#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A world that changes: a point cloud arrives, blocks the path, and the arm plans again with a tool in its hand; toppra times the path,
and the trajectory is proved as it is driven. The picture shows the clearance at all times.

    python 03_world.py [OUT.png]
"""
import pathlib
import sys

import matplotlib.pyplot as plt
import numpy

import leeway

try:
    from leeway.retime import retime
except ImportError as error:
    sys.exit(f"{error}: pip install leeway-robotics[retime]")

first = pathlib.Path(__file__).resolve().parents[1] / "first"
out = sys.argv[1] if len(sys.argv) > 1 else "world.png"

robot = leeway.Robot(first / "arm.urdf", first / "arm.srdf")
world = leeway.World(robot, leeway.Scene(first / "scene.yaml"), group="arm")
start, goal = ([robot.group_states["arm", name][joint][0] for joint in world.checker.variables] for name in ("left", "right"))

# a pen in the hand, 8 cm long, joins the robot: from here on its clearance counts
world.add("pen", leeway.Shape.capsule(0.006, 0.08))
checker = world.attach_at("pen", "hand", [0, 0, 0.12], ["left_finger", "right_finger"])
before = checker.plan(start, goal, min_d=0.003, seconds=10, seed=1)
print("with a pen:", before)

# 5,000 points of a ball beside the lamp, as a sensor sees them: each is a ball of 2 mm
rng = numpy.random.default_rng(1)
points = rng.normal(size=(5000, 3))
points *= 0.05 / numpy.linalg.norm(points, axis=1, keepdims=True)
middle = robot.fk(checker.full_state(before.path[len(before.path) // 2])[:len(robot.variables)])[robot.links.index("hand"), :3, 3]
checker = world.add("cloud", leeway.Shape.points(points, 0.002), middle + [0, 0, 0.02])
seen = checker.path(before.path, min_d=0.003)
print("with the cloud the old path is", seen)
blocked = numpy.flatnonzero(~seen.free)
for i in blocked:
    print(f"  edge {i}: {' and '.join(checker.names[seen.pairs[i]])} at t = {seen.t[i]:.3f}")

plan = checker.plan(start, goal, min_d=0.003, seconds=20, seed=1)
print("again:", plan)
if not plan.solved:
    sys.exit(plan.message)
driven = retime(checker, plan.path, velocity=1.5, acceleration=4.0, min_d=0.001)
print(driven)

# dense states of the cubic pieces, for the picture alone
h, t = numpy.diff(driven.times)[:, None], numpy.linspace(0, 1, 10, endpoint=False)[:, None, None]
p0, p1, v0, v1 = driven.positions[:-1], driven.positions[1:], driven.velocities[:-1], driven.velocities[1:]
q = (2 * t**3 - 3 * t**2 + 1) * p0 + (t**3 - 2 * t**2 + t) * h * v0 + (3 * t**2 - 2 * t**3) * p1 + (t**3 - t**2) * h * v1
times = (driven.times[:-1] + t[:, :, 0] * h[:, 0]).T.ravel()
room = checker.clearance(q.transpose(1, 0, 2).reshape(-1, checker.dof))

figure, plots = plt.subplots(2, 1, figsize=(8, 5), sharex=True, constrained_layout=True)
plots[0].plot(driven.times, driven.velocities, label=checker.variables)
plots[0].set(title=f"Trajectory of {driven.duration:.2f} s, proved between all of its points", ylabel="rad/s")
plots[0].legend(ncols=4)
plots[1].plot(times, room.upper * 1000, color="steelblue", label="measured at states")
plots[1].stairs(driven.proof.lower * 1000, driven.times, baseline=None, color="firebrick", label="proved for each piece")
plots[1].axhline(1, color="gray", linestyle=":")
plots[1].set(xlabel="seconds", ylabel="clearance, mm", ylim=(0, None))
plots[1].legend()
figure.savefig(out, dpi=64)
print(f"picture: {out}")
