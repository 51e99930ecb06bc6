#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""From VAMP, cuRobo and others that plan on spheres: spheres with a proof, and paths judged on the meshes.

    python from_vamp.py [PATH.json]     # a list of states, each a list of joint values; without one, a path is planned on the spheres

Spheres: `leeway spherize --robot arm.urdf --excess 10 --out spheres` writes a URDF, an SRDF and a YAML; `Robot.spheres()` gives the same
numbers. They enclose each link, so a path that is free on them is free on the meshes; spheres made by hand need not, which
`leeway.check_spheres()` proves or refutes. Paths of sphere planners are sampled: `judge()` looks at every edge as a whole.
"""
import json
import pathlib
import sys
import xml.etree.ElementTree

import numpy

import leeway

first = pathlib.Path(__file__).resolve().parents[1] / "first"


def robot_of_spheres(urdf, srdf, excess):
    """The robot with its collision geometry replaced by enclosing spheres, and their number."""
    spheres = leeway.Robot(urdf, srdf).spheres(excess=excess)
    root = xml.etree.ElementTree.parse(urdf).getroot()
    for link in root.iter("link"):
        for collision in link.findall("collision"):
            link.remove(collision)
        for x, y, z, r in spheres[link.get("name")].spheres if link.get("name") in spheres else ():
            collision = xml.etree.ElementTree.SubElement(link, "collision")
            xml.etree.ElementTree.SubElement(collision, "origin", xyz=f"{x} {y} {z}")
            geometry = xml.etree.ElementTree.SubElement(collision, "geometry")
            xml.etree.ElementTree.SubElement(geometry, "sphere", radius=str(r))
    return leeway.Robot(xml.etree.ElementTree.tostring(root, encoding="unicode"), srdf), sum(len(s.spheres) for s in spheres.values())


def judge(checker, path):
    """Verdict of each edge on the real shapes: where the first one that is not free collides, and by how much."""
    edges = checker.path(path)
    for i in numpy.flatnonzero(~edges.free):
        names = " and ".join(checker.names[edges.pairs[i]])
        return f"edge {i} is {leeway.Verdict(edges.verdicts[i]).name} at t = {edges.t[i]:.3f}: {names}, clearance {edges.clearance[i] * 1000:.2f} mm"
    return f"free, proved: at least {edges.lower.min() * 1000:.2f} mm everywhere"


def main():
    urdf, srdf, scene = first / "arm.urdf", first / "arm.srdf", leeway.Scene(first / "scene.yaml")
    meshes = leeway.Checker(leeway.Robot(urdf, srdf), scene, group="arm")
    if len(sys.argv) > 1:
        print(judge(meshes, numpy.array(json.loads(pathlib.Path(sys.argv[1]).read_text()))))
        return
    robot, count = robot_of_spheres(urdf, srdf, 0.01)
    on_spheres = leeway.Checker(robot, scene, group="arm")
    left, right = numpy.array([0.9, 0.9, 0.9, 0.0]), numpy.array([-0.9, 0.9, 0.9, 0.0])
    plan = on_spheres.plan(left, right, seconds=5)
    assert plan.solved, plan.message
    print(f"{count} spheres; path on spheres, on the meshes: {judge(meshes, plan.path)}")
    assert meshes.path(plan.path).all_free
    straight = judge(meshes, numpy.array([left, right]))
    print(f"the straight edge: {straight}")
    assert "BLOCKED" in straight


if __name__ == "__main__":
    main()
