# SPDX-License-Identifier: BSD-3-Clause
"""Bad inputs for every file and option: models, tables, scenes, requests, paths, options, outputs.

A case is Case(name, command, edits, status, words): the changes of the small arm's files, the command, the exit status that is
expected, and words that must be said (regular expressions). `edits` maps a file to (from, to), to a whole new text or bytes,
or to None, which removes it.
"""
from dataclasses import dataclass, field

URDF = """<?xml version="1.0"?>
<robot name="arm">
  <link name="base"><collision><origin xyz="0 0 -0.2"/><geometry><box size="0.2 0.2 0.1"/></geometry></collision></link>
  <link name="upper"><collision><origin xyz="0.2 0 0" rpy="0 1.5708 0"/><geometry><cylinder radius="0.03" length="0.38"/></geometry></collision></link>
  <link name="fore"><collision><geometry><mesh filename="fore.stl" scale="1 1 1"/></geometry></collision></link>
  <link name="tool"><collision><origin xyz="0.1 0 0"/><geometry><sphere radius="0.03"/></geometry></collision></link>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/><origin xyz="0.4 0 0"/><axis xyz="0 0 1"/>
    <limit lower="-2.5" upper="2.5" effort="1" velocity="1"/></joint>
  <joint name="slide" type="prismatic"><parent link="fore"/><child link="tool"/><origin xyz="0.4 0 0"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="0.1" effort="1" velocity="1"/></joint>
</robot>
"""
SRDF = """<?xml version="1.0"?>
<robot name="arm">
  <group name="arm"><joint name="shoulder"/><joint name="elbow"/><joint name="slide"/></group>
  <group name="two"><chain base_link="base" tip_link="fore"/></group>
  <group_state name="home" group="arm"><joint name="shoulder" value="0"/><joint name="elbow" value="0"/><joint name="slide" value="0"/></group_state>
  <disable_collisions link1="base" link2="upper" reason="Adjacent"/>
  <disable_collisions link1="upper" link2="fore" reason="Adjacent"/>
  <disable_collisions link1="fore" link2="tool" reason="Adjacent"/>
</robot>
"""
SCENE = """name: room
world:
  collision_objects:
    - id: wall
      primitives:
        - type: box
          dimensions: [0.2, 2, 2]
      primitive_poses:
        - position: [2.0, 0, 0]
          orientation: [0, 0, 0, 1]
"""
MESH_SCENE = """name: room
world:
  collision_objects:
    - id: pot
      meshes:
        - resource: fore.stl
      mesh_poses:
        - position: [2.0, 0, 0]
          orientation: [0, 0, 0, 1]
"""
STATES = "shoulder,elbow,slide\n0,0,0\n0.5,0.5,0.05\n"
EDGES = "from:shoulder,from:elbow,from:slide,to:shoulder,to:elbow,to:slide\n-1,0,0,1,0,0.1\n"
REQUEST = """group_name: arm
allowed_planning_time: 5
start_state:
  joint_state:
    name: [shoulder, elbow, slide]
    position: [-1, 0, 0]
goal_constraints:
  - joint_constraints:
      - joint_name: shoulder
        position: 1
      - joint_name: elbow
        position: 0
      - joint_name: slide
        position: 0.05
"""
PATH = """joint_names: [shoulder, elbow, slide]
group: arm
points:
  - positions: [-1, 0, 0]
  - positions: [1, 0, 0.05]
"""
MARGINS = "links: {tool: 0.01}\n"


def box_stl():
    lines = ["solid box"]
    for face in ((0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4),
                 (1, 5, 7), (1, 7, 3)):
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += [f"vertex {0.4 * (c & 1)} {0.05 * (c >> 1 & 1) - 0.025} {0.05 * (c >> 2) - 0.025}" for c in face]
        lines += ["endloop", "endfacet"]
    return "\n".join(lines + ["endsolid box", ""])


FILES = {"arm.urdf": URDF, "arm.srdf": SRDF, "scene.yaml": SCENE, "states.csv": STATES, "edges.csv": EDGES, "request.yaml": REQUEST,
         "path.yaml": PATH, "margins.yaml": MARGINS, "fore.stl": box_stl()}

MODEL = "--robot arm.urdf --srdf arm.srdf"
WORLD = MODEL + " --scene scene.yaml"
INFO = f"info {WORLD}"
CHECK = f"check {WORLD} --states states.csv --out out.csv"
EDGE = f"edge {WORLD} --edges edges.csv --out out.csv"
PLAN = f"plan {WORLD} --request request.yaml --out out.yaml --report report.json"
AUDIT = f"audit {WORLD} --path path.yaml --report report.json"
PAIRS = f"pairs {MODEL} --budget 0 --samples 50 --out new.srdf"
SPHERIZE = f"spherize {MODEL} --excess 30 --out spheres"


