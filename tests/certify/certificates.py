#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Certificates against both checkers, and changed or forged ones against a judge that samples.

    PYTHONPATH=build/python certificates.py --leeway build/bin/leeway --checker build/bin/check_certificate [--worlds N] [--mutations N] [--seed S]

honest   leeway plans and proves motions of random robots (paths, timed trajectories with tolerance): both checkers accept them, in the same words.
mutated  numbers, words of the proof, pairs, order and length are changed at random; others are stretched: a claim is made bolder as long as it is
         accepted. Half of all, with a judge, are forged (forge.py): a random proof of a large motion, with something as near as is accepted.
         Both checkers give one verdict. Accepted ones are sampled: the judge has kinematics of its own (4 x 4 matrices) and takes distances of
         shapes from leeway's Python package.

Exit status 1: an honest certificate is refused, the checkers disagree, an accepted claim is false, or the Python checker accepts a digest that does not fit."""
import argparse
import collections
import importlib.util
import os
import pathlib
import random
import subprocess
import sys
import tempfile
import time

import mutations
import worlds

HERE = pathlib.Path(__file__).resolve().parent
SOURCE = HERE.parents[1] / "planners" / "certify" / "check_certificate.py"
sys.setrecursionlimit(10000)


class Checkers:
    """Verdicts: (0, 1 or 2, its sentence)."""

    def __init__(self, c, python, folder, server=None):
        spec = importlib.util.spec_from_file_location("check_certificate", python)
        self.python = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(self.python)
        self.c, self.file, self.told = str(c), str(folder / "c.lwc"), str(folder / "c.txt")
        self.server = server and subprocess.Popen([server], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1)

    def content(self, data):
        return self.python.Reader(data).content()

    def by_python(self, data):
        try:
            content = self.content(data)
            return 0, self.python.Proof(self.python.Model(content), content).run()
        except self.python.Rejected as error:
            return 1, str(error)
        except (self.python.Damaged, KeyError, TypeError, ValueError, IndexError, OverflowError, RecursionError) as error:
            return 2, str(error)

    def by_c(self, data):
        with open(self.file, "wb") as file:
            file.write(data)
        out = [(os.POSIX_SPAWN_OPEN, 1, self.told, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)]
        child = os.posix_spawn(self.c, [self.c, self.file], os.environ, file_actions=out)
        status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        with open(self.told, encoding="utf-8") as file:
            return status, file.read().strip()

    def end_of_model(self, data):
        reader = self.python.Reader(data)
        reader.model()
        return reader.at

    def accepts(self, data):
        if not self.server:
            return self.by_c(data)[0] == 0
        with open(self.file, "wb") as file:
            file.write(data)
        print(self.file, file=self.server.stdin, flush=True)
        return int(self.server.stdout.readline()) == 0


# ---- honest certificates

def honest(given, folder, rng):
    """Three certificates of one random world: of a path, of a timed trajectory with a tolerance, and of a schedule of two robots that drive it; fewer if
    no motion is found."""
    worlds.write_robot(folder, rng)
    worlds.write_scene(folder, rng)
    model = ["--robot", "robot.urdf", "--scene", "scene.yaml", "--no-cache", "--joint-limits", "limits.yaml"]
    plan = [given.leeway, "plan", *model, "--start", "random", "--goal", "random", "--seed", str(rng.randint(1, 10 ** 6)), "--time", "2", "--min-d",
        str(rng.choice([0, 0.001, 0.005])), "--out", "path.yaml", "--trajectory", "trajectory.yaml", "--certificate", "path.lwc"]
    audit = [given.leeway, "audit", *model, "--trajectory", "trajectory.yaml", "--tolerance", "0.001", "--certificate", "trajectory.lwc"]
    made = []
    schedule = [given.leeway, "world", "audit", "--world", "cell.yaml", "--no-cache", "--certificate", "schedule.lwc"]
    for command, name in ((plan, "path.lwc"), (audit, "trajectory.lwc"), (schedule, "schedule.lwc")):
        if name == "schedule.lwc" and not (folder / "trajectory.yaml").exists():
            break
        if name == "schedule.lwc":
            worlds.write_cell(folder, rng)
        run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        if (folder / name).exists():
            made.append((folder / name).read_bytes())
        elif run.returncode == 0:
            raise AssertionError(f"no certificate, and status 0: {command}: {run.stderr}")
    return made


def problems_of_honest(checkers, data):
    c, python = checkers.by_c(data), checkers.by_python(data)
    if c != python or c[0] != 0:
        yield f"honest: C {c}, Python {python}"
    content = checkers.content(data)
    again = checkers.content(mutations.binary(content))
    if {**again, "model_sha256": ""} != {**content, "model_sha256": ""}:
        yield "the test cannot write the format"


def other_files_are_refused(given, folder):
    """The digest of a source: the robot's own file is accepted, a changed one is not."""
    (folder / "other.urdf").write_text((folder / "robot.urdf").read_text() + "\n")
    run = lambda name: subprocess.run([sys.executable, given.python_checker, "--file", name, "path.lwc"], cwd=folder, capture_output=True, check=False).returncode  # noqa: E731
    return run("robot.urdf") == 0 and run("other.urdf") == 1


