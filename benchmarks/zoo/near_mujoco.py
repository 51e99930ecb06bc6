#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""All pairs of bodies within a distance, by leeway and by a loop over mj_geomDistance, for MJCF models that both read.

    PYTHONPATH=build/python build/zoo/venv/bin/python benchmarks/zoo/near_mujoco.py [--states N] [--distance D] [--seed S] MODEL.xml...

States are 1 mrad apart along a random line through the model's first state. Times are medians in microseconds of one thread: leeway's of a batch of all
states with derivatives, MuJoCo's of one bounded call for each pair of geoms that may collide, distances and points alone, Python's part of
a call included. The least distance of each pair of bodies is compared. Exit status 1: two differ by more than 1e-6 m."""
import argparse
import collections
import itertools
import sys
import time

import mujoco
import numpy

import leeway


def colliding_geoms(model):
    """Pairs of geoms that MuJoCo's filters let collide, one of them moving: no welded bodies, parents and excluded pairs."""
    excluded = set(model.exclude_signature.tolist())
    weld = model.body_weldid
    out = []
    for g, h in itertools.combinations(range(model.ngeom), 2):
        bodies = sorted((model.geom_bodyid[g], model.geom_bodyid[h]))
        a, b = (weld[body] for body in bodies)
        parents = weld[model.body_parentid[a]], weld[model.body_parentid[b]]
        related = a == b or (b != 0 and parents[0] == b) or (a != 0 and parents[1] == a)
        meets = model.geom_contype[g] & model.geom_conaffinity[h] or model.geom_contype[h] & model.geom_conaffinity[g]
        if meets and not related and (int(bodies[0]) << 16) + int(bodies[1]) not in excluded:
            out.append((g, h))
    return out


def positions(checker, model, states):
    """Rows of qpos."""
    qpos = numpy.tile(model.qpos0, (len(states), 1))
    for k, name in enumerate(checker.variables):
        qpos[:, model.joint(name).qposadr[0]] = states[:, k]
    for e in range(model.neq):  # joints that follow others
        if model.eq_type[e] == mujoco.mjtEq.mjEQ_JOINT and model.eq_obj2id[e] >= 0:
            follower, leader = (model.jnt_qposadr[joint] for joint in (model.eq_obj1id[e], model.eq_obj2id[e]))
            offset, slope = model.eq_data[e, :2]
            qpos[:, follower] = model.qpos0[follower] + offset + slope * (qpos[:, leader] - model.qpos0[leader])
    return qpos


def whole_pairs(model, geoms, names):
    """Pairs of bodies all of whose colliding geoms may meet: leeway checks a pair with all geoms or not at all."""
    solid = [g for g in range(model.ngeom) if model.geom_contype[g] or model.geom_conaffinity[g]]
    found = collections.Counter(frozenset((names[g], names[h])) for g, h in geoms)
    of = collections.Counter(names[g] for g in solid)
    return {pair for pair, count in found.items() if count == numpy.prod([of[name] for name in pair])}


def least(pairs_and_distances):
    out = {}
    for names, distance in pairs_and_distances:
        key = frozenset(names)
        out[key] = min(out.get(key, numpy.inf), distance)
    return out


def compare(file, count, distance, seed):
    model = mujoco.MjModel.from_xml_path(file)
    data = mujoco.MjData(model)
    robot = leeway.Robot(file)
    free = [name for name in robot.variables if mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name) < 0]
    if free:
        sys.exit(f"{file}: MuJoCo has no joint of one number called {free[0]}; give a model without free and ball joints")
    checker = leeway.Checker(robot)
    way = numpy.random.default_rng(seed).normal(size=checker.dof)
    start = numpy.clip([model.qpos0[model.joint(name).qposadr[0]] for name in checker.variables], checker.lower, checker.upper)
    states = start + 1e-3 * numpy.arange(count)[:, None] * way / numpy.linalg.norm(way)
    times = []
    for _ in range(5):
        before = time.perf_counter()
        near = checker.near(states, distance, threads=1)
        times.append((time.perf_counter() - before) / count)
    geoms = colliding_geoms(model)
    planes = model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE  # obstacles of their own name
    names = [model.geom(g).name if planes[g] else model.body(model.geom_bodyid[g]).name for g in range(model.ngeom)]
    whole = whole_pairs(model, geoms, names)
    loops, worst, pairs = [], 0.0, 0
    for i, q in enumerate(positions(checker, model, states)):
        data.qpos[:] = q
        mujoco.mj_kinematics(model, data)
        points = numpy.zeros(6)
        before = time.perf_counter()
        said = [mujoco.mj_geomDistance(model, data, g, h, distance, points) for g, h in geoms]
        loops.append(time.perf_counter() - before)
        theirs = least(((names[g], names[h]), max(0.0, d)) for (g, h), d in zip(geoms, said) if d < distance)
        ours = least((checker.names[pair].tolist(), d) for pair, d in zip(near.pairs[near.rows(i)], near.upper[near.rows(i)]))
        pairs += len(theirs)
        for key in (theirs.keys() | ours.keys()) & whole:
            worst = max(worst, abs(theirs.get(key, distance) - ours.get(key, distance)))
    print(f"{file}: {len(geoms)} pairs of geoms, {near.upper.size / count:.1f} rows, {pairs / count:.1f} pairs of bodies; "
          f"leeway {numpy.median(times) * 1e6:.0f} us, mj_geomDistance {numpy.median(loops) * 1e6:.0f} us; differ by at most {worst:.1g} m")
    return worst


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--states", type=int, default=300)
    options.add_argument("--distance", type=float, default=0.05)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("models", nargs="+")
    given = options.parse_args()
    return int(max(compare(file, given.states, given.distance, given.seed) for file in given.models) > 1e-6)


if __name__ == "__main__":
    sys.exit(main())