@dataclass
class Case:
    name: str
    command: str
    edits: dict = field(default_factory=dict)
    status: tuple = (2,)
    words: tuple = ()
    expect: str = ""  # of hostile.py, instead of `status`
    clean: dict | None = None  # edits that give the good answer, which `expect` compares with
    place: tuple | None = None  # a file's name, and a function that puts something else in its place


def urdf(name, old, new, *words, status=(2,), command=INFO):
    return Case("model: " + name, command, {"arm.urdf": (old, new)}, status, ("arm.urdf",) * (status == (2,)) + words)


def model_cases():
    mesh = 'filename="fore.stl"'
    cases = [
        urdf("two roots", '<joint name="elbow" type="revolute"><parent link="upper"/>', '<joint name="elbow" type="revolute"><parent link="fore"/>'),
        urdf("link name twice", '<link name="tool">', '<link name="fore">', "fore"),
        urdf("joint name twice", 'joint name="elbow"', 'joint name="shoulder"', "shoulder"),
        urdf("joint type unknown", 'name="elbow" type="revolute"', 'name="elbow" type="bendy"', "bendy"),
        urdf("joint type spherical", 'name="elbow" type="revolute"', 'name="elbow" type="spherical"', "spherical"),
        urdf("parent missing", '<parent link="upper"/>', "", "elbow"),
        urdf("child is its own parent", '<parent link="upper"/><child link="fore"/>', '<parent link="fore"/><child link="fore"/>'),
        urdf("cycle", '<parent link="base"/><child link="upper"/>', '<parent link="tool"/><child link="upper"/>'),
        urdf("axis zero", 'axis xyz="1 0 0"', 'axis xyz="0 0 0"', "slide", "axis"),
        urdf("axis of two numbers", 'axis xyz="1 0 0"', 'axis xyz="1 0"', "slide", "2 numbers"),
        urdf("axis text", 'axis xyz="1 0 0"', 'axis xyz="x y z"', "slide", "not a number"),
        urdf("limit missing", '<limit lower="0" upper="0.1" effort="1" velocity="1"/>', "", "slide", "limit"),
        urdf("limit text", 'lower="0" upper="0.1"', 'lower="low" upper="0.1"', "slide", "low"),
        urdf("limit NaN", 'lower="0" upper="0.1"', 'lower="nan" upper="0.1"', "slide"),
        urdf("limit infinite", 'lower="0" upper="0.1"', 'lower="0" upper="inf"', "slide"),
        urdf("limits swapped", 'lower="0" upper="0.1"', 'lower="0.1" upper="0"', "slide", "above upper|swap"),
        urdf("limits in degrees", 'lower="-2.5" upper="2.5"', 'lower="-170" upper="170"', "notice", "elbow", "degree", status=(0,)),
        urdf("mimic of nothing", '<axis xyz="1 0 0"/>', '<axis xyz="1 0 0"/><mimic joint="nobody"/>', "nobody"),
        urdf("mimic of itself", '<axis xyz="1 0 0"/>', '<axis xyz="1 0 0"/><mimic joint="slide"/>', "slide"),
        urdf("mimic multiplier text", '<axis xyz="1 0 0"/>', '<axis xyz="1 0 0"/><mimic joint="elbow" multiplier="a"/>', "multiplier"),
        urdf("origin of four numbers", 'xyz="0 0 -0.2"', 'xyz="0 0 -0.2 1"', "base", "4 numbers"),
        urdf("origin with commas", 'xyz="0 0 -0.2"', 'xyz="0, 0, -0.2"', "base", "not a number"),
        urdf("rpy infinite", 'rpy="0 1.5708 0"', 'rpy="0 inf 0"', "upper"),
        urdf("box of two numbers", 'size="0.2 0.2 0.1"', 'size="0.2 0.2"', "base"),
        urdf("box zero", 'size="0.2 0.2 0.1"', 'size="0 0.2 0.1"', "base"),
        urdf("box without size", '<box size="0.2 0.2 0.1"/>', "<box/>", "base"),
        urdf("sphere negative", 'sphere radius="0.03"', 'sphere radius="-0.03"', "tool"),
        urdf("sphere without radius", 'sphere radius="0.03"', "sphere", "tool"),
        urdf("cylinder without length", ' length="0.38"', "", "upper"),
        urdf("cylinder NaN", 'radius="0.03" length="0.38"', 'radius="nan" length="0.38"', "upper"),
        urdf("geometry empty", '<geometry><sphere radius="0.03"/></geometry>', "<geometry/>", "tool"),
        urdf("geometry unknown", '<sphere radius="0.03"/>', '<torus radius="0.03"/>', "tool", "torus"),
        urdf("geometry missing", '<geometry><sphere radius="0.03"/></geometry>', "", "tool"),
        urdf("mesh missing", mesh, 'filename="hand.stl"', "fore", "hand.stl", "not found"),
        urdf("mesh without name", mesh, "", "fore"),
        urdf("mesh empty name", mesh, 'filename=""', "fore"),
        urdf("mesh is a folder", mesh, 'filename="."', "fore"),
        urdf("mesh of a package that is not there", mesh, 'filename="package://nowhere/absent.stl"', "absent", "nowhere", "package"),
        urdf("mesh of an empty package", mesh, 'filename="package:///nowhere/absent.stl"', "absent", "package"),
        urdf("mesh beside the robot, of a package that is not there", mesh, 'filename="package://nowhere/fore.stl"', "notice", "nowhere",
            "--package-path", status=(0,)),
        urdf("mesh by http", mesh, 'filename="http://example.com/fore.stl"', "fore"),
        urdf("mesh of unknown suffix", mesh, 'filename="fore.xyz"', "fore"),
        urdf("mesh scale zero", 'scale="1 1 1"', 'scale="0 1 1"', "fore", "scale"),
        urdf("mesh scale of four", 'scale="1 1 1"', 'scale="1 1 1 1"', "fore", "4 numbers"),
        urdf("mesh scale NaN", 'scale="1 1 1"', 'scale="1 nan 1"', "fore"),
        urdf("mesh three hundred metres large", 'scale="1 1 1"', 'scale="1000 1000 1000"', "notice", "fore", status=(0,)),
        urdf("xacro", "<robot ", '<robot xmlns:xacro="http://ros.org/wiki/xacro" ', status=(0, 2)),
        urdf("xacro macro", '<link name="tool">', '<xacro:macro name="m"/><link name="tool">'),
        urdf("name not UTF-8", "", b'<robot name="a"><link name="l\xff"><collision><geometry><sphere radius="1"/></geometry></collision></link>'
             b'<link name="m"><collision><geometry><sphere radius="1"/></geometry></collision></link><joint name="j" type="continuous">'
             b'<parent link="l\xff"/><child link="m"/></joint></robot>', command="info --robot arm.urdf --json out.json", status=(0, 2)),
        Case("model: no file", INFO, {"arm.urdf": None}, words=("arm.urdf", "no such file")),
        Case("model: empty", INFO, {"arm.urdf": ""}, words=("arm.urdf",)),
        Case("model: not XML", INFO, {"arm.urdf": "robot: arm\n"}, words=("arm.urdf",)),
        Case("model: cut short", INFO, {"arm.urdf": URDF[:900]}, words=("arm.urdf",)),
        Case("model: binary", INFO, {"arm.urdf": bytes(range(256)) * 8}, words=("arm.urdf",)),
        Case("model: NUL inside", INFO, {"arm.urdf": URDF.replace("tool", "to\0ol").encode()}, words=("arm.urdf", "byte 0|text")),
        Case("model: UTF-16", INFO, {"arm.urdf": URDF.encode("utf-16")}, words=("arm.urdf",)),
        Case("model: byte order mark", INFO, {"arm.urdf": URDF.encode("utf-8-sig")}, status=(0,)),
        Case("model: CR LF", INFO, {"arm.urdf": URDF.replace("\n", "\r\n")}, status=(0,)),
        Case("model: a folder", "info --robot .", words=(r"\.",)),
        Case("model: an SDF file", INFO, {"arm.urdf": '<sdf version="1.6"><model name="a"/></sdf>'}, words=("arm.urdf", "sdf|SDF|robot")),
        Case("model: an MJCF file", INFO, {"arm.urdf": '<mujoco model="a"/>'}, words=("arm.urdf",)),
        Case("model: one link", "info --robot arm.urdf",
             {"arm.urdf": '<robot name="a"><link name="l"><collision><geometry><sphere radius="1"/></geometry></collision></link></robot>'},
             words=("arm.urdf", "--scene|joint")),
        Case("model: no link", "info --robot arm.urdf", {"arm.urdf": '<robot name="a"/>'}, words=("arm.urdf", "link")),
        Case("model: no collision geometry", "info --robot arm.urdf", {"arm.urdf": URDF.replace("collision", "visual")}, words=("arm.urdf", "collision")),
        Case("model: entities that grow", INFO, {"arm.urdf": '<!DOCTYPE r [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;">]><robot name="&b;"/>'},
             words=("arm.urdf",)),
        Case("model: deep nesting", INFO, {"arm.urdf": "<robot name='a'>" + "<link>" * 200000}, words=("arm.urdf",)),
        Case("mesh: empty file", INFO, {"fore.stl": ""}, words=("fore", "fore.stl")),
        Case("mesh: not a mesh", INFO, {"fore.stl": "hello"}, words=("fore.stl",)),
        Case("mesh: git-LFS pointer", INFO, {"fore.stl": "version https://git-lfs.github.com/spec/v1\noid sha256:" + "0" * 64 + "\nsize 12\n"},
             words=("fore.stl", "LFS|lfs")),
        Case("mesh: binary STL cut short", INFO, {"fore.stl": b"\0" * 80 + (1000).to_bytes(4, "little") + b"\0" * 200}, words=("fore.stl",)),
        Case("mesh: binary STL of four thousand million triangles", INFO, {"fore.stl": b"\0" * 80 + b"\xff\xff\xff\xff" + b"\0" * 50}, words=("fore.stl",)),
        Case("mesh: NaN", INFO, {"fore.stl": ("vertex 0.4 ", "vertex nan ")}, words=("fore.stl",)),
        Case("mesh: infinite", INFO, {"fore.stl": ("vertex 0.4 ", "vertex 1e999 ")}, words=("fore.stl",)),
        Case("mesh: an OBJ without faces", INFO, {"arm.urdf": ("fore.stl", "fore.obj"), "fore.obj": "v 0 0 0\n"}, words=("fore.obj",)),
        Case("mesh: an OBJ face beyond its vertices", INFO, {"arm.urdf": ("fore.stl", "fore.obj"), "fore.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"},
             words=("fore.obj",)),
        Case("mesh: a picture", INFO, {"arm.urdf": ("fore.stl", "fore.png"), "fore.png": b"\x89PNG\r\n"}, words=("fore.png",)),
    ]
    return cases


