# SPDX-License-Identifier: BSD-3-Clause
"""Damaged MJCF and SDF files, each refused with its file, the place in it and a remedy. (xacro: tests/cli/xacro_test.cpp; USD:
planners/python/tests/test_usd.py.)

The whole file is read without an error, so each case is refused for its damage alone. Lines are counted in the damaged file.
"""
from cases import Case

MJCF = """<mujoco model="arm">
  <compiler angle="radian" autolimits="true"/>
  <default>
    <geom size="0.05"/>
    <default class="beam"><geom type="capsule" fromto="0 0 0.1 0 0 0.3" size="0.02"/></default>
  </default>
  <asset>
    <mesh name="block" file="fore.stl"/>
    <hfield name="hill" nrow="2" ncol="2" size="1 1 0.1 0.1" elevation="0 1 0 1"/>
  </asset>
  <worldbody>
    <geom name="ground" type="hfield" hfield="hill" pos="0 0 -1"/>
    <body name="upper" pos="0 0 0.1">
      <joint name="shoulder" axis="0 1 0" range="-2 2"/>
      <geom name="upper_geom" class="beam"/>
      <body name="fore" pos="0 0 0.5" quat="1 0 0 0">
        <joint name="elbow" axis="0 1 0" range="-2 2"/>
        <geom name="fore_geom" type="mesh" mesh="block"/>
        <body name="finger" pos="0.5 0 0">
          <joint name="slide" type="slide" axis="1 0 0" range="0 0.1"/>
          <geom name="finger_geom" type="box" size="0.02 0.02 0.02"/>
        </body>
      </body>
    </body>
  </worldbody>
  <contact>
    <exclude body1="upper" body2="fore"/>
    <pair geom1="ground" geom2="finger_geom"/>
  </contact>
  <equality>
    <joint joint1="slide" joint2="elbow" polycoef="0 0.01"/>
  </equality>
  <keyframe>
    <key name="home" qpos="0 0 0"/>
  </keyframe>
</mujoco>
"""
SDF = """<?xml version="1.0"?>
<sdf version="1.9">
  <model name="arm">
    <link name="base">
      <collision name="foot"><geometry><box><size>0.2 0.2 0.1</size></box></geometry></collision>
    </link>
    <link name="upper">
      <pose relative_to="base">0 0 0.2 0 0 0</pose>
      <collision name="beam"><geometry><cylinder><radius>0.03</radius><length>0.2</length></cylinder></geometry></collision>
    </link>
    <link name="tool">
      <pose>0 0 0.6 0 0 0</pose>
      <collision name="block"><geometry><mesh><uri>fore.stl</uri></mesh></geometry></collision>
    </link>
    <joint name="shoulder" type="revolute">
      <parent>base</parent>
      <child>upper</child>
      <axis><xyz>0 1 0</xyz><limit><lower>-2</lower><upper>2</upper></limit></axis>
    </joint>
    <joint name="slide" type="prismatic">
      <parent>upper</parent>
      <child>tool</child>
      <axis><xyz>0 0 1</xyz><limit><lower>0</lower><upper>0.1</upper></limit></axis>
    </joint>
  </model>
</sdf>
"""
COMMAND = "info --strict --robot "


def mjcf(name, old, new, *words):
    if old not in MJCF:
        raise ValueError(f"{name}: the model has no {old!r}")
    return Case("MJCF: " + name, COMMAND + "arm.xml", {"arm.xml": MJCF.replace(old, new, 1)}, (2,), ("arm.xml", *words))


def mjcf_bytes(name, content, *words):
    return Case("MJCF: " + name, COMMAND + "arm.xml", {"arm.xml": content}, (2,), ("arm.xml", *words))


def nested(depth):
    bodies = "".join(f'<body name="n{i}"><joint/><geom size="0.01"/>' for i in range(depth)) + "</body>" * depth
    return MJCF.replace('<body name="upper"', bodies + '<body name="upper"', 1)


