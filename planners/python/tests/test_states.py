# SPDX-License-Identifier: BSD-3-Clause
"""States: against formulas in NumPy, bit for bit against C, in any number of threads."""
import numpy
import pytest

import leeway
from conftest import ball_robot

ROUNDING = 1e-11  # metres: kinematics and distances of bodies of a few metres


@pytest.fixture(scope="module")
def balls():
    return ball_robot()


@pytest.fixture(scope="module")
def obstacles():
    scene = leeway.Scene()
    scene.add("ball", leeway.Shape.sphere(0.3), (1, 0.5, 0))
    scene.add("box", leeway.Shape.box(0.4, 0.6, 0.8), (-1, 0, 0.5))
    return scene


def truth(q, radius=0.1):
    """Distances by formula: left and right ball, each to the ball and the box of the scene; pairs as names."""
    left, right = q[:, :3], q[:, 3:]

    def to_box(p):
        gap = numpy.maximum(numpy.abs(p - numpy.array([-1, 0, 0.5])) - numpy.array([0.2, 0.3, 0.4]), 0)
        return numpy.linalg.norm(gap, axis=1) - radius

    columns = [numpy.linalg.norm(left - right, axis=1) - 2 * radius]
    names = [("left", "right")]
    for name, p in (("left", left), ("right", right)):
        columns += [numpy.linalg.norm(p - numpy.array([1, 0.5, 0]), axis=1) - radius - 0.3, to_box(p)]
        names += [(name, "ball"), (name, "box")]
    return numpy.maximum(numpy.array(columns).T, 0), names


def test_clearances_equal_formulas(balls, obstacles, rng):
    checker = leeway.Checker(balls, obstacles)
    q = rng.uniform(-2, 2, (2000, 6))
    all_pairs, names = truth(q)
    lower, upper, pairs, witnesses = checker.clearance(q)
    expected = all_pairs.min(axis=1)
    assert (expected == 0).any() and (expected > 0.1).any()
    assert (lower <= expected + 1e-15).all()
    numpy.testing.assert_allclose(upper, expected, rtol=0, atol=ROUNDING)
    numpy.testing.assert_allclose(lower, expected, rtol=0, atol=ROUNDING)
    apart = expected > 1e-6
    nearest = [names[i] for i in all_pairs.argmin(axis=1)]
    assert [tuple(pair) for pair in checker.names[pairs][apart]] == [n for n, a in zip(nearest, apart) if a]
    gaps = numpy.linalg.norm(witnesses[:, 0] - witnesses[:, 1], axis=1)
    numpy.testing.assert_allclose(gaps[apart], upper[apart], rtol=0, atol=ROUNDING)


def test_environment_and_self_are_told_apart(balls, obstacles, rng):
    checker = leeway.Checker(balls, obstacles)
    q = rng.uniform(-2, 2, (500, 6))
    all_pairs, _ = truth(q)
    numpy.testing.assert_allclose(checker.clearance(q, check="self").upper, all_pairs[:, 0], rtol=0, atol=ROUNDING)
    numpy.testing.assert_allclose(checker.clearance(q, check="environment").upper, all_pairs[:, 1:].min(axis=1), rtol=0, atol=ROUNDING)


@pytest.mark.parametrize("min_d", [0.0, 0.01, 0.03])
def test_is_free_says_what_clearances_say(checker, states, min_d):
    clearances = checker.clearance(states)
    free = checker.is_free(states, min_d=min_d)
    assert free.dtype == bool and 0 < free.sum() < len(free)
    assert (free == (clearances.lower > min_d)).all()


def test_answers_are_the_bits_of_c(checker, states, reference):
    lower, upper, pairs, witnesses = checker.clearance(states)
    answers, _ = reference("states", states)
    answers = answers.reshape(len(states), 10)
    found = numpy.column_stack([lower, upper, pairs, witnesses.reshape(-1, 6)])
    assert found.tobytes() == answers.tobytes()


