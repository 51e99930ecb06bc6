#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes mistakes in the libraries on purpose, one at a time, and shows those that the tests do not see. README.md says how to read it.

    .ci/install.sh mutation
    nice tests/mutation/mutate.py --build build/mutation/work --sample 400 --seed 1 --budget 240 --jobs 2

Nothing of the user's tree or build is touched: all work is done in a copy of one commit below --build. A run that was ended goes on where
it was when it is called again with the same options.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import random
import re
import signal
import subprocess
import sys
import threading
import time
import tomllib

import chooser as ch
import coverage_map as cm
import records
import sources
import workshop as ws

HERE = pathlib.Path(__file__).resolve().parent
REPOSITORY = HERE.parent.parent
STOP = threading.Event()


def read_mistakes(path=HERE / "mistakes.toml"):
    """The hand-written mistakes, in the order of the file."""
    with open(path, "rb") as file:
        return tomllib.load(file)["mistake"]


def random_mutants(workshop, found, folders, seed, python):
    """All mutants of lines that some test executes, in an order that the seed decides."""
    files = sorted(f for f in workshop.users if any(f.startswith(folder.rstrip("/") + "/") for folder in folders))
    if not files:
        raise ws.Broken(f"no library has a source in {' '.join(folders)}")
    executed = {}
    for test in found["tests"]:
        for file, bits in test["lines"].items():
            executed[file] = executed.get(file, 0) | bits
    texts = {file: (workshop.tree / file).read_text(encoding="utf-8") for file in files}
    drawn = json.loads(ws.run([python, HERE / "operators.py", workshop.tree, *files]))
    mutants = []
    for file in files:
        wanted = sources.mutable_lines(texts[file]) & cm.lines_of(executed.get(file, 0))
        lines, code = texts[file].split("\n"), sources.blank(texts[file])
        names = {}
        for line, text, rule in drawn[file]:
            if line not in wanted or not sources.changes_code(lines[line - 1], text):
                continue
            if line not in names:
                names[line] = sources.function_at(code, line)
            mutants.append({"file": file, "line": line, "function": names[line], "before": lines[line - 1].strip(),
                            "after": text.strip(), "rule": rule, "new": text})
    random.Random(seed).shuffle(mutants)
    for number, mutant in enumerate(mutants, 1):
        mutant["id"] = f"r{number}"
        mutant["fingerprint"] = sources.fingerprint(mutant["file"], mutant["function"], mutant["before"], mutant["after"])
    return mutants


def domain_mutants(workshop, mistakes):
    """The hand-written mistakes as mutants; "stale" is set where the pattern is not there exactly once."""
    mutants = []
    for mistake in mistakes:
        mutant = {"id": "d" + mistake["id"], "file": mistake["file"], "function": mistake.get("function", ""), "line": 0,
                  "before": " ".join(mistake["pattern"].split()), "after": " ".join(mistake["replacement"].split()), "rule": mistake["what"],
                  "expected": mistake["expected"] if mistake["expected"] != "killed" else ""}
        mutant["fingerprint"] = sources.fingerprint(mutant["file"], mutant["function"], mutant["before"], mutant["after"])
        try:
            mutant["file"] = sources.find_file(workshop.tree, mistake)
            text = (workshop.tree / mutant["file"]).read_text(encoding="utf-8")
            mutant["text"], mutant["line"] = sources.with_mistake(text, mistake)
            begin, end = sources.places(text, mistake)[0]
            mutant["lines"] = list(range(text.count("\n", 0, begin) + 1, text.count("\n", 0, end) + 2))
        except (OSError, ValueError) as error:
            mutant["stale"] = str(error)
        mutants.append(mutant)
    return mutants