def srdf(name, old, new, *words, status=(2,), command=INFO):
    return Case("SRDF: " + name, command, {"arm.srdf": (old, new)}, status, words)


def srdf_cases():
    return [
        Case("SRDF: no file", INFO, {"arm.srdf": None}, words=("arm.srdf", "no such file")),
        Case("SRDF: empty", INFO, {"arm.srdf": ""}, words=("arm.srdf",)),
        Case("SRDF: not XML", INFO, {"arm.srdf": "groups: []"}, words=("arm.srdf",)),
        Case("SRDF: the URDF", "info --robot arm.urdf --srdf arm.urdf", status=(2,), words=("arm.urdf", "URDF")),
        srdf("of another robot", 'robot name="arm"', 'robot name="leg"', status=(0, 2)),
        srdf("an absent joint in a group that is not used", '<joint name="slide"/></group>', '<joint name="hinge"/></group>', "notice", "hinge", status=(0,)),
        srdf("an absent joint in the group that is used", '<joint name="slide"/></group>', '<joint name="hinge"/></group>', "arm.srdf", "hinge",
             command=INFO + " --group arm"),
        srdf("an absent link in a chain", 'tip_link="fore"', 'tip_link="hand"', "notice", "hand", status=(0,)),
        srdf("a chain that is used and broken", 'tip_link="fore"', 'tip_link="hand"', "arm.srdf", "hand", command=INFO + " --group two"),
        srdf("a chain backwards", 'base_link="base" tip_link="fore"', 'base_link="fore" tip_link="base"', status=(0, 2), command=INFO + " --group two"),
        srdf("a subgroup of itself", '<joint name="slide"/></group>', '<group name="arm"/></group>', "arm", status=(0, 2), command=INFO + " --group arm"),
        srdf("a group twice", 'group name="two"', 'group name="arm"', "arm", status=(0, 2)),
        srdf("a pair with an absent link", 'link1="base" link2="upper"', 'link1="base" link2="hand"', "notice", "hand", status=(0,)),
        srdf("a pair without link2", 'link1="base" link2="upper"', 'link1="base"', "arm.srdf|notice", status=(0, 2)),
        srdf("a state without group", 'name="home" group="arm"', 'name="home"', "notice", "home", status=(0,)),
        srdf("a state that is no number", 'name="slide" value="0"', 'name="slide" value="far"', "far", status=(0, 2)),
        srdf("unknown group", "", SRDF, "leg", command=INFO + " --group leg"),
        srdf("absent joint, --strict", '<joint name="slide"/></group>', '<joint name="hinge"/></group>', "arm.srdf", "hinge", command=INFO + " --strict"),
    ]


