#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Clearance of a small arm over two of its joints, 40,000 states in one call; the picture shows the map and the limits of contact.

    python 01_clearance.py [OUT.png]
"""
import pathlib
import sys

import matplotlib.pyplot as plt
import numpy

import leeway

first = pathlib.Path(__file__).resolve().parents[1] / "first"
out = sys.argv[1] if len(sys.argv) > 1 else "clearance.png"

robot = leeway.Robot(first / "arm.urdf", first / "arm.srdf")
scene = leeway.Scene(first / "scene.yaml")
checker = leeway.Checker(robot, scene, group="arm")
print(robot, scene, checker, sep="\n")

# a grid over yaw and shoulder; the other joints as in the group state "left"
left = robot.group_states["arm", "left"]
n = 200
axes = [checker.variables.index(name) for name in ("yaw", "shoulder")]
yaw, shoulder = (numpy.linspace(checker.lower[i], checker.upper[i], n) for i in axes)
q = numpy.tile([left[name][0] for name in checker.variables], (n * n, 1))
q[:, axes[0]] = numpy.repeat(yaw, n)
q[:, axes[1]] = numpy.tile(shoulder, n)

environment = checker.clearance(q, check="environment", threads=0)
itself = checker.clearance(q, check="self", threads=0)
assert (environment.lower <= environment.upper).all()
i = environment.lower.argmax()
print(f"{len(q)} states; {(environment.lower > 0).mean():.0%} apart from the scene; most room: {environment.lower[i] * 1000:.1f} mm, between "
      f"{' and '.join(checker.names[environment.pairs[i]])}")

figure, plots = plt.subplots(1, 2, figsize=(9, 4), sharey=True, constrained_layout=True)
for plot, found, title in zip(plots, (environment, itself), ("To the scene", "Of the arm against itself")):
    room = found.lower.reshape(n, n).T * 1000
    image = plot.imshow(room, origin="lower", extent=(yaw[0], yaw[-1], shoulder[0], shoulder[-1]), aspect="auto", cmap="viridis")
    if (room == 0).any():
        plot.contourf(yaw, shoulder, room == 0, levels=[0.5, 1.5], colors=["firebrick"])
    figure.colorbar(image, ax=plot, label="proved clearance, mm")
    plot.set(title=f"{title} (red: contact)", xlabel="yaw, rad")
plots[0].set_ylabel("shoulder, rad")
figure.savefig(out, dpi=64)
print(f"picture: {out}")
