#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compares a URDF with the stage of USD that another program makes of it: poses of links at random states, limits.

    PYTHONPATH=build/python usd_round.py --converter urdf_usd_converter [--states 100] [--package NAME=FOLDER]... ROBOT.urdf...

The converter is that of the package urdf-usd-converter, in an environment of its own: it brings an OpenUSD along. Stages have numbers of
four bytes, so a robot is equal if poses and limits differ by less than 1e-6. Exit status 1 if one differs.
"""
import argparse
import pathlib
import subprocess
import sys
import tempfile

import numpy

import leeway
from leeway import usd

LIMIT = 1e-6


def compare(urdf, stage, states):
    """(result, links, greatest difference of poses, of limits)"""
    wanted, found = leeway.Robot(urdf, missing_meshes="skip"), usd.load(stage)
    if sorted(wanted.variables) != sorted(found.variables):
        return "differs", 0, 0, 0
    order = [wanted.variables.index(name) for name in found.variables]
    links = [name for name in wanted.links if name in found.links]
    first, second = ([robot.links.index(name) for name in links] for robot in (wanted, found))
    limits = max((float(numpy.abs(a[order] - b)[numpy.abs(b) < 1e6].max(initial=0)) for a, b in
        ((wanted.lower, found.lower), (wanted.upper, found.upper))), default=0)
    rng, worst = numpy.random.default_rng(20261125), 0.0
    for _ in range(states):
        q = rng.uniform(numpy.maximum(wanted.lower, -3), numpy.minimum(wanted.upper, 3))
        poses, others = wanted.fk(q)[first], found.fk(q[order])[second]
        base = others[0] @ numpy.linalg.inv(poses[0])  # the stage's own place of the robot
        worst = max(worst, float(numpy.abs(base @ poses - others).max()))
    return ("equal" if max(worst, limits) < LIMIT else "differs"), len(links), worst, limits


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--converter", required=True)
    parser.add_argument("--states", type=int, default=100)
    parser.add_argument("--package", action="append", default=[], metavar="NAME=FOLDER")
    parser.add_argument("urdfs", nargs="+", type=pathlib.Path)
    options = parser.parse_args()
    packages = [word for package in options.package for word in ("--package", package)]
    bad = 0
    print("| robot | result | links | greatest difference of a pose | of a limit |\n|---|---|---|---|---|")
    for urdf in options.urdfs:
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([options.converter, "--no-layer-structure", str(urdf), folder, *packages], capture_output=True, text=True)
            stages = sorted(pathlib.Path(folder).glob("*.usd*"))
            if not stages:
                print(f"| {urdf.stem} | the converter made none | | | {(done.stdout + done.stderr).strip().splitlines()[-1][:120]} |", flush=True)
                continue
            result, links, pose, limit = compare(urdf, stages[0], options.states)
        bad += result != "equal"
        print(f"| {urdf.stem} | {result} | {links} | {pose:.1e} | {limit:.1e} |", flush=True)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
