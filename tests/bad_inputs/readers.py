# SPDX-License-Identifier: BSD-3-Clause
"""One good file for every reader of the program, and the command whose answer depends on it.

A Reader says where hostile.py may lay hands on: the file, a number in it, and the form of its text. Each file is small, whole, and
says nothing that has no meaning, so that its clean answer is one without a notice about it.
"""
import base64
import json
import struct
import zlib
from dataclasses import dataclass, field

from cases import EDGES, FILES, MARGINS, MODEL, PATH, REQUEST, SCENE, SRDF, STATES, URDF, WORLD

CHECK = f"check {WORLD} --group arm --states states.csv --no-cache --out out.csv"
EDGE = f"edge {WORLD} --group arm --edges edges.csv --no-cache --out out.csv"
PLAN = f"plan {WORLD} --request request.yaml --no-cache --out out.yaml"
AUDIT = f"audit {WORLD} --no-cache --report report.json"

CORNERS = ((0, 0, 0), (0.4, 0, 0), (0, 0.05, 0), (0, 0, 0.05))
FACES = ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))


@dataclass
class Reader:
    name: str
    file: str  # the file that is damaged
    content: bytes
    command: str
    form: str  # "xml", "yaml", "json", "table" and "list" are text; "binary"
    number: str = ""  # a piece of text with one number, which is marked by bars: 'radius="|0.03|"'
    edits: dict = field(default_factory=dict)  # of the other files
    counts: tuple = ()  # pieces with a number of things, marked alike
    ends: bool = True  # a file that is cut short can be told from a whole one

    @property
    def is_text(self):
        return self.form != "binary"


def obj():
    return ("".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS) + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in FACES)).encode()


def off():
    return ("OFF\n4 4 0\n" + "".join(f"{x} {y} {z}\n" for x, y, z in CORNERS) + "".join(f"3 {a} {b} {c}\n" for a, b, c in FACES)).encode()


def binary_stl():
    facets = b"".join(struct.pack("<3f", 0, 0, 0) + b"".join(struct.pack("<3f", *CORNERS[i]) for i in face) + b"\0\0" for face in FACES)
    return b"\0" * 80 + struct.pack("<I", len(FACES)) + facets


def ply_header(form, faces=True):
    more = f"element face {len(FACES)}\nproperty list uchar int vertex_indices\n" if faces else ""
    return f"ply\nformat {form} 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n{more}end_header\n"


def ply(faces=True):
    rows = [f"{x} {y} {z}\n" for x, y, z in CORNERS] + [f"3 {a} {b} {c}\n" for a, b, c in FACES] * faces
    return (ply_header("ascii", faces) + "".join(rows)).encode()


def binary_ply():
    return (ply_header("binary_little_endian").encode() + b"".join(struct.pack("<3f", *c) for c in CORNERS) +
            b"".join(struct.pack("<B3i", 3, *face) for face in FACES))


def collada():
    numbers = " ".join(str(value) for corner in CORNERS for value in corner)
    faces = " ".join(str(index) for face in FACES for index in face)
    return f"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><unit name="m" meter="1"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="12">{numbers}</float_array>
<technique_common><accessor source="#a" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>{faces}</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><translate>0.001 0 0</translate><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>
""".encode()


def gltf_buffer():
    return b"".join(struct.pack("<3f", *corner) for corner in CORNERS) + b"".join(struct.pack("<3H", *face) for face in FACES)


def gltf_root(uri=None):
    buffer = gltf_buffer()
    return {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "translation": [0.001, 0, 0]}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
            "buffers": [{"byteLength": len(buffer), **({"uri": uri} if uri else {})}],
            "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 24}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                          {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}]}


def gltf(uri=None):
    uri = uri or "data:application/octet-stream;base64," + base64.b64encode(gltf_buffer()).decode()
    return json.dumps(gltf_root(uri), indent=1).encode()


def glb():
    text = json.dumps(gltf_root()).encode()
    text += b" " * (-len(text) % 4)
    binary = gltf_buffer()
    binary += b"\0" * (-len(binary) % 4)
    return (b"glTF" + struct.pack("<2I", 2, 28 + len(text) + len(binary)) + struct.pack("<I", len(text)) + b"JSON" + text +
            struct.pack("<I", len(binary)) + b"BIN\0" + binary)


def pcd():
    return ("VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 4\nHEIGHT 1\nPOINTS 4\nDATA ascii\n" +
            "".join(f"{x} {y} {z}\n" for x, y, z in CORNERS)).encode()


def binary_pcd():
    return pcd().split(b"DATA")[0] + b"DATA binary\n" + b"".join(struct.pack("<3f", *corner) for corner in CORNERS)


def octomap():
    """One occupied cell of 0.1 m at the origin: a chain of 16 nodes. Two bits for each of eight children; 3: has children itself."""
    def node(child, kind):
        return struct.pack("<H", kind << 2 * child)

    return b"# Octomap OcTree binary file\nid OcTree\nsize 17\nres 0.1\ndata\n" + node(7, 3) + node(0, 3) * 14 + node(0, 2)


def png():
    rows = b"".join(b"\0" + bytes(10 * (row + column) for column in range(4)) for row in range(4))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 4, 4, 8, 0, 0, 0, 0)) + chunk(b"IDAT", zlib.compress(rows)) +
            chunk(b"IEND", b""))


def scene_of(shape):
    """A scene with this entry of leeway_shapes, 1.5 m before the arm."""
    return f"""name: room
