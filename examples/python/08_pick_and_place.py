#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Pick and place: an arm takes a block from a table and puts it into a shelf. Motions to goals and straight lines are planned together, in one call; the
block joins the robot where it is gripped and leaves it where it stands. Each motion is proved at all times. The picture shows ways and clearances.

    python 08_pick_and_place.py [OUT.png]
"""
import pathlib
import subprocess
import sys
import tempfile

import matplotlib.pyplot as plt
import numpy

import leeway

tasks = pathlib.Path(__file__).resolve().parents[1] / "tasks"
out = sys.argv[1] if len(sys.argv) > 1 else "pick_and_place.png"

with tempfile.TemporaryDirectory() as folder:
    subprocess.run([sys.executable, tasks / "robots.py", folder], check=True)
    robot = leeway.Robot(f"{folder}/arm.urdf")

EDGE, GAP = 0.06, 0.003 - 0.02  # metres: of the block; from the hand's frame to it: 3 mm below the hand, which ends 20 mm above its frame
FROM, TO = [0.45, -0.25, 0.15 + EDGE / 2], [0.4, 0.35, 0.3 + EDGE / 2]  # middles of the block

world = leeway.World(robot)
world.add("table", leeway.Shape.box(0.3, 0.3, 0.15), [0.5, -0.25, 0.075])
world.add("board", leeway.Shape.box(0.3, 0.3, 0.02), [0.45, 0.35, 0.29])
world.add("roof", leeway.Shape.box(0.3, 0.3, 0.02), [0.45, 0.35, 0.75])
world.add("wall", leeway.Shape.box(0.6, 0.02, 0.5), [0.5, 0.05, 0.25])
checker = world.add("block", leeway.Shape.box(EDGE, EDGE, EDGE), FROM)


def hand_above(middle, height):
    """A pose of the hand that looks down on a block."""
    x, y, z = middle
    return {"position": {"x": x, "y": y, "z": z + EDGE / 2 + GAP + height}, "orientation": {"x": 1.0, "y": 0.0, "z": 0.0, "w": 0.0}}


def to(pose):
    """A goal: the pose, turned about the vertical by any angle."""
    return {"goal_constraints": [{
        "position_constraints": [{"link_name": "hand", "constraint_region": {
            "primitives": [{"type": "sphere", "dimensions": [0.001]}], "primitive_poses": [{"position": pose["position"]}]}}],
        "orientation_constraints": [{"link_name": "hand", "orientation": pose["orientation"], "absolute_x_axis_tolerance": 0.01,
            "absolute_y_axis_tolerance": 0.01, "absolute_z_axis_tolerance": 3.14}]}]}


def line(pose):
    """A straight line of the hand, which may turn about the vertical."""
    return {"link_name": "hand", "waypoints": [pose]}


def change(operation=None, touching=None):
    """The change of the scene before a motion: the block joins the hand (ADD) or leaves it (REMOVE). From then on it may touch one object, or none."""
    attached = [{"link_name": "hand", "object": {"id": "block", "operation": operation}}] if operation else []
    matrix = {"entry_names": ["block", touching], "entry_values": [[False, True], [True, False]]} if touching else {"entry_names": ["block"], "entry_values": [[False]]}
    return {"planning_scene_diff": {"is_diff": True, "robot_state": {"is_diff": True, "attached_collision_objects": attached}, "allowed_collision_matrix": matrix}}


home = [0.0, 0.4, 0.0, 1.2, 0.0, 1.4, 0.0]
legs = {
    "to the block": to(hand_above(FROM, 0.1)),  # the goal is one from which all later motions are found
    "down": line(hand_above(FROM, 0)),
    # from here on the block is a part of the robot; it stands on the table, so that contact is allowed until it is lifted
    "lift": {"req": line(hand_above(FROM, 0.1)), "planning_options": change("ADD", touching="table")},
    "to the shelf": {"req": to(hand_above(TO, 0.05)), "planning_options": change()},
    "put down": {"req": line(hand_above(TO, 0)), "planning_options": change(touching="board")},
    # the block stays, an obstacle again
    "up": {"req": line(hand_above(TO, 0.08)), "planning_options": change("REMOVE")},
    "home": home,
}
plan = checker.plan_sequence(list(legs.values()), home, free_axis=[0, 0, 1], tolerance=1e-3, angle=0.01, speed=0.25, min_d=0.002, seconds=20, seed=1)
if not plan.solved:
    sys.exit(plan.message)
print(f"{len(legs)} motions: {plan.times[-1]:.2f} s, {len(plan.times)} points, planned in {plan.seconds:.3f} s")

figure, (side, room) = plt.subplots(1, 2, figsize=(10, 4), constrained_layout=True)
hand = robot.links.index("hand")
for name, checker, (begin, end) in zip(legs, plan.checkers, plan.legs):
    of_leg = (plan.times > begin - 1e-6) & (plan.times < end + 1e-6)
    time, position, velocity = plan.times[of_leg], plan.positions[of_leg], plan.velocities[of_leg]
    # dense states of the cubic pieces, for the picture alone
    h, t = numpy.diff(time)[:, None], numpy.linspace(0, 1, 8, endpoint=False)[:, None, None]
    p0, p1, v0, v1 = position[:-1], position[1:], velocity[:-1], velocity[1:]
    q = (2 * t**3 - 3 * t**2 + 1) * p0 + (t**3 - 2 * t**2 + t) * h * v0 + (3 * t**2 - 2 * t**3) * p1 + (t**3 - t**2) * h * v1
    q = q.transpose(1, 0, 2).reshape(-1, checker.dof)
    times = (time[:-1] + t[:, :, 0] * h[:, 0]).T.ravel()
    places = robot.fk(checker.full_state(q)[:, :len(robot.variables)])[:, hand, :3, 3]
    side.plot(places[:, 1], places[:, 2], label=name)
    room.plot(times, 1000 * checker.clearance(q).upper)
for name, (y, z), (w, h) in (("table", (-0.4, 0), (0.3, 0.15)), ("wall", (0.04, 0), (0.02, 0.5)), ("board", (0.2, 0.28), (0.3, 0.02)), ("roof", (0.2, 0.74), (0.3, 0.02))):
    side.add_patch(plt.Rectangle((y, z), w, h, color="lightgray"))
side.set(title="Way of the hand, seen along x", xlabel="y, m", ylabel="z, m", xlim=(-0.9, 0.65), aspect="equal")
side.legend(fontsize="small", loc="upper left")
room.axhline(2, color="gray", linestyle=":")
room.set(title=f"{plan.times[-1]:.1f} s, every motion proved to keep 2 mm", xlabel="seconds", ylabel="clearance, mm", ylim=(0, None))
figure.savefig(out, dpi=64)
print(f"picture: {out}")
