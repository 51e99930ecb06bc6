# SPDX-License-Identifier: BSD-3-Clause
"""Robots and scenes that tests share, and seeded random numbers. LEEWAY_TEST_SEED sets the seed of all tests."""
import os
import pathlib
import subprocess

import numpy
import pytest

import leeway

ROOT = pathlib.Path(__file__).resolve().parents[3]
FIRST = ROOT / "examples" / "first"


@pytest.fixture
def rng():
    seed = int(os.environ.get("LEEWAY_TEST_SEED", "20260101"))
    print(f"seed {seed}")  # pytest shows it with a failure
    return numpy.random.default_rng(seed)


@pytest.fixture(scope="session")
def robot():
    return leeway.Robot(FIRST / "arm.urdf", FIRST / "arm.srdf")


@pytest.fixture(scope="session")
def scene():
    return leeway.Scene(FIRST / "scene.yaml")


@pytest.fixture(scope="session")
def checker(robot, scene):
    return leeway.Checker(robot, scene, group="arm")


@pytest.fixture
def states(checker, rng):
    """1,000 random states of the arm."""
    return rng.uniform(checker.lower, checker.upper, (1000, checker.dof))


@pytest.fixture
def reference(tmp_path):
    """Answers of the C functions: reference(question, states, rounds) -> (doubles, seconds)."""
    program = os.environ.get("LEEWAY_PYTHON_REFERENCE")
    if not program:
        pytest.fail("LEEWAY_PYTHON_REFERENCE names no program: build the target python_reference, or run the tests by ctest")

    def ask(question, states, rounds=1, urdf=FIRST / "arm.urdf", srdf=FIRST / "arm.srdf", scene=FIRST / "scene.yaml", group="arm"):
        given, answer = tmp_path / "states", tmp_path / "answers"
        given.write_bytes(numpy.ascontiguousarray(states, float).tobytes())
        call = [program, question, str(urdf), str(srdf), str(scene), group, str(given), str(answer), str(rounds)]
        printed = subprocess.run(call, check=True, capture_output=True, text=True).stdout
        return numpy.frombuffer(answer.read_bytes()), float(printed.split()[-1])

    return ask


def ball_robot(radius=0.1):
    """Two balls on rails along x, y and z: distances are known by formula. Returns (robot, poses of both balls for states)."""
    def link(name):
        return f'<link name="{name}"><collision><geometry><sphere radius="{radius}"/></geometry></collision></link>'

    def rail(name, parent, child, axis):
        return (f'<joint name="{name}" type="prismatic"><parent link="{parent}"/><child link="{child}"/><axis xyz="{axis}"/>'
                f'<limit lower="-2" upper="2" effort="1" velocity="1"/></joint>')

    text = ('<robot name="balls"><link name="base"/><link name="a"/><link name="b"/>' + link("left") + '<link name="c"/><link name="d"/>' +
            link("right") + rail("x1", "base", "a", "1 0 0") + rail("y1", "a", "b", "0 1 0") + rail("z1", "b", "left", "0 0 1") +
            rail("x2", "base", "c", "1 0 0") + rail("y2", "c", "d", "0 1 0") + rail("z2", "d", "right", "0 0 1") + "</robot>")
    return leeway.Robot(text)