def scene(name, old, new, *words, status=(2,), command=CHECK):
    return Case("scene: " + name, command, {"scene.yaml": (old, new)}, status, ("scene.yaml",) * (status == (2,)) + words)


def scene_cases():
    pose = "orientation: [0, 0, 0, 1]"
    return [
        Case("scene: no file", CHECK, {"scene.yaml": None}, words=("scene.yaml", "no such file")),
        Case("scene: empty", CHECK, {"scene.yaml": ""}, (0, 2), ("scene.yaml",)),
        Case("scene: a list", CHECK, {"scene.yaml": "- 1\n"}, words=("scene.yaml",)),
        Case("scene: tabs", CHECK, {"scene.yaml": "world:\n\tcollision_objects: []\n"}, words=("scene.yaml",)),
        Case("scene: a bomb", CHECK, {"scene.yaml": "a: &a [1,1,1,1,1,1,1,1,1]\n" + "".join(
            f"{chr(98 + i)}: &{chr(98 + i)} [{','.join(['*' + chr(97 + i)] * 9)}]\n" for i in range(9)) + "world: *j\n"}, words=("scene.yaml",)),
        Case("scene: two hundred thousand brackets", CHECK, {"scene.yaml": "world: " + "[" * 200000}, words=("scene.yaml",)),
        Case("scene: a URDF that is not one", CHECK.replace("scene.yaml", "scene.urdf"), {"scene.urdf": "<robot"}, words=("scene.urdf",)),
        scene("key one letter away", "collision_objects:", "collision_object:", "collision_object", "collision_objects"),
        scene("key far away", "name: room", "name: room\ncolour: red", "notice", "colour", status=(0,)),
        scene("no id", "    - id: wall\n      primitives", "    - primitives", "id"),
        scene("dimensions of two", "[0.2, 2, 2]", "[0.2, 2]", "wall"),
        scene("dimensions negative", "[0.2, 2, 2]", "[-0.2, 2, 2]", "wall"),
        scene("dimensions text", "[0.2, 2, 2]", "[wide, 2, 2]", "wall"),
        scene("dimensions missing", "          dimensions: [0.2, 2, 2]\n", "", "wall", "dimensions"),
        scene("no pose", "      primitive_poses:\n        - position: [2.0, 0, 0]\n          orientation: [0, 0, 0, 1]\n", "", "wall"),
        scene("position of two", "[2.0, 0, 0]", "[2.0, 0]", "wall"),
        scene("position at 1e20 m", "[2.0, 0, 0]", "[1.0e20, 0, 0]", "wall", "far|position|m"),
        scene("orientation of three", pose, "orientation: [0, 0, 1]", "wall"),
        scene("orientation zero", pose, "orientation: [0, 0, 0, 0]", "wall", "quaternion"),
        scene("orientation not normalised", pose, "orientation: [0, 0, 0, 2]", "notice", "wall", status=(0,)),
        scene("type unknown", "type: box", "type: torus", "wall", "torus"),
        scene("same id twice", "world:\n  collision_objects:\n", "world:\n  collision_objects:\n    - id: wall\n      primitives:\n        - type: sphere\n"
              "          dimensions: [0.1]\n      primitive_poses:\n        - position: [3, 0, 0]\n          orientation: [0, 0, 0, 1]\n", "wall"),
        scene("frame unknown", "id: wall", "id: wall\n      header: {frame_id: nowhere}", "nowhere"),
        scene("mesh missing", "", MESH_SCENE.replace("fore.stl", "pot.stl"), "pot.stl"),
        scene("mesh scale zero", "", MESH_SCENE.replace("resource: fore.stl", "resource: fore.stl\n          scale: [0, 1, 1]"), status=(0, 2)),
        scene("allowed pair of an unknown name", "name: room", "name: room\nallowed_collision_matrix:\n  entry_names: [wall, ghost]\n"
              "  entry_values:\n    - enabled: [true, true]\n    - enabled: [true, true]", status=(0, 2)),
        scene("allowed matrix that is not square", "name: room", "name: room\nallowed_collision_matrix:\n  entry_names: [wall, tool]\n"
              "  entry_values:\n    - enabled: [true]", "allowed_collision_matrix|entry"),
        scene("attached to an unknown link", "name: room", "name: room\nrobot_state:\n  attached_collision_objects:\n    - link_name: hand\n"
              "      object: {id: cup, primitives: [{type: sphere, dimensions: [0.1]}], primitive_poses: [{position: [0, 0, 0], orientation: [0, 0, 0, 1]}]}",
              "hand"),
    ]