def broken_texts():
    whole = MJCF.encode()
    return [
        mjcf_bytes("cut in a body", whole[:900], "not well-formed"),
        mjcf_bytes("cut in an attribute", whole[:whole.index(b'"fore_geom"') + 4], "not well-formed", "line 18"),
        mjcf_bytes("cut before the last tag", whole[:whole.index(b"</mujoco>")], "not well-formed"),
        mjcf_bytes("wrong end tag", MJCF.replace("</contact>", "</contacts>"), "not well-formed", "line (26|29)"),
        mjcf_bytes("no root", "<!-- nothing -->"),
        mjcf_bytes("wrong root", MJCF.replace("mujoco", "muloco"), "muloco"),
        mjcf_bytes("included part as a model", "<mujocoinclude><body name='a'/></mujocoinclude>", "mujocoinclude"),
        mjcf_bytes("byte 0 in a name", whole.replace(b"upper_geom", b"upper\0geom"), "line 15|well-formed|byte"),
        mjcf_bytes("Latin-1 in a name", whole.replace(b'"shoulder"', b'"sch\xfcltra"'), "UTF-8"),
        mjcf_bytes("UTF-16", MJCF.encode("utf-16")),
        mjcf_bytes("binary", bytes(range(1, 256)) * 9),
        mjcf_bytes("compiled model", b"\xd5\x0b\x00\x00\x08\x00\x00\x00" + bytes(400)),
        mjcf_bytes("10,000 elements deep", "<mujoco>" + "<worldbody>" * 10000 + "</worldbody>" * 10000 + "</mujoco>", "line 1", "nested more than 100 deep"),
        mjcf_bytes("5,000 bodies deep", nested(5000), "line 13", "nested more than 100 deep"),
    ]


