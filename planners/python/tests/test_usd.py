# SPDX-License-Identifier: BSD-3-Clause
"""Stages of USD as robots: poses of random chains by matrices of this file, shapes, units, and refusals that name the prim."""
import math
import os

import numpy
import pytest

import leeway

if os.environ.get("LEEWAY_PYTHON_EXTRAS") != "required":
    pytest.importorskip("pxr")
from leeway import usd  # noqa: E402
from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics  # noqa: E402


def turn(axis, angle):
    """Rodrigues' formula, [4, 4]."""
    x, y, z = numpy.asarray(axis, float) / numpy.linalg.norm(axis)
    cross = numpy.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    result = numpy.eye(4)
    result[:3, :3] += math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    return result


def shift(vector):
    result = numpy.eye(4)
    result[:3, 3] = vector
    return result


def new_stage(metres=1.0, up="Z"):
    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageMetersPerUnit(stage, metres)
    UsdGeom.SetStageUpAxis(stage, getattr(UsdGeom.Tokens, up.lower()))
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, "/robot").GetPrim())
    return stage


def add_body(stage, path, pose=numpy.eye(4), shape=True):
    body = UsdGeom.Xform.Define(stage, path)
    body.AddTransformOp().Set(Gf.Matrix4d(pose.T.tolist()))
    UsdPhysics.RigidBodyAPI.Apply(body.GetPrim())
    if shape:
        ball = UsdGeom.Sphere.Define(stage, path + "/ball")
        ball.GetRadiusAttr().Set(0.01)
        UsdPhysics.CollisionAPI.Apply(ball.GetPrim())
    return body


def add_joint(stage, kind, path, body0, body1, frames=None, axis="Z", limits=(-90, 90)):
    joint = getattr(UsdPhysics, kind + "Joint").Define(stage, path)
    for relation, body in ((joint.CreateBody0Rel(), body0), (joint.CreateBody1Rel(), body1)):
        if body:
            relation.SetTargets([body])
    placed = []
    for i, (axis_of_turn, angle, position) in enumerate(frames or [((1, 0, 0), 0, (0, 0, 0))] * 2):
        half = numpy.asarray(axis_of_turn, float) / numpy.linalg.norm(axis_of_turn) * math.sin(angle / 2)
        rotation, vector = Gf.Quatf(math.cos(angle / 2), *half), Gf.Vec3f(*position)
        getattr(joint, f"CreateLocalPos{i}Attr")(vector)
        getattr(joint, f"CreateLocalRot{i}Attr")(rotation)
        q = numpy.array([rotation.GetReal(), *rotation.GetImaginary()], float)  # as they were rounded to four bytes
        q /= numpy.linalg.norm(q)
        sine = numpy.linalg.norm(q[1:])
        placed.append(shift(numpy.array(vector, float)) @ (turn(q[1:], 2 * math.atan2(sine, q[0])) if sine > 0 else numpy.eye(4)))
    if kind != "Fixed":
        joint.CreateAxisAttr(axis)
        if limits:
            joint.CreateLowerLimitAttr(limits[0])
            joint.CreateUpperLimitAttr(limits[1])
    return placed


def pose_of(robot, q, link):
    return robot.fk(numpy.asarray(q, float))[robot.links.index(link)]


