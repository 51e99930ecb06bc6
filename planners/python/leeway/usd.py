# SPDX-License-Identifier: BSD-3-Clause
"""Robots of USD: a stage with physics becomes a URDF, by OpenUSD's own library (`pip install leeway-robotics[usd]`).

    robot = leeway.usd.load( "robot.usd" )
    made = leeway.usd.to_urdf( "robot.usd", "robot" )       # robot/robot.urdf and robot/meshes/*.obj, for the program too
    made.urdf, made.notices

Links are prims with UsdPhysics.RigidBodyAPI, shapes are prims with CollisionAPI, enabled, at the default time: Cube, Sphere, Cylinder, Capsule and
Mesh. Joints are fixed, revolute and prismatic ones. Metres per unit, the upward axis and scales are applied: the root link `world` is in
metres, with z up. A joint's frame need not be that of its link, so `JOINT/moved`, without geometry, stands in it. Whatever cannot be read is
an InputError with the path of the prim.
"""
from __future__ import annotations

import math
import os
import pathlib
import re
import tempfile
from typing import NamedTuple
from xml.sax.saxutils import quoteattr

import numpy
from pxr import Gf, Usd, UsdGeom, UsdPhysics

from ._core import InputError, Robot

__all__ = ["Converted", "load", "to_urdf"]

WORLD = "world"
AXES = {"X": numpy.array([1.0, 0, 0]), "Y": numpy.array([0, 1.0, 0]), "Z": numpy.array([0, 0, 1.0])}
SAME = 1e-9  # relative difference of scales that are rounding
FLAT = 1e-9  # determinant of a matrix of size 1 that has lost a direction
JOINTS_REMEDY = "use fixed, revolute and prismatic joints in its place, or deactivate the prim (prim.SetActive(False))"


class Converted(NamedTuple):
    """A URDF that was written."""
    urdf: str  #: path
    notices: list[str]  #: lines on parts that were changed or not used


def load(stage, *, missing_meshes="refuse", **options) -> Robot:
    """The robot of a stage. stage: a path, or a Usd.Stage. options: those of leeway.Robot; missing_meshes as for to_urdf()."""
    with tempfile.TemporaryDirectory(prefix="leeway-") as folder:
        read = _Stage(stage, missing_meshes)
        made = read.write(pathlib.Path(folder))
        try:
            return Robot(made.urdf, missing_meshes=missing_meshes, **options)
        except InputError as error:  # of a file that nobody has seen
            raise read.problem(error.element, error.problem.replace(folder + "/", ""), error.remedy.replace(folder + "/", "")) from None


def to_urdf(stage, folder, *, missing_meshes="refuse") -> Converted:
    """Writes robot.urdf and its meshes into a folder, which is made. stage: a path, or a Usd.Stage. missing_meshes: "refuse" or "skip", for
    references to files and prims that are not there. Raises InputError."""
    return _Stage(stage, missing_meshes).write(pathlib.Path(folder))


def _reason(error):
    """OpenUSD's reason why a stage does not open: its first line that says more than "failed"."""
    said = re.findall(r"in file \S+ : '(.*?)'?\s*$", str(error), re.MULTILINE)
    return next((line for line in said if not line.startswith("Failed to open layer")), "it is no stage, or damaged")


def _rigid(matrix):
    """Rotation and translation of an affine matrix [4, 4] (columns), and the 3 x 3 remainder: matrix = rigid @ remainder."""
    linear = matrix[:3, :3]
    u, _, v = numpy.linalg.svd(linear)
    rotation = u @ v  # the nearest one (Higham 1986)
    if numpy.linalg.det(rotation) < 0:  # a mirror stays in the remainder
        rotation = u @ numpy.diag([1.0, 1.0, -1.0]) @ v
    rigid = numpy.eye(4)
    rigid[:3, :3], rigid[:3, 3] = rotation, matrix[:3, 3]
    return rigid, rotation.T @ linear


def _inverse(rigid):
    result = numpy.eye(4)
    result[:3, :3] = rigid[:3, :3].T
    result[:3, 3] = -rigid[:3, :3].T @ rigid[:3, 3]
    return result