def mjcf_cases():
    fore = '<joint name="elbow" axis="0 1 0" range="-2 2"/>'
    return broken_texts() + [
        mjcf("unit of angles unknown", 'angle="radian"', 'angle="grad"', r"compiler \(line 2\)", "degree, radian"),
        mjcf("truth that is none", 'autolimits="true"', 'autolimits="1.0"', r"compiler \(line 2\)", "true, false"),
        mjcf("class without a name", 'default class="beam"', "default", r"default \(line 5\)", "no name"),
        mjcf("class twice", "</default>\n  </default>", '</default><default class="beam"/>\n  </default>', r"default beam \(line 5\)", "defined before"),
        mjcf("class unknown", 'class="beam"/>', 'class="beem"/>', "line 15", "no default class beem", "beam"),
        mjcf("childclass unknown", 'pos="0 0 0.1"', 'pos="0 0 0.1" childclass="none"', r"body upper \(line 13\)", "none"),
        mjcf("include missing", "<asset>", '<include file="none.xml"/><asset>', r"none.xml \(line 7\)"),
        mjcf("include of itself", "<asset>", '<include file="arm.xml"/><asset>', "line 7", "includes itself"),
        mjcf("include of a folder", "<asset>", '<include file="."/><asset>', "line 7|folder"),
        mjcf("mesh missing", 'file="fore.stl"', 'file="pot.stl"', r"mesh block \(line 8\)", "pot.stl"),
        mjcf("mesh of no known format", 'file="fore.stl"', 'file="arm.xml"', r"mesh block \(line 8\)|arm.xml"),
        mjcf("mesh twice", "<hfield", '<mesh name="block" file="fore.stl"/><hfield', r"mesh block \(line 9\)", "before"),
        mjcf("mesh without a name", '<mesh name="block" file="fore.stl"/>', "<mesh/>", r"mesh \(line 8\)", "name"),
        mjcf("mesh scale of two numbers", 'file="fore.stl"', 'file="fore.stl" scale="1 1"', r"mesh block \(line 8\)", "scale"),
        mjcf("mesh turned by zero", 'file="fore.stl"', 'file="fore.stl" refquat="0 0 0 0"', r"mesh block \(line 8\)", "refquat"),
        mjcf("mesh unknown", 'mesh="block"/>', 'mesh="brick"/>', r"geom fore_geom \(line 18\)", "brick", "block"),
        mjcf("height field unknown", 'hfield="hill"', 'hfield="hall"', r"geom ground \(line 12\)", "hall", "hill"),
        mjcf("height field of other size", 'elevation="0 1 0 1"', 'elevation="0 1 0"', r"hfield hill \(line 9\)", "3 numbers, not 4"),
        mjcf("height field of 10^18 heights", 'nrow="2" ncol="2"', 'nrow="1000000000" ncol="1000000000"', r"hfield hill \(line 9\)"),
        mjcf("height field without size", 'size="1 1 0.1 0.1" ', "", r"hfield hill \(line 9\)", "size"),
        mjcf("body twice", 'body name="fore"', 'body name="upper"', r"body upper \(line 16\)", "before"),
        mjcf("body called world", 'body name="fore"', 'body name="world"', r"body world \(line 16\)", "before"),
        mjcf("position of two numbers", 'pos="0 0 0.5"', 'pos="0 0.5"', r"body fore \(line 16\)", "2 numbers"),
        mjcf("position NaN", 'pos="0 0 0.5"', 'pos="0 0 nan"', r"body fore \(line 16\)", "nan"),
        mjcf("position 1e999", 'pos="0 0 0.5"', 'pos="0 0 1e999"', r"body fore \(line 16\)"),
        mjcf("position text", 'pos="0 0 0.5"', 'pos="0 0 half"', r"body fore \(line 16\)", "half"),
        mjcf("zero quaternion", 'quat="1 0 0 0"', 'quat="0 0 0 0"', r"body fore \(line 16\)", "zero quaternion"),
        mjcf("two orientations", 'quat="1 0 0 0"', 'quat="1 0 0 0" euler="0 0 0"', "body fore|<body>", "line 16", "both quat and euler"),
        mjcf("unknown element of a body", fore, "<hinge/>" + fore, r"<hinge> \(line 17\)", "not known"),
        mjcf("joint twice", 'name="elbow"', 'name="shoulder"', r"joint shoulder \(line 17\)", "before"),
        mjcf("joint type unknown", 'type="slide"', 'type="screw"', r"joint slide \(line 20\)", "screw", "hinge, slide"),
        mjcf("axis zero", 'type="slide" axis="1 0 0"', 'type="slide" axis="0 0 0"', r"joint slide \(line 20\)", "axis"),
        mjcf("axis of four numbers", 'type="slide" axis="1 0 0"', 'type="slide" axis="1 0 0 0"', r"joint slide \(line 20\)", "4 numbers"),
        mjcf("range swapped", 'range="0 0.1"', 'range="0.1 0"', r"joint slide \(line 20\)", "above upper"),
        mjcf("range of one number", 'range="0 0.1"', 'range="0.1"', r"joint slide \(line 20\)", "range"),
        mjcf("range NaN", 'range="0 0.1"', 'range="nan 0.1"', r"joint slide \(line 20\)", "nan|finite"),
        mjcf("range on one side", fore, '<joint name="elbow" axis="0 1 0" range="-2 inf"/>', r"joint elbow \(line 17\)", "one side"),
        mjcf("limited by no range", 'range="0 0.1"', 'limited="true"', r"joint slide \(line 20\)", "0 to 0"),
        mjcf("free joint below a body", fore, "<freejoint/>", r"body fore \(line 16\)", "no child of the world"),
        mjcf("ball and hinge", fore, fore + '<joint type="ball"/>', r"body fore \(line 16\)", "ball"),
        mjcf("joint of the world", '<body name="upper"', '<joint name="w"/><body name="upper"', "line 13", "world has a joint"),
        mjcf("geom type unknown", 'type="box"', 'type="cube"', r"geom finger_geom \(line 21\)", "cube", "box"),
        mjcf("size zero", 'size="0.02 0.02 0.02"', 'size="0.02 0 0.02"', r"geom finger_geom \(line 21\)", "size"),
        mjcf("size negative", 'size="0.02 0.02 0.02"', 'size="0.02 -1 0.02"', r"geom finger_geom \(line 21\)", "size"),
        mjcf("size missing", 'size="0.02 0.02 0.02"', 'size="0.02 0.02"', r"geom finger_geom \(line 21\)", "size"),
        mjcf("ends of a beam are one", 'fromto="0 0 0.1 0 0 0.3"', 'fromto="0 0 0.1 0 0 0.1"', "geom upper_geom", "line (5|15)"),
        mjcf("mask that is no number", 'type="box" size', 'contype="all" type="box" size', r"geom finger_geom \(line 21\)", "all"),
        mjcf("mesh geom without a mesh", ' mesh="block"/>', "/>", r"geom fore_geom \(line 18\)", "mesh="),
        mjcf("10^9 replicas", '<body name="finger"', '<replicate count="1000000000"><geom/></replicate><body name="finger"', "line 19|replicas", "limit"),
        mjcf("half a replica", '<body name="finger"', '<replicate count="0.5"><geom/></replicate><body name="finger"', r"replicate \(line 19\)", "whole number"),
        mjcf("exclusion of an unknown body", 'body2="fore"', 'body2="four"', r"exclude \(line 27\)", "four"),
        mjcf("exclusion of one body", ' body2="fore"', "", r"exclude \(line 27\)", "body2"),
        mjcf("pair of an unknown geom", 'geom2="finger_geom"', 'geom2="finger"', r"pair \(line 28\)", "finger"),
        mjcf("coupling of an unknown joint", 'joint2="elbow"', 'joint2="elbo"', r"equality.*\(line 31\)", "elbo"),
        mjcf("coupling with itself", 'joint2="elbow"', 'joint2="slide"', "line 31", "itself"),
        mjcf("coupling of text", 'polycoef="0 0.01"', 'polycoef="0 one"', "line 31", "one"),
        mjcf("state twice", "</keyframe>", '<key name="home"/></keyframe>', r"key home \(line 35\)", "before"),
        mjcf("state of text", 'qpos="0 0 0"', 'qpos="0 0 up"', "line 34", "up"),
    ]


