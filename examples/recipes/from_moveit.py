#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""From MoveIt: scene and request files of a running system, and a plan that goes back as a trajectory.

    python from_moveit.py [FOLDER]      # a folder with arm.urdf, arm.srdf, scene.yaml, request.yaml; examples/first without one

The files of a running system:

    ros2 param get /move_group robot_description          > arm.urdf      # without its first line
    ros2 param get /move_group robot_description_semantic > arm.srdf
    ros2 topic echo --once --full-length /monitored_planning_scene > scene.yaml
    ros2 topic echo --once --full-length /motion_plan_request      > request.yaml

`answer()` is the body of a service in Python: from a moveit_msgs/MotionPlanRequest's joint goal to joint_trajectory. MoveIt's own planners stay
usable beside it: `judge()` proves or refutes a trajectory that they made.
"""
import pathlib
import sys

import numpy
import yaml

import leeway


def answer(checker, start, goal, speed=0.5):
    """A joint_trajectory as a dictionary: straight edges with a stop at each corner, by quintics, at most `speed` rad/s."""
    plan = checker.plan(start, goal, seconds=5, min_d=0.005)
    if not plan.solved:
        raise RuntimeError(plan.message)
    # a quintic from rest to rest is 15/8 as fast as its mean
    lengths = numpy.abs(numpy.diff(plan.path, axis=0)).max(axis=1)
    times = numpy.concatenate([[0], numpy.cumsum(15 / 8 * lengths / speed)])
    rest = [0.0] * checker.dof
    return {"joint_names": checker.variables, "points": [{"positions": p.tolist(), "velocities": rest, "accelerations": rest,
        "time_from_start": {"sec": int(t), "nanosec": round((t - int(t)) * 1e9)}} for t, p in zip(times, plan.path)]}


def judge(checker, trajectory, min_d=0.0):
    """The audit of a joint_trajectory as joint_trajectory_controller drives it: at all times, not at its points."""
    columns = [trajectory["joint_names"].index(name) for name in checker.variables]
    points = trajectory["points"]

    def numbers(key):
        return numpy.array([p[key] for p in points])[:, columns] if all(key in p for p in points) else None

    times = [p["time_from_start"]["sec"] + p["time_from_start"]["nanosec"] * 1e-9 for p in points]
    return checker.audit_trajectory(times, numbers("positions"), numbers("velocities"), numbers("accelerations"), min_d=min_d)


def main():
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parents[1] / "first")
    request = yaml.safe_load((folder / "request.yaml").read_text())
    request = request.get("motion_plan_request", request)
    checker = leeway.Checker(leeway.Robot(folder / "arm.urdf", folder / "arm.srdf"), leeway.Scene(folder / "scene.yaml"),
        group=request["group_name"])
    state = request["start_state"]["joint_state"]
    at = dict(zip(state["name"], state["position"]))
    start = numpy.array([at.get(name, 0.0) for name in checker.variables])
    goals = {c["joint_name"]: c["position"] for c in request["goal_constraints"][0]["joint_constraints"]}
    goal = numpy.array([goals.get(name, value) for name, value in zip(checker.variables, start)])
    trajectory = answer(checker, start, goal)
    report = judge(checker, trajectory, min_d=0.002)
    seconds = trajectory["points"][-1]["time_from_start"]["sec"]
    print(f"{len(trajectory['points'])} points, {seconds} s and more, valid: {report['valid']}")
    assert report["valid"], report
    # the same points driven without speeds: linear motions, proved as such
    linear = {"joint_names": trajectory["joint_names"], "points": [{k: p[k] for k in ("positions", "time_from_start")} for p in trajectory["points"]]}
    assert judge(checker, linear)["valid"]


if __name__ == "__main__":
    main()