world:
  collision_objects:
    - id: scan
      pose: {{position: [1.5, 0, 0], orientation: [0, 0, 0, 1]}}
      leeway_shapes:
        - {{{shape}}}
"""


ARTICULATION = """<?xml version="1.0"?>
<robot name="kitchen">
  <link name="box"><collision><origin xyz="1.5 0 0"/><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <link name="door"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
  <joint name="hinge" type="revolute"><parent link="box"/><child link="door"/><origin xyz="1.2 1 0"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="1" effort="1" velocity="1"/></joint>
</robot>
"""
OCTOMAP_SCENE = f"""name: room
world:
  octomap:
    header: {{frame_id: base}}
    origin: {{position: {{x: 1.5, y: 0, z: 0}}, orientation: {{x: 0, y: 0, z: 0, w: 1}}}}
    octomap: {{binary: true, id: OcTree, resolution: 0.1, data: !!binary {base64.b64encode(octomap().split(b'data' + chr(10).encode(), 1)[1]).decode()}}}
"""
TRAJECTORY = """joint_trajectory:
  joint_names: [shoulder, elbow, slide]
  points:
    - positions: [-1, 0, 0]
      time_from_start: {sec: 0, nanosec: 0}
    - positions: [1, 0.25, 0.05]
      time_from_start: {sec: 3, nanosec: 500000000}
"""
JSON_TRAJECTORY = json.dumps({"joint_trajectory": {"joint_names": ["shoulder", "elbow", "slide"], "points": [
    {"positions": [-1, 0, 0], "time_from_start": {"sec": 0, "nanosec": 0}},
    {"positions": [1, 0.25, 0.05], "time_from_start": {"sec": 3, "nanosec": 500000000}}]}}, indent=1) + "\n"
TIMED_TABLE = "time,shoulder,elbow,slide\n0,-1,0,0\n3.5,1,0.25,0.05\n"
STEPS = "steps:\n- trajectory: motion.csv\n- allow: [tool, wall]\n"
JOINT_LIMITS = """joint_limits:
  shoulder:
    has_velocity_limits: true
    max_velocity: 0.25
    has_acceleration_limits: false
"""
PADDING = "default_robot_padding: 0.125\n"
ATTACHED = SCENE + """robot_state:
  attached_collision_objects:
    - link_name: tool
      object:
        id: cup
        primitives: [{type: sphere, dimensions: [0.05]}]
        primitive_poses: [{position: [0.1, 0, 0], orientation: [0, 0, 0, 1]}]