def table(name, text, *words, status=(2,), command=CHECK):
    return Case("states: " + name, command, {"states.csv": text}, status, ("states.csv",) * (status == (2,)) + words)


def edges(name, text, *words, status=(2,)):
    return Case("edges: " + name, EDGE, {"edges.csv": text}, status, ("edges.csv",) * (status == (2,)) + words)


def table_cases():
    head = "shoulder,elbow,slide\n"
    wide = "from:shoulder,from:elbow,from:slide,to:shoulder,to:elbow,to:slide\n"
    return [
        Case("states: no file", CHECK, {"states.csv": None}, words=("states.csv", "no such file")),
        table("empty", "", "empty"),
        table("header only", head, status=(0, 2)),
        table("blank lines only", "\n\n\n"),
        table("text", head + "0,up,0\n", "line 2", "elbow", "up"),
        table("NaN", head + "0,nan,0\n", "line 2", "elbow"),
        table("infinite", head + "0,0,inf\n", "line 2", "slide"),
        table("too large a number", head + "0,1e999,0\n", "line 2", "elbow"),
        table("hexadecimal", head + "0,0x10,0\n", "line 2", "elbow"),
        table("decimal comma", head + "0;0,5;0\n", "line 2"),
        table("semicolons", "shoulder;elbow;slide\n0;0;0\n"),
        table("short row", head + "0,0\n", "line 2"),
        table("long row", head + "0,0,0,0\n", "line 2"),
        table("cell missing", head + "0,,0\n", "line 2", "elbow", "missing"),
        table("column twice", "shoulder,elbow,elbow\n0,0,0\n", "elbow", "twice"),
        table("column missing", "shoulder,elbow\n0,0\n", "notice", "slide", status=(0,)),
        table("unknown column", "shoulder,elbow,slide,hinge\n0,0,0,0\n", "notice", "hinge", status=(0,)),
        table("no known column", "a,b\n0,0\n", "states.csv"),
        table("quote not closed", head + '0,"0,0\n', "line 2"),
        table("NUL in a cell", (head + "0,0\0,0\n").encode(), "line 2", "elbow|byte 0|text"),
        table("binary", bytes(range(256))),
        table("byte order mark and CR LF", "\ufeff" + head.replace("\n", "\r\n") + "0,0,0\r\n", status=(0,)),
        table("beyond limits", head + "9,0,0\n", "notice", "shoulder", status=(0, 1)),
        table("1e308 rad", head + "1e308,0,0\n", status=(0, 1, 2)),
        Case("states: a folder", CHECK.replace("states.csv", "."), words=(r"\.",)),
        Case("states: the scene", CHECK.replace("states.csv", "scene.yaml", 1).replace("--scene scene.yaml", "") + " --states scene.yaml", status=(2,)),
        edges("empty", ""),
        edges("header only", wide, status=(0, 2)),
        edges("a table of states", STATES, "from:"),
        edges("to missing", "from:shoulder,from:elbow,from:slide,to:shoulder,to:elbow\n0,0,0,0,0\n", status=(2,)),
        edges("NaN", wide + "0,0,0,nan,0,0\n", "line 2", "to:shoulder"),
        edges("infinite", wide + "0,0,0,0,-inf,0\n", "line 2", "to:elbow"),
        edges("both ends equal", wide + "0,0,0,0,0,0\n", status=(0,)),
        edges("1e5 rad long", wide + "0,0,0,1e5,0,0\n", status=(0, 1, 2)),
        edges("1e9 rad long", wide + "0,0,0,1e9,0,0\n", status=(0, 1, 2)),
        edges("1e300 rad long", wide + "0,0,0,1e300,0,0\n", status=(0, 1, 2)),
    ]


