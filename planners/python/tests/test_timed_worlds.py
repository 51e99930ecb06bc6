# SPDX-License-Identifier: BSD-3-Clause
"""Several robots on one clock: contacts at known times, plans that keep to velocities and are proved, errors that name the cause."""
import numpy as np
import pytest

import leeway

ROBOT = """<robot name='slider'>
  <link name='rail'/>
  <link name='x'/>
  <link name='ball'><collision><geometry><sphere radius='0.2'/></geometry></collision></link>
  <joint name='jx' type='prismatic'><parent link='rail'/><child link='x'/><axis xyz='1 0 0'/>
    <limit lower='-3' upper='3' velocity='1' effort='1'/></joint>
  <joint name='jy' type='prismatic'><parent link='x'/><child link='ball'/><axis xyz='0 1 0'/>
    <limit lower='-3' upper='3' velocity='1' effort='1'/></joint>
</robot>"""

WORLD = """leeway_world: 1
robots:
  - {name: a, robot: slider.urdf, state: {jx: -1}, lag: 0.01, tolerance: 0.005}
  - {name: b, robot: slider.urdf, state: {jx: 1}}
objects:
  - name: gate
    shapes: [{type: box, dimensions: [0.1, 1, 1]}]
    pose: {position: [0, 2, 0]}
    motion: [{start: 1, end: 3, position: [0, 1.5, 0]}]
"""


@pytest.fixture
def world(tmp_path):
    (tmp_path / "slider.urdf").write_text(ROBOT)
    (tmp_path / "world.yaml").write_text(WORLD)
    return leeway.TimedWorld(str(tmp_path / "world.yaml"))


def test_parts_and_states_are_those_of_the_file(world):
    assert [p["name"] for p in world.parts] == ["a", "b", "gate"]
    assert world.parts[0]["variables"] == ["a/jx", "a/jy"]
    assert world.duration == 3
    at = dict(zip(world.variables, world.state(0)))
    assert at["a/jx"] == -1 and at["b/jx"] == 1
    assert dict(zip(world.variables, world.state(2)))["gate/y"] == pytest.approx(-0.25)


def test_a_meeting_is_found_with_its_time(world):
    # both go to the other's place at 1 m/s: their balls touch when they are 0.4 m apart
    world.set_motion("a", [0, 2], [[-1, 0], [1, 0]])
    world.set_motion("b", [0, 2], [[1, 0], [-1, 0]])
    report = world.prove(contact_resolution=1e-3)
    assert report["verdict"] == "BLOCKED" and not report["valid"]
    assert 0.77 <= report["proved_until"] <= 0.8 <= report["violation"]["time"] + 1e-9
    # beside each other they pass
    world.set_motion("b", [0, 2], [[1, 0.6], [-1, 0.6]])
    report = world.prove()
    assert report["valid"] and 0 < report["lower_bound"] <= 0.2
    with pytest.raises(leeway.InputError, match="jump|runs backwards|begin before it ends|has to begin"):
        world.set_motion("a", [0, 0], [[-1, 0], [1, 0]])


def test_two_robots_change_places_together(world):
    order = world.plan({"a": [1, 0], "b": [-1, 0]}, deadline=20, seconds=0.3)
    assert not order["solved"] and order["problem"]
    plan = world.plan({"a": [1, 0], "b": [-1, 0]}, deadline=20, together=True, min_d=0.01)
    assert plan["solved"], plan["problem"]
    for name, (times, positions) in plan["paths"].items():
        speeds = np.abs(np.diff(positions, axis=0)) / np.diff(times)[:, None]
        assert speeds.max() <= 1 + 1e-9
        world.set_motion(name, times, positions)
    report = world.prove(min_d=0.01)
    assert report["valid"] and report["lower_bound"] > 0.01


def test_errors_name_the_cause(world, tmp_path):
    with pytest.raises(leeway.InputError, match="no.*part|part"):
        world.set_motion("c", [0], [[0, 0]])
    with pytest.raises(ValueError, match="positions"):
        world.set_motion("a", [0, 1], [[0], [1]])
    with pytest.raises(leeway.InputError, match="end is before start"):
        world.prove(start=2, end=1)
    with pytest.raises(leeway.InputError):
        leeway.TimedWorld(str(tmp_path / "slider.urdf"))
