# SPDX-License-Identifier: BSD-3-Clause
"""Threads of Python share checkers, batches leave the interpreter to others, and objects give their memory back."""
import concurrent.futures
import gc
import subprocess
import sys
import threading

import numpy
import pytest

import leeway
from conftest import FIRST


INTERRUPTED = """
import os, signal, sys, threading, time
signal.signal(signal.SIGINT, signal.default_int_handler)  # jobs in the background of a shell ignore it
import numpy
import leeway
robot = leeway.Robot(sys.argv[1], sys.argv[2])
scene = leeway.Scene()
scene.add("wall", leeway.Shape.box(0.02, 9, 9), [0.2, 0, 0])
checker = leeway.Checker(robot, scene, group="arm")
q = numpy.random.default_rng(1).uniform(checker.lower, checker.upper, (2000, checker.dof))
free = q[checker.is_free(q)]
behind = numpy.tile(q, (500, 1))
threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
try:
    if sys.argv[3] == "plan":
        checker.plan(free[:1], free[1:2], optimize_seconds=1000)
    else:
        checker.clearance(behind, threads=int(sys.argv[4]))
    time.sleep(5)
    print("not interrupted")
except KeyboardInterrupt:
    print("interrupted", checker.clearance(q[0]))
"""


@pytest.mark.parametrize("work", [["plan"], ["clearance", "1"], ["clearance", "2"]])
def test_ctrl_c_ends_batches_and_searches(work):
    call = [sys.executable, "-c", INTERRUPTED, FIRST / "arm.urdf", FIRST / "arm.srdf", *work]
    done = subprocess.run(call, capture_output=True, text=True, timeout=200)
    assert done.stdout.startswith("interrupted Clearances"), done.stdout + done.stderr


def resident():
    """Bytes of this process."""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * 4096


def test_threads_share_a_checker_and_get_the_same_bits(checker, states):
    expected = checker.clearance(states).lower.tobytes()
    with concurrent.futures.ThreadPoolExecutor(8) as pool:
        answers = list(pool.map(lambda i: checker.clearance(states, threads=1 + i % 3).lower.tobytes(), range(40)))
    assert set(answers) == {expected}


def test_threads_edit_a_scene_while_checkers_are_made_of_it(robot):
    scene = leeway.Scene()
    for i in range(50):
        scene.add(f"box {i}", leeway.Shape.box(0.1, 0.1, 0.1), [i, 0, 3])

    def edit(k):
        for i in range(50):
            scene.add(f"{k} {i}", leeway.Shape.sphere(0.1), [i, 1, 3])
            scene.remove(f"{k} {i}")

    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        edits = [pool.submit(edit, k) for k in range(8)]
        made = [pool.submit(leeway.Checker, robot, scene, group="arm") for _ in range(40)]
        assert all(len(job.result().objects) >= 50 for job in made) and not any(job.result() for job in edits)


def test_threads_plan_while_the_world_changes(robot, scene, states):
    world = leeway.World(robot, scene, group="arm")
    free = states[world.checker.is_free(states)]
    ends = [(free[i], free[i + 1]) for i in range(0, 20, 2)]

    def work(i):
        checker = world.checker
        plan = checker.plan(*ends[i % 10], seconds=20)
        return plan.solved and checker.path(plan.path).all_free

    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        jobs = [pool.submit(work, i) for i in range(40)]
        for i in range(40):
            world.move("mug", [3 + i, 0, 0])
        assert all(job.result() for job in jobs)


def test_batches_release_the_interpreter(checker, states):
    """Another thread of Python counts while a batch runs: with the lock held it could not."""
    many = numpy.tile(states, (200, 1))
    count, done = [0], threading.Event()

    def counting():
        while not done.is_set():
            count[0] += 1

    thread = threading.Thread(target=counting)
    thread.start()
    before = count[0]
    checker.clearance(many)
    during = count[0] - before
    done.set()
    thread.join()
    assert during > 1000


def grows(make, count):
    """Bytes that `count` calls leave behind, after as many to warm up."""
    for _ in range(count // 10):
        make()
    gc.collect()
    before = resident()
    for _ in range(count):
        make()
    gc.collect()
    return resident() - before


def test_a_hundred_thousand_objects_leave_nothing_behind(robot, scene, checker, states):
    rows, points = states[:4], states[:, :3].copy()
    kinds = {
        "shapes": lambda: leeway.Shape.points(points[:50], 0.1).vertices.sum(),
        "answers": lambda: checker.clearance(rows),
        "edges": lambda: checker.path(rows[:2]),
        "poses": lambda: robot.fk(robot.default_state()),
        "scenes": lambda: leeway.Scene().add("a", leeway.Shape.sphere(1)),
    }
    for name, make in kinds.items():
        assert grows(make, 20000) < 4 << 20, name
    few = {
        "checkers": lambda: leeway.Checker(robot, scene, group="arm").clearance(rows),
        "robots": lambda: leeway.Robot(FIRST / "arm.urdf", FIRST / "arm.srdf"),
        "states of pickles": lambda: robot.__getstate__(),
        "errors": lambda: _raises(checker),
    }
    for name, make in few.items():
        assert grows(make, 500) < 4 << 20, name


def _raises(checker):
    try:
        checker.clearance(numpy.full((2, checker.dof), numpy.nan))
    except leeway.CoreError as error:
        return error.status
    raise AssertionError("no error")
