#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes a curved sheet with a seam on it, for a torch in the hand of arm.urdf. Standard library only.

    seam.py FOLDER

Writes seam_scene.yaml, a planning scene with the sheet as a mesh and the torch in the hand, and seam.txt: poses of the torch's tip from end to
end of the seam, X,Y,Z,QX,QY,QZ,QW in a line. The tip is 4 mm above the sheet and points into it, along the normal.
"""
import math
import pathlib
import sys

STEPS_X, STEPS_Y = 24, 48
LEGS = 24
STAND_OFF = 0.004  # metres
TORCH = 0.12  # metres from the hand's frame to the tip


def height(x, y):
    """The sheet: a saddle, curved by 1 / 0.6 m and 1 / 0.8 m."""
    return 0.35 + (x - 0.5) ** 2 / 1.2 - y ** 2 / 1.6


def normal(x, y):
    n = (-(x - 0.5) / 0.6, y / 0.8, 1)
    return [v / math.hypot(*n) for v in n]


def seam(t):
    """A place on the seam, t from 0 to 1."""
    y = -0.2 + 0.4 * t
    return 0.48 + 0.05 * math.sin(8 * y), y


def pose(t):
    """The tip: its z axis goes into the sheet, its x axis is near the x axis of the base."""
    x, y = seam(t)
    n = normal(x, y)
    place = [x + STAND_OFF * n[0], y + STAND_OFF * n[1], height(x, y) + STAND_OFF * n[2]]
    away = [1 - n[0] * n[0], -n[0] * n[1], -n[0] * n[2]]  # the base's x axis without its part along the normal
    ax = [v / math.hypot(*away) for v in away]
    az = [-v for v in n]
    ay = [az[1] * ax[2] - az[2] * ax[1], az[2] * ax[0] - az[0] * ax[2], az[0] * ax[1] - az[1] * ax[0]]
    # Near a half turn about x: that is the quaternion's largest coordinate
    qx = math.sqrt(1 + ax[0] - ay[1] - az[2]) / 2
    return place + [qx, (ay[0] + ax[1]) / (4 * qx), (az[0] + ax[2]) / (4 * qx), (ay[2] - az[1]) / (4 * qx)]


def scene():
    vertices, triangles = [], []
    for i in range(STEPS_X + 1):
        for j in range(STEPS_Y + 1):
            x, y = 0.35 + 0.3 * i / STEPS_X, -0.3 + 0.6 * j / STEPS_Y
            vertices.append(f"[{x:.6f}, {y:.6f}, {height(x, y):.6f}]")
    for i in range(STEPS_X):
        for j in range(STEPS_Y):
            a = i * (STEPS_Y + 1) + j
            b = a + STEPS_Y + 1
            triangles += [f"{{vertex_indices: [{a}, {b}, {b + 1}]}}", f"{{vertex_indices: [{a}, {b + 1}, {a + 1}]}}"]
    return f"""# Made by seam.py: a curved sheet, and a torch in the hand.
name: sheet
world:
  collision_objects:
    - id: sheet
      meshes: [{{vertices: [{', '.join(vertices)}],
        triangles: [{', '.join(triangles)}]}}]
      mesh_poses: [{{position: [0, 0, 0], orientation: [0, 0, 0, 1]}}]
robot_state:
  attached_collision_objects:
    - link_name: hand
      touch_links: [hand]
      object:
        id: torch
        primitives: [{{type: cylinder, dimensions: [0.05, 0.012]}}, {{type: cylinder, dimensions: [{TORCH - 0.03:.3f}, 0.005]}}]
        primitive_poses: [{{position: [0, 0, 0.005]}}, {{position: [0, 0, {0.03 + (TORCH - 0.03) / 2:.4f}]}}]
object_colors:
  - {{id: sheet, color: {{r: 0.62, g: 0.68, b: 0.74, a: 1}}}}
"""


def sag():
    """Farthest places of the seam from the chain of straight legs, both at the height of the tip: metres."""
    most = 0
    for leg in range(LEGS):
        a, b = pose(leg / LEGS)[:3], pose((leg + 1) / LEGS)[:3]
        way = [q - p for p, q in zip(a, b)]
        for k in range(1, 20):
            p = [v - u for u, v in zip(a, pose((leg + k / 20) / LEGS)[:3])]
            along = sum(u * v for u, v in zip(p, way)) / sum(u * u for u in way)
            most = max(most, math.hypot(*[u - along * v for u, v in zip(p, way)]))
    return most


def main():
    out = pathlib.Path(sys.argv[1])
    (out / "seam_scene.yaml").write_text(scene(), encoding="utf-8")
    poses = [pose(i / LEGS) for i in range(LEGS + 1)]
    (out / "seam.txt").write_text("".join(",".join(f"{v:.9f}" for v in p) + "\n" for p in poses), encoding="utf-8")
    print(f"seam: {LEGS} legs, at most {1000 * sag():.2f} mm from the seam")


if __name__ == "__main__":
    main()
