#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Inverse kinematics of fifteen arms: leeway.Inverse beside pinocchio's CLIK loop, TRAC-IK and ssik; branches of six-joint arms beside ssik.

    PYTHONPATH=build/python build/zoo/venv/bin/python benchmarks/zoo/inverse.py [--poses N] [--only NAME] [--csv OUT.csv]

`pip install ssik pytracik` in that environment first; columns of peers that are not installed stay empty. The poses are those of random states.
near    starts are those states with a normal error of 0.1 rad in each joint
random  starts are other random states
A pose counts as solved if the answer has it, by leeway's Robot.fk(), to 1e-6 m and rad (TRAC-IK: 1e-4; the loop: 2e-4, as its page stops at 1e-4), and
is within the joint limits after whole turns. Microseconds are means of processor time, calls from Python included; the loop is Python, and TRAC-IK has two
threads and at most 50 ms. ssik has six-joint arms alone: some of seven take it more than ten seconds a pose.
Exit status 1: leeway misses a pose, or a branch of ssik's in more than one pose of a hundred."""
import argparse
import copy
import sys
import time

import numpy
import pinocchio
import arms

import leeway

try:
    import ssik
except ImportError:
    ssik = None
try:
    import pytracik
except ImportError:
    pytracik = None


def limits_of(checker):
    """Joints without limits turn once round."""
    none = ~(checker.upper - checker.lower < 100)
    return numpy.where(none, -numpy.pi, checker.lower), numpy.where(none, numpy.pi, checker.upper)


def wrapped(angles):
    return numpy.remainder(angles + numpy.pi, 2 * numpy.pi) - numpy.pi


class Poses:
    """Random states of an arm, their poses in its base, and starts."""

    def __init__(self, arm, count):
        self.arm = arm
        self.robot, self.checker = arm.load()
        self.lower, self.upper = limits_of(self.checker)
        rng = numpy.random.default_rng(1)
        self.states = rng.uniform(self.lower, self.upper, (count, self.checker.dof))
        near = self.states + rng.normal(0, 0.1, self.states.shape)
        self.starts = {"near": numpy.clip(near, self.lower, self.upper), "random": rng.uniform(self.lower, self.upper, self.states.shape)}
        self.poses = self.fk(self.states)

    def first(self, count):
        """The same with the first poses alone."""
        few = copy.copy(self)
        few.states, few.poses = self.states[:count], self.poses[:count]
        few.starts = {kind: starts[:count] for kind, starts in self.starts.items()}
        return few

    def fk(self, q):
        links = self.robot.fk(self.checker.full_state(q))
        index = self.robot.links.index
        return numpy.linalg.inv(links[..., index(self.arm.base), :, :]) @ links[..., index(self.arm.tip), :, :]

    def solved(self, q, tolerance):
        """bool [n]: the answers have their poses within the limits, after whole turns."""
        middle = 0.5 * (self.lower + self.upper)
        nearest = middle + wrapped(q - middle)
        inside = (abs(nearest - middle) <= 0.5 * (self.upper - self.lower) + 1e-6).all(axis=1)
        there = self.fk(numpy.where(numpy.isfinite(q), q, 0))
        turn = numpy.swapaxes(there[:, :3, :3], 1, 2) @ self.poses[:, :3, :3]
        sine = numpy.linalg.norm(turn - numpy.eye(3), axis=(1, 2))
        good = (numpy.linalg.norm(there[:, :3, 3] - self.poses[:, :3, 3], axis=1) < tolerance) & (sine < 2 * tolerance)
        return good & inside & numpy.isfinite(q).all(axis=1)


def by_leeway(poses, starts):
    inverse = leeway.Inverse(poses.checker, poses.arm.tip, frame=poses.arm.base)
    begin = time.process_time()
    found = inverse.solve(poses.poses, starts, count=1)
    return found.first, time.process_time() - begin


class Clik:
    """The loop of pinocchio's page on inverse kinematics: damped steps of a tenth, at most a thousand."""

    def __init__(self, poses):
        model = pinocchio.buildModelFromUrdf(str(poses.arm.urdf))
        wanted = poses.arm.joints()
        locked = [model.getJointId(name) for name in model.names[1:] if name not in wanted]
        self.model = pinocchio.buildReducedModel(model, locked, pinocchio.neutral(model))
        self.data = self.model.createData()
        tip, base = (self.model.getFrameId(name) for name in (poses.arm.tip, poses.arm.base))
        self.joint = self.model.frames[tip].parentJoint
        pinocchio.framesForwardKinematics(self.model, self.data, pinocchio.neutral(self.model))
        self.world_from_base = self.data.oMf[base].homogeneous
        self.tip_from_joint = numpy.linalg.inv(self.model.frames[tip].placement.homogeneous)
        self.order = [wanted.index(name) for name in self.model.names[1:]]

    def configuration(self, angles):
        """Of a continuous joint pinocchio has the cosine and the sine."""
        parts = []
        for joint, angle in zip(self.model.joints[1:], angles[self.order]):
            parts += [numpy.cos(angle), numpy.sin(angle)] if joint.nq == 2 else [angle]
        return numpy.array(parts)

    def angles(self, q):
        out = numpy.zeros(len(self.order))
        for place, joint in zip(self.order, self.model.joints[1:]):
            out[place] = numpy.arctan2(q[joint.idx_q + 1], q[joint.idx_q]) if joint.nq == 2 else q[joint.idx_q]
        return out

    def solve(self, pose, start):
        model, data, q = self.model, self.data, self.configuration(start)
        wanted = pinocchio.SE3(self.world_from_base @ pose @ self.tip_from_joint)
        for _ in range(1000):
            pinocchio.forwardKinematics(model, data, q)
            error_pose = data.oMi[self.joint].actInv(wanted)
            error = pinocchio.log(error_pose).vector
            if numpy.linalg.norm(error) < 1e-4:
                return self.angles(q)
            jacobian = -pinocchio.Jlog6(error_pose.inverse()) @ pinocchio.computeJointJacobian(model, data, q, self.joint)
            velocity = -jacobian.T @ numpy.linalg.solve(jacobian @ jacobian.T + 1e-12 * numpy.eye(6), error)
            q = pinocchio.integrate(model, q, 0.1 * velocity)
        return numpy.full(len(start), numpy.nan)