@pytest.mark.parametrize("metres, up", [(1.0, "Z"), (0.01, "Z"), (1.0, "Y"), (0.001, "Y")])
def test_poses_of_random_chains(rng, tmp_path, metres, up):
    to_z = turn((1, 0, 0), math.pi / 2) if up == "Y" else numpy.eye(4)
    for round in range(10):
        stage = new_stage(metres, up)
        base = shift(rng.uniform(-1, 1, 3) / metres) @ turn(rng.normal(size=3), rng.uniform(-3, 3))
        add_body(stage, "/robot/l0", base)
        expected = [to_z @ shift(base[:3, 3] * metres) @ shift(-base[:3, 3]) @ base]
        states, order = {}, []
        for i in range(1, 6):
            add_body(stage, f"/robot/l{i}", shift(rng.normal(size=3)))  # where it stands in the stage does not count: its joint does
            kind, axis = ("Prismatic" if i == 3 else "Revolute"), "XYZ"[rng.integers(3)]
            frames = [(rng.normal(size=3), rng.uniform(-3, 3), rng.uniform(-1, 1, 3) / metres) for _ in range(2)]
            swap = i % 2 == 0  # body0 is the child
            ends = [f"/robot/l{i - 1}", f"/robot/l{i}"]
            first, second = add_joint(stage, kind, f"/robot/j{i}", *(ends[::-1] if swap else ends), frames, axis,
                (-100 / metres, 100 / metres) if i == 3 else (-170, 170))
            first[:3, 3] *= metres
            second[:3, 3] *= metres
            value = rng.uniform(-1, 1)
            direction = numpy.eye(3)["XYZ".index(axis)]
            motion = shift(value * direction) if i == 3 else turn(direction, value)
            step = first @ motion @ numpy.linalg.inv(second)
            expected.append(expected[-1] @ (numpy.linalg.inv(step) if swap else step))
            states[f"j{i}"] = value
        robot = usd.load(stage)
        q = [states[name] for name in robot.variables]
        for i, pose in enumerate(expected):
            assert numpy.abs(pose_of(robot, q, f"l{i}") - pose).max() < 1e-12, (round, i)


def test_limits_are_radians_and_metres(tmp_path):
    stage = new_stage(0.01)
    for i in range(4):
        add_body(stage, f"/robot/l{i}")
    add_joint(stage, "Revolute", "/robot/turn", "/robot/l0", "/robot/l1", limits=(-90, 45))
    add_joint(stage, "Prismatic", "/robot/slide", "/robot/l1", "/robot/l2", limits=(0, 50))
    add_joint(stage, "Revolute", "/robot/endless", "/robot/l2", "/robot/l3", limits=None)
    add_joint(stage, "Fixed", "/robot/hold", None, "/robot/l0")
    robot = usd.load(stage)
    assert robot.variables == ["turn", "slide", "endless"]
    assert numpy.allclose(robot.lower[:2], [-math.pi / 2, 0]) and numpy.allclose(robot.upper[:2], [math.pi / 4, 0.5])
    made = usd.to_urdf(stage, tmp_path / "out")
    assert made.notices == [] and leeway.Robot(made.urdf).variables == robot.variables


def test_joints_that_follow_others():
    stage = new_stage(0.01)
    for i in range(3):
        add_body(stage, f"/robot/l{i}")
    add_joint(stage, "Revolute", "/robot/turn", "/robot/l0", "/robot/l1")
    add_joint(stage, "Revolute", "/robot/second", "/robot/l1", "/robot/l2")
    second = stage.GetPrimAtPath("/robot/second")
    second.SetMetadata("apiSchemas", Sdf.TokenListOp.Create(prependedItems=["NewtonMimicAPI"]))
    second.CreateRelationship("newton:mimicJoint").SetTargets(["/robot/turn"])
    second.CreateAttribute("newton:mimicCoef0", Sdf.ValueTypeNames.Float).Set(10)
    second.CreateAttribute("newton:mimicCoef1", Sdf.ValueTypeNames.Float).Set(-2)
    robot = usd.load(stage)
    assert robot.variables == ["turn"]
    turned = pose_of(robot, [math.pi / 6], "l2")[:3, :3]  # 30 + 10 - 60 degrees
    assert numpy.allclose(turned, turn((0, 0, 1), math.radians(-20))[:3, :3])
    second.GetRelationship("newton:mimicJoint").SetTargets(["/robot/l0"])
    with pytest.raises(leeway.InputError, match="/robot/second: follows none of the joints that move"):
        usd.load(stage)
    add_body(stage, "/robot/l3")
    add_joint(stage, "Prismatic", "/robot/slide", "/robot/l2", "/robot/l3", limits=(-1, 1))
    second.GetRelationship("newton:mimicJoint").SetTargets(["/robot/slide"])
    with pytest.raises(leeway.InputError, match="/robot/second: follows /robot/slide, a joint of another kind"):
        usd.load(stage)


