#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A sweep over bad inputs: does each get a clear answer, and does none make the program write or read elsewhere?

    bad_inputs.py PROGRAM [--guard LIBRARY] [--only TEXT] [--share N] [--jobs N] [--csv FILE]

Clear is: exit status 0, 1 or 2, and the one that is expected (cases.py), or what the class of the file demands (hostile.py); at most
--limit seconds; no internal error; with 2 one line "leeway: error: FILE: ELEMENT: PROBLEM; REMEDY" as the last one, and no output file; and
every input file as it was before. With --guard (tests/guard) also: no file is opened for writing, made, renamed or removed but the outputs that
the command names and the cache, none is read beside the case's folder, the cache and the system's libraries, and nothing is started.
"""
import argparse
import collections
import concurrent.futures
import csv
import hashlib
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import time
import zlib

from cases import FILES, Case, cases
from commands import command_cases
from formats import format_cases
from hostile import HARMLESS, REFUSED, SAME, TOLD, hostile_cases

OUTPUTS = ("--out", "--report", "--json", "--profile", "--view", "--csv", "--png")
# What a program of C++ reads to begin with, and qhull's place for its messages
READS = ("/lib", "/lib64", "/usr", "/etc/ld.so.cache", "/etc/localtime", "/proc/self", "/proc/cpuinfo", "/sys/devices/system", "/dev/null", "/dev/stdin", "/dev/urandom")
WRITES = ("/dev/null", os.path.expanduser("~/.sdformat"))  # the log of libsdformat, which nothing turns off


def prepare(folder, case):
    files = dict(FILES)
    for name, edit in case.edits.items():
        if isinstance(edit, tuple):
            old, new = edit
            if old and old not in files[name]:
                raise ValueError(f"{case.name}: {name} has no {old!r}")
            files[name] = files[name].replace(old, new, 1) if old else new
        else:
            files[name] = edit
    for name, text in files.items():
        if text is not None:
            (folder / name).write_bytes(text if isinstance(text, bytes) else text.encode())


    if case.place:
        name, place = case.place
        place(folder / name)


def digests(folder):
    return {path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.rglob("*")
            if path.is_file() and not path.is_symlink()}


def outputs_of(command):
    words = shlex.split(command)
    named = [after for word, after in zip(words, words[1:]) if word in OUTPUTS or (word == "--trajectory" and words[0] == "plan")]
    return named + [after for word, after in zip(words, words[1:]) if word in (">", ">>")]


def guarded(library, command, folder, cache, log):
    """Variables of a run under the guard: its places are the outputs of the command and the cache."""
    words = shlex.split(command)
    caches = [folder / after for word, after in zip(words, words[1:]) if word == "--cache"]
    caches = [] if "--no-cache" in words else caches or [pathlib.Path(cache)]
    writes = [os.path.normpath(folder / name) for name in outputs_of(command)] + [str(path) for path in caches]
    return {"LD_PRELOAD": str(library), "LEEWAY_GUARD_LOG": str(log), "LEEWAY_GUARD_WRITES": ":".join([*WRITES, *writes]),
            "LEEWAY_GUARD_READS": ":".join([*READS, str(folder), *map(str, caches), *writes]), "ASAN_OPTIONS": "verify_asan_link_order=0"}


def without_times(value):
    if isinstance(value, dict):
        return {key: without_times(inner) for key, inner in value.items() if not re.search("seconds|time_left|rate$", key)}
    return [without_times(inner) for inner in value] if isinstance(value, list) else value


def answer_of(done, folder, command):
    """All that the program said and wrote, without times."""
    parts = [str(done.returncode), re.sub(r"[\d.]+ (\w*seconds|m?s)\b", "", done.stdout.decode("utf-8", "replace"))]
    parts += [line for line in done.stderr.decode("utf-8", "replace").splitlines() if line.startswith(("leeway: notice", "leeway: error"))]
    for name in outputs_of(command):
        path = folder / name
        text = path.read_text(errors="replace") if path.is_file() else ""
        if name.endswith(".csv") and text:
            rows = list(csv.DictReader(text.splitlines()))
            text = json.dumps([{key: cell for key, cell in row.items() if key != "microseconds"} for row in rows])
        elif name.endswith(".json") and text:
            text = json.dumps(without_times(json.loads(text)))
        parts.append(text)
    return "\n".join(parts)


def error_faults(message, before, after):
    """Faults of an error: of its one line, and files left behind."""
    lines = message.splitlines()
    errors = [line for line in lines if line.startswith("leeway: error: ")]
    if len(errors) != 1 or lines[-1] != errors[0]:
        return [f"{len(errors)} lines of error, not one at the end"]
    faults = []
    if "; " not in errors[0]:
        faults.append("no remedy")
    if "internal" in errors[0]:
        faults.append("an internal error")
    if len(errors[0]) > 1500:
        faults.append(f"{len(errors[0])} letters long")
    left = sorted(set(after) - set(before))
    if left:
        faults.append(f"left {', '.join(left)}")
    return faults


def expectation_faults(case, status, answer, clean):
    """Faults against the class of a hostile file. @param clean: the answer of the good file"""
    if case.expect == SAME and answer != clean:
        return ["another answer than that of the good file"]
    if case.expect == REFUSED and status != 2:
        return [f"exit status {status}, expected 2"]
    if case.expect == HARMLESS and status != 2 and answer != clean:
        return ["neither refused nor the answer of the good file"]
    return ["taken silently: the same answer, and no notice"] if case.expect == TOLD and answer == clean else []


def check_case(case, done, folder, before, clean):
    said, told = done.stderr.decode("utf-8", "replace"), done.stdout.decode("utf-8", "replace")
    after = digests(folder)
    faults = []
    if "this build of leeway has no page" in said and after == before:
        return []  # without npm's tools every `view` is refused
    if "-DLEEWAY_SDF=ON" in said and done.returncode == 2:
        return error_faults(said, before, after)  # without libsdformat every SDF is refused
    if done.returncode not in (case.status if not case.expect else (0, 1, 2)):
        faults.append(f"exit status {done.returncode}, expected {' or '.join(map(str, case.status))}")
    if done.returncode == 2:
        faults += error_faults(said, before, after)
    if case.expect:
        faults += expectation_faults(case, done.returncode, answer_of(done, folder, case.command), clean)
    changed = [name for name in before if after.get(name) != before[name]]
    if changed:
        faults.append(f"changed its input {', '.join(changed)}")
    words = case.words if not case.expect or done.returncode == 2 else ()
    return faults + [f"does not say /{word}/" for word in words if not re.search(word, told + said)]


def run_case(case, options, clean=None):
    """@return the row of the table, and the answer in full"""
    with tempfile.TemporaryDirectory() as name, tempfile.TemporaryDirectory() as cache, tempfile.NamedTemporaryFile() as log:
        folder = pathlib.Path(name)
        prepare(folder, case)
        before = digests(folder)
        guard = guarded(options.guard.resolve(), case.command, folder, cache, log.name) if options.guard else {}
        variables = " ".join(f"{key}={shlex.quote(value)}" for key, value in guard.items())
        begin = time.monotonic()
        try:
            done = subprocess.run(f"exec env {variables} '{options.program}' {case.command}", shell=True, cwd=folder, timeout=options.limit,
                                  stdin=subprocess.DEVNULL, capture_output=True, env={**os.environ, "XDG_CACHE_HOME": cache})
        except subprocess.TimeoutExpired as slow:
            last = (slow.stderr or b"").decode("utf-8", "replace").strip().splitlines()[-1:]
            return {"case": case.name, "status": "time limit", "seconds": options.limit, "faults": [f"beyond {options.limit:g} s"], "said": "".join(last)}, ""
        seconds = round(time.monotonic() - begin, 2)
        faults = check_case(case, done, folder, before, clean)
        refused = sorted(set(pathlib.Path(log.name).read_text(errors="replace").splitlines()))
        faults += [f"outside of the stated places: {line[:200]}" for line in refused]
        said = done.stderr.decode("utf-8", "replace").strip().splitlines()[-1:]
        row = {"case": case.name, "status": done.returncode, "seconds": seconds, "faults": faults, "said": "".join(said)[:1500]}
        return row, answer_of(done, folder, case.command)


def clean_answers(pool, chosen, options):
    """Of the good files, by command and edits; they are cases of their own."""
    wanted = {}
    for case in chosen:
        if case.clean is not None:
            wanted.setdefault((case.command, repr(case.clean)), Case(f"good files: {case.name}", case.command, case.clean, (0, 1)))
    rows = list(pool.map(lambda case: run_case(case, options), wanted.values()))
    return dict(zip(wanted, rows))


def shared(all_cases, share):
    """One in `share` of each class and reader, by the name: the same in each run. 0: none."""
    if share <= 1:
        return all_cases if share == 1 else []
    kinds = collections.defaultdict(list)
    for case in all_cases:
        kinds[case.name.rsplit(": ", 1)[0]].append(case)
    return [case for group in kinds.values() for case in
            ([c for c in group if zlib.crc32(c.name.encode()) % share == 0] or group[:1])]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--only", default="", help="cases whose name has this text")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--limit", type=float, default=60, help="seconds of one case (default 60)")
    parser.add_argument("--csv", type=pathlib.Path, help="all answers as a table")
    parser.add_argument("--guard", type=pathlib.Path, help="leeway_guard.so (tests/guard): nothing is written or read elsewhere")
    parser.add_argument("--share", type=int, default=1, help="of the hostile files one in N of each class, at least one; 0: none (default: all)")
    options = parser.parse_args()
    options.program = options.program.resolve()
    chosen = [case for case in [*command_cases(), *cases(), *format_cases(), *shared(hostile_cases(), options.share)] if options.only in case.name]
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        clean = clean_answers(pool, chosen, options)
        answers = [row for row, _ in clean.values()]
        answers += pool.map(lambda case: run_case(case, options, clean[case.command, repr(case.clean)][1] if case.clean is not None else None)[0], chosen)
    bad = [answer for answer in answers if answer["faults"]]
    for answer in bad:
        print(f"{answer['case']}: {'; '.join(answer['faults'])}\n    {answer['said']}")
    counts = {}
    for answer in answers:
        counts[answer["status"]] = counts.get(answer["status"], 0) + 1
    told = ", ".join(f"{count} times {status}" for status, count in sorted(counts.items(), key=str))
    print(f"{len(answers)} cases, {len(answers) - len(bad)} with a clear answer; exit status {told}; slowest {max(a['seconds'] for a in answers):.1f} s")
    if options.csv:
        with open(options.csv, "w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(["case", "status", "seconds", "faults", "said"])
            writer.writerows([[a["case"], a["status"], a["seconds"], "; ".join(a["faults"]), a["said"]] for a in answers])
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
