#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A path for a small arm with 5 mm of room to everything, each edge proved. The picture shows the way of the hand, and the clearance along
the path above its proved bound.

    python 02_plan.py [OUT.png]
"""
import pathlib
import sys

import matplotlib.pyplot as plt
import numpy

import leeway

first = pathlib.Path(__file__).resolve().parents[1] / "first"
out = sys.argv[1] if len(sys.argv) > 1 else "plan.png"
min_d = 0.005  # metres

robot = leeway.Robot(first / "arm.urdf", first / "arm.srdf")
scene = leeway.Scene(first / "scene.yaml")
checker = leeway.Checker(robot, scene, group="arm")
start, goal = ([robot.group_states["arm", name][joint][0] for joint in checker.variables] for name in ("left", "right"))

plan = checker.plan(start, goal, min_d=min_d, seconds=10, seed=1)
print(plan)
if not plan.solved:
    sys.exit(plan.message)
proof = checker.path(plan.path, min_d=min_d)
assert proof.all_free
print(f"every state of every edge keeps more than {proof.lower.min() * 1000:.2f} mm")

# dense states along the path, for the picture alone: the proof needs none
full = [robot.interpolate(checker.full_state(a), checker.full_state(b), numpy.linspace(0, 1, 100)) for a, b in zip(plan.path, plan.path[1:])]
q = numpy.concatenate(full)
measured = checker.clearance(q[:, [robot.variables.index(name) for name in checker.variables]]).upper
hand = robot.fk(q)[:, robot.links.index("hand"), :3, 3]

figure = plt.figure(figsize=(9, 4), constrained_layout=True)
space = figure.add_subplot(1, 2, 1, projection="3d")
space.plot(*hand.T, color="darkorange", linewidth=2)
for k in (0, len(q) // 2, -1):
    space.plot(*robot.fk(q[k])[:5, :3, 3].T, color="steelblue", marker="o", markersize=3)
for name in scene.objects:
    for shape, pose in scene.shapes(name):
        low, high = shape.bounds
        corners = numpy.array([[x, y, z, 1] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]) @ pose.T
        for a in range(8):
            for b in (a ^ 1, a ^ 2, a ^ 4):
                space.plot(*corners[[a, b], :3].T, color="gray", linewidth=0.7)
space.set(title="Way of the hand around the lamp", xlabel="x, m", ylabel="y, m", zlabel="z, m")
space.set_aspect("equal")
along = figure.add_subplot(1, 2, 2)
share = numpy.linspace(0, len(full), len(q))
along.plot(share, measured * 1000, color="steelblue", label="measured at states")
along.stairs(proof.lower * 1000, numpy.arange(len(full) + 1), baseline=None, color="firebrick", label="proved for the whole edge")
along.set(title="Clearance along the path", xlabel="edge", ylabel="mm", ylim=(0, None))
along.legend()
figure.savefig(out, dpi=64)
print(f"picture: {out}")
