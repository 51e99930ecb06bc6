#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes arm.urdf, an arm of seven joints with a hand, and two_arms.urdf, two of them side by side. Standard library only.

    robots.py FOLDER

Shoulder, elbow and wrist are 0.3, 0.7 and 1.1 m above the base; the hand's frame is 0.16 m from the wrist, z away from the arm.
"""
import pathlib
import sys

# Name, origin, axis, and the shapes of the link behind the joint: kind, size, place
JOINTS = [
    ("j1", "0 0 0.3", "0 0 1", [("cylinder", "radius='0.06' length='0.12'", "0 0 0")]),
    ("j2", "0 0 0", "0 1 0", [("cylinder", "radius='0.045' length='0.14'", "0 0 0.13")]),
    ("j3", "0 0 0.2", "0 0 1", [("cylinder", "radius='0.045' length='0.14'", "0 0 0.07")]),
    ("j4", "0 0 0.2", "0 -1 0", [("sphere", "radius='0.055'", "0 0 0"), ("cylinder", "radius='0.04' length='0.14'", "0 0 0.13")]),
    ("j5", "0 0 0.2", "0 0 1", [("cylinder", "radius='0.04' length='0.15'", "0 0 0.07")]),
    ("j6", "0 0 0.2", "0 1 0", [("sphere", "radius='0.045'", "0 0 0")]),
    ("j7", "0 0 0.06", "0 0 1", [("cylinder", "radius='0.035' length='0.03'", "0 0 0.01")]),
]
SKIN, DARK = "0.86 0.87 0.9 1", "0.25 0.27 0.32 1"


def link(name, shapes, colour):
    """A link whose collision shapes are also seen, in a colour."""
    text = ""
    for kind, size, place in shapes:
        shape = f"<origin xyz='{place}'/><geometry><{kind} {size}/></geometry>"
        text += f"<visual>{shape}<material name='{colour.replace(' ', '_')}'><color rgba='{colour}'/></material></visual><collision>{shape}</collision>"
    return f"  <link name='{name}'>{text}</link>\n"


def arm(prefix, base_place):
    """Links and joints of one arm on the link `base`."""
    text, last = "", "base"
    for i, (name, origin, axis, shapes) in enumerate(JOINTS):
        origin = base_place if i == 0 else origin
        text += link(prefix + name + "_link", shapes, DARK if i % 2 else SKIN)
        text += (f"  <joint name='{prefix}{name}' type='revolute'><parent link='{last}'/><child link='{prefix}{name}_link'/><origin xyz='{origin}'/>"
            f"<axis xyz='{axis}'/><limit lower='-2.8' upper='2.8' effort='1' velocity='1.5' acceleration='4'/></joint>\n")
        last = prefix + name + "_link"
    text += link(prefix + "hand", [("box", "size='0.04 0.1 0.05'", "0 0 -0.045")], DARK)
    return text + (f"  <joint name='{prefix}flange' type='fixed'><parent link='{last}'/><child link='{prefix}hand'/><origin xyz='0 0 0.1'/></joint>\n")


def main():
    out = pathlib.Path(sys.argv[1])
    base = [("cylinder", "radius='0.08' length='0.22'", "0 0 0.11")]
    (out / "arm.urdf").write_text(f"<robot name='arm'>\n{link('base', base, DARK)}{arm('', '0 0 0.3')}</robot>\n", encoding="utf-8")
    body = [("box", "size='0.14 0.5 0.22'", "0 0 0.11")]
    both = arm("left_", "0 0.3 0.3") + arm("right_", "0 -0.3 0.3")
    (out / "two_arms.urdf").write_text(f"<robot name='two_arms'>\n{link('base', body, DARK)}{both}</robot>\n", encoding="utf-8")


if __name__ == "__main__":
    main()
