# SPDX-License-Identifier: BSD-3-Clause
"""leeway.Guard: a motion of the arm in a world that changes."""
import math
import threading

import leeway
import numpy
import pytest

BOX = leeway.Shape.box(0.1, 0.1, 1)
# Two links of 0.4 m along x; both joints turn about z
LINK = """<link name="{name}"><collision><origin xyz="0.2 0 0"/><geometry><box size="0.4 0.1 0.1"/></geometry></collision></link>"""
JOINT = """<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/><origin xyz="{x} 0 0"/>
<axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>"""
ARM = ('<robot name="arm"><link name="base"/>' + LINK.format(name="upper") + LINK.format(name="fore")
       + JOINT.format(name="shoulder", parent="base", child="upper", x=0) + JOINT.format(name="elbow", parent="upper", child="fore", x=0.4)
       + "</robot>")


def at(x: float, y: float) -> numpy.ndarray:
    pose = numpy.eye(4)
    pose[:2, 3] = x, y
    return pose


@pytest.fixture
def arm(tmp_path):
    (tmp_path / "arm.urdf").write_text(ARM)
    return leeway.Robot(tmp_path / "arm.urdf")


@pytest.fixture
def world(arm):
    return leeway.World(arm, None)


@pytest.fixture
def sweep(world):
    """From -0.6 to 0.6 rad of the first joint in 2 s."""
    q = numpy.zeros((2, world.checker.dof))
    q[:, 0] = -0.6, 0.6
    return world.checker, [0.0, 2.0], q


def test_a_change_is_not_seen(world, sweep):
    guard = leeway.Guard(*sweep, deceleration=4, reaction=0.05)
    assert guard.end == 2
    assert guard.ask(0).verdict == leeway.Verdict.FREE
    guard.publish(world.add("post", BOX, at(0.6, 0.3)), 7)
    answer = guard.ask(0.5)
    assert answer.verdict == leeway.Verdict.BLOCKED and answer.stamp == 7 and "post" in answer.pair
    assert 1 < answer.time < 2 and answer.time - 1e-3 <= answer.proved_until <= answer.time
    assert answer.upper <= 1e-9 and "BLOCKED" in repr(answer)
    stop = guard.stop(0.5)
    assert stop.verdict == leeway.Verdict.FREE and math.isclose(stop.time, 0.5 + 0.05 + 0.6 / 4)
    brake = guard.brake_by(0.5, answer.proved_until)
    assert 0.5 < brake < answer.time - 0.1
    assert math.isnan(guard.brake_by(answer.time - 0.02, answer.proved_until))
    guard.publish(world.remove("post"), 8)
    assert guard.ask(0.5).verdict == leeway.Verdict.FREE


def test_the_clock_is_not_that_of_the_trajectory(world, sweep):
    checker, times, q = sweep
    guard = leeway.Guard(checker, times, q)
    later = leeway.Guard(checker, [t + 1 for t in times], q)
    post = world.add("post", BOX, at(0.6, 0.3))
    guard.publish(post, 1)
    later.publish(post, 1)
    assert later.end == 3
    assert math.isclose(later.ask(0).time, guard.ask(0).time + 1, abs_tol=2e-3)


def test_a_world_that_does_not_fit_reads_as_free(world, sweep):
    guard = leeway.Guard(*sweep, spare_shapes=0)
    assert guard.ask(0).verdict == leeway.Verdict.FREE
    with pytest.raises(leeway.Error, match="spare_shapes"):
        guard.publish(world.add("many", [BOX] * 200, at(9, 9)), 1)
    answer = guard.ask(0)
    assert answer.verdict == leeway.Verdict.UNDECIDED and answer.pair is None and answer.proved_until == 0
    guard.publish(world.remove("many"), 2)
    assert guard.ask(0).verdict == leeway.Verdict.FREE
    with pytest.raises(leeway.Error, match="stamp"):
        guard.publish(world.checker, 2)
    assert guard.ask(0).verdict == leeway.Verdict.FREE


def test_people_do_not_slow_the_robot(arm, sweep):
    people = leeway.World(arm, None)
    guard = leeway.Guard(people.checker, *sweep[1:])
    assert guard.speed(0.5).scale == 1
    guard.publish(people.add("anna", BOX, at(1.1, 0)), 1)
    near = guard.speed(0.5, reaction=0.02, deceleration=5, intrusion=0.05)
    assert 0 < near.scale < 1 and near.stamp == 1 and "anna" in near.pair
    assert math.isclose(near.separation, 0.05 + 1.6 * (0.02 + near.scale / 5))
    assert math.isclose(near.until, 0.5 + near.scale * 0.02 + near.scale ** 2 / 10)
    assert guard.speed(0.5, 0.1, reaction=0.02, deceleration=5).scale < guard.speed(0.5, reaction=0.02, deceleration=5).scale
    assert guard.speed(0.5, 10.0).scale == 0 and math.isnan(guard.speed(0.5, 10.0).separation)


def test_bad_arguments_are_taken(sweep):
    guard = leeway.Guard(*sweep)
    for call in (lambda: guard.ask(math.nan), lambda: guard.ask(0, 0), lambda: guard.stop(0), lambda: guard.brake_by(0, 1, 0),
                 lambda: guard.speed(0, -1), lambda: guard.speed(0, grid=0), lambda: guard.speed(0, deceleration=0),
                 lambda: leeway.Guard(*sweep, min_d=-1), lambda: leeway.Guard(*sweep, window=0),
                 lambda: leeway.Guard(*sweep, deceleration=-1), lambda: leeway.Guard(*sweep, tolerance=[0.1]),
                 lambda: leeway.Guard(sweep[0], [0.0, 0.0], sweep[2])):
        with pytest.raises(ValueError):
            call()


def test_threads_see_an_old_world(world, sweep):
    guard = leeway.Guard(*sweep)
    free, blocked = world.checker, world.add("post", BOX, at(0.6, 0.3))
    published = 0

    def write() -> None:
        nonlocal published
        for stamp in range(1, 400):
            guard.publish(blocked if stamp % 2 else free, stamp)
            published = stamp

    writer = threading.Thread(target=write)
    writer.start()
    while True:
        before = published
        answer = guard.ask(0)
        assert answer.stamp >= before or answer.verdict == leeway.Verdict.UNDECIDED
        if answer.pair is not None or answer.verdict == leeway.Verdict.FREE:
            assert (answer.verdict == leeway.Verdict.BLOCKED) == bool(answer.stamp % 2)
        if before == 399:
            break
    writer.join()
