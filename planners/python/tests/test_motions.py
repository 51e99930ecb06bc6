# SPDX-License-Identifier: BSD-3-Clause
"""Motions and plans: bit for bit against C, against dense states, and by formula."""
import numpy
import pytest

import leeway
from conftest import ball_robot


def dense(checker, robot, a, b, count=200):
    """Least upper clearance of states along the edge."""
    full = robot.interpolate(checker.full_state(a), checker.full_state(b), numpy.linspace(0, 1, count))
    columns = [robot.variables.index(name) for name in checker.variables]
    return checker.clearance(full[:, columns]).upper.min()


def test_edges_are_the_bits_of_c(checker, states, reference):
    found = checker.path(states)
    answers, _ = reference("edges", states)
    assert numpy.column_stack([found.verdicts, found.t, found.lower]).astype(float).tobytes() == answers.tobytes()
    assert found.free.any() and not found.all_free


def test_plans_are_the_bits_of_c(checker, states, reference):
    free = states[checker.is_free(states)]
    plan = checker.plan(free[0], free[1])
    answers, _ = reference("plan", free[:2])
    assert plan.solved and plan.path.tobytes() == answers.tobytes()
    assert (plan.path[0] == free[0]).all() and (plan.path[-1] == free[1]).all()
    assert checker.path(plan.path).all_free


def test_free_edges_hold_no_colliding_state(checker, robot, states):
    found = checker.path(states[:60])
    for i in range(59):
        least = dense(checker, robot, states[i], states[i + 1])
        if found.free[i]:
            assert least >= found.lower[i] > 0
        elif found.verdicts[i] == leeway.Verdict.BLOCKED:
            at = robot.interpolate(checker.full_state(states[i]), checker.full_state(states[i + 1]), found.t[i])
            q = at[[robot.variables.index(name) for name in checker.variables]]
            assert not checker.is_free(q)
            assert (found.pairs[i] >= 0).all()


def test_threads_change_no_bit_of_an_edge(checker, states):
    first = checker.path(states, proved_until=True)
    for threads in (3, 0):
        for a, b in zip(first, checker.path(states, proved_until=True, threads=threads)):
            assert a.tobytes() == b.tobytes()


def test_edge_beside_a_ball_keeps_the_distance_of_the_formula():
    scene = leeway.Scene()
    scene.add("ball", leeway.Shape.sphere(0.3), (0, 1, 0))
    checker = leeway.Checker(ball_robot(), scene, allowed=[("left", "right")])
    a, b = [-2, 0.2, 0, 2, -2, 2], [2, 0.2, 0, 2, -2, 2]  # the left ball passes at 0.8 - 0.1 - 0.3
    assert checker.edges(a, b, min_d=0.398).all_free
    blocked = checker.edges(a, b, min_d=0.402)
    assert blocked.verdicts[0] == leeway.Verdict.BLOCKED and list(checker.names[blocked.pairs[0]]) == ["left", "ball"]
    assert checker.edges(a, b, min_d=0.3, tolerance=[0.01] * 6).all_free
    assert not checker.edges(a, b, min_d=0.398, tolerance=[0.01] * 6).all_free
    sampled = checker.edges(a, b, min_d=0.39, step=0.01)
    assert sampled.all_free and sampled.lower[0] == 0


def test_curves_of_degree_one_are_edges(checker, states):
    short = numpy.clip(states + 0.05, checker.lower, checker.upper)
    straight = checker.edges(states, short)
    curved = checker.curves(numpy.stack([states, short], axis=1))
    decided = (straight.verdicts != leeway.Verdict.UNDECIDED) & (curved.verdicts != leeway.Verdict.UNDECIDED)
    assert decided.mean() > 0.9 and (straight.verdicts == curved.verdicts)[decided].all()


def test_trajectories_are_proved_between_their_points():
    scene = leeway.Scene()
    scene.add("post", leeway.Shape.sphere(0.1), (0, 0.5, 0))
    checker = leeway.Checker(ball_robot(), scene, allowed=[("left", "right")])
    rest = [2, -2, 2]
    times, positions = [0, 1], [[-1, 0, 0] + rest, [1, 0, 0] + rest]
    assert checker.trajectory(times, positions).all_free
    # the cubic leaves the straight line and meets the post in the middle: y(1/2) = (v0 - v1) / 8
    velocities = [[2, 2, 0, 0, 0, 0], [2, -2, 0, 0, 0, 0]]
    found = checker.trajectory(times, positions, velocities)
    assert found.verdicts[0] == leeway.Verdict.BLOCKED and 0.3 < found.t[0] < 0.7
    accelerations = numpy.zeros((2, 6))
    assert checker.trajectory(times, positions, numpy.zeros((2, 6)), accelerations).all_free
    with pytest.raises(ValueError, match=r"times\[1\]: is not after"):
        checker.trajectory([1, 1], positions)
    with pytest.raises(ValueError, match="velocities: 1 rows beside 2 positions"):
        checker.trajectory(times, positions, velocities[:1])


