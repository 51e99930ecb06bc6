#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Inverse kinematics by pink (pinocchio) whose collision limit asks leeway. The hand follows a circle that goes through a block: with no
limit, with pink's own SelfCollisionBarrier, and with the limit of this file, which also marks pairs that are 10 cm apart or nearer.
The picture shows the proved clearance, and the speed of one joint.

    pip install pin-pink daqp
    python 04_pink.py [OUT.png]
"""
import os
import pathlib
import sys
import time

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # matrices this small take several times as long in threads

import matplotlib.pyplot as plt
import numpy
import pink
import pink.barriers
import pink.limits
import pinocchio

import leeway

first = pathlib.Path(__file__).resolve().parents[1] / "first"
out = sys.argv[1] if len(sys.argv) > 1 else "pink.png"
min_d, gain = 0.01, 20.0  # metres; 1 / s
dt, seconds = 0.005, 8.0
boxes = {"desk": ((1.2, 1.6, 0.04), (0.3, 0, -0.02)), "block": ((0.16, 0.5, 0.2), (0.4, 0, 0.1))}  # size, centre


class LeewayLimit(pink.limits.Limit):
    """Velocities that lower no clearance faster than gain * (clearance - min_d) per second.

    Above a flat face the nearest point jumps from corner to corner as the hand tilts, and a limit that knows one of them rattles. So near
    states are asked too, one joint turned by `probe`: their rows, led back to the state, are those of the other corners."""

    def __init__(self, checker, model, min_d, gain, distance=0.1, probe=0.005):
        for name in checker.variables:
            if not model.existJointName(name) or model.joints[model.getJointId(name)].nq != 1:
                raise ValueError(f"pinocchio's model has no joint '{name}' of one number")
        joints = [model.joints[model.getJointId(name)] for name in checker.variables]
        self.q = [joint.idx_q for joint in joints]  # leeway's order of joints in that of pinocchio
        self.v = [joint.idx_v for joint in joints]
        self.checker, self.min_d, self.gain, self.distance = checker, min_d, gain, distance
        probes = probe * numpy.vstack([numpy.zeros(checker.dof), numpy.eye(checker.dof), -numpy.eye(checker.dof)])
        self.probes = probes if probe > 0 else probes[:1]

    def compute_qp_inequalities(self, configuration, dt):
        near = self.checker.near(configuration.q[self.q] + self.probes, self.distance)
        parts = [near.barrier(self.min_d, self.gain, i) for i in range(len(self.probes))]
        rows = numpy.vstack([rows for rows, _ in parts])
        h = numpy.concatenate([h + self.gain * rows @ probe for (rows, h), probe in zip(parts, self.probes)])
        G = numpy.zeros((len(h), configuration.model.nv))
        G[:, self.v] = rows
        return G, h * dt  # pink's unknowns are steps, not velocities


def models():
    """The robot, its gripper closed, in the scene: for pinocchio, and for leeway."""
    scene = leeway.Scene()
    for name, (size, centre) in boxes.items():
        scene.add(name, leeway.Shape.box(*size), centre)
    checker = leeway.Checker(leeway.Robot(first / "arm.urdf", first / "arm.srdf"), scene, group="arm", allowed=[("foot", "desk")])
    whole = pinocchio.buildModelFromUrdf(str(first / "arm.urdf"))
    geometry = pinocchio.buildGeomFromUrdf(whole, str(first / "arm.urdf"), pinocchio.GeometryType.COLLISION)
    for name, (size, centre) in boxes.items():
        pose = pinocchio.SE3(numpy.eye(3), numpy.array(centre))
        geometry.addGeometryObject(pinocchio.GeometryObject(name, 0, 0, pose, pinocchio.coal.Box(*size)))
    geometry.addAllCollisionPairs()
    pinocchio.removeCollisionPairs(whole, geometry, str(first / "arm.srdf"))
    locked = [whole.getJointId(name) for name in whole.names[1:] if name not in checker.variables]
    model, geometry = pinocchio.buildReducedModel(whole, geometry, locked, pinocchio.neutral(whole))
    for pair in list(geometry.collisionPairs):  # of bodies that stand still to each other
        if geometry.geometryObjects[pair.first].parentJoint == geometry.geometryObjects[pair.second].parentJoint:
            geometry.removeCollisionPair(pair)
    return checker, model, geometry


def follow(model, limit=None, barrier=None, geometry=None):
    """States and velocities of all steps, and the median time of a step in microseconds."""
    hand = pink.FrameTask("hand", position_cost=1.0, orientation_cost=0.0)
    posture = pink.PostureTask(cost=1e-3)
    start = numpy.zeros(model.nq)
    for name, value in {"shoulder": 0.3, "elbow": 1.2, "wrist": 1.2}.items():
        start[model.joints[model.getJointId(name)].idx_q] = value
    posture.set_target(start)
    configuration = pink.Configuration(model, model.createData(), start, collision_model=geometry)
    limits = [configuration.model.configuration_limit, configuration.model.velocity_limit] + ([limit] if limit else [])
    target = configuration.get_transform_frame_to_world("hand")
    states, velocities, times = [configuration.q], [], []
    for k in range(int(seconds / dt)):
        angle = 2 * numpy.pi * k * dt / 4
        target.translation = numpy.array([0.4, 0.18 * numpy.sin(angle), 0.32 + 0.14 * numpy.cos(angle)])
        hand.set_target(target)
        before = time.perf_counter()
        velocity = pink.solve_ik(configuration, [hand, posture], dt, "daqp", limits=limits, barriers=[barrier] if barrier else [])
        configuration.integrate_inplace(velocity, dt)
        times.append(time.perf_counter() - before)
        states.append(configuration.q)
        velocities.append(velocity)
    return numpy.array(states), numpy.array(velocities), numpy.median(times) * 1e6


def sign_changes(velocities):
    """Per second, of all joints; speeds below 1e-3 have no sign."""
    signs = numpy.sign(numpy.where(numpy.abs(velocities) < 1e-3, 0, velocities))
    return (signs[1:] * signs[:-1] < 0).sum() / (len(velocities) * dt)


checker, model, geometry = models()
pairs = len(geometry.collisionPairs)
own = pink.barriers.SelfCollisionBarrier(pairs, gain=gain, safe_displacement_gain=0.0, d_min=min_d)  # the same program to solve
runs = {
    "no limit": follow(model),
    "pink's barrier": follow(model, barrier=own, geometry=geometry),
    "leeway, one state": follow(model, limit=LeewayLimit(checker, model, min_d, gain, probe=0.0)),
    "leeway": follow(model, limit=LeewayLimit(checker, model, min_d, gain)),
}
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4), constrained_layout=True)
print(f"{pairs} pairs of bodies, {min_d * 1000:g} mm to keep\n{'':18}{'us / step':>10}{'least clearance':>24}{'sign changes / s':>18}")
for label, (states, velocities, median) in runs.items():
    order = [model.joints[model.getJointId(name)].idx_q for name in checker.variables]
    least = checker.clearance(states[:, order]).lower.min()
    proved = least > 0 and checker.path(states[:, order], min_d=0.9 * least).all_free  # between the states too
    least = f"{least * 1000:.2f} mm" + (f", {900 * least:.2f} proved" if proved else "") if least > 0 else "contact"
    print(f"{label:18}{median:10.0f}{least:>24}{sign_changes(velocities):18.1f}")
    seconds_of = numpy.arange(len(states)) * dt
    left.plot(seconds_of, checker.clearance(states[:, order]).lower * 1000, label=label)
    right.plot(seconds_of[1:], velocities[:, order[1]], label=label)
left.axhline(min_d * 1000, color="gray", linestyle="--")
left.set(title="Clearance", xlabel="s", ylabel="mm", ylim=(0, 60))
right.set(title=f"Speed of the {checker.variables[1]}", xlabel="s", ylabel="rad/s")
left.legend()
figure.savefig(out, dpi=64)
print(f"picture: {out}")
