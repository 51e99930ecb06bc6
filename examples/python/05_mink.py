#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Inverse kinematics by mink (MuJoCo) whose collision limit asks leeway. Both read the same MJCF. The hand points down and follows a circle
that goes through a block: with no limit, with mink's own CollisionAvoidanceLimit, with the gain of its default and with the gain of this file, and
with the limit of this file. The picture shows the clearance, and the speed of one joint.

    pip install mink daqp
    python 05_mink.py [OUT.png]
"""
import os
import sys
import time

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # matrices this small take several times as long in threads

import matplotlib.pyplot as plt
import mink
import mujoco
import numpy

import leeway

out = sys.argv[1] if len(sys.argv) > 1 else "mink.png"
min_d, gain, distance = 0.01, 20.0, 0.1  # metres; 1 / s; metres
dt, seconds = 0.005, 8.0
MODEL = """
<mujoco model="seven joints">
  <compiler angle="radian"/>
  <default><geom type="capsule" size="0.05"/><joint range="-2.8 2.8"/></default>
  <worldbody>
    <geom name="table" type="box" size="0.5 0.8 0.02" pos="0.5 0 -0.02"/>
    <geom name="block" type="box" size="0.1 0.25 0.1" pos="0.5 0 0.1"/>
    <geom name="post" type="box" size="0.03 0.03 0.3" pos="0.3 0.3 0.3"/>
    <body name="base" pos="0 0 0.05">
      <body name="shoulder"><joint name="j1" axis="0 0 1"/><geom fromto="0 0 0.05 0 0 0.25"/>
        <body name="upper" pos="0 0 0.3"><joint name="j2" axis="0 1 0"/><geom fromto="0 0 0.05 0 0 0.15"/>
          <body name="elbow" pos="0 0 0.2"><joint name="j3" axis="0 0 1"/><geom fromto="0 0 0 0 0 0.1" size="0.04"/>
            <body name="fore" pos="0 0 0.15"><joint name="j4" axis="0 1 0"/><geom fromto="0 0 0.05 0 0 0.15" size="0.04"/>
              <body name="wrist" pos="0 0 0.2"><joint name="j5" axis="0 0 1"/><geom fromto="0 0 0 0 0 0.1" size="0.035"/>
                <body name="bend" pos="0 0 0.15"><joint name="j6" axis="0 1 0"/><geom type="sphere" size="0.04"/>
                  <body name="hand" pos="0 0 0.06"><joint name="j7" axis="0 0 1"/>
                    <geom name="palm" type="box" size="0.03 0.07 0.02" pos="0 0 0.02"/>
                    <geom name="left" type="box" size="0.01 0.01 0.03" pos="0 0.04 0.07"/>
                    <geom name="right" type="box" size="0.01 0.01 0.03" pos="0 -0.04 0.07"/>
                    <site name="tip" pos="0 0 0.1"/>
                  </body>
                </body>
              </body>
            </body>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


class LeewayLimit(mink.Limit):
    """Velocities that lower no clearance faster than gain * (clearance - min_d) per second.

    Above a flat face the nearest point jumps from corner to corner as the hand tilts, and a limit that knows one of them rattles. So near
    states are asked too, one joint turned by `probe`: their rows, led back to the state, are those of the other corners."""

    def __init__(self, checker, model, min_d, gain, distance, probe=0.005):
        joints = [model.joint(name) for name in checker.variables]  # raises KeyError for a name that MuJoCo does not have
        self.q = numpy.concatenate([joint.qposadr for joint in joints])  # leeway's order of joints in that of MuJoCo
        self.v = numpy.concatenate([joint.dofadr for joint in joints])
        self.checker, self.min_d, self.gain, self.distance = checker, min_d, gain, distance
        probes = probe * numpy.vstack([numpy.zeros(checker.dof), numpy.eye(checker.dof), -numpy.eye(checker.dof)])
        self.probes = probes if probe > 0 else probes[:1]

    def compute_qp_inequalities(self, configuration, dt):
        near = self.checker.near(configuration.q[self.q] + self.probes, self.distance)
        parts = [near.barrier(self.min_d, self.gain, i) for i in range(len(self.probes))]
        rows = numpy.vstack([rows for rows, _ in parts])
        h = numpy.concatenate([h + self.gain * rows @ probe for (rows, h), probe in zip(parts, self.probes)])
        G = numpy.zeros((len(h), configuration.nv))
        G[:, self.v] = rows
        return mink.Constraint(G, h * dt)  # mink's unknowns are steps, not velocities


