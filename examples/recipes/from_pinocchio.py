#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""From pinocchio: the same URDF in both, states in pinocchio's order, the same poses and the same point Jacobians.

    python from_pinocchio.py [ROBOT.urdf]

pinocchio's q lists the joints by its tree, a continuous joint as cosine and sine; leeway's q has one number for each turning joint.
`Order` maps between the two by names.
"""
import pathlib
import sys

import numpy
import pinocchio

import leeway


class Order:
    """Maps leeway's states of a checker to pinocchio's."""

    def __init__(self, checker, model):
        self.size = model.nq
        self.places = []
        for name in checker.variables:
            joint = model.joints[model.getJointId(name)]
            self.places.append((joint.idx_q, joint.nq, joint.idx_v))

    def to_pinocchio(self, q, neutral):
        out = neutral.copy()
        for value, (at, count, _) in zip(q, self.places):
            out[at : at + count] = value if count == 1 else (numpy.cos(value), numpy.sin(value))
        return out

    def columns(self, jacobian):
        """The columns of leeway's variables of a Jacobian in pinocchio's order."""
        return jacobian[:, [at for _, _, at in self.places]]


def main():
    urdf = sys.argv[1] if len(sys.argv) > 1 else str(pathlib.Path(__file__).resolve().parents[1] / "first" / "arm.urdf")
    robot = leeway.Robot(urdf)
    model = pinocchio.buildModelFromUrdf(urdf, mimic=True) if "mimic" in pathlib.Path(urdf).read_text() else pinocchio.buildModelFromUrdf(urdf)
    checker = leeway.Checker(robot)
    order, data, neutral = Order(checker, model), model.createData(), pinocchio.neutral(model)
    rng = numpy.random.default_rng(1)
    lower, upper = numpy.maximum(checker.lower, -3), numpy.minimum(checker.upper, 3)
    worst = worst_slope = 0.0
    for q in rng.uniform(lower, upper, (200, checker.dof)):
        p = order.to_pinocchio(q, neutral)
        pinocchio.framesForwardKinematics(model, data, p)
        pinocchio.computeJointJacobians(model, data, p)
        poses = robot.fk(checker.full_state(q))
        for link, pose in zip(robot.links, poses):
            frame = model.getFrameId(link)
            if frame == model.nframes:
                continue
            placement = data.oMf[frame]
            worst = max(worst, numpy.abs(placement.homogeneous - pose).max())
            theirs = pinocchio.getFrameJacobian(model, data, frame, pinocchio.ReferenceFrame.LOCAL_WORLD_ALIGNED)[:3]
            ours = checker.point_jacobian(q, link, pose[:3, 3])
            worst_slope = max(worst_slope, numpy.abs(order.columns(theirs) - ours).max())
    print(f"{len(robot.links)} links, 200 states: poses differ by at most {worst:.1e}, point Jacobians by {worst_slope:.1e}")
    assert worst < 1e-9 and worst_slope < 1e-9


if __name__ == "__main__":
    main()
