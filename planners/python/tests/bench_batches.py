#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Cost of Checker.clearance() over a loop in C: both take turns on the same states, one thread, processor time.

    bench_batches.py --reference build/bin/python_reference [--states 100000] [--rounds 7] URDF SRDF SCENE GROUP

SRDF and SCENE may be "". Prints the medians, their ratio, and whether all bits are equal. The aim: at most 5 % and 0.1 us a state.
"""
import argparse
import pathlib
import subprocess
import tempfile
import time

import numpy

import leeway


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--reference", required=True)
    parser.add_argument("--states", type=int, default=100000)
    parser.add_argument("--rounds", type=int, default=7)
    for name in ("urdf", "srdf", "scene", "group"):
        parser.add_argument(name)
    a = parser.parse_args()
    scene = leeway.Scene(a.scene) if a.scene else None
    checker = leeway.Checker(leeway.Robot(a.urdf, a.srdf), scene, group=a.group)
    q = numpy.random.default_rng(1).uniform(checker.lower, checker.upper, (a.states, checker.dof))
    checker.clearance(q[:1000])
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        given, answers = pathlib.Path(folder, "states"), pathlib.Path(folder, "answers")
        given.write_bytes(q.tobytes())
        for _ in range(a.rounds):
            call = [a.reference, "states", a.urdf, a.srdf, a.scene, a.group, given, answers, "3"]
            in_c = float(subprocess.run(call, check=True, capture_output=True, text=True).stdout)
            in_python = []
            for _ in range(3):
                begin = time.thread_time()
                found = checker.clearance(q)
                in_python.append(time.thread_time() - begin)
            rows.append((in_c, min(in_python)))
        table = numpy.column_stack([found.lower, found.upper, found.pairs, found.witnesses.reshape(-1, 6)])
        equal = table.tobytes() == answers.read_bytes()
    c, python = numpy.median(rows, axis=0) / a.states * 1e6
    ratio = numpy.median([p / t for t, p in rows])
    print(f"C {c:.3f} us, Python {python:.3f} us a state; median of ratios {ratio:.3f}, of the least times {min(r[1] for r in rows) / min(r[0] for r in rows):.3f}; "
          f"bits {'equal' if equal else 'DIFFER'}")


if __name__ == "__main__":
    main()
