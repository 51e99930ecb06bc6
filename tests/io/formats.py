#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compares poses of xacro and SDF models with kinematics of this file at random states.

    PYTHONPATH=build/python formats.py [--states 100] [--table rows.md] [--package NAME=FOLDER]... FOLDER...

Below each folder: every .xacro file, expanded by xacro for the reference too, and every .sdf file (links without relative_to, as versions
up to 1.6 write them). A model is equal if all poses of all links differ by less than 1e-9, refused if leeway names a reason, a part if a
xacro file has no link. Exit status 1 if a model differs.
"""
import argparse
import collections
import math
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

import numpy

import leeway

LIMIT = 1e-9


def numbers(text, default="0 0 0"):
    return [float(word) for word in (text or default).split()]


def turn(axis, angle):
    """Rodrigues' formula."""
    x, y, z = numpy.asarray(axis, float) / numpy.linalg.norm(axis)
    cross = numpy.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    result = numpy.eye(4)
    result[:3, :3] += math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    return result


def placed(xyz, rpy):
    result = turn((0, 0, 1), rpy[2]) @ turn((0, 1, 0), rpy[1]) @ turn((1, 0, 0), rpy[0])
    result[:3, 3] = xyz
    return result


def slide(axis, value):
    result = numpy.eye(4)
    result[:3, 3] = numpy.asarray(axis) / numpy.linalg.norm(axis) * value
    return result


def of_urdf(text):
    """poses(values) of a URDF: link -> [4, 4]."""
    root = ElementTree.fromstring(text)
    joints = {joint.find("child").get("link"): joint for joint in root.findall("joint")}
    names = [link.get("name") for link in root.findall("link")]

    def motion(joint, values):
        kind, mimic = joint.get("type"), joint.find("mimic")
        if kind == "fixed":
            return numpy.eye(4)
        name = joint.get("name") if mimic is None else mimic.get("joint")
        value = values[name]
        if mimic is not None:
            value = float(mimic.get("multiplier", 1)) * value + float(mimic.get("offset", 0))
        axis = numbers(joint.find("axis").get("xyz")) if joint.find("axis") is not None else [1, 0, 0]
        return slide(axis, value) if kind == "prismatic" else turn(axis, value)

    def poses(values):
        found = {}

        def pose(link):
            if link not in found:
                joint = joints.get(link)
                if joint is None:
                    found[link] = numpy.eye(4)
                else:
                    origin = joint.find("origin")
                    get = (lambda key: numbers(origin.get(key))) if origin is not None else lambda key: [0, 0, 0]
                    found[link] = pose(joint.find("parent").get("link")) @ placed(get("xyz"), get("rpy")) @ motion(joint, values)
            return found[link]

        return {name: pose(name) for name in names}

    return poses


def pose_element(element):
    found = numbers(element.findtext("pose"), "0 0 0 0 0 0")
    return placed(found[:3], found[3:])


def of_sdf(file):
    """poses(values) of models whose links and joints are placed in the model and the child link."""
    root = ElementTree.parse(file).getroot()
    world = root.find("world")
    version = [int(part) for part in root.get("version").split(".")]
    zero, joints = {}, {}
    for model in (root if world is None else world).findall("model"):
        scope, base = ("" if world is None else model.get("name") + "::"), pose_element(model)
        for link in model.findall("link"):
            zero[scope + link.get("name")] = base @ pose_element(link)
        given = model.findall("joint")
        for joint in [j for j in given if j.get("type") not in ("screw", "gearbox")]:
            joints.setdefault(scope + joint.findtext("child"), (joint, scope, base))

    def motion(joint, scope, values, in_model):
        """In the frame of the joint. in_model: the rotation from the model to it."""
        name = scope + joint.get("name")
        if joint.get("type") == "ball":
            return turn((1, 0, 0), values[name + "_x"]) @ turn((0, 1, 0), values[name + "_y"]) @ turn((0, 0, 1), values[name + "_z"])
        result = numpy.eye(4)
        for number, key in enumerate(("axis", "axis2"), 1):
            axis = joint.find(key)
            if axis is None or (key == "axis2" and joint.get("type") not in ("universal", "revolute2")):
                continue
            xyz = numpy.array(numbers(axis.findtext("xyz"), "0 0 1"))
            of_model = version < [1, 5] or axis.findtext("use_parent_model_frame", "0").strip() in ("1", "true")
            xyz = in_model @ xyz if of_model else xyz
            variable = f"{name}/{number}" if joint.get("type") in ("universal", "revolute2") else name
            result = result @ (slide if joint.get("type") == "prismatic" else turn)(xyz, values[variable])
        return result

    def poses(values):
        found = {}

        def pose(link):
            if link not in found:
                joint, scope, base = joints.get(link, (None, "", None))
                if joint is None:
                    found[link] = zero[link]
                    return found[link]
                frame = zero[link] @ pose_element(joint)
                parent = joint.findtext("parent")
                before = numpy.eye(4) if parent == "world" else numpy.linalg.inv(zero[scope + parent])
                above = numpy.eye(4) if parent == "world" else pose(scope + parent)
                moved = numpy.eye(4) if joint.get("type") == "fixed" else \
                    motion(joint, scope, values, frame[:3, :3].T @ base[:3, :3])
                found[link] = above @ before @ frame @ moved @ numpy.linalg.inv(frame) @ zero[link]
            return found[link]

        return {name: pose(name) for name in zero}

    return poses


