# SPDX-License-Identifier: BSD-3-Clause
"""Near pairs: against Checker.clearance(), finite differences, and in any number of threads."""
import numpy
import pytest

import leeway
from conftest import ball_robot


@pytest.fixture(scope="module")
def checker():
    scene = leeway.Scene()
    scene.add("ball", leeway.Shape.sphere(0.3), (1, 0.5, 0))
    scene.add("box", leeway.Shape.box(0.4, 0.6, 0.8), (-1, 0, 0.5))
    return leeway.Checker(ball_robot(), scene)


def test_the_first_row_is_the_nearest_pair(checker, rng):
    q = rng.uniform(-2, 2, (500, 6))
    near = checker.near(q, numpy.inf)
    nearest = checker.clearance(q)
    assert (numpy.diff(near.offsets) == 5).all()  # two balls, two objects, and the balls
    for i in range(len(q)):
        rows = near.rows(i)
        assert (numpy.diff(near.upper[rows]) >= 0).all()
        assert abs(near.upper[rows.start] - nearest.upper[i]) <= 1e-12
    assert (near.lower <= near.upper).all()
    touching = near.upper == 0
    assert touching.any() and (near.directions[touching] == leeway.Direction.NONE).all() and not near.derivatives[touching].any()
    gaps = near.witnesses[:, 0] - near.witnesses[:, 1]
    numpy.testing.assert_allclose(gaps, near.normals * near.upper[:, None], rtol=0, atol=1e-12)


def test_derivatives_are_slopes(checker, rng):
    q = rng.uniform(-2, 2, (100, 6))
    near = checker.near(q, numpy.inf)
    state = numpy.repeat(numpy.arange(len(q)), numpy.diff(near.offsets))
    clear = near.upper > 0.01

    def by_bodies(states):
        moved = checker.near(states, numpy.inf)
        return {(i, *pair): d for i, pair, d in zip(state, map(tuple, moved.pairs.tolist()), moved.upper)}

    h = 1e-6
    for v in range(6):
        step = numpy.eye(6)[v] * h
        more, less = by_bodies(q + step), by_bodies(q - step)
        keys = [(i, *pair) for i, pair in zip(state, map(tuple, near.pairs.tolist()))]
        slopes = numpy.array([(more[k] - less[k]) / (2 * h) for k in keys])
        numpy.testing.assert_allclose(near.derivatives[clear, v], slopes[clear], rtol=0, atol=1e-6)


def test_a_rounded_shape_misses_a_part_or_reaches_too_far(rng):
    box, radius = leeway.Shape.box(0.2, 0.3, 0.4), 0.02
    round_box = box.rounded(radius)
    assert 0 < round_box.excess <= radius * (3 ** 0.5 - 1)
    q = rng.uniform(-1, 1, (500, 6))

    def near(shape):
        scene = leeway.Scene()
        scene.add("box", shape)
        return leeway.Checker(ball_robot(), scene).near(q, numpy.inf, check="environment")

    sharp, soft = near(box), near(round_box)

    def by_bodies(rows):
        state = numpy.repeat(numpy.arange(len(q)), numpy.diff(rows.offsets))
        return {(i, *bodies): (low, high) for i, bodies, low, high in zip(state, map(tuple, rows.bodies.tolist()), rows.lower, rows.upper)}

    rounded_rows = by_bodies(soft)
    for key, (low, high) in by_bodies(sharp).items():
        lower, upper = rounded_rows[key]
        assert lower <= high + 1e-12 and upper >= low - round_box.excess - 1e-12
    for wrong in [-0.1, numpy.nan, numpy.inf]:
        with pytest.raises(leeway.Error, match="radius"):
            box.rounded(wrong)


def test_threads_and_batches_change_no_row(checker, rng):
    q = rng.uniform(-2, 2, (300, 6))
    one, many = checker.near(q, 0.4), checker.near(q, 0.4, threads=4)
    for a, b in zip(one, many):
        numpy.testing.assert_array_equal(a, b)
    single = checker.near(q[7], 0.4)
    rows = one.rows(7)
    assert len(single.offsets) == 2 and single.links.shape == (len(checker.links),)
    numpy.testing.assert_allclose(single.upper, one.upper[rows], rtol=0, atol=1e-12)
    assert (one.links[7] <= 0.4).all() and one.links[7].min() <= max(one.upper[rows].min(initial=0.4), 0)


