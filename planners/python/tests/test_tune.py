# SPDX-License-Identifier: BSD-3-Clause
"""leeway.tune: promises hold on states that it did not see, proposals meet their target."""
import numpy
import pytest

import leeway
import leeway.tune
from conftest import ball_robot


@pytest.fixture(scope="module")
def tuned(checker):
    return leeway.tune.tune(checker, min_d=0.002, max_d=0.3, states=200, edges=60, error=0.01)


def test_promises_hold_on_other_states(tuned, checker, states):
    truth = numpy.clip(checker.clearance(states).upper, 0.002, 0.3)
    for row in (row for row in tuned.settings if row.kind == "states"):
        found = checker.clearance(states, min_d=row.min_d, max_d=row.max_d, alpha=row.alpha).lower
        reported = numpy.clip(numpy.where(found <= row.min_d, 0.002, numpy.minimum(found, row.max_d)), 0.002, 0.3)
        assert (reported <= truth + 1e-9).all() and (truth - reported).max() <= row.promised + 1e-9, row


def test_promises_hold_on_other_edges(tuned, checker, states):
    a, b = states[:-1], states[:-1] + 0.1 * (states[1:] - states[:-1])
    for row in (row for row in tuned.settings if row.kind != "states" and row.proof):
        free = checker.edges(a, b, min_d=row.min_d, slack=row.slack, step=row.step, alpha=row.alpha).free
        roomy = checker.edges(a, b, min_d=0.002 + row.promised, slack=1e-5).free
        assert (free >= roomy).all(), row


def test_proposals_keep_their_proofs_and_meet_their_target(tuned):
    assert tuned.met and tuned.states.promised <= 0.01 and tuned.states.proof and tuned.edges.proof
    assert any(row.front for row in tuned.settings) and not all(row.front for row in tuned.settings)
    exact = tuned.settings[0]
    assert exact.promised == 0 and exact.worst <= 1e-9 and "target met" in repr(tuned)


def test_a_target_out_of_reach_is_said(checker):
    found = leeway.tune.tune(checker, max_d=0.3, states=40, edges=10, microseconds=1e-6)
    assert not found.met and "NOT met" in repr(found) and found.states is not None


def test_bad_requests_are_refused(checker):
    with pytest.raises(ValueError, match="give one of"):
        leeway.tune.tune(checker, error=0.1, microseconds=1)
    with pytest.raises(ValueError, match="range of clearances"):
        leeway.tune.tune(checker, min_d=0.5, max_d=0.1)
    walled = leeway.Scene()
    walled.add("block", leeway.Shape.halfspace(), [0, 0, 9])
    with pytest.raises(ValueError, match="none of 20000 random states"):
        leeway.tune.tune(leeway.Checker(ball_robot(), walled), states=10, edges=5)
