# SPDX-License-Identifier: BSD-3-Clause
"""Lines and arcs: Checker.plan_line()."""
import numpy
import pytest

import leeway

JOINTS = [("j1", "0 0 0.3", "0 0 1"), ("j2", "0 0 0", "0 1 0"), ("j3", "0 0 0.2", "0 0 1"), ("j4", "0.05 0 0.2", "0 -1 0"), ("j5", "-0.05 0 0.2", "0 0 1"),
    ("j6", "0 0 0.2", "0 1 0"), ("j7", "0.08 0 0", "0 0 1")]


@pytest.fixture
def arm(tmp_path):
    """Seven joints, and a ball as its hand."""
    links, joints, last = "<link name='base'/>", "", "base"
    for name, origin, axis in JOINTS:
        links += f"<link name='{name}_link'/>"
        joints += (f"<joint name='{name}' type='revolute'><parent link='{last}'/><child link='{name}_link'/><origin xyz='{origin}'/><axis xyz='{axis}'/>"
            "<limit lower='-2.7' upper='2.7' effort='1' velocity='1'/></joint>")
        last = name + "_link"
    hand = "<link name='hand'><collision><geometry><sphere radius='0.02'/></geometry></collision></link>"
    flange = f"<joint name='flange' type='fixed'><parent link='{last}'/><child link='hand'/><origin xyz='0 0 0.1'/></joint>"
    (tmp_path / "arm.urdf").write_text(f"<robot name='arm'>{links}{hand}{joints}{flange}</robot>")
    return leeway.Robot(tmp_path / "arm.urdf")


DOWN = [1, 0, 0, 0]


def test_a_line_is_on_its_line_and_its_trajectory_is_proved(arm):
    checker = leeway.Checker(arm)
    line = checker.plan_line("hand", [[0.4, -0.2, 0.3, *DOWN], [0.4, 0.2, 0.35, *DOWN]])
    assert line.solved and line.message == "" and line.attempts >= 1
    assert 0 < line.position_error <= 1e-4 and 0 < line.angle_error <= 0.0017
    assert line.times[0] == 0 and (numpy.diff(line.times) > 0).all()
    assert (line.velocities[[0, -1]] == 0).all() and (abs(line.velocities) <= 1 + 1e-9).all()
    assert checker.trajectory(line.times, line.positions, line.velocities).all_free
    hand = arm.fk(checker.full_state(line.positions))[:, arm.links.index("hand"), :3, 3]
    assert abs(hand[:, 0] - 0.4).max() < 1e-9
    u = line.times / line.times[-1]
    fraction = u * u * (3 - 2 * u)
    assert abs(hand[:, 1] - (-0.2 + 0.4 * fraction)).max() < 1e-9
    again = checker.plan_line("hand", [[0.4, -0.2, 0.3, *DOWN], [0.4, 0.2, 0.35, *DOWN]])
    assert again.positions.tobytes() == line.positions.tobytes()


def test_an_arc_from_a_state_goes_through_its_place(arm):
    checker = leeway.Checker(arm)
    start = checker.plan_line("hand", [[0.4, -0.1, 0.3, *DOWN], [0.4, -0.1, 0.31, *DOWN]]).positions[0]
    line = checker.plan_line("hand", [([0.4, 0.1, 0.3, *DOWN], [0.4, 0, 0.4])], start=start, velocity=numpy.full(7, 0.5))
    assert line.solved and (line.positions[0] == start).all()
    hand = arm.fk(checker.full_state(line.positions))[:, arm.links.index("hand"), :3, 3]
    assert abs(numpy.hypot(hand[:, 1], hand[:, 2] - 0.3) - 0.1).max() < 1e-9
    assert hand[:, 2].max() > 0.38
    assert (abs(line.velocities) <= 0.5 + 1e-9).all()


def test_a_line_that_is_not_found_says_why(arm):
    checker = leeway.Checker(arm)
    line = checker.plan_line("hand", [[0.4, 0, 0.3, *DOWN], [3, 0, 0.3, *DOWN]], attempts=3)
    assert not line.solved and len(line.times) == 0 and line.positions.shape == (0, 7)
    assert "joint j" in line.message
    with pytest.raises(leeway.InputError, match="palm"):
        checker.plan_line("palm", [[0.4, 0, 0.3], [0.4, 0.1, 0.3]])
    with pytest.raises(leeway.InputError, match="tolerance"):
        checker.plan_line("hand", [[0.4, 0, 0.3], [0.4, 0.1, 0.3]], tolerance=0)
    with pytest.raises(ValueError, match="above 0"):
        checker.plan_line("hand", [[0.4, 0, 0.3], [0.4, 0.1, 0.3]], velocity=numpy.zeros(7))


def test_a_rounded_corner_is_not_rested_at(arm):
    checker = leeway.Checker(arm)
    way = [[0.4, -0.2, 0.3, *DOWN], [0.4, 0, 0.3, *DOWN], [0.4, 0, 0.45, *DOWN]]
    line = checker.plan_line("hand", way, blend=0.05)
    assert line.solved and (abs(line.velocities[1:-1]).max(axis=1) > 0).all()
    hand = arm.fk(checker.full_state(line.positions))[:, arm.links.index("hand"), :3, 3]
    # Lines up to 50 mm from the corner, a circle of 50 mm between them
    circle = numpy.hypot(hand[:, 1] + 0.05, hand[:, 2] - 0.35)
    on_line = (hand[:, 1] <= -0.05 + 1e-9) & (abs(hand[:, 2] - 0.3) < 1e-9) | (hand[:, 2] >= 0.35 - 1e-9) & (abs(hand[:, 1]) < 1e-9)
    assert (on_line | (abs(circle - 0.05) < 1e-9)).all() and not on_line.all()
    assert checker.trajectory(line.times, line.positions, line.velocities).all_free
    assert checker.plan_line("hand", way, blend=[0, 0.05, 0]).positions.tobytes() == line.positions.tobytes()
    with pytest.raises(leeway.InputError, match="of a line of 0.15 m"):
        checker.plan_line("hand", way, blend=0.16)
    with pytest.raises(leeway.InputError, match="radius nan"):
        checker.plan_line("hand", way, blend=numpy.nan)
    with pytest.raises(ValueError, match="blend"):
        checker.plan_line("hand", way, blend=[0.05])