def follow(model, limit=None):
    """States and velocities of all steps, and the median time of a step in microseconds."""
    configuration = mink.Configuration(model)
    configuration.update(numpy.array([0, 0.4, 0, 1.1, 0, 1.4, 0]))
    tip = mink.FrameTask("tip", "site", position_cost=1.0, orientation_cost=0.1)
    down = mink.SO3.from_y_radians(numpy.pi)
    posture = mink.PostureTask(model, cost=1e-2)
    posture.set_target_from_configuration(configuration)
    limits = [mink.ConfigurationLimit(model), mink.VelocityLimit(model, {f"j{k}": 2.0 for k in range(1, 8)})] + ([limit] if limit else [])
    states, velocities, times = [configuration.q.copy()], [], []
    for k in range(int(seconds / dt)):
        angle = 2 * numpy.pi * k * dt / 4
        place = numpy.array([0.5, 0.18 * numpy.sin(angle), 0.28 + 0.16 * numpy.cos(angle)])
        tip.set_target(mink.SE3.from_rotation_and_translation(down, place))
        before = time.perf_counter()
        velocity = mink.solve_ik(configuration, [tip, posture], dt, "daqp", damping=1e-6, limits=limits)
        configuration.integrate_inplace(velocity, dt)
        times.append(time.perf_counter() - before)
        states.append(configuration.q.copy())
        velocities.append(velocity)
    return numpy.array(states), numpy.array(velocities), numpy.median(times) * 1e6


def sign_changes(velocities):
    """Per second, of all joints; speeds below 1e-3 have no sign."""
    signs = numpy.sign(numpy.where(numpy.abs(velocities) < 1e-3, 0, velocities))
    return (signs[1:] * signs[:-1] < 0).sum() / (len(velocities) * dt)


model = mujoco.MjModel.from_xml_string(MODEL)
checker = leeway.Checker(leeway.Robot(MODEL))
everything = list(range(model.ngeom))


def own(gain):
    """mink allows a step that lowers the clearance by gain / dt * (clearance - min_d)."""
    return mink.CollisionAvoidanceLimit(model, [(everything, everything)], gain, min_d, distance)


runs = {
    "no limit": follow(model),
    "mink's, gain 0.85": follow(model, own(0.85)),
    "mink's, same gain": follow(model, own(gain * dt * dt)),
    "leeway, one state": follow(model, LeewayLimit(checker, model, min_d, gain, distance, probe=0.0)),
    "leeway": follow(model, LeewayLimit(checker, model, min_d, gain, distance)),
}
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4), constrained_layout=True)
print(f"{len(own(1).geom_id_pairs)} pairs of geoms, {min_d * 1000:g} mm to keep\n{'':18}{'us / step':>10}{'least clearance':>24}{'sign changes / s':>18}")
order = [model.joint(name).qposadr[0] for name in checker.variables]
for label, (states, velocities, median) in runs.items():
    least = checker.clearance(states[:, order]).lower.min()
    proved = least > 0 and checker.path(states[:, order], min_d=0.9 * least).all_free  # between the states too
    least = f"{least * 1000:.2f} mm" + (f", {900 * least:.2f} proved" if proved else "") if least > 0 else "contact"
    print(f"{label:18}{median:10.0f}{least:>24}{sign_changes(velocities):18.1f}")
    seconds_of = numpy.arange(len(states)) * dt
    left.plot(seconds_of, checker.clearance(states[:, order]).lower * 1000, label=label)
    right.plot(seconds_of[1:], velocities[:, 5], label=label)
left.axhline(min_d * 1000, color="gray", linestyle="--")
left.set(title="Clearance", xlabel="s", ylabel="mm", ylim=(0, 40))
right.set(title="Speed of j6", xlabel="s", ylabel="rad/s")
left.legend()
figure.savefig(out, dpi=64)
print(f"picture: {out}")