def test_threads_and_earlier_calls_change_no_bit(checker, states):
    first = checker.clearance(states)
    checker.clearance(states[::-1])
    for threads in (1, 2, 7, 0):
        for a, b in zip(first, checker.clearance(states, threads=threads)):
            assert a.tobytes() == b.tobytes()


def test_one_state_has_no_first_axis(checker, states):
    many, one = checker.clearance(states[:1]), checker.clearance(states[0])
    assert one.lower.shape == () and one.pairs.shape == (2,) and one.witnesses.shape == (2, 3)
    assert one.lower == many.lower[0] and (one.pairs == many.pairs[0]).all()
    assert checker.is_free(states[0]) is bool(checker.is_free(states[:1])[0])


def test_no_state_gives_no_answer(checker):
    empty = numpy.empty((0, checker.dof))
    assert checker.clearance(empty).lower.shape == (0,) and checker.is_free(empty).shape == (0,)


def test_arrays_of_any_kind_are_taken(checker, states):
    expected = checker.clearance(states).lower
    fortran, wide = numpy.asfortranarray(states), numpy.repeat(states, 2, axis=1)[:, ::2]
    frozen = states.copy()
    frozen.flags.writeable = False
    for q in (fortran, wide, frozen, states.tolist()):
        assert (checker.clearance(q).lower == expected).all()
    single = checker.clearance(states.astype(numpy.float32)).lower
    numpy.testing.assert_allclose(single, expected, atol=1e-5)


def test_errors_name_the_state_and_never_read_as_free(checker, states):
    states[17, 2] = numpy.nan
    for call in (checker.clearance, checker.is_free):
        with pytest.raises(leeway.CoreError, match=r"q\[17\]: entry 2 is not finite") as caught:
            call(states, threads=2)
        assert caught.value.status == "LW_ERROR_INVALID_ARGUMENT" and isinstance(caught.value, ValueError)
    with pytest.raises(ValueError, match=r"q: shape \(5, 3\) is neither \(4,\) nor \(n, 4\): 4 variables of the group"):
        checker.clearance(numpy.zeros((5, 3)))
    with pytest.raises(ValueError, match="check: 'all' is none of"):
        checker.is_free(states[0], check="all")
    with pytest.raises(leeway.CoreError):
        checker.clearance(states[0], alpha=2)


def test_ranges_and_margins_bound_the_true_clearance(robot, scene, checker, states):
    exact = checker.clearance(states)
    rough = checker.clearance(states, alpha=0.3, max_d=0.03)
    assert (rough.lower <= exact.upper + ROUNDING).all() and (rough.upper >= exact.lower - ROUNDING).all()
    assert numpy.isinf(rough.upper).any() and (rough.pairs[numpy.isinf(rough.upper)] == -1).all()
    margins = leeway.Margins(environment=0.02, self_collision=0.02)
    with_margin = leeway.Checker(robot, scene, group="arm", margins=margins).clearance(states)
    apart = exact.lower > 0.02
    numpy.testing.assert_allclose(with_margin.upper[apart], exact.upper[apart] - 0.02, rtol=0, atol=ROUNDING)


def test_proofs_of_pairs_change_no_answer(robot, scene, checker, states):
    fast = leeway.Checker(robot, scene, group="arm", reach=leeway.Reach(robot, seconds=0.2))
    a, b = checker.clearance(states), fast.clearance(states)
    numpy.testing.assert_allclose(a.lower, b.lower, rtol=0, atol=ROUNDING)
    assert (checker.is_free(states) == fast.is_free(states)).all()


def test_full_states_of_a_batch_are_those_of_its_first(checker, robot, states):
    full = checker.full_state(states[:9])
    columns = [robot.variables.index(name) for name in checker.variables]
    assert (full[:, columns] == states[:9]).all()
    others = [k for k in range(len(robot.variables)) if k not in columns]
    assert (full[:, others] == checker.reference[others]).all() and full.tobytes() == b"".join(checker.full_state(q).tobytes() for q in states[:9])