PACKAGES = """import os, sys
def get_package_share_directory(name):
    for entry in os.environ["FORMATS_PACKAGES"].split("\\n"):
        if entry.split("=")[0] == name:
            return entry.split("=", 1)[1]
    folder = os.environ["FORMATS_FOLDER"]
    while os.path.basename(folder) != name and not os.path.isdir(os.path.join(folder, name)):
        if folder == os.path.dirname(folder):
            raise LookupError(name)
        folder = os.path.dirname(folder)
    return folder if os.path.basename(folder) == name else os.path.join(folder, name)
"""


def expanded(path, packages):
    """What xacro alone makes of a file, with packages by name or from the folders above."""
    with tempfile.TemporaryDirectory() as folder:
        stub = pathlib.Path(folder, "ament_index_python")
        stub.mkdir()
        (stub / "__init__.py").write_text("")
        (stub / "packages.py").write_text(PACKAGES)
        variables = {**os.environ, "PYTHONPATH": folder, "FORMATS_PACKAGES": "\n".join(packages), "FORMATS_FOLDER": str(path.parent.resolve())}
        return subprocess.run(["xacro", str(path)], capture_output=True, check=True, env=variables).stdout


def compare(path, packages, states):
    """A row: result, links, pose, reason."""
    xacro = path.suffix == ".xacro"
    try:
        robot = leeway.Robot(path, packages=packages, **({"xacro": {}} if xacro else {}))
    except leeway.InputError as error:
        reason = str(error).replace(str(path) + ": ", "").replace(shutil.which("xacro") or "xacro", "xacro")
        return {"result": "part" if "macros only" in reason else "refused", "reason": reason}
    poses = of_urdf(expanded(path, packages)) if xacro else of_sdf(path)
    rng, worst, links = numpy.random.default_rng(20261125), 0.0, 0
    for _ in range(states):
        q = rng.uniform(numpy.maximum(robot.lower, -10), numpy.minimum(robot.upper, 10))
        found, wanted = robot.fk(q), poses(dict(zip(robot.variables, q)))
        links = len(wanted)
        worst = max(worst, *(float(numpy.abs(found[robot.links.index(name)] - pose).max()) for name, pose in wanted.items()))
    return {"result": "equal" if worst < LIMIT else "differs", "links": links, "pose": worst}


def as_table(rows):
    text = "| model | result | links | greatest difference of a pose | reason |\n|---|---|---|---|---|\n"
    for name, row in rows:
        pose = f"{row['pose']:.1e}" if "pose" in row else ""
        text += f"| {name} | {row['result']} | {row.get('links', '')} | {pose} | {row.get('reason', '').replace('|', '/')[:160]} |\n"
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--states", type=int, default=100)
    parser.add_argument("--table", type=pathlib.Path, help="the rows as Markdown")
    parser.add_argument("--package", action="append", default=[], metavar="NAME=FOLDER")
    parser.add_argument("folders", nargs="+", type=pathlib.Path)
    options = parser.parse_args()
    rows = []
    for folder in options.folders:
        for path in sorted(path for path in folder.rglob("*") if path.suffix in (".xacro", ".sdf")):
            row = compare(path, options.package, options.states)
            shorter = str(folder.parent) + "/"
            row = {key: value.replace(shorter, "") if isinstance(value, str) else value for key, value in row.items()}
            rows.append((str(path).replace(shorter, ""), row))
            print(row["result"], rows[-1][0], row.get("reason", f"{row.get('pose', 0):.1e}"), flush=True)
    counts = collections.Counter(row["result"] for _, row in rows)
    if options.table:
        options.table.write_text(as_table(rows))
    print(counts)
    return 1 if counts["differs"] or not rows else 0


if __name__ == "__main__":
    sys.exit(main())
