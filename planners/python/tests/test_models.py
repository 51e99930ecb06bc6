# SPDX-License-Identifier: BSD-3-Clause
"""Shapes and robots: arrays in and out, errors, pickling, kinematics by formula."""
import copy
import pickle

import numpy
import pytest

import leeway
from conftest import FIRST, ball_robot

CUBE = numpy.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
FACES = numpy.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4],
    [1, 5, 7], [1, 7, 3]], dtype=numpy.uint32)


def shapes():
    rng = numpy.random.default_rng(3)
    cloud = rng.normal(size=(100, 3))
    return [leeway.Shape.mesh(CUBE, FACES), leeway.Shape.mesh(CUBE, FACES, solid=True, scale=[1, 2, -1]),
        leeway.Shape.points(cloud, 0.01), leeway.Shape.spheres(numpy.column_stack([cloud, numpy.full(100, 0.02)])),
        leeway.Shape.boxes(numpy.hstack([cloud, cloud + 0.1])), leeway.Shape.box(1, 2, 3), leeway.Shape.sphere(0.5),
        leeway.Shape.cylinder(0.5, 2), leeway.Shape.capsule(0.5, 2), leeway.Shape.cone(0.5, 2), leeway.Shape.halfspace(),
        leeway.Shape.plane()]


def test_shapes_say_their_type_and_hold_their_arrays():
    types = [shape.type for shape in shapes()]
    assert types == ["mesh", "mesh", "points", "spheres", "boxes", "box", "sphere", "cylinder", "capsule", "cone", "half-space", "plane"]
    for shape in shapes():
        assert repr(shape).startswith("<leeway.Shape: ")
    mesh = leeway.Shape.mesh(CUBE, FACES)
    assert {tuple(v) for v in mesh.vertices} == {tuple(v) for v in CUBE} and mesh.triangles.shape == (12, 3)
    assert (mesh.bounds == [[0, 0, 0], [1, 1, 1]]).all() and "12 triangles" in repr(mesh)
    with pytest.raises(ValueError):
        mesh.vertices[0, 0] = 5
    assert leeway.Shape.sphere(1).vertices is None and leeway.Shape.spheres([[0, 0, 0, 2]]).radii.tolist() == [2]


@pytest.mark.parametrize("wrong, words", [
    (lambda f: f.astype(float), "type float64"), (lambda f: f + 0.9, "type float64"), (lambda f: numpy.where(f == 3, numpy.nan, f), "type float64"),
    (lambda f: f.astype(numpy.int64) + 2**32, "is 4294967296; give whole numbers from 0 to 7, indices of vertices"), (lambda f: f.astype(numpy.int64) - 1, "is -1; give"),
    (lambda f: f == 1, "type bool"), (lambda f: f.astype(str), "type <U"),
    (lambda f: f.astype(complex), "type complex"), (lambda f: [[0, 1, 2**70]], "is 1180591620717411303424; give"), (lambda f: [[0, 1, 2], [3]], "no array of integers"),
    (lambda f: numpy.ma.masked_equal(f, 3), "masked"), (lambda f: f.ravel(), "shape")])
def test_triangles_that_are_no_indices_of_the_vertices_are_refused_not_cast(wrong, words):
    with pytest.raises(ValueError, match=f"triangles.*: .*({words})"):
        leeway.Shape.mesh(CUBE, wrong(FACES))


def test_numbers_that_a_cast_would_change_are_refused():
    for wrong in (CUBE.astype(complex) + 1j, CUBE.astype(str), numpy.ma.masked_less(CUBE, 0.5)):
        with pytest.raises(TypeError):
            leeway.Shape.points(wrong, 0.1)
    for kind in (numpy.float32, numpy.int64, numpy.uint8, numpy.longdouble, ">f8"):
        assert leeway.Shape.points(CUBE.astype(kind), 0.1).bounds.tolist() == leeway.Shape.points(CUBE, 0.1).bounds.tolist()
    for kind in (numpy.int64, numpy.uint8, numpy.int32, ">i4"):
        assert leeway.Shape.mesh(CUBE, FACES.astype(kind)).triangles.tolist() == leeway.Shape.mesh(CUBE, FACES).triangles.tolist()


def test_views_keep_their_shape_alive():
    points = numpy.random.default_rng(5).normal(size=(5000, 3))
    view = leeway.Shape.points(points, 0).vertices
    del_me = [leeway.Shape.points(points + 1, 0) for _ in range(20)]
    del del_me
    assert {tuple(p) for p in view} == {tuple(p) for p in points}