def test_errors_of_motions_name_their_edge(checker, states):
    states[5, 0] = numpy.inf
    with pytest.raises(leeway.CoreError, match="edge 4: LW_ERROR_INVALID_ARGUMENT"):
        checker.path(states[:10])
    with pytest.raises(ValueError, match="a and b: 3 states beside 2"):
        checker.edges(states[:3], states[:2])
    with pytest.raises(ValueError, match=r"points: shape \(2, 9, 4\)"):
        checker.curves(numpy.zeros((2, 9, 4)))
    with pytest.raises(leeway.CoreError):
        checker.path(states[:3], slack=-1)


def test_plans_state_their_reasons(checker, states):
    colliding = states[~checker.is_free(states)]
    free = states[checker.is_free(states)]
    plan = checker.plan(colliding[0], free[0], seconds=1)
    assert plan.outcome == leeway.Outcome.NO_START and plan.path is None and not plan.solved and plan.message
    assert checker.plan(free[0], free[1], most_nodes=2, min_d=0.02).outcome != leeway.Outcome.UNKNOWN
    with pytest.raises(leeway.CoreError):
        checker.plan(free[0] + 100, free[1])
    again = [checker.plan(free[2], free[3], seed=5) for _ in range(2)]
    assert again[0].path.tobytes() == again[1].path.tobytes() and again[0].seed == 5
    several = checker.plan(free[2], free[:6], threads=2, optimize_seconds=0.1, seconds=5)
    assert several.solved and several.length <= several.raw_length + 1e-9 and checker.path(several.path).all_free

    pushed = checker.plan(free[2], free[3], seed=5, clearance_goal=0.03, clearance_seconds=numpy.inf)
    assert again[0].clearance is None and checker.path(pushed.path).all_free
    for kind in ("environment", "self"):
        change = pushed.clearance[kind]
        assert change["before"][0] <= change["after"][0] <= change["after"][1] <= change["ends"] + 1e-3
    with pytest.raises(leeway.CoreError, match="clearance_goal"):
        checker.plan(free[2], free[3], clearance_goal=-1)


def test_goal_states_reach_their_pose_and_are_free(checker, robot, states):
    q = states[checker.is_free(states, min_d=0.005)][0]
    hand = robot.links.index("hand")
    pose = robot.fk(checker.full_state(q))[hand]
    found = checker.goal_states("hand", pose, min_d=0.005, count=4)
    assert 1 <= len(found.states) <= 4 and found.message == ""
    assert checker.is_free(found.states, min_d=0.005).all()
    assert (found.states >= checker.lower).all() and (found.states <= checker.upper).all()
    reached = robot.fk(checker.full_state(found.states))[:, hand]
    assert (numpy.linalg.norm(reached[:, :3, 3] - pose[:3, 3], axis=1) <= 1e-4 + 1e-12).all()
    turns = numpy.einsum("kij,il->kjl", reached[:, :3, :3], pose[:3, :3])
    assert (numpy.trace(turns, axis1=1, axis2=2) >= 1 + 2 * numpy.cos(2e-3)).all()
    assert checker.goal_states("hand", pose, min_d=0.005, count=4).states.tobytes() == found.states.tobytes()
    assert checker.plan(checker.start, found.states, seconds=10).solved
    far = checker.goal_states("hand", [9, 9, 9])
    assert far.states.shape == (0, 4) and far.message
    with pytest.raises(leeway.InputError, match="palm"):
        checker.goal_states("palm", pose)


def test_a_proved_run_is_the_place_of_the_failure(checker, states):
    found = checker.path(states, proved_until=True)
    stopped = ~found.free & checker.is_free(states[:-1])
    assert stopped.sum() > 5 and (found.proved_until[found.free] == 1).all()
    assert (found.proved_until[stopped] < found.t[stopped]).all() and (found.proved_until[stopped] > 0).any()
    assert (checker.path(states).proved_until[stopped] == 0).all()


def test_plans_ignore_an_argument(checker, states):
    both, alone = checker.is_free(states), checker.is_free(states, check="self")
    free, touching = states[both], states[alone & ~both]
    assert len(touching) > 0 and not checker.plan(touching[0], free[0]).solved
    plan = checker.plan(touching[0], touching[0] + 1e-3, check="self")
    assert plan.solved and (plan.path[0] == touching[0]).all(), plan.message
    plan = checker.plan(free[0], numpy.array([touching[0], free[1]]))
    assert plan.solved and (plan.path[-1] == free[1]).all(), plan.message
    low, high = numpy.minimum(free[0], free[1]), numpy.maximum(free[0], free[1])
    assert checker.plan(free[0], free[1]).solved
    for bounds in ({"upper": high - (high > low) * 1e-3}, {"lower": low + (high > low) * 1e-3}):
        with pytest.raises(leeway.CoreError, match="outside of"):
            checker.plan(free[0], free[1], **bounds)
