# SPDX-License-Identifier: BSD-3-Clause
"""Scenes that change: each snapshot answers as a checker from scratch, and older snapshots stay as they were."""
import numpy
import pytest

import leeway
from conftest import FIRST

POSE = [0.45, 0.1, 0.3]


@pytest.fixture
def world(robot, scene):
    return leeway.World(robot, scene, group="arm")


def same(a, b, states):
    for x, y in zip(a.clearance(states), b.clearance(states)):
        numpy.testing.assert_allclose(x, y, rtol=0, atol=1e-12)


def test_added_moved_and_removed_objects_answer_as_from_scratch(world, robot, scene, checker, states):
    ball = leeway.Shape.sphere(0.08)
    added = world.add("ball", ball, POSE)
    assert added.objects == checker.objects + ["ball"]
    assert (added.clearance(states).lower != checker.clearance(states).lower).any()
    scratch = leeway.Scene(FIRST / "scene.yaml")
    scratch.add("ball", ball, POSE)
    same(added, leeway.Checker(robot, scratch, group="arm"), states)
    before = added.clearance(states)
    moved = world.move("ball", [5, 5, 5])
    same(moved, checker, states)
    assert added.clearance(states).lower.tobytes() == before.lower.tobytes()
    removed = world.remove("ball")
    assert removed.objects == checker.objects and world.checker.objects == checker.objects
    same(removed, checker, states)


def test_attached_objects_move_with_their_link(world, checker, states):
    ball = [(leeway.Shape.sphere(0.05), [0, 0, 0.01])]
    world.add("ball", ball, [0, 0, 3])
    held = world.attach_at("ball", "hand", [0, 0, 0.1], ["left_finger", "right_finger"])
    assert "ball" in held.links and "ball" not in held.objects
    assert (held.clearance(states).upper <= checker.clearance(states).upper + 1e-12).all()
    assert (held.clearance(states).lower < checker.clearance(states).lower - 1e-3).any()
    q = states[0]
    pose = numpy.array(held.full_state(q))
    placed = world.detach("ball", q)
    assert "ball" in placed.objects and pose.shape == (5,)
    again = world.attach("ball", "hand", ["left_finger", "right_finger"], q)
    same(again, held, states)


def test_allowed_contacts_and_margins_change(world, checker, states):
    blocked = ~checker.is_free(states, check="environment")
    assert blocked.any()
    for link in checker.links:
        for thing in checker.objects:
            allowed = world.allow(link, thing)
    assert allowed.is_free(states, check="environment").all()
    for link in checker.links[1:]:  # the foot stands on the desk
        for thing in checker.objects:
            forbidden = world.allow(link, thing, False)
    same(forbidden, checker, states)
    with_margin = world.set_margins(leeway.Margins(environment=0.02))
    near = checker.clearance(states, check="environment")
    apart = near.lower > 0.02
    numpy.testing.assert_allclose(with_margin.clearance(states, check="environment").upper[apart], near.upper[apart] - 0.02, atol=1e-12)


def test_errors_name_the_object_and_change_nothing(world, checker):
    for call in (lambda: world.move("cup", POSE), lambda: world.remove("cup"), lambda: world.attach("mug", "palm"),
            lambda: world.detach("mug"), lambda: world.add("mug", leeway.Shape.sphere(1))):
        with pytest.raises(leeway.InputError) as caught:
            call()
        assert caught.value.problem and str(caught.value).count("\n") == 0
    with pytest.raises(ValueError, match="the list is empty"):
        world.add("nothing", [])
    with pytest.raises(ValueError, match="no rigid motion"):
        world.add("bent", leeway.Shape.sphere(1), numpy.diag([1, 2, 1, 1]))
    assert world.checker.objects == checker.objects


def test_scenes_are_edited_before_they_are_used(robot):
    scene = leeway.Scene()
    scene.add("box", leeway.Shape.box(1, 1, 1), [0, 0, 0, 0, 0, 0, 1])
    with pytest.raises(ValueError, match="object 'box': the scene has one"):
        scene.add("box", leeway.Shape.box(1, 1, 1))
    with pytest.raises(ValueError, match="object 'ball': the scene has none"):
        scene.remove("ball")
    assert scene.objects == ["box"] and len(scene.shapes("box")) == 1
    checker = leeway.Checker(robot, scene, group="arm")
    scene.remove("box")
    assert checker.objects == ["box"] and leeway.Checker(robot, scene, group="arm").objects == []
    assert "0 objects" in repr(scene)
