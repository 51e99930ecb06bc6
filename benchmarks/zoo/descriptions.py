# SPDX-License-Identifier: BSD-3-Clause
"""Robot descriptions of the zoo: their places, the SRDF of each URDF, and the contents of their XML.

Nothing here uses leeway: whether a file should be readable is decided independently of whether leeway reads it.
"""
import math
import os
import pathlib
import re
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, field

import low

# Folder below the zoo folder, and the prefix of its robots' names; example-robot-data needs none.
SOURCES = (
    ("example-robot-data", "cmeel.prefix/share/example-robot-data/robots", ""),
    ("robosuite", "robosuite", "robosuite/"),
    ("pybullet", "pybullet_data", "pybullet/"),
    ("low", ".", "low/"),  # written by low.py
)
FIXED = ("fixed",)
FOLDERS_OF_NO_MEANING = ("urdf", "robots", "robot", "models", "assets")


@dataclass
class Joint:
    name: str
    type: str
    parent: str
    child: str
    lower: float
    upper: float
    mimic: str = ""


@dataclass
class Description:
    name: str
    source: str
    urdf: pathlib.Path
    srdfs: list = field(default_factory=list)
    joints: list = field(default_factory=list)  # that can move
    all_joints: list = field(default_factory=list)
    links: int = 0
    collisions: int = 0
    visuals: int = 0
    defect: str = ""  # of the XML

    @property
    def kind(self):
        if self.defect:
            return "no XML"
        if self.links == 0:
            return "no links"
        if not self.joints:
            return "no joints"
        return "robot" if self.collisions else "no collision geometry"


def number(text, default):
    try:
        value = float(text)
        return value if math.isfinite(value) else default
    except (TypeError, ValueError):
        return default


def read_joint(element):
    limit, mimic = element.find("limit"), element.find("mimic")
    kind = element.get("type", "")
    lower = number(limit.get("lower") if limit is not None else None, 0.0)
    upper = number(limit.get("upper") if limit is not None else None, 0.0)
    link = lambda name: (element.find(name).get("link", "") if element.find(name) is not None else "")
    return Joint(element.get("name", ""), kind, link("parent"), link("child"), lower, upper,
                 mimic.get("joint", "") if mimic is not None else "")


def describe(name, source, path):
    robot = Description(name, source, path)
    try:
        # Some files begin with a blank line or end in a NUL, which Python's parser refuses.
        text = path.read_bytes().decode("utf-8", "replace").strip().strip("\0")
        root = ElementTree.fromstring(re.sub(r"^<\?xml.*?\?>", "", text, count=1))
    except ElementTree.ParseError as error:
        robot.defect = f"no well-formed XML: {error}"
        return robot
    robot.all_joints = [read_joint(element) for element in root.findall("joint")]
    robot.joints = [joint for joint in robot.all_joints if joint.type not in FIXED]
    robot.links = len(root.findall("link"))
    robot.collisions = len(root.findall("link/collision"))
    robot.visuals = len(root.findall("link/visual"))
    return robot


def short_name(base, path, prefix):
    parts = list(path.relative_to(base).with_suffix("").parts)
    parts = [part for part in parts[:-1] if part not in FOLDERS_OF_NO_MEANING] + parts[-1:]
    parts = [re.sub(r"(_simple)?_description$|_data$", "", part) for part in parts]
    return prefix + "/".join(part for i, part in enumerate(parts) if i == 0 or part != parts[i - 1])


def belongs(longer, shorter):
    return longer == shorter or (longer.startswith(shorter) and not longer[len(shorter)].isalpha())


def assign_srdfs(robots, srdfs):
    """The SRDF of a robot is the one of the same package with its name, or the longest one that begins its name; an SRDF
    left goes to the robot whose name begins the SRDF's. The first one of a robot is the one that it is used with."""
    left = set(srdfs)
    package = lambda path: path.parent.parent
    for robot in robots:
        candidates = [s for s in srdfs if package(s) == package(robot.urdf) and belongs(robot.urdf.stem, s.stem)]
        if candidates:
            robot.srdfs = [max(candidates, key=lambda s: len(s.stem))]
            left -= set(robot.srdfs)
    for srdf in sorted(left):
        same = [r for r in robots if package(r.urdf) == package(srdf)]
        named = [r for r in same if belongs(srdf.stem, r.urdf.stem)]
        chosen = max(named, key=lambda r: len(r.urdf.stem)) if named else same[0] if len(same) == 1 else None
        if chosen:
            chosen.srdfs.append(srdf)


def find(zoo):
    """All descriptions below the zoo folder, objects without joints included, sorted by name."""
    robots = []
    low.write(pathlib.Path(zoo) / "low")
    for folder, below, prefix in SOURCES:
        base = pathlib.Path(zoo) / folder / below
        # pybullet_data/random_urdfs are a thousand objects without joints.
        paths = sorted(p for p in base.rglob("*.urdf") if "random_urdfs" not in p.parts) if base.is_dir() else []
        found = [describe(short_name(base, path, prefix), folder, path) for path in paths]
        assign_srdfs(found, sorted(base.rglob("*.srdf")) if base.is_dir() else [])
        robots += found
    names = {}
    for robot in robots:
        names.setdefault(robot.name, []).append(robot)
    for same in names.values():
        for i, robot in enumerate(same[1:], 2):
            robot.name += f"_{i}"
    return sorted(robots, key=lambda robot: robot.name)


def resolve(urdf, filename):
    """A mesh's file name in a URDF as a path: package://NAME/... by upward search, as leeway does."""
    if filename.startswith("file://"):
        return filename[len("file://"):]
    if filename.startswith(("package://", "model://")):
        inside = filename.split("://", 1)[1].lstrip("/")
        name, _, rest = inside.partition("/")
        for folder in urdf.resolve().parents:
            for candidate in (folder / inside, folder / rest if folder.name == name else None):
                if candidate is not None and candidate.exists():
                    return str(candidate)
        return filename
    return os.path.normpath(urdf.parent / filename)