def test_distances_equal_formulas(rng):
    sphere, box = leeway.Shape.sphere(0.5), leeway.Shape.box(1, 1, 1)
    found = leeway.distance(sphere, [3, 0, 0], box, None)
    assert found.lower <= 2 <= found.upper + 1e-12 and found.upper - found.lower < 1e-11
    numpy.testing.assert_allclose(found.witnesses, [[2.5, 0, 0], [0.5, 0, 0]], atol=1e-9)
    a, b = rng.normal(size=(40, 3)), rng.normal(size=(50, 3)) + 6
    truth = numpy.linalg.norm(a[:, None] - b[None], axis=2).min() - 0.2
    found = leeway.distance(leeway.Shape.points(a, 0.1), None, leeway.Shape.points(b, 0.1), numpy.eye(4))
    assert found.lower <= truth <= found.upper + 1e-12 and found.upper - found.lower < 1e-11
    inside = leeway.distance(leeway.Shape.mesh(CUBE, FACES, solid=True), None, leeway.Shape.sphere(0.1), [0.5, 0.5, 0.5])
    hollow = leeway.distance(leeway.Shape.mesh(CUBE, FACES), None, leeway.Shape.sphere(0.1), [0.5, 0.5, 0.5])
    assert inside.upper == 0 and abs(hollow.upper - 0.4) < 1e-12


def test_shapes_refuse_bad_arrays():
    with pytest.raises(leeway.CoreError, match="vertex") as caught:
        leeway.Shape.mesh(CUBE * numpy.nan, FACES)
    assert caught.value.status == "LW_ERROR_BAD_GEOMETRY"
    with pytest.raises(leeway.CoreError, match="open|closed"):
        leeway.Shape.mesh(CUBE, FACES[1:], solid=True)
    with pytest.raises(leeway.CoreError):
        leeway.Shape.sphere(-1)
    with pytest.raises(ValueError, match=r"points: shape \(8, 2\) is not \(n, 3\)"):
        leeway.Shape.points(CUBE[:, :2], 0)
    with pytest.raises(TypeError):
        leeway.Shape.points("cloud", 0)


def test_simpler_shapes_and_spheres_enclose_their_original(rng):
    n = 40  # a globe
    around, down = numpy.meshgrid(numpy.linspace(0, 2 * numpy.pi, n), numpy.linspace(0, numpy.pi, n))
    globe = numpy.stack([numpy.cos(around) * numpy.sin(down), numpy.sin(around) * numpy.sin(down), numpy.cos(down)], axis=-1)
    corner = (numpy.arange(n - 1)[:, None] * n + numpy.arange(n - 1)).ravel()
    faces = numpy.concatenate([corner[:, None] + [0, 1, n], corner[:, None] + [1, n, n + 1]])
    mesh = leeway.Shape.mesh(globe.reshape(-1, 3), faces)
    simple = mesh.simplify(0.05)
    assert 0 < simple.excess <= 0.05 and len(simple.triangles) < len(mesh.triangles)
    balls, report = leeway.Shape.mesh(CUBE, FACES).enclosing_spheres(count=8)
    assert report["encloses"] and len(balls) <= 8
    corners = CUBE[rng.integers(8, size=1000)] * rng.uniform(size=(1000, 3))
    assert (numpy.linalg.norm(corners[:, None] - balls[None, :, :3], axis=2) <= balls[:, 3] + 1e-12).any(axis=1).all()


def test_given_spheres_are_proved_or_refuted():
    cube = [(leeway.Shape.mesh(CUBE, FACES), [0, 0, 1])]
    whole = leeway.check_spheres(cube, [[0.5, 0.5, 1.5, 0.867]])
    assert whole["encloses"] and whole["uncovered"] == 0 and 0.366 < whole["excess_attained"] <= whole["excess"] < 0.3671
    part = leeway.check_spheres(cube, [[0.5, 0.5, 1.5, 0.8]])
    assert not part["encloses"] and 0 < part["uncovered"] <= numpy.sqrt(0.75) - 0.8 + 1e-9
    assert numpy.linalg.norm(part["uncovered_at"] - [0.5, 0.5, 1.5]) > 0.8
    with pytest.raises(leeway.CoreError):
        leeway.check_spheres(cube, [[0, 0, 0, -1]])