def test_names_of_links_and_joints_are_those_that_users_see(tmp_path):
    stage, path = new_stage(), "/robot"
    for i in range(30):  # bodies in bodies: paths of 600 letters
        path += f"/arm_of_a_long_name_{i}"
        body = add_body(stage, path, shape=False)
    mesh = UsdGeom.Mesh.Define(stage, path + "/shape")
    mesh.CreatePointsAttr([(0, 0, 0), (1, 0, 0), (0, 1, 0)])
    mesh.CreateFaceVertexCountsAttr([3])
    mesh.CreateFaceVertexIndicesAttr([0, 1, 2])
    UsdPhysics.CollisionAPI.Apply(mesh.GetPrim())
    body.GetPrim().SetDisplayName("hand.left")
    add_joint(stage, "Revolute", "/robot/arm_of_a_long_name_3", "/robot/arm_of_a_long_name_0", path)
    robot = usd.load(stage)
    assert "hand.left" in robot.links and "arm_of_a_long_name_3" in robot.links and robot.variables == ["arm_of_a_long_name_3"]


def test_shapes_with_scales_and_axes():
    stage = new_stage(0.1)
    add_body(stage, "/robot/l", shape=False)

    def shape(kind, name, scale=(1, 1, 1), **attributes):
        geometry = getattr(UsdGeom, kind).Define(stage, f"/robot/l/{name}")
        UsdGeom.Xformable(geometry).AddTranslateOp().Set(Gf.Vec3d(1, 2, 3))
        UsdGeom.Xformable(geometry).AddScaleOp().Set(Gf.Vec3f(*scale))
        for attribute, value in attributes.items():
            geometry.GetPrim().GetAttribute(attribute).Set(value)
        UsdPhysics.CollisionAPI.Apply(geometry.GetPrim())
        return geometry

    shape("Cube", "box", (1, 2, 4), size=2.0)
    shape("Sphere", "sphere", (2, 2, 2), radius=1.5)
    shape("Cylinder", "cylinder", (3, 2, 2), radius=1.0, height=2.0, axis="X")
    shape("Capsule", "capsule", radius=0.5, height=2.0, axis="Y")
    mesh = shape("Mesh", "mesh", (2, 1, 1))
    mesh.CreatePointsAttr([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.5, 0.5, 1)])
    mesh.CreateFaceVertexCountsAttr([4, 3, 3, 3, 3])
    mesh.CreateFaceVertexIndicesAttr([3, 2, 1, 0, 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4])
    off = shape("Cone", "off")
    UsdPhysics.CollisionAPI(off.GetPrim()).GetCollisionEnabledAttr().Set(False)
    pieces = usd.load(stage).collision["l"]
    found = {piece.type: (piece, pose) for piece, pose in pieces}
    assert len(pieces) == 5
    at = numpy.array([0.1, 0.2, 0.3])

    def bounds(kind):
        """Of the shape in the link: its corners moved."""
        piece, pose = found[kind]
        low, high = piece.bounds
        corners = numpy.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]) @ pose[:3, :3].T + pose[:3, 3]
        return numpy.array([corners.min(axis=0), corners.max(axis=0)])

    for kind, half in (("box", (0.1, 0.2, 0.4)), ("sphere", (0.3, 0.3, 0.3)), ("cylinder", (0.3, 0.2, 0.2)), ("capsule", (0.05, 0.15, 0.05))):
        assert numpy.allclose(bounds(kind), [at - half, at + half], atol=1e-9), kind
    assert numpy.allclose(bounds("mesh"), [at, at + [0.2, 0.1, 0.1]], atol=1e-9)
    assert found["mesh"][0].triangles.shape == (6, 3)


def refused(edit, words):
    stage = new_stage()
    for i in range(3):
        add_body(stage, f"/robot/l{i}")
    edit(stage)
    with pytest.raises(leeway.InputError, match=words) as raised:
        usd.load(stage)
    assert raised.value.remedy and raised.value.file


