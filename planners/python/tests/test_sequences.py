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


def two_arms(tmp_path):
    """Two arms of two joints that face each other, each with a ball of 5 cm as its hand; the arms stand at x = -0.5 and 0.5."""
    links, joints = ["<link name='base'/>"], []
    for side, origin in (("left", "xyz='-0.5 0 0'"), ("right", "xyz='0.5 0 0' rpy='0 0 3.141592653589793'")):
        links += [f"<link name='{side}_upper'/><link name='{side}_hand'><collision><origin xyz='0.4 0 0'/><geometry><sphere radius='0.05'/></geometry>"
                  "</collision></link>"]
        for name, parent, child, at in (("shoulder", "base", f"{side}_upper", origin), ("elbow", f"{side}_upper", f"{side}_hand", "xyz='0.4 0 0'")):
            joints += [f"<joint name='{side}_{name}' type='revolute'><parent link='{parent}'/><child link='{child}'/><origin {at}/><axis xyz='0 0 1'/>"
                       "<limit lower='-3' upper='3' effort='1' velocity='1'/></joint>"]
    groups = [f"<group name='{side}'><joint name='{side}_shoulder'/><joint name='{side}_elbow'/></group>" for side in ("left", "right")]
    (tmp_path / "two.urdf").write_text(f"<robot name='two'>{''.join(links + joints)}</robot>")
    (tmp_path / "two.srdf").write_text(f"<robot name='two'>{''.join(groups)}</robot>")
    return leeway.Robot(tmp_path / "two.urdf", tmp_path / "two.srdf")


def hands(positions):
    """Centres of both hands, by trigonometry."""
    out = []
    for base, sign, (a, b) in ((-0.5, 1, positions.T[:2]), (0.5, -1, positions.T[2:])):
        out += [numpy.stack([base + sign * 0.4 * (numpy.cos(a) + numpy.cos(a + b)), sign * 0.4 * (numpy.sin(a) + numpy.sin(a + b))], -1)]
    return out


def test_the_arm_that_moved_first_is_not_moved_by_the_second(tmp_path):
    checker = leeway.Checker(two_arms(tmp_path), group="left+right")
    start, there = numpy.array([2.5, 0.3, 0.8, 0]), numpy.array([-1.318116, 2.636232])  # the left hand at (-0.3, 0)
    goal = {"goal_constraints": [{"joint_constraints": [{"joint_name": "right_shoulder", "position": -0.8}, {"joint_name": "right_elbow", "position": 0}]}]}
    plan = checker.plan_sequence([{"req": there, "group_name": "left"}, dict(goal, group_name="right"), start], start, seconds=20)
    assert plan.solved, plan.message
    first, second = ((plan.times > begin - 1e-9) & (plan.times < end + 1e-9) for begin, end in plan.legs[:2])
    assert (plan.positions[first, 2:] == start[2:]).all() and (plan.positions[second, :2] == there).all()
    assert (plan.positions[-1] == start).all()
    times = numpy.linspace(*plan.legs[1], 2000)
    left, right = hands(numpy.stack([numpy.interp(times, plan.times, plan.positions[:, i]) for i in range(4)], -1))
    assert numpy.linalg.norm(left - right, axis=1).min() > 0.09  # straight pieces between the points
    assert checker.trajectory(plan.times, plan.positions, plan.velocities).all_free
    alone = checker.plan_sequence([dict(goal, group_name="right")], start)
    assert alone.solved and (alone.positions[:, :2] == start[:2]).all()
    with pytest.raises(leeway.InputError, match=r"items\[1\]\.req\.group_name.*group rihgt.*use one of left, right"):
        checker.plan_sequence([there.tolist() + [1, 0], dict(goal, group_name="rihgt")], start)
    with pytest.raises(leeway.InputError, match="left_shoulder.*group 'right'"):
        leeway.Checker(two_arms(tmp_path), group="right").plan_sequence([dict(goal, group_name="left")], start[2:])
    with pytest.raises(ValueError, match="items"):
        checker.plan_sequence([{"req": start, "group_name": "left"}], start)
