# SPDX-License-Identifier: BSD-3-Clause
"""Fifteen arms of the zoo: their descriptions, their first links and their tips."""
import csv
import os
import pathlib
import tempfile
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass

import leeway

ROOT = pathlib.Path(__file__).resolve().parents[2]
DATA = "example-robot-data/cmeel.prefix/share/example-robot-data/robots"
BULLET = "pybullet/pybullet_data"
SUITE = "robosuite/robosuite/models/assets/bullet_data"


@dataclass(frozen=True)
class Arm:
    name: str
    file: str  # below the zoo folder
    base: str  # link
    tip: str

    @property
    def urdf(self):
        return zoo_folder() / self.file

    def joints(self):
        """Names of the joints that move, from the base to the tip."""
        of_child = {joint.find("child").get("link"): joint for joint in ElementTree.parse(self.urdf).getroot().findall("joint")}
        names, link = [], self.tip
        while link != self.base:
            joint = of_child[link]
            names.append(joint.get("name") if joint.get("type") != "fixed" else None)
            link = joint.find("parent").get("link")
        return [name for name in reversed(names) if name]

    def load(self, self_collision=False):
        """The robot, and a checker of the arm alone, without obstacles; other joints stand at zero. Self-collision: but for pairs that need no check."""
        name = ElementTree.parse(self.urdf).getroot().get("name")
        group = f'<group name="arm"><chain base_link="{self.base}" tip_link="{self.tip}"/></group>'
        with tempfile.TemporaryDirectory() as folder:
            srdf = pathlib.Path(folder) / "arm.srdf"
            srdf.write_text(f'<robot name="{name}">{group}</robot>')
            robot = leeway.Robot(self.urdf, srdf, missing_meshes="skip")
            if self_collision:
                srdf.write_text(leeway.pairs(robot, seconds=1, samples=500, srdf=True)["new_srdf"])
                robot = leeway.Robot(self.urdf, srdf, missing_meshes="skip")
        return robot, leeway.Checker(robot, group="arm")


def zoo_folder():
    return ROOT / (os.environ.get("LEEWAY_ZOO_DIR") or "build/zoo")


def say(row):
    """Prints a row of figures."""
    print("; ".join(f"{key} {value:.4g}" if isinstance(value, float) else f"{key} {value}" for key, value in row.items()), flush=True)


def write(rows, name):
    """Writes rows to a CSV file, if it has a name."""
    if name:
        with open(name, "w", newline="") as file:
            writer = csv.DictWriter(file, list(dict.fromkeys(key for row in rows for key in row)))
            writer.writeheader()
            writer.writerows(rows)


ARMS = (
    Arm("UR3", f"{DATA}/ur_description/urdf/ur3_robot.urdf", "base_link", "ee_link"),
    Arm("UR5", f"{DATA}/ur_description/urdf/ur5_robot.urdf", "base_link", "ee_link"),
    Arm("UR10", f"{DATA}/ur_description/urdf/ur10_robot.urdf", "base_link", "ee_link"),
    Arm("Kinova j2s6s200", f"{DATA}/kinova_description/robots/kinova.urdf", "j2s6s200_link_base", "j2s6s200_end_effector"),
    Arm("Unitree Z1", f"{DATA}/z1_description/urdf/z1.urdf", "link00", "link06"),
    Arm("xArm6", f"{BULLET}/xarm/xarm6_robot.urdf", "link_base", "link6"),
    Arm("Panda", f"{DATA}/panda_description/urdf/panda.urdf", "panda_link0", "panda_hand"),
    Arm("xArm7", f"{DATA}/xarm_description/urdf/xarm7.urdf", "link_base", "link_eef"),
    Arm("iiwa", f"{BULLET}/kuka_iiwa/model.urdf", "lbr_iiwa_link_0", "lbr_iiwa_link_7"),
    Arm("Sawyer", f"{SUITE}/sawyer_description/urdf/sawyer_arm.urdf", "right_arm_base_link", "right_l6"),
    Arm("Baxter, left", f"{DATA}/baxter_description/urdf/baxter.urdf", "torso", "left_gripper"),
    Arm("Talos, left", f"{DATA}/talos_data/robots/talos_reduced.urdf", "torso_2_link", "gripper_left_base_link"),
    Arm("Tiago", f"{DATA}/tiago_description/robots/tiago.urdf", "torso_lift_link", "arm_tool_link"),
    Arm("PR2, right", f"{DATA}/pr2_description/urdf/pr2.urdf", "torso_lift_link", "r_gripper_tool_frame"),
    Arm("G1, left", f"{DATA}/g1_description/urdf/g1_29dof_rev_1_0.urdf", "torso_link", "left_rubber_hand"),
)
