# SPDX-License-Identifier: BSD-3-Clause
"""Motions one after the other: Checker.plan_sequence(). Ctrl-C ends planned motions."""
import json
import subprocess
import sys

import numpy
import pytest

import leeway
from test_lines import DOWN, arm  # noqa: F401


def test_legs_join_and_a_file_is_the_same_sequence(arm, tmp_path):  # noqa: F811
    checker = leeway.Checker(arm)
    above = checker.goal_states("hand", [0.4, -0.2, 0.3, *DOWN]).states
    line = {"link_name": "hand", "waypoints": [{"position": p, "orientation": DOWN} for p in [[0.4, -0.2, 0.25]]]}
    side = {"link_name": "hand", "waypoints": [{"position": [0.4, -0.1, 0.25], "orientation": DOWN}]}
    plan = checker.plan_sequence([above, {"req": line, "blend_radius": 0.01}, side, numpy.zeros(7)], numpy.full(7, 0.3))
    assert plan.solved and plan.failed is None and plan.message == "" and "4 legs" in repr(plan)
    assert (plan.positions[0] == 0.3).all() and (plan.positions[-1] == 0).all() and (plan.velocities[[0, -1]] == 0).all()
    assert plan.legs.shape == (4, 2) and abs(plan.legs[1:, 0] - plan.legs[:-1, 1]).max() < 1e-8
    assert checker.trajectory(plan.times, plan.positions, plan.velocities).all_free
    hand = arm.fk(checker.full_state(plan.positions))[:, arm.links.index("hand"), :3, 3]
    first = (plan.times > plan.legs[1, 0] - 1e-9) & (plan.times < plan.legs[1, 1] - 0.1)
    assert first.sum() > 1 and abs(hand[first, 0] - 0.4).max() < 2e-4
    assert numpy.linalg.norm(hand[numpy.argmin(abs(plan.times - plan.legs[2, 0]))] - [0.4, -0.2, 0.25]) > 0.001  # rounded
    names = [f"j{i + 1}" for i in range(7)]
    goal = {"goal_constraints": [{"joint_constraints": [{"joint_name": n, "position": 0} for n in names]}]}
    message = {"items": [{"req": dict(goal, start_state={"joint_state": {"name": names, "position": [0.3] * 7}})}]}
    (tmp_path / "q.json").write_text(json.dumps(message))
    alone = checker.plan_sequence(message)
    assert alone.positions.tobytes() == checker.plan_sequence(tmp_path / "q.json").positions.tobytes()
    assert alone.positions.tobytes() == checker.plan_sequence([numpy.zeros(7)], numpy.full(7, 0.3)).positions.tobytes()
    with pytest.raises(leeway.InputError, match="plan_sequence"):
        checker.plan_request(tmp_path / "q.json")


def test_the_leg_that_fails_is_named(arm):  # noqa: F811
    checker = leeway.Checker(arm)
    far = {"link_name": "hand", "waypoints": [{"position": [2, 0, 0.3], "orientation": DOWN}]}
    above = checker.goal_states("hand", [0.4, -0.2, 0.3, *DOWN]).states[:2]
    plan = checker.plan_sequence([numpy.zeros(7), above, far], numpy.full(7, 0.3), seconds=20)
    assert not plan.solved and plan.failed == 2 and len(plan.times) == 0 and plan.legs.shape == (0, 2)
    assert "leg 3 is not found" in plan.message and "leg 3" in repr(plan)
    with pytest.raises(leeway.InputError, match=r"items\[1\]"):
        checker.plan_sequence([above, dict(far, link_name="palm")], numpy.zeros(7))
    with pytest.raises(leeway.InputError, match="blend"):
        checker.plan_sequence([{"req": dict(far, start_state={}), "blend_radius": 0.1}, numpy.zeros(7)])
    with pytest.raises(ValueError, match="items"):
        checker.plan_sequence([numpy.zeros(5)], numpy.zeros(7))


INTERRUPTED = """
import os, signal, sys, threading
signal.signal(signal.SIGINT, signal.default_int_handler)
import leeway
scene = leeway.Scene()
scene.add("wall", leeway.Shape.box(0.02, 10, 10), [0.02, 0, 1.2])
checker = leeway.Checker(leeway.Robot(sys.argv[1]), scene)
start, goal = [0, 0.3, 0, -1.6, 0, 0.5, 0.3], [2.6, 0.3, 0, -1.6, 0, 0.5, 0.3]
threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
try:
    plan = checker.plan_sequence([goal], start, seconds=1000) if sys.argv[2] == "sequence" else checker.plan_request({}, start, goal, seconds=1000)
    print("not interrupted", plan)
except KeyboardInterrupt:
    print("interrupted")
"""


