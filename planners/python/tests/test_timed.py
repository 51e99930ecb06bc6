# SPDX-License-Identifier: BSD-3-Clause
"""Timed paths: proved as they are driven, within their limits, faster than with stops."""
import math

import numpy
import pytest

LIMITS = {name: {"max_velocity": 1.5, "max_acceleration": 4, "max_jerk": 40} for name in ("yaw", "shoulder", "elbow", "wrist")}


@pytest.fixture
def path(checker, states):
    free = states[checker.clearance(states).lower > 0.005]
    return checker.plan(free[0], free[1], seconds=5).path


def test_a_limit_is_exceeded_or_a_corner_in_contact(checker, path):
    timed = checker.timed(path, joint_limits=LIMITS)
    assert checker.trajectory(*timed).all_free
    audit = checker.audit_trajectory(*timed, joint_limits=LIMITS)
    assert audit["valid"] and not audit["problems"]
    assert numpy.allclose(timed.positions[[0, -1]], path[[0, -1]], rtol=0, atol=1e-12)
    assert not timed.velocities[[0, -1]].any() and not timed.accelerations[[0, -1]].any()
    slow = {name: {"max_velocity": 1.5, "max_acceleration": 4, "max_jerk": 10} for name in LIMITS}
    assert not checker.audit_trajectory(*timed, joint_limits=slow)["valid"], "its jerk is above 10"


def test_stops_are_as_fast_as_roundings(checker, path):
    if len(path) < 3:
        path = numpy.array([path[0], 0.5 * (path[0] + path[-1]), path[-1]])
    stops = checker.timed(path, joint_limits=LIMITS, path_tolerance=0)
    assert checker.timed(path, joint_limits=LIMITS).duration < stops.duration
    still = (numpy.abs(stops.velocities).max(axis=1) == 0).sum()
    assert still == len(path)


def test_bad_arguments_are_taken(checker, path):
    for call in (lambda: checker.timed(path, path_tolerance=-1), lambda: checker.timed(path, path_tolerance=math.nan), lambda: checker.timed(path[:0]),
                 lambda: checker.timed(path[:, :2]), lambda: checker.timed(path, joint_limits={"yaw": {"max_jolt": 1}}),
                 lambda: checker.timed(path, joint_limits={"yaww": {"max_jerk": 1}})):
        with pytest.raises(ValueError):
            call()
