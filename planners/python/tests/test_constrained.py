# SPDX-License-Identifier: BSD-3-Clause
"""Plans that keep constraints along the path: Checker.plan_request()."""
import json
import math

import numpy
import pytest

import leeway

START, GOAL = [0.1, 0.9, 0.1, -1.6, 0.1, 0.5, 0.3], [1.1, 0.7, 0.2, -1.5, 0.3, 0.6, 0.2]
JOINTS = [("0 0 0.3", "0 0 1"), ("0 0 0", "0 1 0"), ("0 0 0.2", "0 0 1"), ("0 0 0.2", "0 -1 0"), ("0 0 0.2", "0 0 1"), ("0 0 0.2", "0 1 0"), ("0 0 0.06", "0 0 1")]


@pytest.fixture
def arm(tmp_path):
    """Seven joints, and a ball as its hand."""
    links, joints, last = "<link name='base'/>", "", "base"
    for i, (origin, axis) in enumerate(JOINTS):
        name = "hand" if i == 6 else f"l{i + 1}"
        shape = "<collision><geometry><sphere radius='0.03'/></geometry></collision>" if i == 6 else ""
        links += f"<link name='{name}'>{shape}</link>"
        joints += (f"<joint name='j{i + 1}' type='revolute'><parent link='{last}'/><child link='{name}'/><origin xyz='{origin}'/><axis xyz='{axis}'/>"
            "<limit lower='-2.8' upper='2.8' effort='1' velocity='1'/></joint>")
        last = name
    (tmp_path / "arm.urdf").write_text(f"<robot name='arm'>{links}{joints}</robot>")
    return leeway.Robot(tmp_path / "arm.urdf")


def hand_of(arm, checker, states):
    return arm.fk(checker.full_state(numpy.asarray(states)))[:, arm.links.index("hand")]


def keep(pose, tolerance):
    """The orientation of a pose within a tolerance about x and y, any turn about z."""
    r = pose[:3, :3]
    w = math.sqrt(1 + r[0, 0] + r[1, 1] + r[2, 2]) / 2
    turn = [(r[2, 1] - r[1, 2]) / (4 * w), (r[0, 2] - r[2, 0]) / (4 * w), (r[1, 0] - r[0, 1]) / (4 * w), w]
    return {"orientation_constraints": [{"link_name": "hand", "orientation": turn, "absolute_x_axis_tolerance": tolerance,
        "absolute_y_axis_tolerance": tolerance, "absolute_z_axis_tolerance": 4}]}


def tilts(arm, checker, states, pose):
    return numpy.arccos(numpy.clip(hand_of(arm, checker, states)[:, :3, 2] @ pose[:3, 2], -1, 1))


def test_a_plan_keeps_its_constraint_and_its_trajectory_is_free(arm):
    checker = leeway.Checker(arm)
    pose = hand_of(arm, checker, [START])[0]
    request = {"path_constraints": keep(pose, numpy.float64(0.1)), "goal_constraints": [{"position_constraints": [{"link_name": "hand",
        "constraint_region": {"primitives": [{"type": "box", "dimensions": numpy.array([0.02, 0.02, 0.02])}],
            "primitive_poses": [{"position": [pose[0, 3] - 0.2, pose[1, 3] + 0.2, pose[2, 3] - 0.1], "orientation": [0, 0, 0, 1]}]}}]}]}
    plan = checker.plan_request(request, START)
    assert plan.solved and plan.message == "" and plan.mended == 0
    assert (plan.positions[0] == START).all() and (plan.velocities[[0, -1]] == 0).all()
    assert (abs(plan.velocities) <= 1 + 1e-9).all()
    assert checker.trajectory(plan.times, plan.positions, plan.velocities).all_free
    end = hand_of(arm, checker, plan.positions[-1:])[0]
    assert (abs(end[:3, 3] - pose[:3, 3] - [-0.2, 0.2, -0.1]) < 0.0101).all()
    # Cubics between the points, at dense times; x and y within 0.1 allow a tilt of their hypotenuse
    for i in range(len(plan.times) - 1):
        h, (a, b), (v, w) = plan.times[i + 1] - plan.times[i], plan.positions[i:i + 2], plan.velocities[i:i + 2]
        s = numpy.linspace(0, 1, 50)[:, None]
        q = (2 * s ** 3 - 3 * s ** 2 + 1) * a + (s ** 3 - 2 * s ** 2 + s) * h * v + (3 * s ** 2 - 2 * s ** 3) * b + (s ** 3 - s ** 2) * h * w
        assert tilts(arm, checker, q, pose).max() < math.hypot(0.1, 0.1)
    again = checker.plan_request(request, START)
    assert again.positions.tobytes() == plan.positions.tobytes()