def test_pickles_of_shapes_keep_every_bit():
    for shape in shapes():
        again = pickle.loads(pickle.dumps(shape))
        assert again.digest == shape.digest and repr(again) == repr(shape)
        assert copy.deepcopy(shape).digest == shape.digest
    damaged = bytearray(shapes()[0].__getstate__())
    damaged[len(damaged) // 2] ^= 1
    with pytest.raises(leeway.CoreError) as caught:
        leeway.Shape.__new__(leeway.Shape).__setstate__(bytes(damaged))
    assert caught.value.status == "LW_ERROR_DAMAGED"


def test_pickles_of_robots_and_scenes_give_the_same_answers(robot, scene, checker, states):
    robot2, scene2 = pickle.loads(pickle.dumps((robot, scene)))
    assert robot2.digest == robot.digest and repr(robot2) == repr(robot) and repr(scene2) == repr(scene)
    assert robot2.group_states == robot.group_states and robot2.notices == robot.notices
    again = leeway.Checker(robot2, scene2, group="arm")
    for a, b in zip(checker.clearance(states), again.clearance(states)):
        assert a.tobytes() == b.tobytes()
    with pytest.raises(leeway.CoreError, match="another version"):
        leeway.Robot.__new__(leeway.Robot).__setstate__((b"",))


def test_checkers_refuse_pickling_with_a_remedy(robot, scene, checker):
    for held in (checker, leeway.World(robot, scene, group="arm"), leeway.Reach(robot, seconds=0.05)):
        for copying in (pickle.dumps, copy.copy, copy.deepcopy):
            with pytest.raises(TypeError, match="pickle the Robot and the Scene"):
                copying(held)


def test_robots_are_read_from_files_and_text(robot):
    text = leeway.Robot((FIRST / "arm.urdf").read_text(), (FIRST / "arm.srdf").read_text())
    assert text.digest == robot.digest and text.groups == robot.groups
    assert robot.variables == ["yaw", "shoulder", "elbow", "wrist", "grip"] and robot.lower.shape == (5,)
    assert robot.group_states["arm", "left"]["yaw"] == [0.9] and robot.velocity_limits["yaw"] > 0
    assert set(robot.collision) == set(robot.links)
    assert {tuple(sorted(pair)) for pair in robot.disabled_pairs} and "disable_collisions" in robot.srdf([("foot", "hand")])


def test_errors_of_files_name_file_element_and_remedy(tmp_path):
    with pytest.raises(leeway.InputError) as caught:
        leeway.Robot("<robot name='r'><link name='a'/><link name='a'/></robot>")
    assert caught.value.file == "URDF text" and caught.value.element and caught.value.problem and caught.value.remedy
    assert str(caught.value).startswith("URDF text: ")
    with pytest.raises(leeway.InputError, match="absent.urdf"):
        leeway.Robot(tmp_path / "absent.urdf")
    with pytest.raises(leeway.InputError):
        leeway.Scene(tmp_path / "absent.yaml")
    robot = leeway.Robot(FIRST / "arm.urdf", FIRST / "arm.srdf")
    with pytest.raises(leeway.InputError, match="group"):
        leeway.Checker(robot, group="leg")
    with pytest.raises(ValueError, match="reference: robot desk_arm has no variable 'knee'"):
        leeway.Checker(robot, reference={"knee": 0.0})
    with pytest.raises(leeway.InputError):
        leeway.Checker(robot, margins=leeway.Margins(links={"knee": 0.1}))


def test_kinematics_equal_formulas(rng):
    robot = ball_robot()
    q = rng.uniform(-2, 2, (50, 6))
    poses = robot.fk(q)
    assert poses.shape == (50, len(robot.links), 4, 4)
    assert (poses[:, robot.links.index("left"), :3, 3] == q[:, :3]).all()
    assert (poses[:, robot.links.index("right"), :3, 3] == q[:, 3:]).all()
    assert (poses[:, :, 3] == [0, 0, 0, 1]).all() and robot.fk(q[0]).tobytes() == poses[0].tobytes()
    numpy.testing.assert_allclose(robot.interpolate(q[0], q[1], [0, 0.25, 1]), [q[0], 0.75 * q[0] + 0.25 * q[1], q[1]], atol=1e-15)
    with pytest.raises(leeway.CoreError, match=r"q\[3\]"):
        q[3] = numpy.nan
        robot.fk(q)


def test_spheres_of_robots_enclose_their_links(robot):
    links = robot.spheres(excess=0.02)
    assert set(links) == {name for name, placed in robot.collision.items() if placed}
    for spheres, excess, encloses in links.values():
        assert encloses and 0 <= excess <= 0.02 and (spheres[:, 3] > 0).all()


def test_reach_lists_every_pair(robot):
    reach = leeway.Reach(robot, seconds=0.2)
    assert len(reach.pairs) == 7 * 6 // 2 and {kind for _, _, kind in reach.pairs} >= {"adjacent"}
    assert reach.info["pairs"] > 0 and "proved apart" in repr(reach)


def test_pairs_that_are_allowed_are_checked_no_more():
    robot = ball_robot()
    touching = numpy.zeros(6)
    assert not leeway.Checker(robot).is_free(touching)
    looser = robot.allowed([("left", "right")])
    assert leeway.Checker(looser).is_free(touching) and ("left", "right") in looser.disabled_pairs
    assert not leeway.Checker(robot).is_free(touching), "the robot itself changed"
    for pairs, words in (([("left", "middle")], "no link 'middle'"), ([("left", "left")], "paired with itself")):
        with pytest.raises(ValueError, match=words):
            robot.allowed(pairs)
