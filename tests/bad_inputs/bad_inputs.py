#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A sweep over bad inputs: does each get a clear answer?

    bad_inputs.py PROGRAM [--only TEXT] [--jobs N] [--csv FILE]

Clear is: exit status 0, 1 or 2, and the one that is expected; at most --limit seconds; no internal error; with 2 one line "leeway: error:
FILE: ELEMENT: PROBLEM; REMEDY" as the last one, and no output file; and every input file as it was before.
"""
import argparse
import concurrent.futures
import csv
import hashlib
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

from cases import FILES, cases


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


def digests(folder):
    return {path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.rglob("*") if path.is_file()}


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


def run_case(case, program, limit):
    with tempfile.TemporaryDirectory() as name, tempfile.TemporaryDirectory() as cache:
        folder = pathlib.Path(name)
        prepare(folder, case)
        before = digests(folder)
        begin = time.monotonic()
        try:
            done = subprocess.run(f"exec '{program}' {case.command}", shell=True, cwd=folder, timeout=limit, stdin=subprocess.DEVNULL,
                                  capture_output=True, env={**os.environ, "XDG_CACHE_HOME": cache})
        except subprocess.TimeoutExpired as slow:
            last = (slow.stderr or b"").decode("utf-8", "replace").strip().splitlines()[-1:]
            return {"case": case.name, "status": "time limit", "seconds": limit, "faults": [f"beyond {limit:g} s"], "said": "".join(last)}
        seconds = round(time.monotonic() - begin, 2)
        told, said = done.stdout.decode("utf-8", "replace"), done.stderr.decode("utf-8", "replace")
        after = digests(folder)
    faults = []
    if done.returncode not in case.status:
        faults.append(f"exit status {done.returncode}, expected {' or '.join(map(str, case.status))}")
    if done.returncode == 2:
        faults += error_faults(said, before, after)
    changed = [name for name in before if after.get(name) != before[name]]
    if changed:
        faults.append(f"changed its input {', '.join(changed)}")
    faults += [f"does not say /{word}/" for word in case.words if not re.search(word, told + said)]
    return {"case": case.name, "status": done.returncode, "seconds": seconds, "faults": faults,
            "said": "".join(said.strip().splitlines()[-1:])}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--only", default="", help="cases whose name has this text")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--limit", type=float, default=60, help="seconds of one case (default 60)")
    parser.add_argument("--csv", type=pathlib.Path, help="all answers as a table")
    options = parser.parse_args()
    chosen = [case for case in cases() if options.only in case.name]
    program = options.program.resolve()
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        answers = list(pool.map(lambda case: run_case(case, program, options.limit), chosen))
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
