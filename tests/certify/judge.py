# SPDX-License-Identifier: BSD-3-Clause
"""Samples the claim of a certificate: is a pair nearer than it says, at any of many times and deviations? Kinematics by 4 x 4 matrices;
distances by leeway's Python package, which shares no code with the checkers."""
import math

import numpy

import leeway

TIMES, DEVIATIONS, ROUNDING = 60, 4, 1e-9
TRIANGLES, BALLS, BOXES, CYLINDER, CAPSULE, CONE, HALFSPACE, PLANE = range(1, 9)


def matrix_of(pose):
    x, y, z, w = numpy.array(pose[3:]) / numpy.linalg.norm(pose[3:])
    out = numpy.eye(4)
    skew = numpy.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    out[:3, :3] += 2 * w * skew + 2 * skew @ skew
    out[:3, 3] = pose[:3]
    return out


def joint_matrix(link, value):
    out = numpy.eye(4)
    if link["type"] == 0:
        return out
    x, y, z = axis = numpy.array(link["axis"]) / numpy.linalg.norm(link["axis"])
    if link["type"] == 2:
        out[:3, 3] = value * axis
        return out
    skew = numpy.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    out[:3, :3] += numpy.sin(value) * skew + (1 - numpy.cos(value)) * skew @ skew
    return out


def poses_of(content, q):
    poses = []
    for number, link in enumerate(content["links"]):
        value = 0
        if link["type"]:
            value = link["offset"] + (link["multiplier"] * q[link["variable"]] if link["variable"] is not None else 0)
        local = matrix_of(link["origin"]) @ joint_matrix(link, value)
        poses.append(poses[link["parent"]] @ local if number else local)
    return poses


def shape_of(shape):
    """Of leeway; with the radius that its distances are to be lessened by."""
    kind, numbers = shape["kind"], numpy.array(shape["numbers"])
    if kind == TRIANGLES:
        return leeway.Shape.mesh(numbers.reshape(-1, 3), numpy.array(shape["corners"], numpy.uint32).reshape(-1, 3), solid=shape["solid"]), shape["radius"]
    if kind == BALLS:
        return leeway.Shape.spheres(numbers.reshape(-1, 4)), 0
    if kind == BOXES:
        return leeway.Shape.boxes(numbers.reshape(-1, 6)), 0
    if kind == HALFSPACE:
        return leeway.Shape.halfspace(), 0
    if kind == PLANE:
        return leeway.Shape.plane(), 0
    make = {CYLINDER: leeway.Shape.cylinder, CAPSULE: leeway.Shape.capsule, CONE: leeway.Shape.cone}[kind]
    return make(max(shape["radius"], 1e-9), max(shape["height"], 1e-9)), 0


def above(content, link):
    """Joints with a variable between a link and the root."""
    found = set()
    while link:
        if content["links"][link]["type"] and content["links"][link]["variable"] is not None:
            found.add(link)
        link = content["links"][link]["parent"]
    return found


def pairs_of(content):
    listed = {(r["object"], *((r["a"], r["b"]) if r["object"] else sorted((r["a"], r["b"])))) for r in content["allowed"]}
    margins = {}
    for r in content["margins"]:
        key = (r["object"], *((r["a"], r["b"]) if r["object"] else sorted((r["a"], r["b"]))))
        margins[key] = max(margins.get(key, 0), r["margin"])
    bodies = content["bodies"]
    for i, a in enumerate(bodies):
        for b in content["obstacles"] if content["claims"] & 1 else []:
            key = (1, a["owner"], b["owner"])
            if key not in listed:
                yield a, b, True, margins.get(key, 0)
        for b in bodies[i + 1:] if content["claims"] & 2 else []:
            key = (0, *sorted((a["owner"], b["owner"])))
            if key not in listed and above(content, a["owner"]) != above(content, b["owner"]):
                yield a, b, False, margins.get(key, 0)


def bezier(points, t):
    points = [numpy.array(p) for p in points]
    while len(points) > 1:
        points = [(1 - t) * a + t * b for a, b in zip(points, points[1:])]
    return points[0]


def states(content, rng):
    last = content["start"]
    tolerance = numpy.array([v["tolerance"] for v in content["variables"]])
    for piece in content["pieces"]:
        points = [last, *piece]
        last = piece[-1]
        for i in range(TIMES):
            q = bezier(points, i / (TIMES - 1))
            yield q
            for _ in range(DEVIATIONS if tolerance.any() else 0):
                yield q + tolerance * numpy.array([rng.choice([-1, 1, rng.uniform(-1, 1)]) for _ in tolerance])


class Side:
    """A body or an obstacle: its shape, and a sphere around it."""

    def __init__(self, shape, pose):
        self.shape, self.less = shape
        self.pose = matrix_of(pose)
        low, high = numpy.clip(self.shape.bounds, -1e9, 1e9)
        self.middle, self.radius = numpy.append((low + high) / 2, 1), float(numpy.linalg.norm(high - low) / 2) + self.less

    def at(self, world):
        pose = world @ self.pose
        return pose, (pose @ self.middle).tolist()


def contradiction(content, rng):
    """A sentence about a pair that is nearer than the certificate claims; None if the samples know none."""
    shapes = [shape_of(s) for s in content["shapes"]]
    sides = {id(p): Side(shapes[p["shape"]], p["pose"]) for p in content["bodies"] + content["obstacles"]}
    resting = {id(p): sides[id(p)].at(numpy.eye(4)) for p in content["obstacles"]}
    pairs = [(a, b, sides[id(a)], sides[id(b)], margin) for a, b, _, margin in pairs_of(content)]
    for q in states(content, rng):
        poses = poses_of(content, q)
        places = {**resting, **{id(p): sides[id(p)].at(poses[p["owner"]]) for p in content["bodies"]}}
        for a, b, side_a, side_b, margin in pairs:
            (world_a, middle_a), (world_b, middle_b), need = places[id(a)], places[id(b)], content["min_d"] + margin - ROUNDING
            if math.dist(middle_a, middle_b) - side_a.radius - side_b.radius >= need:
                continue
            found = leeway.distance(side_a.shape, world_a, side_b.shape, world_b)
            if found.upper - side_a.less - side_b.less < need:
                return f"body of link {a['owner']} and that of {b['owner']} are {found.upper:.9g} apart at {q.tolist()}"
    return None