"""


def mesh(name, file, content, form, number="", **more):
    return Reader(name, file, content, CHECK, form, number, {"arm.urdf": ("fore.stl", file)}, **more)


def resource(name, file, content, form, shape, number="", **more):
    return Reader(name, file, content, CHECK, form, number, {"scene.yaml": scene_of(shape + ", resource: " + file)}, **more)


def readers():
    cloud, map_, ground = "type: point_cloud, radius: 0.05", "type: octomap, unknown: free", "type: height_map, resolution: 0.1, z_scale: 0.001"
    text = str.encode
    return [
        Reader("URDF", "arm.urdf", text(URDF), CHECK, "xml", 'origin xyz="|0.4| 0 0"/><axis xyz="0 0 1"'),
        Reader("URDF sizes", "arm.urdf", text(URDF), CHECK, "xml", 'sphere radius="|0.03|"'),
        Reader("SRDF", "arm.srdf", text(SRDF), f"{CHECK} --strict", "xml", 'name="slide" value="|0|"'),
        Reader("scene", "scene.yaml", text(SCENE), CHECK, "yaml", "position: [|2.0|, 0, 0]", ends=False),
        Reader("scene sizes", "scene.yaml", text(SCENE), CHECK, "yaml", "dimensions: [|0.2|, 2, 2]", ends=False),
        Reader("attached object", "scene.yaml", text(ATTACHED), CHECK, "yaml", "dimensions: [|0.05|]", ends=False),
        Reader("articulation", "kitchen.urdf", text(ARTICULATION), CHECK.replace("scene.yaml", "kitchen.urdf"), "xml", 'xyz="|1.5| 0 0"'),
        Reader("states", "states.csv", text(STATES), CHECK, "table", "0.5,|0.5|,0.05", ends=False),
        Reader("edges", "edges.csv", text(EDGES), EDGE, "table", "-1,0,0,|1|,0,0.1", ends=False),
        Reader("request", "request.yaml", text(REQUEST), PLAN, "yaml", "position: |1|\n", ends=False),
        Reader("path", "path.yaml", text(PATH), f"{AUDIT} --path path.yaml", "yaml", "[|1|, 0, 0.05]", ends=False),
        Reader("trajectory", "motion.yaml", text(TRAJECTORY), f"{AUDIT} --trajectory motion.yaml", "yaml", "[1, |0.25|, 0.05]", ends=False),
        Reader("trajectory times", "motion.yaml", text(TRAJECTORY), f"{AUDIT} --trajectory motion.yaml", "yaml", "sec: |3|,", ends=False),
        Reader("JSON trajectory", "motion.json", text(JSON_TRAJECTORY), f"{AUDIT} --trajectory motion.json", "json", "|0.25|"),
        Reader("table trajectory", "motion.csv", text(TIMED_TABLE), f"{AUDIT} --trajectory motion.csv", "table", "3.5,|1|,0.25", ends=False),
        Reader("steps", "steps.yaml", text(STEPS), f"{AUDIT} --steps steps.yaml", "yaml", edits={"motion.csv": TIMED_TABLE}, ends=False),
        Reader("joint limits", "limits.yaml", text(JOINT_LIMITS), f"{AUDIT} --trajectory motion.csv --joint-limits limits.yaml", "yaml",
               "max_velocity: |0.25|", {"motion.csv": TIMED_TABLE}, ends=False),
        Reader("margins", "margins.yaml", text(MARGINS), f"{CHECK} --margins margins.yaml", "yaml", "tool: |0.01|", ends=False),
        Reader("padding", "padding.yaml", text(PADDING), f"{CHECK} --padding padding.yaml", "yaml", "padding: |0.125|", ends=False),
        mesh("STL", "fore.stl", FILES["fore.stl"].encode(), "list", "vertex |0.4| 0.025 0.025"),
        mesh("binary STL", "fore.stl", binary_stl(), "binary"),
        mesh("OBJ", "fore.obj", obj(), "list", "v |0.4| 0 0", ends=False),
        mesh("OFF", "fore.off", off(), "list", "|0.4| 0 0", counts=("OFF\n|4| 4 0", "OFF\n4 |4| 0")),
        mesh("PLY", "fore.ply", ply(), "list", "|0.4| 0 0", counts=("vertex |4|", "face |4|", "\n|3| 1 2 3", "3 1 2 |3|")),
        mesh("binary PLY", "fore.ply", binary_ply(), "binary", counts=("vertex |4|", "face |4|")),
        mesh("COLLADA", "fore.dae", collada(), "xml", "0 0 0 |0.4|", counts=('count="|12|"', 'count="|4|" stride', 'stride="|3|"', 'triangles count="|4|"', "1 2 |3|</p>")),
        mesh("glTF", "fore.gltf", gltf(), "json", "|0.001|",
             counts=('"byteLength": |72|', '"byteOffset": |48|', '"byteLength": |48|', '"count": |4|', '"count": |12|', '"indices": |1|', '"mesh": |0|', '"componentType": |5126|')),
        mesh("binary glTF", "fore.glb", glb(), "binary"),
        resource("PCD", "cloud.pcd", pcd(), "list", cloud, "|0.4| 0 0", counts=("WIDTH |4|", "POINTS |4|", "SIZE |4| 4 4", "COUNT |1| 1 1", "HEIGHT |1|")),
        resource("binary PCD", "cloud.pcd", binary_pcd(), "binary", cloud, counts=("WIDTH |4|", "POINTS |4|", "SIZE |4| 4 4", "COUNT |1| 1 1")),
        resource("PLY cloud", "cloud.ply", ply(False), "list", cloud, "|0.4| 0 0", counts=("vertex |4|",)),
        resource("octomap", "map.bt", octomap(), "binary", map_, counts=("size |17|", "res |0.1|")),
        Reader("octomap message", "scene.yaml", text(OCTOMAP_SCENE), CHECK, "yaml", "x: |1.5|", counts=("resolution: |0.1|",), ends=False),
        resource("height map", "ground.txt", b"0 1 2\n3 4 5\n6 7 8\n", "list", ground, "|4|", ends=False),
        resource("PNG height map", "ground.png", png(), "binary", ground),
    ]


__all__ = ["Reader", "readers", "gltf", "gltf_buffer", "scene_of", "CHECK", "MODEL", "AUDIT", "PLAN", "TIMED_TABLE", "ARTICULATION"]
