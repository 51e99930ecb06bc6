# SPDX-License-Identifier: BSD-3-Clause
"""Beside other packages: toppra, OMPL's Python, trimesh, yourdfpy, Open3D. ctest has all but Open3D, whose wheel has 400 MB; elsewhere a
test whose package is missing is skipped."""
import importlib
import os

import numpy
import pytest

import leeway
from conftest import FIRST, ball_robot


def package(name):
    return importlib.import_module(name) if os.environ.get("LEEWAY_PYTHON_EXTRAS") else pytest.importorskip(name)


@pytest.fixture
def ends(checker, states):
    """Two states on both sides of the desk, with room."""
    free = states[checker.is_free(states, min_d=0.01)]
    yaw = free[:, checker.variables.index("yaw")]
    return free[yaw.argmin()], free[yaw.argmax()]


def test_retimed_paths_are_proved_and_keep_their_limits(checker, ends):
    retime = package("leeway.retime")
    plan = checker.plan(*ends, min_d=0.005, seconds=10)
    velocity, acceleration = numpy.full(4, 1.5), numpy.full(4, 3.0)
    found = retime.retime(checker, plan.path, velocity, acceleration, min_d=0.002)
    assert found.proof.all_free and found.proof.lower.min() >= 0.002
    assert retime.limits_kept(found, velocity, acceleration) and not retime.limits_kept(found, velocity / 2, acceleration)
    assert (found.positions[0] == plan.path[0]).all() and (found.positions[-1] == plan.path[-1]).all()
    assert (found.velocities[[0, -1]] == 0).all() and (numpy.diff(found.times) > 0).all()
    # dense cubic states, in NumPy
    h, t = numpy.diff(found.times)[:, None], numpy.linspace(0, 1, 20)[:, None, None]
    p0, p1, v0, v1 = found.positions[:-1], found.positions[1:], found.velocities[:-1], found.velocities[1:]
    q = (2 * t**3 - 3 * t**2 + 1) * p0 + (t**3 - 2 * t**2 + t) * h * v0 + (3 * t**2 - 2 * t**3) * p1 + (t**3 - t**2) * h * v1
    least = checker.clearance(q.reshape(-1, 4)).upper.min()
    assert least >= found.proof.lower.min()
    slow = sum(max(1.875 * abs(b - a).max() / 1.5, numpy.sqrt(5.7735 * abs(b - a).max() / 3)) for a, b in zip(plan.path, plan.path[1:]))
    assert found.duration < slow


def test_retiming_refuses_a_path_without_room():
    retime = package("leeway.retime")
    scene = leeway.Scene()
    scene.add("post", leeway.Shape.sphere(0.3), (0, 0, 0))
    checker = leeway.Checker(ball_robot(), scene, allowed=[("left", "right")])
    path = numpy.array([[-1, 0, 0, 2, 2, 2], [1, 0, 0, 2, 2, 2]], float)
    with pytest.raises(ValueError, match="no proof after 3 attempts"):
        retime.retime(checker, path, 1, 1, attempts=3)
    with pytest.raises(ValueError, match="above 0"):
        retime.retime(checker, path, 0, 1)


def test_planners_of_ompl_return_paths_that_are_proved(checker, ends):
    bridge = package("leeway.ompl")
    from ompl import base, geometric
    setup = geometric.SimpleSetup(bridge.state_space(checker))
    si = setup.getSpaceInformation()
    bridge.install(si, checker, min_d=0.005)
    start, goal = si.getStateSpace().allocState(), si.getStateSpace().allocState()
    bridge.from_array(checker, ends[0], start)
    bridge.from_array(checker, ends[1], goal)
    assert (bridge.to_array(checker, start) == ends[0]).all()
    setup.setStartAndGoalStates(start, goal)
    setup.setPlanner(geometric.RRTConnect(si))
    assert setup.solve(20.0)
    path = setup.getSolutionPath()
    rows = numpy.array([bridge.to_array(checker, path.getState(i)) for i in range(path.getStateCount())])
    assert checker.path(rows, min_d=0.005).all_free and path.check()
    assert isinstance(si.getMotionValidator(), base.MotionValidator)


def test_meshes_of_trimesh_keep_their_distances():
    trimesh = package("trimesh")
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.5)
    shape = leeway.Shape.mesh(ball.vertices, ball.faces, solid=True)
    found = leeway.distance(shape, [2, 0, 0], leeway.Shape.sphere(0.5), None)
    corners = ball.vertices + [2, 0, 0]
    assert found.upper <= numpy.linalg.norm(corners, axis=1).min() - 0.5 + 1e-12
    assert 1 - 1e-9 <= found.upper <= 1.01 and len(shape.triangles) == len(ball.faces)


def test_models_of_yourdfpy_have_the_same_kinematics(robot, rng):
    yourdfpy = package("yourdfpy")
    model = yourdfpy.URDF.load(str(FIRST / "arm.urdf"), load_meshes=False)
    q = rng.uniform(robot.lower, robot.upper)
    model.update_cfg(dict(zip(robot.variables, q)))
    poses = robot.fk(q)
    for i, link in enumerate(robot.links):
        numpy.testing.assert_allclose(poses[i], model.get_transform(link, robot.root_link), atol=1e-9)


def ball_cloud(rng):
    points = rng.normal(size=(2000, 3))
    return points / numpy.linalg.norm(points, axis=1)[:, None]


def check_cloud(points, truth):
    found = leeway.distance(leeway.Shape.points(points, 0.05), [4, 0, 0], leeway.Shape.sphere(0.5), None)
    assert abs(found.upper - (numpy.linalg.norm(truth + [4, 0, 0], axis=1).min() - 0.55)) < 1e-9


def test_point_clouds_in_single_precision_and_in_columns_keep_their_distances(rng):
    truth = ball_cloud(rng)
    check_cloud(truth, truth)
    check_cloud(numpy.asfortranarray(truth), truth)
    rounded = truth.astype(numpy.float32)
    check_cloud(rounded, rounded.astype(float))


def test_clouds_and_meshes_of_open3d_keep_their_distances(rng):
    open3d = pytest.importorskip("open3d")
    truth = ball_cloud(rng)
    check_cloud(open3d.geometry.PointCloud(open3d.utility.Vector3dVector(truth)).points, truth)
    tensors = open3d.t.geometry.PointCloud(open3d.core.Tensor(truth.astype(numpy.float32)))
    check_cloud(tensors.point.positions.numpy(), truth.astype(numpy.float32).astype(float))
    ball = open3d.geometry.TriangleMesh.create_sphere(0.5)
    shape = leeway.Shape.mesh(ball.vertices, ball.triangles, solid=True)
    found = leeway.distance(shape, [2, 0, 0], leeway.Shape.sphere(0.5), None)
    assert 1 - 1e-9 <= found.upper <= 1.01 and len(shape.triangles) == len(ball.triangles)
