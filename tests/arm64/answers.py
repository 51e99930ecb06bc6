# SPDX-License-Identifier: BSD-3-Clause
"""Prints a digest of answers of the Python package: states, edges, a path."""
import hashlib
import pathlib

import numpy

import leeway

first = pathlib.Path(__file__).resolve().parents[2] / "examples" / "first"
checker = leeway.Checker(leeway.Robot(first / "arm.urdf", first / "arm.srdf"), leeway.Scene(first / "scene.yaml"), group="arm")
# raw words: the same on all machines
words = numpy.random.Philox(1).random_raw(2000 * checker.dof).reshape(-1, checker.dof) >> numpy.uint64(11)
q = checker.lower + words * 2.0**-53 * (checker.upper - checker.lower)
free = q[checker.is_free(q)]
for name, arrays in {"states": checker.clearance(q), "edges": checker.edges(q[:-1], q[1:], proved_until=True),
        "path": [checker.plan(free[0], free[1], min_d=0.002).path]}.items():
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(numpy.ascontiguousarray(array).tobytes())
    print(name, digest.hexdigest())
