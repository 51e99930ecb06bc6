# SPDX-License-Identifier: BSD-3-Clause
"""Rulings on results of others, and certificates with their check."""
import json

import numpy
import pytest

import leeway
import leeway.certificate
from conftest import FIRST

FREE = numpy.array([[0.9, 0.9, 0.9, 0.0], [0.0, -0.6, 1.6, 0.6], [-0.9, 0.9, 0.9, 0.0]])
THROUGH = FREE[[0, 2]]


@pytest.fixture(scope="module")
def checker(robot, scene):
    return leeway.Checker(robot, scene, group="arm")


def box(low, high):
    n = len(low)
    return numpy.vstack([numpy.eye(n), -numpy.eye(n)]), numpy.concatenate([high, -numpy.array(low)])


def test_a_path_through_things_passes(checker, tmp_path):
    [free], [bad] = checker.referee(FREE), checker.referee(THROUGH)
    assert free["passed"] and free["verdict"] == "FREE" and free["lower_bound"] > 0 and free["kind"] == "path"
    assert not bad["passed"] and bad["verdict"] == "BLOCKED" and bad["worst"]["depth"][1] >= bad["worst"]["depth"][0] >= 0
    lower, upper, *_ = checker.clearance(bad["worst"]["state"])
    assert upper <= 0
    numpy.save(tmp_path / "paths.npy", numpy.stack([THROUGH, THROUGH]).astype(numpy.float32))
    assert [one["verdict"] for one in checker.referee(tmp_path / "paths.npy")] == ["BLOCKED", "BLOCKED"]


def test_a_state_outside_of_the_region_is_blamed(checker):
    a, b = box(THROUGH.min(axis=0) - 0.05, THROUGH.max(axis=0) + 0.05)
    [ruling] = checker.referee((a, b), seed=3)
    assert ruling["verdict"] == "BLOCKED"
    for kind in ("first", "worst"):
        assert (a @ ruling[kind]["state"] <= b + 1e-12).all()
    [small] = checker.referee(box(FREE[1] - 1e-4, FREE[1] + 1e-4), search=0.05, prove=10)
    assert small["verdict"] == "FREE" and small["region"]["proved_share"] == 1


def test_arguments_are_taken_as_they_come(checker, tmp_path):
    for item, part in ((numpy.zeros((0, 4)), "rows"), (numpy.zeros((2, 3)), "4"), ((numpy.eye(4), numpy.ones(3)), "b")):
        with pytest.raises(ValueError, match=part):
            checker.referee(item)
    with pytest.raises(ValueError, match="policy"):
        checker.referee(FREE, policy="lenient")
    (tmp_path / "r.json").write_text(json.dumps({"A": [[1, 0]], "b": [1]}))
    with pytest.raises(leeway.InputError, match="r.json"):
        checker.referee(tmp_path / "r.json")


def test_a_certificate_is_accepted_for_another_motion_or_robot(checker, tmp_path):
    urdf = str(FIRST / "arm.urdf")
    data = checker.certificate(FREE, sources=[urdf])
    verdict = leeway.certificate.check(data, files=[urdf])
    assert verdict.accepted and verdict.text.startswith("accepted: 2 pieces"), verdict.text
    assert all(len(one) == 3 for one in verdict.allowed)
    file = tmp_path / "c.lwc"
    file.write_bytes(data)
    assert leeway.certificate.check(file) == verdict
    (tmp_path / "other.urdf").write_text("<robot/>")
    assert "was not made from" in leeway.certificate.check(file, files=[tmp_path / "other.urdf"]).text
    assert not leeway.certificate.check(data[:-40] + data[-39:]).accepted
    content = leeway.certificate.content(data)
    content["pieces"][0][0][1] += 1.5
    file.write_text(json.dumps(content))
    assert leeway.certificate.check(file).text.startswith("rejected: ")


def test_a_path_that_is_not_free_gets_a_certificate(checker):
    with pytest.raises(leeway.InputError, match="not farther apart than required"):
        checker.certificate(THROUGH)
    with pytest.raises(leeway.InputError, match="piece 1"):
        checker.certificate(FREE, tolerance=[0.5] * 4)
    with pytest.raises(ValueError, match="min_d"):
        checker.certificate(FREE, min_d=-1)


def test_a_trajectory_gets_the_certificate_of_its_polyline(checker):
    path, speeds = FREE[[0, 1]], numpy.zeros((2, 4))
    straight = leeway.certificate.content(checker.certificate_trajectory([0.0, 2.0], path))
    data = checker.certificate_trajectory([0.0, 2.0], path, speeds, tolerance=[0.001] * 4)
    cubic = leeway.certificate.content(data)
    assert straight["seconds"] == cubic["seconds"] == [2.0]
    assert [len(straight["pieces"][0]), len(cubic["pieces"][0])] == [1, 3]
    assert leeway.certificate.check(data).accepted
    with pytest.raises(leeway.InputError, match="not farther apart"):
        checker.certificate_trajectory([0.0, 2.0], THROUGH)


def test_certificates_of_one_checker_differ(checker):
    first = checker.certificate(FREE)
    checker.certificate(FREE[[1, 2]], check="self", tolerance=[0.001] * 4)
    assert checker.certificate(FREE) == first


def test_states_of_a_bubble_collide(checker):
    random = numpy.random.default_rng(3)
    blocked = 0
    for state in random.uniform(-1.5, 1.5, (40, 4)):
        box = checker.bubble(state)
        free = checker.clearance(state)[0] > 0
        assert (box > 0).all() == free
        blocked += not free
        corners = state + box * numpy.sign(random.uniform(-1, 1, (200, 4)))
        assert not free or all(checker.clearance(corner)[0] > 0 for corner in corners)
    assert blocked > 0
    assert (checker.bubble(FREE[0], most=1e-4) <= 1e-4).all()
    for wrong in ({"min_d": -1}, {"most": 0}):
        with pytest.raises(ValueError, match="min_d"):
            checker.bubble(FREE[0], **wrong)