class Run:
    """One run over mutants with jobs that share the chooser, the state and the clock."""

    def __init__(self, workshop, found, state, options):
        self.workshop, self.state, self.options = workshop, state, options
        self.tests = found["tests"]
        self.numbers = {test["name"]: i for i, test in enumerate(self.tests)}
        self.by_filter = {(t["command"][0], cm.filter_of(t)): i for i, t in enumerate(self.tests)}
        self.chooser = ch.Chooser(self.tests)
        self.proper = {}  # test -> whether it passes without a mutant
        self.lock = threading.Lock()
        for record in state.results.values():
            if record["result"] == "killed" and record["by"] in self.numbers:
                self.chooser.saw(record["file"], [], self.numbers[record["by"]])

    def reaching(self, mutant):
        """The tests that execute the mutant's lines; of a line that is no instruction, those that execute its file or a file that includes it."""
        found = self.chooser.reaching(mutant["file"], mutant.get("lines") or [mutant["line"]])
        if found:
            return found
        files = {mutant["file"]} | self.workshop.users.get(mutant["file"], set())
        return [i for i, test in enumerate(self.tests) if files & test["lines"].keys()]

    def passes_as_it_is(self, number, job):
        """Whether a test passes with the libraries of the commit: asked once, of tests that failed with a mutant."""
        with self.lock:
            if number in self.proper:
                return self.proper[number]
        test = self.tests[number]
        status, _, _ = cm.run_test(test, self.workshop.paths(), job.folder / "scratch", 10 * test["seconds"] + 60)
        with self.lock:
            self.proper[number] = status == 0
        return self.proper[number]

    def run_batch(self, batch, job):
        """None if all tests of the batch pass with the job's libraries, else (number of the first that does not, how)."""
        first = self.tests[batch[0]]
        command = first["command"]
        if len(batch) > 1:
            together = ":".join(cm.filter_of(self.tests[n]) for n in batch)
            command = [f"--gtest_filter={together}" if w.startswith("--gtest_filter=") else w for w in command]
        if cm.filter_of(first) is not None:
            command = command + ["--gtest_fail_fast"]
        limit = 10 * sum(self.tests[n]["seconds"] for n in batch) + 20
        status, _, output = cm.run_test(first, self.workshop.paths([job.folder / "lib"]), job.folder / "scratch", limit, command)
        if status == 0:
            return None
        if status in (124, 137, -9):
            how = "time limit"
        else:
            how = "failed" if 0 < status < 128 and "[  FAILED  ]" in output or cm.filter_of(first) is None else f"crash {status}"
        names = re.findall(r"\[  FAILED  \] (\S+?),? ", output + " ") if how == "failed" else re.findall(r"\[ RUN      \] (\S+)", output)[-1:]
        for name in names:
            if (first["command"][0], name) in self.by_filter and self.by_filter[(first["command"][0], name)] in batch:
                return self.by_filter[(first["command"][0], name)], how
        return batch[0], how

    def measure(self, mutant, job):
        """Builds a mutant and runs the tests that reach it, until one fails; the record of its fate."""
        begin = time.monotonic()
        known = self.state.results.get(mutant["id"], {})
        known = known if known.get("fingerprint") == mutant["fingerprint"] else {}
        kept = ("id", "file", "line", "function", "before", "after", "rule", "fingerprint", "expected")
        record = {name: mutant[name] for name in kept if name in mutant}
        if "stale" in mutant:
            return {**record, "result": "stale", "why": mutant["stale"]}
        text = mutant.get("text")
        if text is None:
            lines = (self.workshop.tree / mutant["file"]).read_text(encoding="utf-8").split("\n")
            lines[mutant["line"] - 1] = mutant["new"]
            text = "\n".join(lines)
        built = job.build(mutant["file"], text)
        if built != "built":
            return {**record, "result": "equivalent" if built == "same" else "invalid", "how": built}
        reaching = self.reaching(mutant)
        passed = {self.numbers[n] for n in known.get("passed", []) if n in self.numbers}
        before = known.get("seconds", 0)
        ordered = self.chooser.order([n for n in reaching if n not in passed and self.proper.get(n) is not False], mutant["file"])
        killer, how, complete = None, "", True

        def program(test):
            return (test["command"][0], test["directory"], str(test["environment"])) if cm.filter_of(test) else None

        tested = time.monotonic()
        for batch in self.chooser.batches(ordered, program):
            if time.monotonic() - tested > self.options.seconds_per_mutant:
                complete = False
                break
            failed = self.run_batch(batch, job)
            if STOP.is_set():
                return None
            if failed is None:
                passed.update(batch)
            elif self.passes_as_it_is(failed[0], job):
                killer, how = failed
                break
        self.chooser.saw(mutant["file"], passed, killer)
        record.update(result="survived" if killer is None else "killed", seconds=round(before + time.monotonic() - begin, 1),
                      tests_run=len(passed) + (killer is not None), tests_that_reach=len(reaching))
        if killer is None:
            record.update(complete=complete, passed=[self.tests[n]["name"] for n in sorted(passed)])
        else:
            record.update(by=self.tests[killer]["name"], how=how)
        return record

    def is_done(self, mutant):
        known = self.state.results.get(mutant["id"])
        if known is None or known["fingerprint"] != mutant["fingerprint"]:
            return False
        return not (self.options.deepen and known["result"] == "survived" and not known["complete"])

    def go(self, mutants, wanted, deadline):
        """Measures mutants in their order until `wanted` of them compiled, or the deadline. Returns their records."""
        waiting = iter(mutants)
        jobs = [ws.Job(self.workshop, number) for number in range(self.options.jobs)]
        free, running, seen, counted = list(jobs), {}, [], 0
        with concurrent.futures.ThreadPoolExecutor(self.options.jobs) as pool:
            while True:
                while free and counted + len(running) < wanted and time.monotonic() < deadline and not STOP.is_set():
                    mutant = next(waiting, None)
                    if mutant is None:
                        break
                    if self.is_done(mutant):
                        record = self.state.results[mutant["id"]]
                        seen.append(record)
                        counted += record["result"] != "invalid"
                        continue
                    job = free.pop()
                    running[pool.submit(self.measure, mutant, job)] = job
                if not running:
                    return seen
                for future in concurrent.futures.wait(running, return_when=concurrent.futures.FIRST_COMPLETED)[0]:
                    free.append(running.pop(future))
                    record = future.result()
                    if record is not None:
                        self.state.add(record)
                        seen.append(record)
                        counted += record["result"] != "invalid"
                        self.say(record, counted, wanted)

    @staticmethod
    def say(record, counted, wanted):
        if record["result"] == "invalid":
            return
        by = f" by {record['by']} ({record['how']})" if "by" in record else ""
        more = "" if record.get("complete", True) else ", not all tests that reach it ran"
        place = f"{record['id']} {record['file']}:{record['line']}"
        print(f"[{counted} of {wanted}] {place} {record['result']}{by}, {record.get('seconds', 0)} s{more}", flush=True)