# ---- changed ones

class Attack:
    def __init__(self, checkers, made, rng, judge_it):
        self.checkers, self.rng = checkers, rng
        self.made = [(data, checkers.content(data), checkers.end_of_model(data)) for data in made]
        self.judge = self.forge = None
        if judge_it:
            import forge
            import judge
            self.judge, self.forge = judge, forge

    def one(self):
        """Kind, bytes, and whether the digests fit."""
        rng, accepts = self.rng, self.checkers.accepts
        if self.forge and rng.random() < 0.5:
            content = next(filter(None, (self.forge.forged(rng, accepts) for _ in range(10))), None)
            if content:
                again = rng.random() < 0.5
                return "forged", mutations.stretched(content, rng, accepts) if again else mutations.binary(content), True
        data, content, model_end = rng.choice(self.made)
        if rng.random() < 0.3:
            return "stretched", mutations.stretched(content, rng, accepts), True
        if rng.random() < 0.1:
            return "flipped", *mutations.flipped(data, model_end, rng)
        return "changed", mutations.mutated(content, rng), True

    def problem(self, data, fits, c, python):
        """Why the verdicts are wrong; None if they are right. Digests that do not fit are the Python checker's business."""
        if c[0] not in (0, 1, 2) or (python and fits and c[0] != python[0]):
            return f"C {c}, Python {python}"
        if python and not fits and python[0] != 2:
            return f"a SHA-256 that does not fit, and Python {python}"
        if c[0] == 0 and fits and self.judge:
            false = self.judge.contradiction(self.checkers.content(data), self.rng)
            return f"accepted, and {false}" if false else None
        return None


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--leeway", required=True)
    options.add_argument("--checker", required=True)
    options.add_argument("--python-checker", default=SOURCE)
    options.add_argument("--server", help="check_server.c, built of the same checker: the search for bold claims asks it")
    options.add_argument("--worlds", type=int, default=20)
    options.add_argument("--mutations", type=int, default=1000)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--python-share", type=float, default=1, help="of mutations that the slower checker in Python judges too")
    options.add_argument("--no-judge", action="store_true", help="without the leeway package: accepted ones are not sampled")
    options.add_argument("--until-wrong", action="store_true", help="end at the first mistake")
    given = options.parse_args()
    given.leeway = str(pathlib.Path(given.leeway).resolve())
    rng, made, wrong, begin = random.Random(given.seed), [], [], time.monotonic()
    tally, done = collections.Counter(), 0
    with tempfile.TemporaryDirectory() as root:
        checkers = Checkers(pathlib.Path(given.checker).resolve(), given.python_checker, pathlib.Path(root), given.server)
        for i in range(given.worlds):
            folder = pathlib.Path(root) / str(i)
            folder.mkdir()
            found = honest(given, folder, rng)
            if found and not (folder / "path.lwc").exists():
                raise AssertionError("a certificate of a trajectory, and none of its path")
            if i == 0 and found and not other_files_are_refused(given, folder):
                wrong.append("--file: a robot's own file is refused, or another one accepted")
            made += found
        for data in made:
            wrong += problems_of_honest(checkers, data)
        attack = Attack(checkers, made, rng, not given.no_judge)
        for done in range(1, given.mutations + 1):
            if wrong and given.until_wrong:
                break
            kind, data, fits = attack.one()
            c = checkers.by_c(data)
            problem = attack.problem(data, fits, c, checkers.by_python(data) if rng.random() < given.python_share else None)
            tally[kind, ["accepted", "rejected", "damaged"][c[0]] if c[0] in (0, 1, 2) else "crashed"] += 1
            wrong += [f"mutation {done}, {kind}: {problem}"] if problem else []
            if done % 1000 == 0:
                print(f"{done} in {time.monotonic() - begin:.0f} s: {dict(tally)}; {len(wrong)} wrong", file=sys.stderr, flush=True)
    counts = ", ".join(f"{n} {kind} and {verdict}" for (kind, verdict), n in sorted(tally.items()))
    print(f"seed {given.seed}: {len(made)} honest certificates; {done} mutations: {counts}; {len(wrong)} wrong")
    for line in wrong[:10]:
        print(f"  {line}")
    return int(bool(wrong) or len(made) < given.worlds)


if __name__ == "__main__":
    sys.exit(main())
