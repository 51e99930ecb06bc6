# SPDX-License-Identifier: BSD-3-Clause
"""Inverse kinematics of batches of poses: leeway.Inverse, against Robot.fk() and Checker.clearance()."""
import numpy
import pytest

import leeway
from test_lines import DOWN, arm  # noqa: F401  (a fixture)


def poses_of(robot, checker, q, link="hand"):
    return robot.fk(checker.full_state(q))[:, robot.links.index(link)]


@pytest.fixture
def reachable(arm, rng):  # noqa: F811
    checker = leeway.Checker(arm)
    q = rng.uniform(checker.lower, checker.upper, (40, checker.dof))
    return checker, q, poses_of(arm, checker, q)


def test_states_have_their_poses_within_the_limits(arm, reachable):  # noqa: F811
    checker, q, poses = reachable
    found = leeway.Inverse(checker, "hand").solve(poses, q + 0.05, count=5)
    assert (found.counts == 5).all() and (found.failures == leeway.InverseFailure.NONE).all()
    of_state = numpy.repeat(poses, found.counts, axis=0)
    assert abs(poses_of(arm, checker, found.states) - of_state).max() < 1.1e-9
    assert (found.states >= checker.lower).all() and (found.states <= checker.upper).all()
    for i in range(len(poses)):
        away = numpy.linalg.norm(found.states[found.rows(i)] - (q[i] + 0.05), axis=1)
        assert (numpy.diff(away) >= 0).all()
    one = leeway.Inverse(checker, "hand").solve(poses, q, count=1)
    assert abs(one.first - q).max() < 1e-8 and one.lower is None and set(one.messages) == {""}


def test_a_pose_has_one_answer_in_all_forms_batches_and_threads(arm, reachable):  # noqa: F811
    checker, q, poses = reachable
    inverse = leeway.Inverse(checker, "hand")
    together, many = inverse.solve(poses, q[0]), inverse.solve(poses, numpy.tile(q[0], (len(q), 1)), threads=4)
    for a, b in zip(together[:2], many[:2]):
        numpy.testing.assert_array_equal(a, b)
    alone = inverse.solve(poses[7], q[0])
    numpy.testing.assert_array_equal(alone.states, together.states[together.rows(7)])
    sevens = inverse.solve([0.4, 0.1, 0.3, *DOWN])
    matrix = numpy.diag([1.0, -1, -1, 1])
    matrix[:3, 3] = 0.4, 0.1, 0.3
    for same in (inverse.solve(matrix), inverse.solve([[0.4, 0.1, 0.3, 2, 0, 0, 0]]), inverse.solve(matrix[None])):
        numpy.testing.assert_allclose(same.states, sevens.states, rtol=0, atol=1e-9)
    assert inverse.solve(numpy.zeros((0, 7))).states.shape == (0, 7)


def test_a_tip_and_a_frame_are_where_they_are_said_to_be(arm, reachable):  # noqa: F811
    checker, q, poses = reachable
    tip = numpy.eye(4)
    tip[:3, 3] = 0, 0.05, 0.1
    shoulder = poses_of(arm, checker, q, "j2_link")
    wanted = numpy.linalg.inv(shoulder) @ poses @ tip
    found = leeway.Inverse(checker, "hand", tip=tip, frame="j2_link").solve(wanted, start=[0.3, -0.2, 0, 0, 0, 0, 0])
    assert (found.counts > 0).all()
    moved = numpy.linalg.inv(poses_of(arm, checker, found.states, "j2_link")) @ poses_of(arm, checker, found.states) @ tip
    assert abs(moved - numpy.repeat(wanted, found.counts, axis=0)).max() < 1.1e-9
    assert (found.states[:, :2] == [0.3, -0.2]).all()  # they move neither frame against the other


def test_clearances_are_those_of_the_checker_and_free_states_come_first(arm, rng):  # noqa: F811
    scene = leeway.Scene()
    scene.add("ball", leeway.Shape.sphere(0.1), (0.4, 0.1, 0.42))
    checker = leeway.Checker(arm, scene)
    inverse = leeway.Inverse(checker, "hand")
    poses = [[0.4, 0.1, z, *DOWN] for z in (0.1, 0.25, 0.29, 0.4)]
    found = inverse.solve(poses, check="both", min_d=0.02)
    assert (found.counts > 0).all()
    exact = checker.clearance(found.states, min_d=0.02)
    above = found.lower > 0.02
    numpy.testing.assert_array_equal(above, checker.is_free(found.states, min_d=0.02))
    numpy.testing.assert_allclose(found.upper[above], exact.upper[above], rtol=0, atol=1e-9)
    for i in range(len(poses)):
        free = above[found.rows(i)]
        assert (numpy.diff(free.astype(int)) <= 0).all()
        assert found.failures[i] == (leeway.InverseFailure.NONE if free.any() else leeway.InverseFailure.IN_COLLISION)
    assert found.failures[3] == leeway.InverseFailure.IN_COLLISION and "clearance above 0.02" in found.messages[3]


def test_reasons_and_bad_arguments_are_named(arm):  # noqa: F811
    checker = leeway.Checker(arm)
    inverse = leeway.Inverse(checker, "hand")
    far = inverse.solve([[0.4, 0, 0.3, *DOWN], [3, 0, 0.3, *DOWN]])
    assert list(far.failures) == [leeway.InverseFailure.NONE, leeway.InverseFailure.UNREACHABLE]
    assert far.metres[0] == 0 and far.metres[1] > 1 and "no state of the robot" in far.messages[1] and numpy.isnan(far.first[1]).all()
    assert "of 1 of 2 poses" in repr(far)
    pose = [0.4, 0, 0.3, *DOWN]
    for bad, word in (([pose, [0.4, 0, numpy.nan, *DOWN]], r"poses\[1\]"), ([pose, [0.4, 0, 0.3, 0, 0, 0, 0]], r"poses\[1\].*zero"),
            (numpy.zeros((2, 4, 4)), r"poses\[0\].*rigid"), (numpy.zeros((2, 6)), r"\(2, 6\)")):
        with pytest.raises(ValueError, match=word):
            inverse.solve(bad)
    for arguments, word in (({"start": numpy.full(7, numpy.inf)}, r"start\[0\]: entry 0"), ({"start": numpy.zeros((3, 7))}, "3 states for 1 poses"),
            ({"count": 0}, "count"), ({"check": "all"}, "check"), ({"apart": 0.0}, "apart"), ({"check": "self", "min_d": -1.0}, "min_d")):
        with pytest.raises(ValueError, match=word):
            inverse.solve(pose, **arguments)
    with pytest.raises(leeway.InputError, match="palm"):
        leeway.Inverse(checker, "palm")
    with pytest.raises(leeway.InputError, match="no joint of it moves base"):
        leeway.Inverse(checker, "base")
    with pytest.raises(TypeError, match="pickle"):
        inverse.__reduce__()