def end_tests(*_):
    """Ends the run at once. The measurements are in the state file."""
    STOP.set()
    for process in list(cm.LIVE):
        cm.end(process)


def parse():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0], epilog="tests/mutation/README.md says more.")
    parser.add_argument("--build", type=pathlib.Path, required=True, help="folder for the copy of the commit, its build and its coverage map")
    parser.add_argument("--commit", default="HEAD", help="the commit whose libraries and tests are used (default HEAD)")
    parser.add_argument("--folders", nargs="+", default=["core/src", "ompl_bridge/src"], help="where random mutants are made")
    parser.add_argument("--sample", type=int, default=400, help="how many random mutants that compile")
    parser.add_argument("--seed", type=int, default=1, help="decides which mutants are drawn")
    parser.add_argument("--budget", type=float, default=240, help="minutes after which no further mutant begins")
    parser.add_argument("--jobs", type=int, default=2, help="mutants at once")
    parser.add_argument("--seconds-per-mutant", type=float, default=300, help="after these seconds no further test of a mutant begins")
    parser.add_argument("--only-domain", action="store_true", help="the hand-written mistakes only")
    parser.add_argument("--no-domain", action="store_true", help="the random mutants only")
    parser.add_argument("--only", nargs="+", default=[], metavar="ID", help="these mutants only, by id, whatever is known of them")
    parser.add_argument("--deepen", action="store_true", help="go on with survivors for which not all tests ran")
    parser.add_argument("--list", action="store_true", help="list what would be tried, and end")
    parser.add_argument("--report", action="store_true", help="print the table of what is known, and end")
    parser.add_argument("--resume", type=pathlib.Path, metavar="STATE", help="file of results that a run goes on with (default below --build)")
    parser.add_argument("--record", action="store_true", help="write the table into benchmarks/results")
    parser.add_argument("--data", type=pathlib.Path, default=REPOSITORY / "../shared/data", help="robots and scenes that some tests use")
    return parser.parse_args()