def by_clik(poses, starts):
    clik = Clik(poses)
    begin = time.process_time()
    answers = [clik.solve(pose, start) for pose, start in zip(poses.poses, starts)]
    return numpy.array(answers), time.process_time() - begin


def by_tracik(poses, starts):
    solver = pytracik.TRAC_IK(poses.arm.base, poses.arm.tip, poses.arm.urdf.read_text(), 0.05, 1e-5, pytracik.SolveType.Speed)
    pytracik.set_joint_limits(solver, poses.lower, poses.upper)
    turns = [pinocchio.Quaternion(pose[:3, :3].copy()).coeffs() for pose in poses.poses]
    begin = time.process_time()
    answers = [pytracik.ik(solver, start, *pose[:3, 3], *turn) for pose, start, turn in zip(poses.poses, starts, turns)]
    seconds = time.process_time() - begin
    return numpy.array([a[1:] if a[0] > 0 else numpy.full(len(a) - 1, numpy.nan) for a in answers]), seconds


def by_ssik(poses, starts):
    manipulator = ssik.Manipulator.from_urdf(poses.arm.urdf, base=poses.arm.base, ee=poses.arm.tip)
    manipulator.solve(poses.poses[0])
    begin = time.process_time()
    answers = [manipulator.solve(pose, q_seed=start, max_solutions=1, respect_limits=True) for pose, start in zip(poses.poses, starts)]
    seconds = time.process_time() - begin
    return numpy.array([a[0].q if a else numpy.full(poses.checker.dof, numpy.nan) for a in answers]), seconds


def ask(poses, row, seconds):
    """Times and shares of all; a peer that would take longer than its seconds gets fewer poses."""
    for name, solve, tolerance, there in PEERS:
        asked = poses
        for kind in poses.starts if there and (name != "ssik" or poses.checker.dof == 6) else ():
            try:
                if name != "leeway":
                    few = poses.first(2)
                    asked = poses.first(max(5, int(2 * seconds / max(solve(few, few.starts[kind])[1], 1e-3))))
                answers, spent = solve(asked, asked.starts[kind])
            except Exception as error:  # a peer that does not read the arm has no figures
                print(f"{poses.arm.name}: {name}: {str(error)[:150]}", file=sys.stderr)
                break
            row[f"{name}_{kind}_us"] = 1e6 * spent / len(asked.poses)
            row[f"{name}_{kind}_solved"] = float(asked.solved(answers, tolerance).mean())


PEERS = (("leeway", by_leeway, 1e-6, True), ("clik", by_clik, 2e-4, True), ("tracik", by_tracik, 1e-4, pytracik), ("ssik", by_ssik, 1e-6, ssik))


def branches(poses, row):
    """Branches that ssik has and leeway misses, and the reverse."""
    manipulator = ssik.Manipulator.from_urdf(poses.arm.urdf, base=poses.arm.base, ee=poses.arm.tip)
    inverse = leeway.Inverse(poses.checker, poses.arm.tip, frame=poses.arm.base)
    begin = time.process_time()
    found = inverse.solve(poses.poses, count=64)
    row["branch_us"] = 1e6 * (time.process_time() - begin) / len(poses.poses)
    begin = time.process_time()
    others = [manipulator.solve(pose, enumerate_windings=False) for pose in poses.poses]
    row["branch_ssik_us"] = 1e6 * (time.process_time() - begin) / len(poses.poses)
    row.update(branches=0, missed=0, only_leeway=0, poses_with_misses=0)
    for i, answers in enumerate(others):
        ours, theirs = found.states[found.rows(i)], numpy.array([a.q for a in answers]).reshape(-1, poses.checker.dof)
        same = abs(wrapped(ours[:, None] - theirs[None])).max(axis=2) < 0.01 if len(ours) and len(theirs) else numpy.zeros((len(ours), len(theirs)), bool)
        missed = int((~same.any(axis=0)).sum())
        row["branches"] += len(theirs)
        row["missed"] += missed
        row["poses_with_misses"] += missed > 0
        row["only_leeway"] += int((~same.any(axis=1)).sum())


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--poses", type=int, default=500)
    parser.add_argument("--only", default="", help="part of an arm's name")
    parser.add_argument("--seconds", type=float, default=20, help="of a peer, an arm and a kind of start (default 20)")
    parser.add_argument("--csv", help="file of all figures")
    given = parser.parse_args()
    rows, bad = [], 0
    for arm in arms.ARMS:
        if given.only.lower() not in arm.name.lower():
            continue
        poses = Poses(arm, given.poses)
        row = {"arm": arm.name, "joints": poses.checker.dof}
        ask(poses, row, given.seconds)
        bad += row["leeway_near_solved"] + row["leeway_random_solved"] < 2
        if ssik and poses.checker.dof == 6:
            few = poses.first(len(poses.poses) if row.get("ssik_near_us", 0) < 2e4 else 100)
            branches(few, row)
            bad += row["poses_with_misses"] > 0.01 * len(few.poses)
        arms.say(row)
        rows.append(row)
    arms.write(rows, given.csv)
    return int(bad > 0)


if __name__ == "__main__":
    sys.exit(main())
