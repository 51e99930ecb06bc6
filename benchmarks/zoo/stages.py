# SPDX-License-Identifier: BSD-3-Clause
"""One robot through `leeway`: info, pairs, check, spherize, plan, audit, and pinocchio + coal beside it."""
import csv
import io
import json
import math
import pathlib
import random
import shutil
import xml.sax.saxutils
from dataclasses import dataclass

import why
from run import run

UNLIMITED = 1e3  # limits beyond this mean none


@dataclass
class Settings:
    leeway: pathlib.Path
    out: pathlib.Path
    oracle_python: pathlib.Path = None  # None: no comparison
    seed: int = 1
    uniform: int = 200
    near_limits: int = 100
    oracle_states: int = 200
    pairs_budget: float = 3.0
    pairs_samples: int = 1000
    plan_time: float = 15.0
    spherize: bool = True
    excess: float = 30.0  # millimetres
    limit: float = 120.0  # seconds of one command


class Variable:
    def __init__(self, name, joint):
        self.name = name
        self.joint = joint
        kind = joint.type
        component = name.rpartition("/")[2] if name != joint.name else ""
        self.unbounded = True
        turns = kind in ("continuous", "revolute") or component == "theta"
        self.low, self.high = (-math.pi, math.pi) if turns else (-1.0, 1.0)
        if kind in ("revolute", "prismatic") and joint.lower < joint.upper and joint.upper - joint.lower < UNLIMITED:
            self.low, self.high, self.unbounded = joint.lower, joint.upper, False
        elif kind in ("revolute", "prismatic") and joint.lower == joint.upper:
            self.low, self.high, self.unbounded = joint.lower, joint.upper, False
        self.quaternion = component.startswith("rot_")

    def at(self, share):
        return min(max(self.low + share * (self.high - self.low), self.low), self.high)


def draw(variables, generator, near_limits):
    """A uniform state, or one whose every variable is within 15 % of its range from one of its limits."""
    state = []
    for variable in variables:
        share = generator.random()
        if near_limits:
            share = 0.15 * share if generator.random() < 0.5 else 1 - 0.15 * share
        state.append(variable.at(share))
    rotations = {}
    for i, variable in enumerate(variables):
        if variable.quaternion:
            rotations.setdefault(variable.joint.name, []).append(i)
    for places in rotations.values():
        parts = [generator.gauss(0, 1) for _ in places]
        norm = math.sqrt(sum(part * part for part in parts))
        for i, part in zip(places, parts):
            state[i] = part / norm
    return state


def write_table(path, header, rows):
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(header)
        writer.writerows([[repr(value) for value in row] for row in rows])


def read_table(text):
    return list(csv.DictReader(io.StringIO(text)))


def write_srdf(path, robot, pairs):
    quote = xml.sax.saxutils.quoteattr
    lines = [f"<robot name={quote(robot)}>"]
    lines += [f"  <disable_collisions link1={quote(a)} link2={quote(b)} reason=\"User\"/>" for a, b in pairs]
    path.write_text("\n".join(lines + ["</robot>", ""]))


def values(names, state):
    return ",".join(f"{name}={value!r}" for name, value in zip(names, state))


