#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A straight path through a lamp post is pushed out of it by SciPy with the derivatives of near pairs, and proved.

States that touch have no derivative. So the post rises out of the desk in ten steps; in each one the path is optimised, from where it was,
against short motions and against clearances below `room`. The picture shows the way of the hand, and the clearance along both paths.

    python 06_optimise_path.py [OUT.png]
"""
import os
import pathlib
import sys
import time

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # matrices this small take several times as long in threads

import matplotlib.pyplot as plt
import numpy
import scipy.optimize

import leeway

first = pathlib.Path(__file__).resolve().parents[1] / "first"
out = sys.argv[1] if len(sys.argv) > 1 else "optimised.png"
room, min_d, weight = 0.04, 0.035, 300.0  # metres: looked for, proved; of a squared lack of room against a squared step
inner, fine = 10, 6  # states that are moved; states on each edge at which clearances are asked
height = 0.5

robot = leeway.Robot(first / "arm.urdf", first / "arm.srdf")


def checker_of(top):
    """With the post up to the height `top` above the desk."""
    scene = leeway.Scene()
    scene.add("desk", leeway.Shape.box(1.2, 1.6, 0.04), (0.3, 0, -0.02))
    scene.add("lamp", leeway.Shape.box(0.06, 0.06, height), (0.42, 0, top - height / 2))
    return leeway.Checker(robot, scene, group="arm", allowed=[("foot", "desk"), ("desk", "lamp")])


def cost(x, checker, weights, start, goal):
    """Squared steps and squared lacks of room, with the gradient. All near pairs count, so it has no jump where the nearest pair changes."""
    path = numpy.vstack([start, x.reshape(inner, -1), goal])
    steps = numpy.diff(path, axis=0)
    near = checker.near(weights @ path, room)
    state = numpy.repeat(numpy.arange(len(weights)), numpy.diff(near.offsets))
    lack = room - near.upper
    of_states = numpy.zeros((len(weights), path.shape[1]))
    numpy.add.at(of_states, state, -2 * weight * lack[:, None] * near.derivatives)
    gradient = weights.T @ of_states
    gradient[:-1] -= 2 * steps
    gradient[1:] += 2 * steps
    return (steps**2).sum() + weight * (lack**2).sum(), gradient[1:-1].ravel()


checker = checker_of(height)
start, goal = (numpy.array([robot.group_states["arm", name][joint][0] for joint in checker.variables]) for name in ("left", "right"))
share = numpy.linspace(0, inner + 1, (inner + 1) * fine + 1)
weights = numpy.maximum(0, 1 - numpy.abs(share[:, None] - numpy.arange(inner + 2)))  # [states asked, states of the path]: linear between
straight = numpy.linspace(start, goal, inner + 2)
print(f"straight: {checker.path(straight, min_d=min_d)}")

x, calls, before = straight[1:-1].ravel(), 0, time.perf_counter()
bounds = list(zip(numpy.tile(checker.lower, inner), numpy.tile(checker.upper, inner)))
for top in numpy.linspace(0, height, 11)[1:]:
    found = scipy.optimize.minimize(cost, x, (checker_of(top), weights, start, goal), "L-BFGS-B", jac=True, bounds=bounds)
    x, calls = found.x, calls + found.nfev
seconds = time.perf_counter() - before
path = numpy.vstack([start, x.reshape(inner, -1), goal])
proof = checker.path(path, min_d=min_d, slack=1e-4)
print(f"optimised: {proof}, {seconds:.2f} s, {calls} calls of near() with {len(share)} states each")
if not proof.all_free:
    sys.exit("the path keeps less: make room or weight larger")
print(f"every state of every edge keeps more than {proof.lower.min() * 1000:.2f} mm; length {numpy.linalg.norm(numpy.diff(path, axis=0), axis=1).sum():.2f} rad, "
      f"straight {numpy.linalg.norm(goal - start):.2f} rad")

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4), constrained_layout=True)
for states, label in ((straight, "straight"), (path, "optimised")):
    dense = weights @ states
    full = numpy.array([checker.full_state(q) for q in dense])
    hand = robot.fk(full)[:, robot.links.index("hand"), :3, 3]
    left.plot(hand[:, 1], hand[:, 2], label=label)
    right.plot(share, checker.clearance(dense).lower * 1000, label=label)
left.add_patch(plt.Rectangle((-0.03, 0), 0.06, height, color="gray"))
left.set(title="Way of the hand and the lamp post", xlabel="y, m", ylabel="z, m", aspect="equal")
right.stairs(proof.lower * 1000, numpy.arange(inner + 2), baseline=None, color="firebrick", label="proved for the whole edge")
right.set(title="Clearance along the path", xlabel="edge", ylabel="mm", ylim=(0, None))
left.legend()
right.legend()
figure.savefig(out, dpi=64)
print(f"picture: {out}")