def sdf(name, old, new, *words):
    if old not in SDF:
        raise ValueError(f"{name}: the model has no {old!r}")
    return Case("SDF: " + name, COMMAND + "arm.sdf", {"arm.sdf": SDF.replace(old, new, 1)}, (2,), ("arm.sdf", *words))


def sdf_cases():
    return [
        sdf("cut", SDF[700:], ""),
        sdf("wrong root", '<sdf version="1.9">', '<sdff version="1.9">'),
        sdf("no version", ' version="1.9"', ""),
        sdf("version of text", '"1.9"', '"new"'),
        sdf("link twice", 'link name="tool"', 'link name="upper"', "upper"),
        sdf("link without a name", 'link name="tool"', "link"),
        sdf("link called world", 'link name="tool"', 'link name="world"', "world"),
        sdf("joint twice", 'joint name="slide"', 'joint name="shoulder"', "shoulder"),
        sdf("joint type unknown", 'type="prismatic"', 'type="bendy"', "bendy"),
        sdf("joint type screw", 'type="prismatic"', 'type="screw"', "slide", "line 20", "screw"),
        sdf("parent unknown", "<parent>upper</parent>", "<parent>uper</parent>", "uper"),
        sdf("child missing", "<child>tool</child>", "", "slide|child"),
        sdf("cycle", "<parent>base</parent>", "<parent>tool</parent>", "cycle|parent"),
        sdf("axis zero", "<axis><xyz>0 0 1</xyz>", "<axis><xyz>0 0 0</xyz>"),
        sdf("axis text", "<axis><xyz>0 0 1</xyz>", "<axis><xyz>x y z</xyz>"),
        sdf("limits swapped", "<lower>0</lower>", "<lower>3</lower>", "slide"),
        sdf("mesh missing", "fore.stl", "pot.stl", "tool", "pot.stl"),
        sdf("box of size zero", "<size>0.2 0.2 0.1</size>", "<size>0.2 0 0.1</size>"),
        sdf("pose in an unknown frame", 'relative_to="base"', 'relative_to="bass"', "bass"),
        sdf("two frames in a circle", "<pose>0 0 0.6 0 0 0</pose>", '<pose relative_to="tool">0 0 0.6 0 0 0</pose>'),
    ]


def format_cases():
    whole = [Case("MJCF: the whole file", COMMAND + "arm.xml", {"arm.xml": MJCF}, (0,)),
             Case("SDF: the whole file", COMMAND + "arm.sdf", {"arm.sdf": SDF}, (0,))]
    return whole + mjcf_cases() + sdf_cases()


__all__ = ["format_cases"]