class RobotRun:
    """`row` is the table's row. Every stage writes into it; one that lacks the result of an earlier stage writes nothing."""

    def __init__(self, description, settings):
        self.description = description
        self.settings = settings
        self.folder = settings.out / "files" / description.name.replace("/", "__")
        self.folder.mkdir(parents=True, exist_ok=True)
        self.row = {"name": description.name, "source": description.source, "kind": description.kind,
                    "urdf": description.urdf.name, "srdf": description.srdfs[0].name if description.srdfs else None}
        self.robot_name = ""
        self.variables = []
        self.own_srdf = self.srdf = None

    def leeway(self, subcommand, *options, srdf=None, limit=None):
        command = [self.settings.leeway, subcommand, "--robot", self.description.urdf]
        command += ["--srdf", srdf] if srdf else []
        return run([*command, *options], limit or self.settings.limit, self.folder / "cache")

    def keep(self, stage, outcome):
        self.row[stage] = outcome.word
        self.row[stage + "_s"] = outcome.seconds
        if outcome.timed_out or outcome.crashed or outcome.status == 2:
            self.row[stage + "_message"] = outcome.message
        return not outcome.timed_out and outcome.status in (0, 1)

    def info(self):
        srdfs = self.description.srdfs
        self.own_srdf = srdfs[0] if srdfs else None
        report = self.folder / "info.json"
        outcome = self.leeway("info", "--json", report, srdf=self.own_srdf)
        if self.own_srdf and outcome.status == 2 and not outcome.timed_out:
            alone = self.leeway("info", "--json", report)
            if alone.status == 0:
                self.row["srdf_read"], self.row["srdf_message"] = "refused", outcome.message
                self.own_srdf, outcome = None, alone
        elif self.own_srdf:
            self.row["srdf_read"] = "yes" if outcome.status == 0 else outcome.word
        extra = []
        for srdf in srdfs[1:]:
            read = self.leeway("info", srdf=srdf)
            extra.append({"srdf": srdf.name, "read": "yes" if read.status == 0 else read.message})
        self.row["more_srdfs"] = extra
        self.row["notices"] = sum("notice:" in line for line in outcome.notices.splitlines())
        (self.folder / "info.txt").write_text(outcome.out + outcome.notices)
        if not self.keep("info", outcome) or outcome.status != 0:
            return False
        told = json.loads(report.read_text())
        joints = {joint.name: joint for joint in self.description.all_joints}
        names = told["robot"]["variables"]
        # A virtual joint of the SRDF (where the robot stands) changes no clearance of the robot with itself: it stays at zero.
        joint_of = lambda name: joints.get(name) or joints.get(name.rpartition("/")[0])
        self.variables = [Variable(name, joint_of(name)) for name in names if joint_of(name)]
        self.robot_name = told["robot"]["name"]
        self.row["variables"] = len(self.variables)
        self.row["shapes"] = told["robot"]["total"]["elements"]
        self.row["triangles"] = told["robot"]["total"]["triangles"]
        return bool(self.variables)

    def pairs(self):
        new, report = self.folder / "new.srdf", self.folder / "pairs.json"
        new.unlink(missing_ok=True)
        s = self.settings
        outcome = self.leeway("pairs", "--budget", s.pairs_budget, "--samples", s.pairs_samples, "--seed", s.seed, "--out", new,
                              "--json", report, srdf=self.own_srdf)
        (self.folder / "pairs.txt").write_text(outcome.out + outcome.notices)
        if self.keep("pairs", outcome) and new.exists():
            self.srdf = new
            told = json.loads(report.read_text())
            self.row["pair_classes"] = told["classes"]
            self.row["findings"] = len(told["findings"])

    def table(self, states):
        path = self.folder / "states.csv"
        write_table(path, [variable.name for variable in self.variables], states)
        return path

    def count_free(self, srdf, states, stage):
        """Indices of free states, and microseconds per state of a second pass over the same states."""
        answers = self.folder / "answers.csv"
        outcome = self.leeway("check", "--what", "self", "--states", self.table(states + states), "--out", answers, srdf=srdf)
        if not self.keep(stage, outcome):
            return None
        rows = read_table(answers.read_text())
        times = [float(row["microseconds"]) for row in rows]
        self.row[stage + "_first_us"] = round(sum(times[:len(states)]) / len(states), 1)
        self.row[stage + "_us"] = round(sum(times[len(states):]) / len(states), 1)
        verdicts = [row["verdict"] for row in rows]
        if verdicts[:len(states)] != verdicts[len(states):]:
            self.row["surprise"] = "the second pass over the same states has other verdicts"
        return [i for i, verdict in enumerate(verdicts[:len(states)]) if verdict == "FREE"]

    def check(self):
        """Free states with the robot's own SRDF and with the one that `pairs` wrote. Where fewer than two are free, ten
        times as many are tried."""
        s = self.settings
        generator = random.Random(f"{s.seed} {self.description.name}")
        states = [draw(self.variables, generator, False) for _ in range(s.uniform)]
        states += [draw(self.variables, generator, True) for _ in range(s.near_limits)]
        own = self.count_free(self.own_srdf, states, "check_own")
        new = self.count_free(self.srdf, states, "check") if self.srdf else None
        self.row["states"] = len(states)
        self.row["free_own"] = len(own) if own is not None else None
        self.row["free"] = len(new) if new is not None else None
        self.states = states
        self.free_own = [states[i] for i in own or []]
        self.free = [states[i] for i in new or []]
        if new is not None and len(new) < 2:
            more = [draw(self.variables, generator, i % 4 == 3) for i in range(10 * len(states))]
            found = self.count_free(self.srdf, more, "check_more")
            self.row["free_more"] = f"{len(found or [])} of {len(more)}"
            self.free += [more[i] for i in found or []]

    def spherize(self):
        folder = self.folder / "spheres"
        outcome = self.leeway("spherize", "--excess", self.settings.excess, "--out", folder, srdf=self.own_srdf)
        if self.keep("spherize", outcome) and outcome.status == 0:
            told = [json.loads(path.read_text()) for path in folder.glob("*_spheres.json")]
            self.row["spheres"] = sum(link["spheres"] for link in told[0]["links"]) if told else None

    def plan(self, srdf, free, stage):
        """Between the first and the last free state, with no option but robot, start and goal."""
        if len(free) < 2:
            self.row[stage] = "fewer than two free states"
            return
        names = [variable.name for variable in self.variables]
        start, goal = free[0], free[-1]
        path, report = self.folder / f"{stage}.yaml", self.folder / f"{stage}.json"
        path.unlink(missing_ok=True)
        report.unlink(missing_ok=True)
        outcome = self.leeway("plan", "--start", values(names, start), "--goal", values(names, goal), "--time", self.settings.plan_time,
                              "--seed", self.settings.seed, "--out", path, "--report", report, srdf=srdf,
                              limit=self.settings.plan_time + self.settings.limit)
        (self.folder / f"{stage}.txt").write_text(outcome.out + outcome.notices)
        self.keep(stage, outcome)
        self.row[stage] = {"yes": "found", "no": "not found"}.get(outcome.word, outcome.word)
        if report.exists():
            told = json.loads(report.read_text())
            self.row[stage + "_planner_s"] = round(told["seconds"]["plan"], 4)
            self.row[stage + "_checks"] = told["checks"]
        if outcome.status == 0 and path.exists():
            audit = self.leeway("audit", "--path", path, srdf=srdf)
            self.keep(stage + "_audit", audit)
            self.row[stage + "_audit"] = {"yes": "valid", "no": "INVALID"}.get(audit.word, audit.word)
        elif outcome.status == 1:
            self.row[stage + "_said"] = [line for line in outcome.notices.splitlines() if line.strip()][-8:]
            self.row[stage + "_why"] = why.explain(self, srdf, start, goal)
            if self.row[stage + "_why"]["verdict"] == "open":
                self.other_planner(srdf, names, start, goal, self.row[stage + "_why"])

    def other_planner(self, srdf, names, start, goal, reasons):
        """Does a planner that is not the default find one? Then the two are connected, and only the search is at fault."""
        outcome = self.leeway("plan", "--start", values(names, start), "--goal", values(names, goal), "--time", self.settings.plan_time,
                              "--planner", "SBL", "--out", self.folder / "other.yaml", srdf=srdf,
                              limit=self.settings.plan_time + self.settings.limit)
        if outcome.status == 0 and not outcome.timed_out:
            reasons["verdict"] = "another planner"
            reasons["text"] = f"connected: SBL finds a path in {outcome.seconds} s; " + reasons["text"]

    def oracle(self):
        """Least self distance against pinocchio + coal: pairs in contact in more than half of 15 states are disabled in both."""
        s = self.settings
        generator = random.Random(f"oracle {s.seed} {self.description.name}")
        names = [variable.name for variable in self.variables]
        states = [draw(self.variables, generator, False) for _ in range(15 + s.oracle_states)]
        question, answer = self.folder / "oracle_in.json", self.folder / "oracle_out.json"
        answer.unlink(missing_ok=True)
        question.write_text(json.dumps({"urdf": str(self.description.urdf), "names": names, "states": states, "sorting": 15}))
        outcome = run([s.oracle_python, pathlib.Path(__file__).with_name("oracle.py"), question, answer], 5 * s.limit)
        self.row["oracle_s"] = outcome.seconds
        if not answer.exists():
            self.row["oracle"] = "time limit" if outcome.timed_out else "not comparable: " + outcome.message
            return
        truth = json.loads(answer.read_text())
        if "error" in truth:
            self.row["oracle"] = "not comparable: " + truth["error"]
            return
        self.compare(states[15:], truth)

    def compare(self, states, truth):
        srdf, answers = self.folder / "oracle.srdf", self.folder / "oracle.csv"
        write_srdf(srdf, self.robot_name, truth["disabled"])
        outcome = self.leeway("check", "--what", "self", "--states", self.table(states), "--out", answers, srdf=srdf)
        if outcome.status == 2 or outcome.timed_out or outcome.crashed:
            self.row["oracle"] = "leeway check: " + outcome.message
            return
        differ, grazing, off, largest, contacts = [], 0, [], 0.0, 0
        for i, (row, answer) in enumerate(zip(read_table(answers.read_text()), truth["answers"])):
            blocked, touches = row["verdict"] == "BLOCKED", answer["distance"] <= 0
            contacts += blocked
            low, high = float(row["self_lower"]), float(row["self_upper"])
            if blocked != touches:
                # Coal's yes or no of curved shapes is within 1e-6 m.
                near = max(answer["distance"], low) < 1e-6
                grazing += near
                differ += [] if near else [[i, answer["distance"], low, high, *answer["pair"], row["self_link1"], row["self_link2"]]]
            elif not blocked and math.isfinite(answer["distance"]):
                error = max(low - answer["distance"], answer["distance"] - high, 0.0)
                largest = max(largest, error)
                off += [[i, answer["distance"], low, high, *answer["pair"]]] if error > 1e-6 else []
        self.row.update(oracle="agrees" if not differ and not off else "DIFFERS", oracle_pairs=truth["pairs"], oracle_states=len(states),
                        oracle_contacts=contacts, oracle_booleans=differ[:5], oracle_booleans_count=len(differ), oracle_grazing=grazing,
                        oracle_distances=off[:5], oracle_distances_count=len(off), oracle_largest=largest,
                        oracle_disabled=len(truth["disabled"]))

    def all(self):
        shutil.rmtree(self.folder / "cache", ignore_errors=True)
        if not self.info():
            return self.row
        self.pairs()
        self.check()
        if self.settings.spherize:
            self.spherize()
        if self.srdf:
            self.plan(self.srdf, self.free, "plan")
        if len(self.free_own) >= 2 and self.own_srdf:
            self.plan(self.own_srdf, self.free_own, "plan_own")
        if self.settings.oracle_python:
            self.oracle()
        return self.row