@pytest.mark.parametrize("work", ["request", "sequence"])
def test_ctrl_c_ends_planned_motions(arm, tmp_path, work):  # noqa: F811
    done = subprocess.run([sys.executable, "-c", INTERRUPTED, tmp_path / "arm.urdf", work], capture_output=True, text=True, timeout=120)
    assert done.stdout.startswith("interrupted"), done.stdout + done.stderr


def held(arm):  # noqa: F811
    """A block below the hand, and the items that take it, carry it to the other side and leave it there."""
    scene = leeway.Scene()
    scene.add("block", leeway.Shape.box(0.06, 0.06, 0.06), [0.4, -0.2, 0.12])
    checker = leeway.Checker(arm, scene)
    down, up = ({"link_name": "hand", "waypoints": [{"position": [0.4, -0.2, z], "orientation": DOWN}]} for z in (0.25, 0.3))

    def diff(operation, **more):
        attached = [dict(more, object={"id": "block", "operation": operation})]
        return {"planning_scene_diff": {"is_diff": True, "robot_state": {"is_diff": True, "attached_collision_objects": attached}}}

    above = checker.goal_states("hand", [0.4, -0.2, 0.3, *DOWN]).states
    place = checker.goal_states("hand", [0.3, 0.3, 0.4, *DOWN]).states
    items = [above, down, {"req": up, "planning_options": diff("ADD", link_name="hand")}, place,
             {"req": numpy.full(7, 0.3), "planning_options": diff("REMOVE")}]
    return scene, checker, items


def test_a_held_part_is_where_the_grasp_left_it(arm):  # noqa: F811
    scene, checker, items = held(arm)
    plan = checker.plan_sequence(items, numpy.full(7, 0.3), seconds=20)
    assert plan.solved, plan.message
    assert [c.links[-1] == "block" for c in plan.checkers] == [False, False, True, True, False]
    for leg, (begin, end) in zip(plan.checkers, plan.legs):
        of_leg = (plan.times > begin - 1e-6) & (plan.times < end + 1e-6)
        assert leg.trajectory(plan.times[of_leg], plan.positions[of_leg], plan.velocities[of_leg]).all_free
    # the same by the edits of a World
    grasp, leave = (plan.positions[numpy.argmin(abs(plan.times - plan.legs[i, 0]))] for i in (2, 4))
    world = leeway.World(arm, scene)
    states = numpy.vstack([plan.positions, numpy.random.default_rng(1).uniform(-1, 1, (50, 7))])
    for leg, by_hand in ((plan.checkers[3], world.attach("block", "hand", state=grasp)), (plan.checkers[4], world.detach("block", leave))):
        ours, theirs = leg.clearance(states), by_hand.clearance(states)
        assert numpy.allclose(ours.lower, theirs.lower, atol=1e-9) and (ours.lower > 0).any()
    moved = leeway.World(arm, scene)
    of_before = moved.checker
    assert of_before.plan_sequence(items, numpy.full(7, 0.3), seconds=20).solved
    moved.move("block", [0.4, -0.2, 0.1])
    with pytest.raises(leeway.InputError, match=r"items\[2\].*has changed since"):
        of_before.plan_sequence(items, numpy.full(7, 0.3))


def test_goal_states_and_diffs_are_checked(arm):  # noqa: F811
    _, checker, items = held(arm)
    items[2]["planning_options"]["planning_scene_diff"]["robot_state"]["attached_collision_objects"][0]["object"]["id"] = "blok"
    with pytest.raises(leeway.InputError, match=r"items\[2\].*no object blok"):
        checker.plan_sequence(items, numpy.full(7, 0.3))
    with pytest.raises(ValueError, match="goal_states"):
        checker.plan_sequence([numpy.zeros(7)], numpy.full(7, 0.3), goal_states=0)
    stays = checker.plan_sequence([numpy.full(7, 0.3)], numpy.full(7, 0.3))
    assert stays.solved and stays.times.tolist() == [0] and (stays.positions == 0.3).all()