def test_what_cannot_be_read_is_refused_by_its_path():
    def define(kind, path="/robot/l0/x"):
        def edit(stage):
            prim = getattr(UsdGeom, kind).Define(stage, path)
            UsdPhysics.CollisionAPI.Apply(prim.GetPrim())
            return prim
        return edit

    def scaled(kind):
        return lambda stage: UsdGeom.Xformable(define(kind)(stage)).AddScaleOp().Set(Gf.Vec3f(1, 2, 3))

    def joined(*joints):
        def edit(stage):
            for i, (kind, body0, body1, limits) in enumerate(joints):
                add_joint(stage, kind, f"/robot/j{i}", body0, body1, limits=limits)
        return edit

    l0, l1, l2 = (f"/robot/l{i}" for i in range(3))
    refused(define("Cone"), "/robot/l0/x: is a Cone that collides.*use a Cube")
    refused(define("Xform"), "/robot/l0/x: is a Xform that collides")
    refused(define("Mesh"), "/robot/l0/x: has faces that are none of its points")
    refused(lambda stage: (define("Cube")(stage), UsdGeom.PointInstancer.Define(stage, "/many").CreatePrototypesRel().SetTargets(["/robot/l0"])),
        "/robot/l0/.*: collides and is a prototype of a PointInstancer")
    refused(scaled("Sphere"), "/robot/l0/x: is scaled by .*no sphere")
    refused(scaled("Capsule"), "/robot/l0/x: is scaled by .*no capsule")
    refused(joined(("Revolute", l0, l1, (-1, 1)), ("Revolute", l1, l2, (-1, 1)), ("Fixed", l2, l0, None)), "/robot/j.: closes a loop")
    refused(joined(("Prismatic", l0, l1, None)), "/robot/j0: slides without limits")
    refused(joined(("Revolute", l0, l1, (2, 1))), "/robot/j0: lower limit 2.0 is above")
    refused(joined(("Revolute", l0, l0, (1, 2))), "/robot/j0: has l0 at both ends")
    refused(joined(("Revolute", l0, "/gone", (1, 2))), "/robot/j0: .*names /gone, which is not there")
    refused(lambda stage: UsdPhysics.SphericalJoint.Define(stage, "/robot/ball"), "/robot/ball: is a PhysicsSphericalJoint.*deactivate")
    with pytest.raises(leeway.InputError, match="no prim with PhysicsRigidBodyAPI"):
        usd.load(new_stage())


def set_attribute(path, name, value):
    return lambda stage: stage.GetPrimAtPath(path).GetAttribute(name).Set(value)


def placed_by(matrix):
    return lambda stage: UsdGeom.Xformable(stage.GetPrimAtPath("/robot/l0")).GetOrderedXformOps()[0].Set(matrix)


def with_joint(name, value):
    def edit(stage):
        add_joint(stage, "Revolute", "/robot/j", "/robot/l0", "/robot/l1")
        set_attribute("/robot/j", name, value)(stage)
    return edit


def with_mesh(points=((0, 0, 0), (1, 0, 0), (0, 1, 0)), counts=(3,), indices=(0, 1, 2)):
    def edit(stage):
        mesh = UsdGeom.Mesh.Define(stage, "/robot/l0/m")
        UsdPhysics.CollisionAPI.Apply(mesh.GetPrim())
        mesh.CreatePointsAttr(list(points))
        mesh.CreateFaceVertexCountsAttr(list(counts))
        mesh.CreateFaceVertexIndicesAttr(list(indices))
    return edit


def with_arc(stage):
    stage.DefinePrim("/robot/arm").GetReferences().AddReference("./gone.usda")