def request(name, old, new, *words, status=(2,), command=PLAN):
    return Case("request: " + name, command, {"request.yaml": (old, new)}, status, words)


def request_cases():
    goal = "goal_constraints:\n  - joint_constraints:\n"
    return [
        Case("request: no file", PLAN, {"request.yaml": None}, words=("request.yaml", "no such file")),
        Case("request: empty", PLAN, {"request.yaml": ""}, words=("request.yaml",)),
        Case("request: a list", PLAN, {"request.yaml": "[1, 2]"}, words=("request.yaml",)),
        Case("request: not YAML", PLAN, {"request.yaml": "a: [b"}, words=("request.yaml",)),
        request("unknown group", "group_name: arm", "group_name: leg", "leg"),
        request("goal out of limits", "position: 1\n", "position: 2.5\n", "shoulder", "limit"),
        request("goal NaN", "position: 1\n", "position: .nan\n", "request.yaml"),
        request("goal text", "position: 1\n", "position: far\n", "request.yaml"),
        request("goal twice", "      - joint_name: elbow\n", "      - joint_name: shoulder\n", "shoulder|elbow"),
        request("goal of an unknown joint", "joint_name: elbow", "joint_name: knee", "knee"),
        request("goal of a pose", goal, "goal_constraints:\n  - position_constraints: []\n    joint_constraints:\n", status=(0, 2)),
        request("two goals", goal, goal + "      - joint_name: slide\n        position: 0\n  - joint_constraints:\n", "request.yaml"),
        request("no goal", REQUEST[REQUEST.index("goal_constraints"):], "", "goal"),
        request("start out of limits", "[-1, 0, 0]", "[-3, 0, 0]", "start_state", "shoulder", "limit"),
        request("start of two numbers", "[-1, 0, 0]", "[-1, 0]", "request.yaml"),
        request("start of an unknown joint", "[shoulder, elbow, slide]", "[shoulder, elbow, knee]", "knee", status=(0, 2)),
        request("planning time negative", "allowed_planning_time: 5", "allowed_planning_time: -5", "allowed_planning_time"),
        request("planning time text", "allowed_planning_time: 5", "allowed_planning_time: soon", "allowed_planning_time"),
        request("path constraints", "group_name: arm", "group_name: arm\npath_constraints: {joint_constraints: [{joint_name: elbow, position: 0}]}", "path_constraints"),
        Case("request: start in contact", PLAN, {"scene.yaml": ("[2.0, 0, 0]", "[0.4, -0.7, 0]")}, words=("start_state", "wall", "contact")),
        Case("request: goal in contact", PLAN, {"scene.yaml": ("[2.0, 0, 0]", "[0.4, 0.9, 0]"), "request.yaml": ("[-1, 0, 0]", "[-2, 0, 0]")},
             (1, 2), ("goal", "wall")),
        Case("request: base in the floor", PLAN, {"scene.yaml": ("[2.0, 0, 0]", "[0, 0, -1.2]")}, words=("base", "wall")),
        Case("goal: unknown joint", f"plan {WORLD} --goal knee=1 --out out.yaml", words=("knee",)),
        Case("goal: no value", f"plan {WORLD} --goal shoulder --out out.yaml", words=("shoulder",)),
        Case("goal: text", f"plan {WORLD} --goal shoulder=far --out out.yaml", words=("far",)),
        Case("goal: twice", f"plan {WORLD} --goal shoulder=1,shoulder=0 --out out.yaml", words=("shoulder", "twice")),
        Case("goal: out of limits", f"plan {WORLD} --goal shoulder=2.5 --out out.yaml", words=("shoulder", "limit")),
        Case("goal: unknown state", f"plan {WORLD} --goal house --out out.yaml", words=("house", "home")),
        Case("goal: none", f"plan {WORLD} --out out.yaml", words=("--goal|--request",)),
        Case("allow: no pair", CHECK + " --allow tool", words=("--allow", "tool")),
        Case("allow: unknown object", CHECK + " --allow tool:ghost", words=("--allow", "ghost")),
    ]


