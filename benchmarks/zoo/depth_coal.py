#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Penetration depths of random convex pairs beside those of Coal's EPA.

    PYTHONPATH=build/python build/zoo/venv/bin/python benchmarks/zoo/depth_coal.py [--pairs N] [--seed S]

Boxes, spheres, capsules, cylinders, cones and hulls of points, of 0.1 to 1 m, at random poses near each other. Coal's depth is compared with leeway's
interval. Where it is outside by more than 1e-6 m, both claims are tried: a body moved by a way out has to be apart, by leeway's and by Coal's
distance. Exit status 1: one of leeway's claims is wrong by either."""
import argparse
import collections
import sys

import coal
import numpy

import leeway

TOLERANCE = 1e-6
TYPES = ("box", "sphere", "capsule", "cylinder", "cone", "hull")


def random_shape(rng):
    """The same body of both libraries."""
    kind = rng.choice(TYPES)
    x, y, z = rng.uniform(0.1, 1, 3)
    if kind == "box":
        return kind, leeway.Shape.box(x, y, z), coal.Box(x, y, z)
    if kind == "sphere":
        return kind, leeway.Shape.sphere(x / 2), coal.Sphere(x / 2)
    if kind == "capsule":
        return kind, leeway.Shape.capsule(x / 2, y), coal.Capsule(x / 2, y)
    if kind == "cylinder":
        return kind, leeway.Shape.cylinder(x / 2, y), coal.Cylinder(x / 2, y)
    if kind == "cone":
        return kind, leeway.Shape.cone(x / 2, y), coal.Cone(x / 2, y)
    points = rng.normal(size=(rng.integers(6, 40), 3))
    points *= numpy.array([x, y, z]) / 2 / numpy.linalg.norm(points, axis=1)[:, None]
    vertices = coal.StdVec_Vec3s()
    for point in points:
        vertices.append(point)
    hull = coal.Convex.convexHull(vertices, True, "Qt")
    faces = [[hull.polygons(i)[k] for k in range(3)] for i in range(hull.num_polygons)]
    return kind, leeway.Shape.mesh(hull.points().reshape(-1, 3).copy(), numpy.array(faces, dtype=numpy.uint32), solid=True), hull


def random_pose(rng):
    q = rng.normal(size=4)
    return numpy.concatenate([rng.uniform(-0.4, 0.4, 3), q / numpy.linalg.norm(q)])


def transform(pose):
    x, y, z, w = pose[3:]
    rotation = numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])
    return coal.Transform3s(rotation, pose[:3])


def coal_distance(a, pose_a, b, pose_b):
    """Signed distance, and the direction from a to b."""
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    request.enable_signed_distance = True
    request.gjk_tolerance = request.epa_tolerance = 1e-9
    request.gjk_max_iterations, request.epa_max_iterations = 512, 512
    distance = coal.distance(a, transform(pose_a), b, transform(pose_b), request, result)
    return distance, numpy.array(result.normal)


def moved(pose, step):
    out = pose.copy()
    out[:3] += step
    return out


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--pairs", type=int, default=20000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    rng = numpy.random.default_rng(options.seed)
    counts, worst, widest, wrong = collections.Counter(), 0.0, 0.0, 0
    while counts["overlap"] < options.pairs:
        (kind_a, a, coal_a), (kind_b, b, coal_b) = random_shape(rng), random_shape(rng)
        pose_a, pose_b = random_pose(rng), random_pose(rng)
        depth = leeway.depth(a, pose_a, b, pose_b)
        if depth.kind != leeway.DepthKind.OVERLAP:
            continue
        counts["overlap"] += 1
        widest = max(widest, depth.upper - depth.lower)
        signed, normal = coal_distance(coal_a, pose_a, coal_b, pose_b)
        off = max(depth.lower + signed, -signed - depth.upper)
        if off <= TOLERANCE:
            worst = max(worst, off)
            continue
        # ours is a way out by Coal's distance, too, and theirs is none that is shorter than ours
        ours = coal_distance(coal_a, moved(pose_a, depth.normal * (depth.upper + TOLERANCE)), coal_b, pose_b)[0] > 0
        answers = numpy.isfinite(normal).all() and abs(signed) < 1e3
        theirs = answers and leeway.distance(a, moved(pose_a, -normal * (-signed + TOLERANCE)), b, pose_b).lower > 0
        shorter = -signed + TOLERANCE < depth.lower
        if shorter and theirs or not ours:
            wrong += 1
            print(f"leeway is wrong: {kind_a}, {kind_b}: [{depth.lower}, {depth.upper}], Coal {-signed}")
        counts["Coal: no answer" if not answers else "Coal: no way out" if not theirs else "Coal: too long" if not shorter else "Coal: other"] += 1
    print(f"{counts['overlap']} overlaps, widest interval {widest:.1e} m; Coal within it to {worst:.1e} m, but for")
    for name, count in sorted(counts.items()):
        if name != "overlap":
            print(f"  {name}: {count}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