def test_a_barrier_keeps_its_distance(checker, rng):
    """Velocities at the edge of G v <= h, followed for a small step, do not lower a clearance by more than the barrier allows."""
    q = rng.uniform(-2, 2, 6)
    near = checker.near(q, 1.0)
    while near.upper.size == 0 or near.upper.min() < 0.1:
        q = rng.uniform(-2, 2, 6)
        near = checker.near(q, 1.0)
    G, h = near.barrier(0.05, 3.0)
    assert G.shape == (near.upper.size, 6) and (h > 0).all()
    velocity = rng.normal(size=6)
    velocity *= (h / numpy.maximum(G @ velocity, 1e-9)).min()
    dt = 1e-5
    later = dict(zip(map(tuple, checker.near(q + dt * velocity, 2.0).pairs.tolist()), checker.near(q + dt * velocity, 2.0).upper))
    for pair, before in zip(map(tuple, near.pairs.tolist()), near.upper):
        assert later[pair] - before >= -3.0 * (before - 0.05) * dt - 1e-7
    with pytest.raises(ValueError, match="derivatives=False"):
        checker.near(q, 1.0, derivatives=False).barrier(0, 1)


def test_a_point_moves_as_its_link(checker):
    q = numpy.zeros(6)
    numpy.testing.assert_array_equal(checker.point_jacobian(q, "left", (1, 2, 3)), numpy.eye(6)[:3])
    numpy.testing.assert_array_equal(checker.point_jacobian(q, "right", (1, 2, 3)), numpy.eye(6)[3:])


@pytest.mark.parametrize("arguments", [{"distance": 0}, {"distance": -1}, {"distance": numpy.nan}, {"distance": 1, "alpha": 1},
    {"distance": 1, "tie_width": -1}, {"distance": 1, "check": "all"}])
def test_bad_arguments_are_named(checker, arguments):
    with pytest.raises(ValueError, match="distance|check"):
        checker.near(numpy.zeros(6), **arguments)


def test_bad_states_and_names_are_named(checker):
    with pytest.raises(leeway.CoreError, match=r"q\[0\]: entry 2 is not finite"):
        checker.near([0, 0, numpy.nan, 0, 0, 0], 1)
    with pytest.raises(ValueError, match="no link 'middle'"):
        checker.point_jacobian(numpy.zeros(6), "middle", (0, 0, 0))


def test_depths_of_pairs_in_contact(checker, rng):
    q = rng.uniform(-1.2, 1.2, (3000, 6))
    near, plain = checker.near(q, 0.1, depth=True, tie_width=1e-6), checker.near(q, 0.1)
    touching = near.directions * (near.upper < 0) > 0
    assert touching.sum() > 100 and (near.upper[~touching] >= 0).all() and (plain.upper >= 0).all()
    gaps = near.witnesses[touching, 0] - near.witnesses[touching, 1]
    numpy.testing.assert_allclose(gaps, near.normals[touching] * near.upper[touching, None], rtol=0, atol=1e-11)
    assert (near.upper - near.lower)[touching].max() < 1e-11
    state = numpy.repeat(numpy.arange(len(q)), numpy.diff(near.offsets))
    smooth = numpy.flatnonzero(touching & (near.directions == leeway.Direction.UNIQUE) & (near.upper < -1e-3))
    assert len(smooth) > 50
    h = 1e-6
    for k in smooth[:60]:
        for v in range(6):
            step = numpy.eye(6)[v] * h
            both = checker.near(numpy.array([q[state[k]] - step, q[state[k]] + step]), 0.1, depth=True)
            values = [both.upper[both.rows(i)][(both.pairs[both.rows(i)] == near.pairs[k]).all(axis=1)] for i in range(2)]
            assert abs((values[1] - values[0]) / (2 * h) - near.derivatives[k, v]).max() < 1e-5


def test_depth_of_two_shapes():
    box, ball = leeway.Shape.box(1, 2, 3), leeway.Shape.sphere(0.25)
    depth = leeway.depth(box, None, ball, (0.5, 0, 0))
    assert depth.kind == leeway.DepthKind.OVERLAP and abs(depth.lower - 0.25) < 1e-13 and abs(depth.upper - 0.25) < 1e-13
    numpy.testing.assert_allclose(depth.normal, (-1, 0, 0), atol=1e-14)
    numpy.testing.assert_allclose(depth.witnesses, [(0.5, 0, 0), (0.25, 0, 0)], atol=1e-13)
    assert leeway.depth(box, None, ball, (2, 0, 0)).kind == leeway.DepthKind.APART
    with pytest.raises(ValueError, match="steps"):
        leeway.depth(box, None, ball, None, steps=0)
