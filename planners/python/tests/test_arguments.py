# SPDX-License-Identifier: BSD-3-Clause
"""Whole numbers of arguments: True is no 1, 2.9 no 2; messages name the place, the value, the range and a remedy."""
import os
import re

import numpy
import pytest

import leeway
from leeway import tune

CUBE = numpy.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
FACES = numpy.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]])
RANGE = "give whole numbers from 0 to 7, indices of vertices"


def changed(row, column, value, type_of=numpy.int64):
    faces = FACES.astype(type_of)
    faces[row, column] = value
    return faces


def with_bool(row, column, value):
    faces = FACES.tolist()
    faces[row][column] = value
    return faces


WRONG = {
    "True in a list": (with_bool(5, 2, True), "triangles[5, 2]: is True, no whole number; " + RANGE),
    "False in a tuple": (tuple(map(tuple, with_bool(0, 0, False))), "triangles[0, 0]: is False, no whole number; " + RANGE),
    "NumPy's True in a list": (with_bool(11, 1, numpy.True_), f"triangles[11, 1]: is {numpy.True_!r}, no whole number; " + RANGE),
    "True in a list of arrays": ([numpy.array([0, 1, 2]), [0, True, 2]], "triangles[1, 1]: is True, no whole number; " + RANGE),
    "an array of bools": (FACES > 3, "triangles[0, 0]: is False of type bool; " + RANGE),
    "a list of bools": ([[True, False, True]], "triangles[0, 0]: is True, no whole number; " + RANGE),
    "2^70": ([[0, 1, 2], [0, 1, 2**70]], f"triangles[1, 2]: is {2**70}; " + RANGE),
    "an array of fractions": (FACES + 0.5, "triangles[0, 0]: is 0.5 of type float64; " + RANGE),
    "an index beyond": (changed(7, 1, 8), "triangles[7, 1]: is 8; " + RANGE),
    "a negative index": (changed(3, 2, -1), "triangles[3, 2]: is -1; " + RANGE),
    "2^32": (changed(2, 0, 2**32), "triangles[2, 0]: is 4294967296; " + RANGE),
    "2^63": (changed(2, 0, 2**63, numpy.uint64), "triangles[2, 0]: is 9223372036854775808; " + RANGE),
    "an index beyond in eight bits": (changed(2, 0, 200, numpy.uint8), "triangles[2, 0]: is 200; " + RANGE),
    "a fraction": (with_bool(1, 1, 2.9), "triangles[1, 1]: is 2.9, no whole number; " + RANGE),
    "NaN": (with_bool(1, 1, numpy.nan), "triangles[1, 1]: is nan, no whole number; " + RANGE),
    "texts": ([["0", "1", "2"]], "triangles[0, 0]: is '0', no whole number; " + RANGE),
    "None": ([[0, 1, None]], "triangles[0, 2]: is None, no whole number; " + RANGE),
    "two columns": (FACES[:, :2], "triangles: shape (12, 2) is not (n, 3); give rows of three"),
    "one row": (FACES[0], "triangles: shape (3,) is not (n, 3); give rows of three"),
    "rows of other lengths": ([[0, 1, 2], [3]], "triangles: is no array of integers; give rows of equal lengths"),
}


@pytest.mark.parametrize("name", WRONG)
def test_an_index_that_is_none_is_named_by_its_place(name):
    given, message = WRONG[name]
    with pytest.raises(ValueError, match=re.escape(message)):
        leeway.Shape.mesh(CUBE, given)


def test_a_mesh_without_vertices_has_no_indices():
    with pytest.raises(ValueError, match=re.escape("triangles[0, 0]: is 0; give none, as there are no vertices")):
        leeway.Shape.mesh(numpy.empty((0, 3)), [[0, 0, 0]])


class Index:
    """A whole number of another type."""

    def __index__(self):
        return 2


