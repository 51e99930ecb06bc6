# SPDX-License-Identifier: BSD-3-Clause
"""Small random robots and scenes as files, for certificates: every kind of joint and shape that a certificate can hold."""
import math
import struct

JOINTS = ["revolute", "revolute", "revolute", "continuous", "prismatic", "mimic", "planar"]


def numbers(values):
    return " ".join(f"{v:.6f}" for v in values)


def direction(rng):
    while True:
        v = [rng.uniform(-1, 1) for _ in range(3)]
        size = math.sqrt(sum(x * x for x in v))
        if 0.1 < size < 1:
            return [x / size for x in v] if rng.random() < 0.7 else rng.choice([[1, 0, 0], [0, 1, 0], [0, 0, 1]])


def write_mesh(file, rng, size):
    """A notched block or a tetrahedron, as binary STL."""
    if rng.random() < 0.5:
        corners = [[rng.uniform(0.3, 1) * size * s for s in signs] for signs in ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1))]
        faces = [(0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2)]
    else:  # an L, as a prism
        outline = [(0, 0), (2, 0), (2, 0.7), (0.7, 0.7), (0.7, 2), (0, 2)]
        corners = [[size * (x - 0.7), size * (y - 0.7), size * z] for z in (-0.4, 0.4) for x, y in outline]
        faces = [(0, 2, 1), (0, 3, 2), (0, 5, 3), (3, 5, 4)]
        faces += [tuple(i + 6 for i in reversed(f)) for f in faces]
        for i in range(6):
            k = (i + 1) % 6
            faces += [(i, k, k + 6), (i, k + 6, i + 6)]
    with open(file, "wb") as out:
        out.write(b"mesh".ljust(80) + struct.pack("<I", len(faces)))
        for face in faces:
            out.write(struct.pack("<12f", 0, 0, 0, *(x for i in face for x in corners[i])) + b"\0\0")


def write_robot(folder, rng):
    links, joints, last = ["<link name='base'><collision><geometry><box size='0.1 0.1 0.1'/></geometry></collision></link>"], [], "base"
    driver, count = None, rng.randint(2, 5)
    for i in range(count):
        kind = rng.choice(JOINTS) if i > 0 or rng.random() < 0.7 else "planar"
        if kind in ("mimic", "planar") and (driver is None) != (kind == "planar"):
            kind = "revolute"
        length = rng.uniform(0.1, 0.3)
        form = rng.choice(["box", "cylinder", "sphere", "mesh"])
        if form == "mesh":
            write_mesh(folder / f"m{i}.stl", rng, 0.25 * length)
        geometry = {"box": f"<box size='{numbers([length, rng.uniform(0.03, 0.1), rng.uniform(0.03, 0.1)])}'/>",
            "cylinder": f"<cylinder radius='{rng.uniform(0.02, 0.06):.6f}' length='{length:.6f}'/>",
            "sphere": f"<sphere radius='{rng.uniform(0.03, 0.08):.6f}'/>", "mesh": f"<mesh filename='m{i}.stl'/>"}[form]
        links.append(f"<link name='l{i}'><collision><origin xyz='{length / 2:.6f} 0 0' rpy='{numbers(rng.uniform(-1, 1) for _ in range(3))}'/>"
            f"<geometry>{geometry}</geometry></collision></link>")
        origin = [rng.uniform(0.15, 0.35), rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1)]
        lower, upper = (-rng.uniform(0.1, 0.3), rng.uniform(0.1, 0.3)) if kind in ("prismatic", "planar") else (-rng.uniform(0.5, 3), rng.uniform(0.5, 3))
        extra = f"<mimic joint='{driver}' multiplier='{rng.uniform(-1, 1):.6f}' offset='{rng.uniform(-0.3, 0.3):.6f}'/>" if kind == "mimic" else ""
        joints.append(f"<joint name='j{i}' type='{'revolute' if kind == 'mimic' else kind}'><parent link='{last}'/><child link='l{i}'/>"
            f"<origin xyz='{numbers(origin)}' rpy='{numbers(rng.uniform(-1, 1) for _ in range(3))}'/><axis xyz='{numbers(direction(rng))}'/>"
            f"<limit lower='{lower:.6f}' upper='{upper:.6f}' effort='1' velocity='1'/>{extra}</joint>")
        driver = driver if kind in ("mimic", "planar") else f"j{i}"
        last = f"l{i}" if rng.random() < 0.85 else last
    planar = [f"  j{i}/{part}: {{has_velocity_limits: true, max_velocity: 1}}\n" for i in range(count) for part in ("x", "y", "theta")]
    (folder / "limits.yaml").write_text("joint_limits:\n" + "".join(planar)) # a URDF has none for planar joints
    (folder / "robot.urdf").write_text(f"<robot name='random'>{''.join(links)}{''.join(joints)}</robot>")


