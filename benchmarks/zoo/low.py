# SPDX-License-Identifier: BSD-3-Clause
"""Robots with one to four joints for the zoo, written as URDFs: public packages have hardly any alone. Rails, gantries, SCARAs, a mobile
base, turntables and grippers; dimensions are those of common machines, rounded. A goal lies behind limits or links that stand in the way."""
import pathlib

NAMES = ("rail", "gantry", "scara", "scara_on_rail", "base", "base_with_mast", "turntable", "pan_tilt", "parallel_gripper", "three_finger_gripper",
         "delta_slides", "lift_with_arm")


def box(name, size, at="0 0 0"):
    return f'  <link name="{name}"><collision><origin xyz="{at}"/><geometry><box size="{size}"/></geometry></collision></link>\n'


def tube(name, radius, length, at="0 0 0"):
    return (f'  <link name="{name}"><collision><origin xyz="{at}"/><geometry><cylinder radius="{radius}" length="{length}"/></geometry></collision>'
            "</link>\n")


def joint(name, kind, parent, child, at="0 0 0", axis="0 0 1", limits=None, mimic=""):
    limit = f'<limit lower="{limits[0]}" upper="{limits[1]}" effort="1" velocity="1"/>' if limits else ""
    follows = f'<mimic joint="{mimic}"/>' if mimic else ""
    return (f'  <joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/><origin xyz="{at}"/><axis xyz="{axis}"/>'
            f"{limit}{follows}</joint>\n")


def rail():
    return box("beam", "2 0.1 0.1") + box("carriage", "0.3 0.2 0.1") + joint("slide", "prismatic", "beam", "carriage", "0 0 0.12", "1 0 0", (-0.8, 0.8))


def gantry():
    return (box("frame", "2 0.1 0.1") + box("bridge", "0.1 1.5 0.1") + box("trolley", "0.2 0.2 0.2") + box("hoist", "0.05 0.05 0.8", "0 0 -0.4") +
            joint("x", "prismatic", "frame", "bridge", "0 0 0.12", "1 0 0", (-0.9, 0.9)) +
            joint("y", "prismatic", "bridge", "trolley", "0 0 0.17", "0 1 0", (-0.6, 0.6)) +
            joint("z", "prismatic", "trolley", "hoist", "0.2 0 0", "0 0 1", (-0.3, 0.3)))


def scara(base="pedestal"):
    return (tube(base, 0.08, 0.3, "0 0 0.15") + box("upper", "0.35 0.09 0.06", "0.15 0 0") + box("fore", "0.3 0.08 0.06", "0.12 0 0") +
            tube("quill", 0.01, 0.3) + box("flange", "0.06 0.02 0.02") +
            joint("j1", "revolute", base, "upper", "0 0 0.34", limits=(-2.3, 2.3)) +
            joint("j2", "revolute", "upper", "fore", "0.3 0 0.07", limits=(-2.6, 2.6)) +
            joint("j3", "prismatic", "fore", "quill", "0.29 0 0", limits=(-0.1, 0.1)) +
            joint("j4", "continuous", "quill", "flange", "0 0 -0.17"))


def scara_on_rail():
    return box("beam", "2 0.1 0.1") + scara("carriage") + joint("rail", "prismatic", "beam", "carriage", "0 0 0.06", "1 0 0", (-0.8, 0.8))


def base():
    return box("world", "0.2 0.2 0.5", "1 0 0.25") + box("chassis", "0.6 0.4 0.2", "0 0 0.15") + joint("drive", "planar", "world", "chassis")


def base_with_mast():
    return base() + tube("mast", 0.04, 0.8, "0 0 0.4") + joint("lift", "prismatic", "chassis", "mast", "0.1 0 0.26", limits=(0, 0.3))


def turntable():
    return box("desk", "0.8 0.8 0.05", "0 0 -0.03") + box("plate", "0.6 0.1 0.02", "0 0 0.02") + joint("turn", "continuous", "desk", "plate")


def pan_tilt():
    return (tube("foot", 0.05, 0.1, "0 0 0.05") + box("yoke", "0.02 0.1 0.08", "0.06 0 0.05") + box("camera", "0.1 0.05 0.05", "0.03 0 0") +
            joint("pan", "revolute", "foot", "yoke", "0 0 0.12", limits=(-3, 3)) +
            joint("tilt", "revolute", "yoke", "camera", "0.12 0 0.06", "0 1 0", (-1, 1)))


def parallel_gripper():
    return (box("palm", "0.05 0.2 0.1", "0 0 -0.05") + box("left", "0.02 0.01 0.05", "0 0.006 0.03") + box("right", "0.02 0.01 0.05", "0 -0.006 0.03") +
            joint("left_slide", "prismatic", "palm", "left", "0 0 0.01", "0 1 0", (0, 0.04)) +
            joint("right_slide", "prismatic", "palm", "right", "0 0 0.01", "0 -1 0", (0, 0.04), "left_slide"))


def three_finger_gripper():
    fingers = "".join(box(f"finger{i}", "0.01 0.01 0.08", "0 0 0.05") for i in range(3))
    places = (("0.04 0 0.01", "0 -1 0"), ("-0.03 0.03 0.01", "1 1 0"), ("-0.03 -0.03 0.01", "-1 1 0"))
    return tube("palm", 0.06, 0.05, "0 0 -0.025") + fingers + "".join(
        joint(f"close{i}", "revolute", "palm", f"finger{i}", at, axis, (-0.3, 0.6)) for i, (at, axis) in enumerate(places))


def delta_slides():
    slides = "".join(box(f"slide{i}", "0.05 0.05 0.1") for i in range(3))
    return box("frame", "1 1 0.05") + slides + "".join(
        joint(f"s{i}", "prismatic", "frame", f"slide{i}", f"{0.3 * i - 0.3} 0 0.3", "0 0 1", (-0.2, 0.2)) for i in range(3))


def lift_with_arm():
    return (box("column", "0.1 0.1 1.5", "0 0 0.75") + box("carriage", "0.1 0.12 0.1") + box("arm", "0.7 0.06 0.06", "0.3 0 0") +
            joint("lift", "prismatic", "column", "carriage", "0.12 0 0.7", limits=(-0.6, 0.6)) +
            joint("swing", "revolute", "carriage", "arm", "0.12 0 0", limits=(-1.5, 1.5)))


def write(folder):
    """One URDF for each robot, where it differs. @return the folder"""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for name in NAMES:
        text, path = f'<?xml version="1.0"?>\n<robot name="{name}">\n{globals()[name]()}</robot>\n', folder / f"{name}.urdf"
        if not path.exists() or path.read_text() != text:
            path.write_text(text)
    return folder