CALLS = {
    "clearance": lambda c, r, s: lambda n: c.clearance(s, threads=n), "is_free": lambda c, r, s: lambda n: c.is_free(s, threads=n),
    "edges": lambda c, r, s: lambda n: c.edges(s[:2], s[2:4], threads=n), "path": lambda c, r, s: lambda n: c.path(s[:2], threads=n),
    "curves": lambda c, r, s: lambda n: c.curves(s[None, :3], threads=n), "trajectory": lambda c, r, s: lambda n: c.trajectory([0, 1], s[:2], threads=n),
    "prepare": lambda c, r, s: lambda n: c.prepare(threads=n), "prepare by place": lambda c, r, s: lambda n: c.prepare(n),
    "plan": lambda c, r, s: lambda n: c.plan(s[0], s[0], threads=n), "spheres": lambda c, r, s: lambda n: r.spheres(excess=0.1, threads=n),
    "Reach": lambda c, r, s: lambda n: leeway.Reach(r, seconds=0, threads=n),
}
COUNTS = {
    "seed of plan": ("seed", 0, 2**64 - 1, lambda c, r, s: lambda n: c.plan(s[0], s[0], seed=n)),
    "most_nodes of plan": ("most_nodes", 2, 2**32 - 1, lambda c, r, s: lambda n: c.plan(s[0], s[0], most_nodes=n)),
    "optimize_samples of plan": ("optimize_samples", 0, 2**64 - 1, lambda c, r, s: lambda n: c.plan(s[0], s[0], optimize_samples=n)),
    "seed of goal_states": ("seed", 0, 2**64 - 1, lambda c, r, s: lambda n: c.goal_states("hand", numpy.eye(4), seed=n)),
    "count of goal_states": ("count", 1, 2**32 - 1, lambda c, r, s: lambda n: c.goal_states("hand", numpy.eye(4), count=n)),
    "seed of plan_line": ("seed", 0, 2**64 - 1, lambda c, r, s: lambda n: c.plan_line("hand", [[0.4, 0, 0.5], [0.4, 0.1, 0.5]], attempts=1, seed=n)),
    "attempts of plan_line": ("attempts", 1, 2**32 - 1, lambda c, r, s: lambda n: c.plan_line("hand", [[9, 9, 9], [9, 9, 8]], attempts=n)),
    "seed of Reach": ("seed", 0, 2**64 - 1, lambda c, r, s: lambda n: leeway.Reach(r, seconds=0, seed=n)),
    "count of spheres": ("count", 0, 2**32 - 1, lambda c, r, s: lambda n: r.spheres(excess=0.1, count=n)),
    "count of enclosing_spheres": ("count", 0, 2**32 - 1, lambda c, r, s: lambda n: leeway.Shape.mesh(CUBE, FACES).enclosing_spheres(count=n)),
    "states of tune": ("states", 1, 2**31 - 1, lambda c, r, s: lambda n: tune.tune(c, states=n)),
    "edges of tune": ("edges", 1, 2**31 - 1, lambda c, r, s: lambda n: tune.tune(c, edges=n)),
    "samples of pairs": ("samples", 0, 2**32 - 1, lambda c, r, s: lambda n: leeway.pairs(r, seconds=0, samples=n)),
    "seed of pairs": ("seed", 0, 2**64 - 1, lambda c, r, s: lambda n: leeway.pairs(r, seconds=0, samples=2, seed=n)),
    "never_after of pairs": ("never_after", 0, 2**32 - 1, lambda c, r, s: lambda n: leeway.pairs(r, seconds=0, samples=2, never_after=n)),
    "seed of tune": ("seed", 0, 2**63 - 1, lambda c, r, s: lambda n: tune.tune(c, seed=n)),
    **{f"threads of {name}": ("threads", 0, 4096, call) for name, call in CALLS.items()},
}
NO_NUMBERS = {"True": True, "False": False, "NumPy's bool": numpy.True_, "a fraction": 2.0, "NaN": float("nan"), "a text": "3", "None": None, "an array": numpy.array([1, 2]), "a list": [1]}


@pytest.mark.parametrize("name", COUNTS)
def test_a_count_that_is_none_is_named_with_its_range(checker, robot, states, name):
    argument, least, most, make = COUNTS[name]
    call = make(checker, robot, states[checker.is_free(states)][:10])
    for wrong in NO_NUMBERS.values():
        with pytest.raises(ValueError, match=re.escape(f"{argument}: is {wrong!r}, no whole number; give a whole number from {least} to {most}")):
            call(wrong)
    for wrong in (least - 1, most + 1, -2**70, 2**70):
        with pytest.raises(ValueError, match=re.escape(f"{argument}: is {wrong}; give a whole number from {least} to {most}")):
            call(wrong)


@pytest.mark.parametrize("name", [name for name in COUNTS if "tune" not in name])
def test_whole_numbers_of_every_type_are_taken(checker, robot, states, name):
    call = COUNTS[name][3](checker, robot, states[checker.is_free(states)][:10])
    for number in (2, numpy.int64(2), numpy.uint8(2), Index()):
        call(number)


def test_counts_of_campaigns_are_refused_alike(tmp_path):
    if os.environ.get("LEEWAY_PYTHON_EXTRAS") != "required":
        pytest.importorskip("pyarrow")
    from leeway.fleet import run, verify
    for wrong in (True, 1.0, -1, "2"):
        with pytest.raises(ValueError, match=f"workers: is {wrong!r}"):
            run(tmp_path / "none.toml", workers=wrong)
        for name in ("remake", "seed"):
            with pytest.raises(ValueError, match=f"{name}: is {wrong!r}"):
                verify(tmp_path, **{name: wrong})