def write_scene(folder, rng):
    objects = []
    for i in range(rng.randint(2, 5)):
        at = [rng.uniform(0.15, 0.5) * rng.choice([-1, 1]) for _ in range(3)]
        turn = [rng.uniform(-1, 1) for _ in range(4)]
        size = math.sqrt(sum(v * v for v in turn))
        pose = f"{{position: {at}, orientation: {[v / size for v in turn]}}}"
        kind, a, b = rng.choice(["box", "sphere", "cylinder", "cone", "mesh", "plane"]), rng.uniform(0.03, 0.2), rng.uniform(0.05, 0.3)
        if kind == "mesh":
            vertices = [[rng.uniform(-a, a) for _ in range(3)] for _ in range(5)]
            faces = [f"{{vertex_indices: {f}}}" for f in ([0, 1, 2], [0, 1, 3], [2, 3, 4])]
            corners = [f"{{x: {x}, y: {y}, z: {z}}}" for x, y, z in vertices]
            text = f"meshes: [{{vertices: [{', '.join(corners)}], triangles: [{', '.join(faces)}]}}], mesh_poses: [{pose}]"
        elif kind == "plane":
            text = f"planes: [{{coef: {direction(rng) + [rng.uniform(0.7, 1.2)]}}}], plane_poses: [{{position: [0, 0, 0], orientation: [0, 0, 0, 1]}}]"
        else:
            dimensions = {"box": [a, b, 0.1], "sphere": [a], "cylinder": [b, a], "cone": [b, a]}[kind]
            text = f"primitives: [{{type: {kind}, dimensions: {dimensions}}}], primitive_poses: [{pose}]"
        objects.append(f"    - {{id: o{i}, {text}}}\n")
    (folder / "scene.yaml").write_text(f"name: random\nworld:\n  collision_objects:\n{''.join(objects)}")


def write_cell(folder, rng):
    """Two robots side by side that drive one trajectory, early or late, a box that passes, and someone of whom only a speed is known."""
    def robot(name, x, seconds):
        return f"  - {{name: {name}, robot: robot.urdf, base: {{position: [{x}, 0, 0]}}, motion: trajectory.yaml, motion_start: {seconds:.3f}, lag: {rng.choice([0, rng.uniform(0, 0.1)]):.4f}}}\n"
    there = [rng.uniform(-1, 1), rng.uniform(0.6, 1.2), 0]
    here = [rng.uniform(-1, 1), -there[1], 0] if rng.random() < 0.3 else [-there[0], there[1], 0]
    box = f"  - {{name: box, shapes: [{{type: box, dimensions: [0.1, 0.1, 0.1]}}], pose: {{position: {there}}}, motion: [{{start: 0, end: {rng.uniform(1, 5):.3f}, position: {here}}}]}}\n"
    person = f"  - {{name: person, shapes: [{{type: sphere, dimensions: [0.2]}}], pose: {{position: [0, 0, {rng.uniform(-3, -1.5)}]}}, unknown_motion: {{speed: {rng.uniform(0.01, 0.2)}, from: {rng.uniform(0, 1)}}}}}\n"
    (folder / "cell.yaml").write_text("leeway_world: 1\nrobots:\n" + robot("left", 0, rng.uniform(0, 1)) + robot("right", rng.uniform(0.5, 2), rng.uniform(0, 1))
        + "objects:\n" + box + person + ("scene: scene.yaml\n" if rng.random() < 0.5 else ""))