def venv_python():
    folder = pathlib.Path(os.environ.get("LEEWAY_MUTATION_DIR", REPOSITORY / "build/mutation"))
    python = folder / "venv/bin/python"
    if not python.exists():
        raise ws.Broken(f"{python} is not there: run .ci/install.sh mutation, which puts universalmutator there")
    return python


def finish(options, header, state, mutants):
    """Prints and writes the table of the mutants that have a result."""
    classes = records.read_classes(HERE / "survivors.toml")
    found = [state.results[m["id"]] for m in mutants if m["id"] in state.results]
    found = [{**r, "expected": m.get("expected", "")} for r, m in zip(found, [m for m in mutants if m["id"] in state.results])]
    for record in found:
        if record["result"] in ("survived", "stale"):
            print(records.describe(record, classes) + "\n")
    name = f"mutation-{header['commit'][:12]}-{header['seed']}.csv"
    place = (REPOSITORY / "benchmarks/results" if options.record else options.build) / name
    totals, scores = records.write_table(place, header, found, classes)
    print(f"{place}: " + ", ".join(f"{name} {count}" for name, count in [*sorted(totals.items()), *scores.items()]))


def main():
    options = parse()
    signal.signal(signal.SIGINT, end_tests)
    signal.signal(signal.SIGTERM, end_tests)
    commit = ws.run(["git", "-C", REPOSITORY, "rev-parse", options.commit]).strip()
    workshop = ws.Workshop(options.build, REPOSITORY, commit)
    workshop.prepare(options.data.resolve(), options.jobs)
    found = cm.make(workshop, options.jobs)
    for name, why in found["broken"].items():
        if why != "skipped":
            print(f"left out, it fails without a mutant: {name}: {why.strip().splitlines()[0] if why.strip() else ''}")
    mutants = [] if options.no_domain else domain_mutants(workshop, read_mistakes())
    domain = len(mutants)
    if not options.only_domain:
        mutants += random_mutants(workshop, found, options.folders, options.seed, venv_python())
    if options.only:
        mutants = [m for m in mutants if m["id"] in options.only]
        domain = sum(m["id"].startswith("d") for m in mutants)
    wanted = domain + (0 if options.only_domain else options.sample)
    if options.list:
        for mutant in mutants[:wanted]:
            print(f"{mutant['id']} {mutant['file']}:{mutant['line']} {mutant['function']}\n  - {mutant['before']}\n  + {mutant['after']}")
        print(f"{domain} hand-written, {len(mutants) - domain} random mutants of lines that tests execute")
        return
    header = {"commit": commit, "seed": options.seed, "folders": " ".join(options.folders)}
    state = records.State(options.resume or options.build / f"state-{options.seed}.jsonl", header)
    if options.only:
        for mutant in mutants:
            state.results.pop(mutant["id"], None)
    if not options.report:
        run = Run(workshop, found, state, options)
        run.go(mutants, wanted, time.monotonic() + 60 * options.budget)
    finish(options, header, state, mutants)


if __name__ == "__main__":
    try:
        main()
    except (ws.Broken, ValueError, OSError, subprocess.SubprocessError) as error:
        sys.exit(f"{sys.argv[0]}: {error}")
