#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""From MuJoCo: certified clearances as labels of a simulation, and a model that both read.

    python from_mujoco.py [MODEL.xml]

Each step of the simulation gets the least clearance of the robot, its pair and the way out. qpos and leeway's state have the same joints:
they are mapped by name. A free joint's quaternion is w, x, y, z in MuJoCo and x, y, z, w here.
"""
import pathlib
import sys
import tempfile

import mujoco
import numpy

import leeway

MODEL = """<mujoco model="two links over a post">
  <option timestep="0.002" gravity="0 0 0"/>
  <worldbody>
    <geom name="post" type="box" size="0.05 0.05 0.3" pos="0.55 0.2 0.3"/>
    <body name="upper" pos="0 0 0.4"><joint name="shoulder" axis="0 0 1" range="-170 170" damping="1"/>
      <geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.04"/>
      <body name="fore" pos="0.4 0 0"><joint name="elbow" axis="0 0 1" range="-150 150" damping="1"/>
        <geom type="capsule" fromto="0.06 0 0 0.35 0 0" size="0.03"/></body></body>
  </worldbody>
  <actuator><motor joint="shoulder" ctrlrange="-5 5"/><motor joint="elbow" ctrlrange="-5 5"/></actuator>
</mujoco>"""


def columns(checker, model):
    """Index into qpos of each variable of the checker; hinges and slides."""
    return [model.joint(name).qposadr[0] for name in checker.variables]


def main():
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(folder) / "model.xml"
        if len(sys.argv) == 1:
            file.write_text(MODEL)
        model = mujoco.MjModel.from_xml_path(str(file))
        checker = leeway.Checker(leeway.Robot(file))
    data, rng = mujoco.MjData(model), numpy.random.default_rng(1)
    order = columns(checker, model)
    states = []
    for step in range(2000):
        if step % 100 == 0 and model.nu > 0:
            data.ctrl[:] = rng.uniform(*model.actuator_ctrlrange.T)
        q = data.qpos[order].copy()
        mujoco.mj_step(model, data)  # its contacts are those of the state before
        states.append((q, data.ncon > 0))
    q = numpy.array([state for state, _ in states])
    near = checker.near(q, numpy.inf, check="both", threads=0)
    least = numpy.array([near.upper[near.rows(i)].min(initial=numpy.inf) for i in range(len(q))])
    touching = numpy.array([contact for _, contact in states])
    print(f"{len(q)} steps, {touching.mean():.0%} in contact by MuJoCo; least clearance {least.min() * 1000:.3f} mm; "
          f"{(least < 0.05).mean():.0%} of the steps within 50 mm")
    # MuJoCo's contacts begin at a distance of 0 with its default margins, up to the tolerance of its own solver
    assert (least[touching] < 1e-6).all() and (least[~touching] > -1e-12).all() and not (least[~touching] == 0).any()


if __name__ == "__main__":
    main()