@pytest.mark.parametrize("edit, words", [
    (placed_by(Gf.Matrix4d(math.nan)), "/robot/l0: has a transform that is not finite"),
    (placed_by(Gf.Matrix4d(0)), "/robot/l0: has a transform that makes it flat"),
    (lambda stage: UsdGeom.Xformable(stage.GetPrimAtPath("/robot/l0/ball")).AddScaleOp().Set(Gf.Vec3f(1, 0, 1)), "/robot/l0/ball: has a transform that makes it flat"),
    (lambda stage: UsdGeom.SetStageMetersPerUnit(stage, 0), "metersPerUnit is 0"),
    (lambda stage: UsdGeom.SetStageMetersPerUnit(stage, -1), "metersPerUnit is -1"),
    (with_joint("physics:lowerLimit", math.nan), "/robot/j: lower limit nan"),
    (with_joint("physics:localPos0", Gf.Vec3f(0, math.inf, 0)), "/robot/j: physics:localPos0 is not finite"),
    (with_joint("physics:localRot1", Gf.Quatf(math.nan, 0, 0, 0)), "/robot/j: physics:localRot1 is not finite"),
    (with_joint("physics:localRot1", Gf.Quatf(0, 0, 0, 0)), "/robot/j: physics:localRot1 is the zero quaternion"),
    (with_joint("physics:axis", "W"), "/robot/j: physics:axis is W; give X, Y or Z"),
    (set_attribute("/robot/l0/ball", "radius", math.nan), "/robot/l0/ball: radius is nan"),
    (set_attribute("/robot/l0/ball", "radius", -1.0), "/robot/l0/ball: radius is -1"),
    (with_mesh(points=((0, 0, 0), (math.nan, 0, 0), (0, 1, 0))), "/robot/l0/m: point 1 is not finite; repair"),
    (with_mesh(points=((3e38, 0, 0), (1, 0, 0), (0, 1, 0))), "link l0, collision .*more than 1e.09 m from the origin"),
    (with_mesh(indices=(0, 1, -1)), "/robot/l0/m: has faces that are none of its points"),
    (with_mesh(counts=(2147483647,)), "/robot/l0/m: has faces that are none of its points"),
    (with_arc, "/robot/arm: Could not open asset @gone.usda@.*missing_meshes"),
])
def test_damaged_stages_are_refused_by_the_path_of_the_prim(edit, words):
    refused(edit, words)


def test_messages_name_the_stage_and_not_the_file_that_was_made_of_it(tmp_path):
    stage = new_stage()
    add_body(stage, "/robot/l0")
    with_mesh(points=((3e38, 0, 0), (1, 0, 0), (0, 1, 0)))(stage)
    stage.Export(str(tmp_path / "robot.usda"))
    with pytest.raises(leeway.InputError, match="robot.usda: link l0") as raised:
        usd.load(tmp_path / "robot.usda")
    assert "leeway-" not in str(raised.value)


def test_missing_references_are_left_out_on_request():
    stage = new_stage()
    add_body(stage, "/robot/l0")
    with_arc(stage)
    assert usd.load(stage, missing_meshes="skip").links == ["world", "l0"]
    with pytest.raises(ValueError, match="give 'refuse' or 'skip'"):
        usd.load(stage, missing_meshes="ignore")


def test_files_that_are_cut_tell_where(tmp_path):
    stage = new_stage()
    add_body(stage, "/robot/l0")
    for name in ("robot.usda", "robot.usdc"):
        stage.Export(str(tmp_path / name))
    text, binary = (tmp_path / "robot.usda").read_text(), (tmp_path / "robot.usdc").read_bytes()
    (tmp_path / "cut.usda").write_text(text[:len(text) * 2 // 3])
    (tmp_path / "cut.usdc").write_bytes(binary[:len(binary) // 2])
    (tmp_path / "word.usda").write_text(text.replace("radius = 0.01", "radius = big"))
    for name, words in (("cut.usda", "cut.usda:[0-9]+:"), ("cut.usdc", "possibly truncated"), ("word.usda", "radius"), ("gone.usda", "no such file")):
        with pytest.raises(leeway.InputError, match=f"{name}: .*{words}") as raised:
            usd.load(tmp_path / name)
        assert raised.value.remedy


def test_files_that_are_no_stage_and_stages_in_files(tmp_path):
    (tmp_path / "no.usda").write_text("no stage")
    with pytest.raises(leeway.InputError, match="no.usda: cannot be opened"):
        usd.load(tmp_path / "no.usda")
    stage = new_stage()
    add_body(stage, "/robot/l0", shift((1, 2, 3)))
    stage.Export(str(tmp_path / "robot.usda"))
    robot = usd.load(tmp_path / "robot.usda")
    assert numpy.allclose(pose_of(robot, [], "l0")[:3, 3], [1, 2, 3])
    assert any("bodies that no joint holds" in line for line in usd.to_urdf(tmp_path / "robot.usda", tmp_path / "o").notices)
    with pytest.raises(leeway.InputError, match=r"this is a USD stage \(text\).*leeway.usd.load"):
        leeway.Robot(tmp_path / "robot.usda")