def _origin(rigid):
    """As URDF writes it. Near pitch 90 degrees roll and yaw are taken together, so that their sum is right."""
    r = rigid[:3, :3]
    yaw = math.atan2(r[1, 0], r[0, 0])
    sine, cosine = math.sin(yaw), math.cos(yaw)
    pitch = math.atan2(-r[2, 0], math.hypot(r[0, 0], r[1, 0]))
    roll = math.atan2(sine * r[0, 2] - cosine * r[1, 2], cosine * r[1, 1] - sine * r[0, 1])
    return f'<origin xyz="{_numbers(rigid[:3, 3])}" rpy="{_numbers((roll, pitch, yaw))}"/>'


def _numbers(values):
    return " ".join(repr(float(value)) for value in values)


class _Joint(NamedTuple):
    name: str
    prim: object
    parent: str
    child: str
    frame: numpy.ndarray  # of the joint in the parent link
    child_frame: numpy.ndarray  # of the joint in the child link
    reverse: bool  # body1 is the parent


class _Stage:
    def __init__(self, stage, missing_meshes):
        self.file = stage.GetRootLayer().identifier if isinstance(stage, Usd.Stage) else os.fspath(stage)
        if not isinstance(stage, Usd.Stage):
            if not os.path.exists(self.file):
                raise self.problem("", "no such file", "check the path")
            try:
                stage = Usd.Stage.Open(self.file)
            except Exception as error:  # pxr.Tf.ErrorException
                raise self.problem("", "cannot be opened: " + _reason(error), "give a stage of USD (.usd, .usda, .usdc, .usdz)") from None
        self.stage, self.notices, self.files = stage, [], []
        self.require_all_parts(missing_meshes)
        self.poses = UsdGeom.XformCache()  # default time
        scale = UsdGeom.GetStageMetersPerUnit(stage)
        if not (math.isfinite(scale) and scale > 0):
            raise self.problem("", f"metersPerUnit is {scale}", "give a number above 0, such as 1 or 0.01")
        self.to_metres = numpy.diag([scale, scale, scale, 1.0])
        if UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.y:
            self.to_metres = numpy.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]]) @ self.to_metres
        self.units = scale
        self.prims = list(Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies()))
        self.links, self.link_names, self.joint_names = {}, {WORLD}, set()  # links: path of a body -> its name
        for prim in self.prims:
            body = UsdPhysics.RigidBodyAPI(prim) if prim.HasAPI(UsdPhysics.RigidBodyAPI) else None
            if body and body.GetRigidBodyEnabledAttr().Get() is not False:
                self.links[prim.GetPath()] = self.fresh(prim, self.link_names)
        if not self.links:
            raise self.problem("", "has no prim with PhysicsRigidBodyAPI", "give the stage of a robot with UsdPhysics, or a URDF or MJCF of it")

    def require_all_parts(self, missing_meshes):
        """References, payloads and layers that are not there: their shapes would be missing without a word."""
        if missing_meshes not in ("refuse", "skip"):
            raise ValueError(f"missing_meshes is {missing_meshes!r}; give 'refuse' or 'skip'")
        errors = list(dict.fromkeys(str(error).strip().rstrip(".") for error in self.stage.GetCompositionErrors()))
        if errors and missing_meshes == "refuse":
            place = re.search(r"introduced by @[^@]*@<([^>]*)>", errors[0])
            raise self.problem(place[1] if place else "layers", errors[0] + (f", and {len(errors) - 1} more" if len(errors) > 1 else ""),
                "put the file where the stage looks for it, or read the rest by missing_meshes=\"skip\"")
        self.notices += ["LEFT OUT: " + error for error in errors]

    def problem(self, path, problem, remedy):
        error = InputError(": ".join(part for part in (self.file, str(path), f"{problem}; {remedy}") if part))
        error.file, error.element, error.problem, error.remedy = self.file, str(path), problem, remedy
        return error

    @staticmethod
    def fresh(prim, names):
        """A name of its own for a link or joint: the one that users see, if it has no blanks."""
        shown = prim.GetDisplayName()
        name = shown if shown and not re.search(r"\s", shown) else prim.GetName()
        if name in names:
            name = str(prim.GetPath()).strip("/").replace("/", "_")
        while name in names:
            name += "_"
        names.add(name)
        return name

    def matrix(self, prim):
        """From the prim's own frame to the world in metres, [4, 4] for columns."""
        matrix = self.to_metres @ numpy.array(self.poses.GetLocalToWorldTransform(prim)).T
        if not numpy.isfinite(matrix).all():
            raise self.problem(prim.GetPath(), "has a transform that is not finite, or stands in one", "correct its xformOps")
        size = numpy.linalg.norm(matrix[:3, :3])
        if not abs(numpy.linalg.det(matrix[:3, :3])) > FLAT * size**3:
            raise self.problem(prim.GetPath(), "has a transform that makes it flat, or stands in one", "give scales other than 0, or take its API off it")
        return matrix

    def body_of(self, prim):
        """The link that a prim is part of, by its path; None for the world."""
        while prim and not prim.IsPseudoRoot():
            if prim.GetPath() in self.links:
                return prim.GetPath()
            prim = prim.GetParent()
        return None

    def pose_of(self, body):
        return numpy.eye(4) if body is None else _rigid(self.matrix(self.stage.GetPrimAtPath(body)))[0]

    def name_of(self, body):
        return WORLD if body is None else self.links[body]

    # joints

    def end(self, joint, relation, position, rotation):
        """The body at an end of a joint, and the joint's frame in it."""
        path = joint.GetPrim().GetPath()
        targets = relation.GetTargets()
        if len(targets) > 1:
            raise self.problem(path, f"{relation.GetName()} names {len(targets)} prims", "name one")
        prim = self.stage.GetPrimAtPath(targets[0]) if targets else None
        if targets and not prim:
            raise self.problem(path, f"{relation.GetName()} names {targets[0]}, which is not there", "correct the path")
        body = self.body_of(prim) if prim else None
        given = position.Get() or Gf.Vec3f(0)
        quaternion = rotation.Get() or Gf.Quatf(1)
        q = numpy.array([quaternion.GetReal(), *quaternion.GetImaginary()], float)
        for attribute, value in ((position, given), (rotation, q)):
            if not numpy.isfinite(value).all():
                raise self.problem(path, f"{attribute.GetName()} is not finite", "correct it")
        if not numpy.linalg.norm(q) > 0:
            raise self.problem(path, f"{rotation.GetName()} is the zero quaternion", "write (1, 0, 0, 0) for no rotation")
        w, x, y, z = q / numpy.linalg.norm(q)
        placed = numpy.eye(4)
        matrix = self.matrix(prim) if prim else self.to_metres
        rigid = _rigid(matrix)[0]
        placed[:3, :3] = rigid[:3, :3] @ numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)], [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])
        placed[:3, 3] = matrix[:3, :3] @ numpy.array(given, float) + matrix[:3, 3]  # scales of the body move it
        return body, _inverse(self.pose_of(body)) @ placed

    def given_joints(self):
        """(prim, schema, ends) of each joint that is enabled."""
        found = []
        for prim in self.prims:
            if not prim.IsA(UsdPhysics.Joint):
                continue
            joint = UsdPhysics.Joint(prim)
            if joint.GetJointEnabledAttr().Get() is False:
                continue
            if prim.GetTypeName() not in ("PhysicsFixedJoint", "PhysicsRevoluteJoint", "PhysicsPrismaticJoint"):
                raise self.problem(prim.GetPath(), f"is a {prim.GetTypeName()}, which is not read", JOINTS_REMEDY)
            ends = (self.end(joint, joint.GetBody0Rel(), joint.GetLocalPos0Attr(), joint.GetLocalRot0Attr()),
                self.end(joint, joint.GetBody1Rel(), joint.GetLocalPos1Attr(), joint.GetLocalRot1Attr()))
            if ends[0][0] == ends[1][0]:
                raise self.problem(prim.GetPath(), f"has {self.name_of(ends[0][0])} at both ends", "name two bodies, or deactivate the prim")
            if any("PhysxMimicJoint" in schema for schema in self.schemas(prim)):
                self.notices.append(f"{prim.GetPath()}: follows another joint in the stage; here it is a joint of its own")
            found.append((prim, ends))
        return found

    @staticmethod
    def schemas(prim):
        """Names of the prim's API schemas, those of other vendors too."""
        listed = prim.GetMetadata("apiSchemas")
        return [*listed.prependedItems, *listed.explicitItems, *listed.appendedItems] if listed else []

    def tree(self):
        """Joints from the world outwards; bodies that no joint holds are fixed to the world first."""
        given = self.given_joints()
        held = {ends[1][0] for _, ends in given}
        roots = [path for path in self.links if path not in held]
        known, queue, used, joints, floating = {None}, [None], set(), [], []
        waiting = roots + [path for path in self.links if path in held]
        while True:
            while queue:
                body = queue.pop(0)
                for prim, ends in given:
                    side = 0 if ends[0][0] == body else 1 if ends[1][0] == body else None
                    if side is None or prim.GetPath() in used:
                        continue
                    used.add(prim.GetPath())
                    (_, frame), (child, child_frame) = ends[side], ends[1 - side]
                    if child in known:
                        raise self.problem(prim.GetPath(), f"closes a loop at {self.name_of(child)}: a robot is a tree of links",
                            "deactivate one joint of the loop (prim.SetActive(False))")
                    known.add(child)
                    queue.append(child)
                    joints.append(_Joint(self.fresh(prim, self.joint_names), prim, self.name_of(body), self.name_of(child), frame, child_frame, side == 1))
            waiting = [path for path in waiting if path not in known]
            if not waiting:
                break
            floating.append(waiting[0])
            known.add(waiting[0])
            queue.append(waiting[0])
        if floating:
            self.notices.append(f"bodies that no joint holds stand where the stage places them ({len(floating)}): " +
                ", ".join(str(path) for path in floating))
        return joints, floating

    def limits(self, joint):
        """(type, axis, lower, upper) in radians and metres."""
        revolute = joint.prim.GetTypeName() == "PhysicsRevoluteJoint"
        schema = (UsdPhysics.RevoluteJoint if revolute else UsdPhysics.PrismaticJoint)(joint.prim)
        axis = AXES[self.axis(schema.GetAxisAttr(), "X")] * (-1 if joint.reverse else 1)
        lower, upper = (attribute.Get() for attribute in (schema.GetLowerLimitAttr(), schema.GetUpperLimitAttr()))
        lower, upper = (-math.inf if lower is None else lower), (math.inf if upper is None else upper)
        path = joint.prim.GetPath()
        if math.isnan(lower) or math.isnan(upper) or lower > upper:
            raise self.problem(path, f"lower limit {lower} is above upper limit {upper}", "swap or correct them")
        bounded = [abs(value) < 1e30 for value in (lower, upper)]  # some exporters write the largest float for infinity
        if revolute and not any(bounded):
            return "continuous", axis, 0, 0
        if not all(bounded):
            raise self.problem(path, "has a limit on one side only" if any(bounded) else "slides without limits", "give both limits")
        unit = self.unit_of(joint.prim)
        return ("revolute" if revolute else "prismatic"), axis, lower * unit, upper * unit

    def axis(self, attribute, default):
        """X, Y or Z."""
        axis = attribute.Get() or default
        if axis not in AXES:
            raise self.problem(attribute.GetPrim().GetPath(), f"{attribute.GetName()} is {axis}", "give X, Y or Z")
        return axis

    def unit_of(self, prim):
        """Radians or metres of one unit of a joint."""
        return math.pi / 180 if prim.GetTypeName() == "PhysicsRevoluteJoint" else self.units

    def mimic(self, joint, names):
        """The rule of a NewtonMimicAPI: value = coef0 + coef1 * value of the other, in units of the stage. names: of joints by path."""
        if "NewtonMimicAPI" not in self.schemas(joint.prim):
            return ""
        path, relation = joint.prim.GetPath(), joint.prim.GetRelationship("newton:mimicJoint")
        targets = relation.GetTargets() if relation else []
        other = self.stage.GetPrimAtPath(targets[0]) if len(targets) == 1 else None
        if not other or other.GetPath() not in names or other.GetPath() == path or other.GetTypeName() == "PhysicsFixedJoint":
            raise self.problem(path, "follows none of the joints that move: newton:mimicJoint", "name one, or take NewtonMimicAPI off it")
        if other.GetTypeName() != joint.prim.GetTypeName():
            raise self.problem(path, f"follows {other.GetPath()}, a joint of another kind, by a factor without a unit",
                "let it follow one of its own kind, or take NewtonMimicAPI off it")
        offset, factor = (joint.prim.GetAttribute("newton:mimicCoef" + number) for number in "01")
        offset = offset.Get() if offset and offset.Get() is not None else 0.0
        factor = factor.Get() if factor and factor.Get() is not None else 1.0
        if not (math.isfinite(offset) and math.isfinite(factor)):
            raise self.problem(path, f"newton:mimicCoef0 and newton:mimicCoef1 are {offset} and {factor}", "give finite numbers")
        return (f'<mimic joint={quoteattr(names[other.GetPath()])} multiplier="{float(factor)!r}" ' +
            f'offset="{float(offset) * self.unit_of(joint.prim)!r}"/>')

    def joint_text(self, joint, names):
        """The joint, and where its child is not in its frame, a link between."""
        def text(name, kind, parent, child, frame, more=""):
            return (f'<joint name={quoteattr(name)} type="{kind}"><parent link={quoteattr(parent)}/><child link={quoteattr(child)}/>' +
                f"{_origin(frame)}{more}</joint>\n")

        rest = _inverse(joint.child_frame)
        if joint.prim.GetTypeName() == "PhysicsFixedJoint":
            return text(joint.name, "fixed", joint.parent, joint.child, joint.frame @ rest)
        kind, axis, lower, upper = self.limits(joint)
        speeds = [attribute.Get() for attribute in map(joint.prim.GetAttribute, ("newton:velocityLimit", "physxJoint:maxJointVelocity")) if attribute]
        speeds = [speed * self.unit_of(joint.prim) for speed in speeds if speed is not None and 0 < speed < 1e30]
        speed = f' velocity="{min(speeds)!r}"' if speeds else ""
        bounds = f' lower="{lower!r}" upper="{upper!r}"' if kind != "continuous" else ""
        more = f'<axis xyz="{_numbers(axis)}"/>' + (f"<limit{bounds}{speed}/>" if bounds or speed else "") + self.mimic(joint, names)
        if numpy.array_equal(rest, numpy.eye(4)):
            return text(joint.name, kind, joint.parent, joint.child, joint.frame, more)
        between = joint.name + "/moved"
        return (f"<link name={quoteattr(between)}/>\n" + text(joint.name, kind, joint.parent, between, joint.frame, more) +
            text(joint.name + "/child", "fixed", between, joint.child, rest))

    # shapes

    def shapes(self, folder):
        """Text of the collision elements by link."""
        found = {name: [] for name in (WORLD, *self.links.values())}
        for prim in self.prims:
            if not prim.HasAPI(UsdPhysics.CollisionAPI) or UsdPhysics.CollisionAPI(prim).GetCollisionEnabledAttr().Get() is False:
                continue
            if any(prim.GetPath().HasPrefix(prototype) for prototype in self.prototypes()):
                raise self.problem(prim.GetPath(), "collides and is a prototype of a PointInstancer, whose instances are not read",
                    "place the instances as prims of their own, or take CollisionAPI off it")
            body = self.body_of(prim)
            found[self.name_of(body)].append(self.shape(prim, _inverse(self.pose_of(body)) @ self.matrix(prim), folder))
        if not any(found.values()):
            raise self.problem("", "no prim has PhysicsCollisionAPI, enabled", "apply it to the shapes that collide")
        if any(prim.HasAPI(UsdPhysics.FilteredPairsAPI) for prim in self.prims):
            self.notices.append("filtered pairs are not used: allow them in an SRDF")
        return found

    def prototypes(self):
        return [path for prim in self.prims if prim.IsA(UsdGeom.PointInstancer) for path in UsdGeom.PointInstancer(prim).GetPrototypesRel().GetTargets()]

    def shape(self, prim, matrix, folder):
        """A <collision>. matrix: from the prim to its link."""
        path = prim.GetPath()
        if prim.IsA(UsdGeom.Mesh):
            return self.mesh(prim, matrix, folder)
        rigid, stretch = _rigid(matrix)
        scales = numpy.diag(stretch)
        if not numpy.allclose(stretch, numpy.diag(scales), rtol=0, atol=SAME * numpy.abs(scales).max()):
            raise self.problem(path, "is sheared", "make it a mesh, or scale it along its own axes")
        scales = numpy.abs(scales)

        def value(attribute):
            number = attribute.Get()
            if number is None or not math.isfinite(number) or number <= 0:
                raise self.problem(path, f"{attribute.GetName()} is {number}", "give a number above 0")
            return number

        def same(indices, what):
            if numpy.ptp(scales[indices]) > SAME * scales.max() * 100:
                raise self.problem(path, f"is scaled by {_numbers(scales)}: no {what}", "scale it evenly, or make it a mesh")
            return float(scales[indices].max())

        if prim.IsA(UsdGeom.Cube):
            geometry = f'<box size="{_numbers(scales * value(UsdGeom.Cube(prim).GetSizeAttr()))}"/>'
        elif prim.IsA(UsdGeom.Sphere):
            geometry = f'<sphere radius="{same([0, 1, 2], "sphere") * value(UsdGeom.Sphere(prim).GetRadiusAttr())!r}"/>'
        elif prim.IsA(UsdGeom.Cylinder) or prim.IsA(UsdGeom.Capsule):
            capsule = prim.IsA(UsdGeom.Capsule)
            schema = (UsdGeom.Capsule if capsule else UsdGeom.Cylinder)(prim)
            along = "XYZ".index(self.axis(schema.GetAxisAttr(), "Z"))
            across = [i for i in range(3) if i != along]
            radius = same([0, 1, 2] if capsule else across, "capsule" if capsule else "cylinder") * value(schema.GetRadiusAttr())
            length = float(scales[along]) * value(schema.GetHeightAttr())  # of a capsule: without its caps, as in URDF
            turn = numpy.eye(4)
            turn[:3, :3] = numpy.roll(numpy.eye(3), 2 - along, axis=1)  # z goes to the axis
            rigid = rigid @ turn
            geometry = f'<{"capsule" if capsule else "cylinder"} radius="{radius!r}" length="{length!r}"/>'
        else:
            raise self.problem(path, f"is a {prim.GetTypeName() or 'prim without type'} that collides, which is not read",
                "use a Cube, Sphere, Cylinder, Capsule or Mesh, or take CollisionAPI off it")
        return f"<collision>{_origin(rigid)}<geometry>{geometry}</geometry></collision>"

    def mesh(self, prim, matrix, folder):
        """The mesh as a file in the frame of its link; faces are cut into fans."""
        mesh, path = UsdGeom.Mesh(prim), prim.GetPath()
        points = mesh.GetPointsAttr().Get()
        counts, indices = (numpy.array(attribute.Get() or [], int) for attribute in (mesh.GetFaceVertexCountsAttr(), mesh.GetFaceVertexIndicesAttr()))
        points = numpy.array(points if points is not None else [], float).reshape(-1, 3)
        if not len(counts) or (counts < 3).any() or counts.sum() != len(indices) or (indices < 0).any() or (indices >= len(points)).any():
            raise self.problem(path, "has faces that are none of its points", "repair the mesh")
        if prim.HasAPI(UsdPhysics.MeshCollisionAPI):
            kind = UsdPhysics.MeshCollisionAPI(prim).GetApproximationAttr().Get()
            if kind not in (None, "none"):
                self.notices.append(f"{path}: the mesh itself is used, not its approximation {kind}")
        if not numpy.isfinite(points).all():
            raise self.problem(path, f"point {int(numpy.argmin(numpy.isfinite(points).all(axis=1)))} is not finite", "repair the mesh")
        moved = points @ matrix[:3, :3].T + matrix[:3, 3]
        lines = [f"v {_numbers(point)}" for point in moved]
        start = 0
        for count in counts:
            face = indices[start:start + count] + 1
            lines += [f"f {face[0]} {face[i]} {face[i + 1]}" for i in range(1, count - 1)]
            start += count
        name = f"{len(self.files) + 1}_{re.sub('[^A-Za-z0-9_]', '_', prim.GetName())[:100]}.obj"
        self.files.append(name)
        (folder / "meshes").mkdir(parents=True, exist_ok=True)
        (folder / "meshes" / name).write_text("\n".join(lines) + "\n")
        return f'<collision><geometry><mesh filename="meshes/{name}"/></geometry></collision>'

    def write(self, folder):
        folder.mkdir(parents=True, exist_ok=True)
        joints, floating = self.tree()
        shapes = self.shapes(folder)
        default = self.stage.GetDefaultPrim()
        text = f'<?xml version="1.0"?>\n<robot name={quoteattr(default.GetName() if default else pathlib.Path(self.file).stem)}>\n'
        for name, elements in shapes.items():
            text += f"<link name={quoteattr(name)}>{''.join(elements)}</link>\n" if elements else f"<link name={quoteattr(name)}/>\n"
        for path in floating:
            name = quoteattr(self.links[path] + "/fixed")
            text += (f'<joint name={name} type="fixed"><parent link="{WORLD}"/><child link={quoteattr(self.links[path])}/>' +
                f"{_origin(self.pose_of(path))}</joint>\n")
        names = {joint.prim.GetPath(): joint.name for joint in joints}
        for joint in joints:
            text += self.joint_text(joint, names)
        urdf = folder / "robot.urdf"
        urdf.write_text(text + "</robot>\n", encoding="utf-8")
        return Converted(str(urdf), self.notices)
