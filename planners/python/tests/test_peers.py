# SPDX-License-Identifier: BSD-3-Clause
"""Self distances of ten public robots against pinocchio and coal. LEEWAY_PEER_STATES: states of each robot (100).

Robots and peers come from .ci/install.sh zoo-tests; without them these tests fail and say so."""
import json
import os
import pathlib
import subprocess
import sys

import numpy
import pytest

import leeway
from conftest import ROOT

sys.path.insert(0, str(ROOT / "benchmarks" / "zoo"))
import descriptions  # noqa: E402

ZOO = pathlib.Path(os.environ.get("LEEWAY_ZOO_DIR", ROOT / "build" / "zoo"))
STATES = int(os.environ.get("LEEWAY_PEER_STATES", "100"))
SORTING = 15  # states by which pairs that touch by design are found
CONTACT = 1e-6  # metres: coal's yes or no of curved shapes is this exact
ROBOTS = ["ur/ur5_robot", "panda", "kinova", "z1", "a1", "go1", "so_arm/so100", "allegro_hand/allegro_left_hand", "tiago/tiago_no_hand",
    "double_pendulum/double_pendulum_continuous"]


@pytest.fixture(scope="module")
def zoo():
    found = {robot.name: robot for robot in descriptions.find(ZOO)}
    if not found or not (ZOO / "venv" / "bin" / "python").exists():
        pytest.fail(f"{ZOO} has no robots or no peers: run .ci/install.sh zoo-tests")
    return found


def peer(folder, question):
    given, answer = folder / "question.json", folder / "answer.json"
    given.write_text(json.dumps(question))
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    subprocess.run([ZOO / "venv" / "bin" / "python", ROOT / "benchmarks" / "zoo" / "oracle.py", given, answer], check=True, timeout=3000,
        env=environment)
    found = json.loads(answer.read_text())
    assert "error" not in found, found
    return found


@pytest.mark.parametrize("name", ROBOTS)
def test_self_distances_agree_with_pinocchio_and_coal(name, zoo, rng, tmp_path):
    urdf = zoo[name].urdf
    robot = leeway.Robot(urdf)
    low, high = numpy.maximum(robot.lower, -numpy.pi), numpy.minimum(robot.upper, numpy.pi)
    states = rng.uniform(low, high, (SORTING + STATES, len(low)))
    truth = peer(tmp_path, {"urdf": str(urdf), "names": robot.variables, "states": states.tolist(), "sorting": SORTING})
    text = "".join(f'<disable_collisions link1="{a}" link2="{b}" reason="User"/>' for a, b in truth["disabled"])
    checker = leeway.Checker(leeway.Robot(urdf, f'<robot name="{robot.name}">{text}</robot>'))
    found = checker.clearance(states[SORTING:], check="self", threads=0)
    free = checker.is_free(states[SORTING:], check="self", threads=0)
    distance = numpy.array([answer["distance"] for answer in truth["answers"]])
    touches = distance <= 0
    differ = free == touches
    grazing = differ & (numpy.maximum(distance, found.lower) < CONTACT)
    assert len(distance) == STATES and (differ == grazing).all()
    apart = free & ~touches & numpy.isfinite(distance)
    off = numpy.maximum(found.lower - distance, distance - found.upper)[apart]
    assert (off <= CONTACT).all(), off.max()
    print(f"{name}: {STATES} states, {int(touches.sum())} in contact, {int(grazing.sum())} grazing, off by {off.max(initial=0):.1e} m")