def path(name, text, *words, status=(2,)):
    return Case("path: " + name, AUDIT, {"path.yaml": text}, status, ("path.yaml",) * (status == (2,)) + words)


def path_cases():
    names = "joint_names: [shoulder, elbow, slide]\ngroup: arm\n"
    return [
        Case("path: no file", AUDIT, {"path.yaml": None}, words=("path.yaml", "no such file")),
        path("empty", ""),
        path("no points", names),
        path("no names", "group: arm\npoints:\n  - positions: [0, 0, 0]\n"),
        path("points empty", names + "points: []\n"),
        path("short point", names + "points:\n  - positions: [0, 0]\n"),
        path("text", names + "points:\n  - positions: [0, up, 0]\n"),
        path("infinite", names + "points:\n  - positions: [0, .inf, 0]\n"),
        path("unknown joint", names.replace("slide", "knee") + "points:\n  - positions: [0, 0, 0]\n", "knee|slide"),
        path("joint twice", names.replace("slide", "elbow") + "points:\n  - positions: [0, 0, 0]\n", "repeated|twice"),
        path("unknown group", PATH.replace("group: arm", "group: leg"), "leg"),
        path("margin negative", PATH + "min_d: -1\n", "min_d"),
        path("out of limits", PATH.replace("[1, 0, 0.05]", "[9, 0, 0.05]"), "shoulder", status=(1,)),
        path("into the wall", PATH.replace("[1, 0, 0.05]", "[1, 0, 0.05]"), status=(0,)),
        path("one point", names + "points:\n  - positions: [0, 0, 0]\n", status=(0, 2)),
        path("1e9 rad long", PATH.replace("[1, 0, 0.05]", "[1.0e9, 0, 0.05]"), status=(1, 2)),
        path("the request", REQUEST),
    ]


def option(name, command, *words, status=(2,)):
    return Case("option: " + name, command, {}, status, words)


