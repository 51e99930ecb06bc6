# SPDX-License-Identifier: BSD-3-Clause
"""Distances of random convex hulls as MuJoCo compiles them: against separating planes, and against mj_geomDistance, which once returned 0 for
hulls that are apart. LEEWAY_HULL_PAIRS sets the number of pairs."""
import os

import numpy
import pytest

import leeway

if os.environ.get("LEEWAY_PYTHON_EXTRAS") != "required":
    pytest.importorskip("mujoco")
    pytest.importorskip("scipy")
import mujoco
import scipy.spatial

COUNT = int(os.environ.get("LEEWAY_HULL_PAIRS", "300"))


def hull(rng):
    """Vertices and triangles, seen from outside anticlockwise."""
    points = rng.normal(size=(int(rng.integers(8, 60)), 3))
    points *= rng.uniform(0.02, 0.2, 3) * rng.uniform(0.7, 1, (len(points), 1)) / numpy.linalg.norm(points, axis=1)[:, None]
    found = scipy.spatial.ConvexHull(points)
    triangles = numpy.searchsorted(numpy.sort(found.vertices), found.simplices)
    vertices = points[numpy.sort(found.vertices)]
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    inwards = (numpy.cross(b - a, c - a) * (a - vertices.mean(axis=0))).sum(axis=1) < 0
    triangles[inwards] = triangles[inwards][:, [0, 2, 1]]
    return vertices, triangles


def pair(rng):
    """MuJoCo's model of two hulls, and shapes and poses as it has them."""
    spec = mujoco.MjSpec()
    for name, reach in (("a", 0), ("b", 0.35)):
        vertices, triangles = hull(rng)
        turn = rng.normal(size=4)
        spec.add_mesh(name=name, uservert=vertices.ravel(), userface=triangles.ravel())
        body = spec.worldbody.add_body(name=name, pos=rng.uniform(-reach, reach, 3), quat=turn / numpy.linalg.norm(turn))
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    placed = []
    for g in range(2):
        mesh = model.mesh(model.geom_dataid[g])
        vertices = model.mesh_vert[mesh.vertadr[0]:mesh.vertadr[0] + mesh.vertnum[0]].astype(float)
        triangles = model.mesh_face[mesh.faceadr[0]:mesh.faceadr[0] + mesh.facenum[0]]
        pose = numpy.eye(4)
        pose[:3, :3], pose[:3, 3] = data.geom_xmat[g].reshape(3, 3), data.geom_xpos[g]
        placed.append((leeway.Shape.mesh(vertices, triangles, solid=True), pose, vertices @ pose[:3, :3].T + pose[:3, 3]))
    return model, data, placed


def test_hulls_that_a_plane_parts_are_apart():
    rng = numpy.random.default_rng(3383)
    apart = zeros = 0
    for number in range(COUNT):
        model, data, ((a, pose_a, corners_a), (b, pose_b, corners_b)) = pair(rng)
        found = leeway.distance(a, pose_a, b, pose_b)
        mujoco_says = mujoco.mj_geomDistance(model, data, 0, 1, 2.0, None)
        if found.upper == 0:
            assert mujoco_says < 1e-6, f"pair {number}: leeway says contact"
            continue
        # independent of both: dot products along the direction of the witnesses bound the distance from below
        direction = (found.witnesses[0] - found.witnesses[1]) / found.upper
        gap = (corners_a @ direction).min() - (corners_b @ direction).max()
        assert abs(gap - found.upper) < 1e-12 and found.lower <= gap + 1e-12 and found.upper - found.lower < 1e-9, f"pair {number}"
        apart += 1
        zeros += mujoco_says <= 0
        assert mujoco_says <= 0 or abs(mujoco_says - found.upper) < 1e-6, f"pair {number}"
    assert apart > COUNT // 2
    print(f"{apart} of {COUNT} pairs are apart; mj_geomDistance of MuJoCo {mujoco.__version__} is 0 for {zeros} of them, leeway.distance() for none")