def test_a_file_and_a_mapping_are_one_request(arm, tmp_path):
    checker = leeway.Checker(arm)
    request = {"start_state": {"joint_state": {"name": [f"j{i + 1}" for i in range(7)], "position": START}},
        "goal_constraints": [{"joint_constraints": [{"joint_name": f"j{i + 1}", "position": q} for i, q in enumerate(GOAL)]}],
        "path_constraints": {"joint_constraints": [{"joint_name": "j2", "position": 0.8, "tolerance_above": 0.2, "tolerance_below": 0.2}]}}
    (tmp_path / "q.json").write_text(json.dumps(request))
    plan, of_file = checker.plan_request(request), checker.plan_request(tmp_path / "q.json")
    assert plan.solved and plan.positions.tobytes() == of_file.positions.tobytes()
    assert (plan.positions[-1] == GOAL).all()
    del request["goal_constraints"]
    assert checker.plan_request(request, goal=GOAL).positions.tobytes() == plan.positions.tobytes()
    with pytest.raises(ValueError, match="goal"):
        checker.plan_request(tmp_path / "q.json", goal=GOAL)


def test_starts_and_goals_that_break_constraints_are_errors(arm):
    checker = leeway.Checker(arm)
    low = {"path_constraints": {"joint_constraints": [{"joint_name": "j1", "position": 0.8, "tolerance_above": 0.4, "tolerance_below": 0.4}]}}
    with pytest.raises(leeway.InputError, match="joint j1 is 0.1") as caught:
        checker.plan_request(low, START, GOAL)
    assert caught.value.element == "start_state" and "mend_start" in caught.value.remedy
    mended = checker.plan_request(low, START, GOAL, mend_start=True)
    assert mended.solved and mended.mended > 0
    assert (mended.positions[mended.times >= mended.mended - 1e-9, 0] > 0.4).all()
    with pytest.raises(leeway.InputError, match="goal"):
        checker.plan_request(low, GOAL, START)
    with pytest.raises(leeway.InputError, match="palm"):
        checker.plan_request({"path_constraints": {"orientation_constraints": [{"link_name": "palm", "orientation": [0, 0, 0, 1], "absolute_x_axis_tolerance": 1,
            "absolute_y_axis_tolerance": 1, "absolute_z_axis_tolerance": 1}]}}, START, GOAL)
    with pytest.raises(leeway.InputError, match="no goal"):
        checker.plan_request(low, START)
    with pytest.raises(leeway.InputError, match="group_name"):
        checker.plan_request(dict(low, group_name="legs"), START, GOAL)
    with pytest.raises(ValueError, match="start"):
        checker.plan_request(low, START[:3], GOAL)


def test_a_plan_that_is_not_found_says_why(arm):
    scene = leeway.Scene()
    scene.add("wall", leeway.Shape.box(0.02, 10, 10), [0.02, 0, 1.2])
    checker = leeway.Checker(arm, scene)
    fixed = {"path_constraints": {"joint_constraints": [{"joint_name": "j4", "position": -1.6, "tolerance_above": 0.2, "tolerance_below": 0.2}]}}
    plan = checker.plan_request(fixed, [0, 0.3, 0, -1.6, 0, 0.5, 0.3], [3.1 - 0.4, 0.3, 0, -1.6, 0, 0.5, 0.3], seconds=0.3)
    assert not plan.solved and len(plan.times) == 0 and plan.positions.shape == (0, 7)
    assert "timed out" in plan.message and "timed out" in repr(plan)