def option_cases():
    return [
        option("no subcommand", "", "subcommand"),
        option("unknown subcommand", "frobnicate", "frobnicate"),
        option("unknown option", CHECK + " --sideways", "--sideways"),
        option("robot missing", "info", "--robot"),
        option("states missing", f"check {WORLD}", "--states"),
        option("margin negative", CHECK + " --min-d -1", "--min-d"),
        option("margin NaN", CHECK + " --min-d nan", "--min-d"),
        option("margin infinite", CHECK + " --min-d inf", "--min-d"),
        option("margin text", CHECK + " --min-d wide", "--min-d"),
        option("max-d zero", CHECK + " --max-d 0", "--max-d"),
        option("alpha one", CHECK + " --alpha 1", "--alpha"),
        option("alpha negative", CHECK + " --alpha -0.5", "--alpha"),
        option("what unknown", CHECK + " --what all", "--what"),
        option("simd unknown", CHECK + " --simd avx1024", "--simd"),
        option("group unknown", CHECK + " --group leg", "leg"),
        option("margins of an unknown link", CHECK + " --margins m.yaml", "m.yaml"),
        option("margin between links negative", CHECK + " --self-margin -1", "--self-margin"),
        option("detail negative", CHECK + " --detail -1", "--detail"),
        option("input limit without value", CHECK + " --input-limit triangles", "--input-limit"),
        option("input limit unknown", CHECK + " --input-limit towers=3", "towers"),
        option("input limit met", CHECK + " --input-limit triangles=5", "triangles", "--input-limit"),
        option("cache in a file", CHECK + " --cache arm.urdf", "arm.urdf"),
        option("package path missing", CHECK + " --package-path nowhere", "nowhere"),
        option("slack zero", EDGE + " --slack 0", "--slack"),
        option("validator unknown", EDGE + " --validator guess", "--validator"),
        option("planner unknown", PLAN + " --planner Magic", "Magic", "RRTConnect"),
        option("planner parameter unknown", PLAN + " --planner-param reach=1", "reach", "range"),
        option("planner parameter no number", PLAN + " --planner-param range=wide", "wide"),
        option("time negative", PLAN + " --time -1", "--time"),
        option("seed zero", PLAN + " --seed 0", "--seed"),
        option("threads for one that has none", PLAN + " --planner RRTConnect --threads 4", "--threads|thread"),
        option("resolution zero", AUDIT + " --resolution 0", "--resolution"),
        option("budget negative", f"pairs {MODEL} --budget -1", "--budget"),
        option("samples zero", f"pairs {MODEL} --samples 0 --budget 0", status=(0, 1, 2)),
        option("samples negative", f"pairs {MODEL} --samples -5", "--samples"),
        option("excess zero", f"spherize {MODEL} --excess 0 --out spheres", "--excess"),
        option("neither excess nor spheres", f"spherize {MODEL} --out spheres", "--excess|--spheres"),
        option("excess and spheres", f"spherize {MODEL} --excess 9 --spheres 9 --out spheres", "--excess|--spheres"),
        option("fewer spheres than links", f"spherize {MODEL} --spheres 1 --out spheres", "spheres|links"),
        option("same option twice", CHECK + " --robot arm.urdf", "--robot"),
    ]


def output_cases():
    return [
        Case("output: over the robot", CHECK.replace("out.csv", "arm.urdf"), words=("arm.urdf",)),
        Case("output: over the SRDF", CHECK.replace("out.csv", "arm.srdf"), words=("arm.srdf",)),
        Case("output: over the scene", CHECK.replace("out.csv", "scene.yaml"), words=("scene.yaml",)),
        Case("output: over a mesh", CHECK.replace("out.csv", "fore.stl"), words=("fore.stl",)),
        Case("output: over its states", CHECK.replace("out.csv", "states.csv"), words=("states.csv",)),
        Case("output: over its states by another name", CHECK.replace("out.csv", "./states.csv"), words=("states.csv",)),
        Case("output: over its edges", EDGE.replace("out.csv", "edges.csv"), words=("edges.csv",)),
        Case("output: over its request", PLAN.replace("out.yaml", "request.yaml"), words=("request.yaml",)),
        Case("output: over its path", AUDIT.replace("report.json", "path.yaml"), words=("path.yaml",)),
        Case("output: pairs over the robot", PAIRS.replace("new.srdf", "arm.urdf"), words=("arm.urdf",)),
        Case("output: pairs over its SRDF", PAIRS.replace("new.srdf", "arm.srdf"), words=("arm.srdf",)),
        Case("output: info over the robot", INFO + " --json arm.urdf", words=("arm.urdf",)),
        Case("output: two in one file", PLAN.replace("report.json", "out.yaml"), words=("out.yaml",)),
        Case("output: profile and report in one file", AUDIT + " --profile report.json", words=("report.json",)),
        Case("output: in no folder", CHECK.replace("out.csv", "none/out.csv"), words=("none/out.csv",)),
        Case("output: a folder", CHECK.replace("out.csv", "."), words=(r"\.",)),
        Case("output: spheres into a file", SPHERIZE.replace("spheres", "arm.urdf"), words=("arm.urdf",)),
        Case("output: full device", CHECK.replace("out.csv", "/dev/full"), words=("/dev/full",)),
        Case("output: standard output that is full", CHECK.replace(" --out out.csv", " >/dev/full"), words=("standard output|stdout",)),
    ]


def cases():
    return (model_cases() + srdf_cases() + scene_cases() + table_cases() + request_cases() + path_cases() + option_cases() + output_cases())
