# SPDX-License-Identifier: BSD-3-Clause
"""Least self distance by pinocchio + coal. Runs in the zoo's own Python environment: oracle.py QUESTION ANSWER.

QUESTION: {"urdf", "names" (variables), "states" (rows), "sorting": n}. In the first n states every pair of links is
tested, and those in contact in more than half of them are disabled. ANSWER: {"disabled", "pairs", "answers": [{"distance",
"pair"}]} for the others, or {"error"}. A state in contact has distance 0 and the first pair that was found.
"""
import collections
import json
import pathlib
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

import coal
import numpy
import pinocchio

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from descriptions import number, resolve  # noqa: E402


def read_model(urdf):
    """Mesh names are made absolute first: pinocchio wants folders for its packages, and has no rule for relative ones."""
    tree = ElementTree.fromstring(urdf.read_bytes().decode("utf-8", "replace").strip().strip("\0"))
    for mesh in tree.iter("mesh"):
        mesh.set("filename", resolve(urdf, mesh.get("filename", "")))
    mimics = {joint.get("name"): joint.find("mimic") for joint in tree.findall("joint") if joint.find("mimic") is not None}
    with tempfile.NamedTemporaryFile("wb", suffix=".urdf") as file:
        file.write(ElementTree.tostring(tree))
        file.flush()
        model = pinocchio.buildModelFromUrdf(file.name)
        geometry = pinocchio.buildGeomFromUrdf(model, file.name, pinocchio.GeometryType.COLLISION)
    for thing in geometry.geometryObjects:
        if thing.meshPath.lower().endswith(".obj"):
            thing.geometry = read_obj(thing.meshPath, numpy.array(thing.meshScale).reshape(3))
    geometry.addAllCollisionPairs()
    return model, geometry, mimics


def read_obj(path, scale):
    """Triangles of a Wavefront file. Coal's own reading goes wrong where Blender left loose edges ("l" lines): it loses
    contacts of pybullet's Panda, 15 mm beside triangles that cross."""
    corners, triangles = [], []
    for line in pathlib.Path(path).read_text(errors="replace").splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            corners.append([float(word) for word in words[1:4]])
        elif words[:1] == ["f"]:
            face = [int(word.split("/")[0]) for word in words[1:]]
            face = [i - 1 if i > 0 else len(corners) + i for i in face]
            triangles += [(face[0], face[i], face[i + 1]) for i in range(1, len(face) - 1)]
    mesh = coal.BVHModelOBBRSS()
    mesh.beginModel(len(triangles), len(corners))
    mesh.addVertices(numpy.array(corners) * scale)
    mesh.addTriangles(numpy.array(triangles))
    mesh.endModel()
    return mesh


def configuration(model, mimics, values):
    q = pinocchio.neutral(model)

    def value(name, depth=0):
        if name in mimics and depth < 10:
            mimic = mimics[name]
            return number(mimic.get("multiplier"), 1.0) * value(mimic.get("joint"), depth + 1) + number(mimic.get("offset"), 0.0)
        return values.get(name, 0.0)

    for i in range(1, model.njoints):
        joint = model.joints[i]
        if joint.nq == 1:
            q[joint.idx_q] = value(model.names[i])
        elif joint.nq == 2:  # without limits: cosine and sine
            q[joint.idx_q], q[joint.idx_q + 1] = numpy.cos(value(model.names[i])), numpy.sin(value(model.names[i]))
        else:
            raise ValueError(f"joint {model.names[i]} has {joint.nq} variables")
    return q


class Pairs:
    def __init__(self, model, geometry):
        objects = geometry.geometryObjects
        self.links = [model.frames[o.parentFrame].name for o in objects]
        self.shapes = [o.geometry for o in objects]
        for shape in self.shapes:
            shape.computeLocalAABB()
        self.centers = numpy.array([shape.aabb_center for shape in self.shapes])
        self.radii = numpy.array([shape.aabb_radius for shape in self.shapes])
        pairs = [(p.first, p.second) for p in geometry.collisionPairs]
        self.pairs = [(a, b) for a, b in pairs if self.links[a] != self.links[b]]

    def names(self, pair):
        return tuple(sorted((self.links[pair[0]], self.links[pair[1]])))

    def place(self, poses):
        self.poses = [coal.Transform3s(numpy.array(pose.rotation), numpy.array(pose.translation)) for pose in poses]
        world = numpy.array([pose.act(center) for pose, center in zip(poses, self.centers)])
        first, second = numpy.array(self.pairs).T
        gaps = numpy.linalg.norm(world[first] - world[second], axis=1) - self.radii[first] - self.radii[second]
        order = numpy.argsort(gaps)
        return [(gaps[i], self.pairs[i]) for i in order]

    def touch(self, pair):
        a, b = pair
        request, result = coal.CollisionRequest(), coal.CollisionResult()
        return coal.collide(self.shapes[a], self.poses[a], self.shapes[b], self.poses[b], request, result) > 0

    def distance(self, pair):
        a, b = pair
        request, result = coal.DistanceRequest(), coal.DistanceResult()
        request.gjk_tolerance, request.gjk_max_iterations = 1e-9, 1000
        return coal.distance(self.shapes[a], self.poses[a], self.shapes[b], self.poses[b], request, result)


def in_contact_by_design(pairs, placements):
    counts = collections.Counter()
    for poses in placements:
        touching = {pairs.names(pair) for gap, pair in pairs.place(poses) if gap <= 0 and pairs.touch(pair)}
        counts.update(touching)
    return sorted(names for names, count in counts.items() if 2 * count > len(placements))


def least(pairs, poses):
    best, named = float("inf"), ("", "")
    for gap, pair in pairs.place(poses):
        if gap >= best:
            break
        distance = pairs.distance(pair)
        # Distances of touching meshes are 0 or below; the yes or no of two solids is collide's.
        if distance < 1e-5 and pairs.touch(pair):
            return 0.0, pairs.names(pair)
        if distance < best:
            best, named = max(distance, 0.0), pairs.names(pair)
    return best, named


def answer(question):
    model, geometry, mimics = read_model(pathlib.Path(question["urdf"]))
    data, geometry_data = model.createData(), geometry.createData()

    def poses(state):
        q = configuration(model, mimics, dict(zip(question["names"], state)))
        pinocchio.updateGeometryPlacements(model, data, geometry, geometry_data, q)
        return [pose.copy() for pose in geometry_data.oMg]

    pairs = Pairs(model, geometry)
    if not pairs.pairs:
        return {"error": "no pairs of links"}
    sorting = question["sorting"]
    disabled = in_contact_by_design(pairs, [poses(state) for state in question["states"][:sorting]])
    forbidden = set(disabled)
    pairs.pairs = [pair for pair in pairs.pairs if pairs.names(pair) not in forbidden]
    if not pairs.pairs:
        return {"error": "every pair is in contact in most states"}
    answers = []
    for state in question["states"][sorting:]:
        distance, named = least(pairs, poses(state))
        answers.append({"distance": distance, "pair": named})
    return {"disabled": disabled, "pairs": len(pairs.pairs), "answers": answers}


def main():
    question = json.loads(pathlib.Path(sys.argv[1]).read_text())
    try:
        result = answer(question)
    except Exception as error:  # whatever the two libraries refuse is told in the table
        result = {"error": f"{type(error).__name__}: {error}"}
    pathlib.Path(sys.argv[2]).write_text(json.dumps(result))


if __name__ == "__main__":
    main()
