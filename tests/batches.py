#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the tests that CTest lists, many tests of a program in one process.

    batches.py FOLDER [--jobs N] [--timeout SECONDS] [--tests-regex R] [--exclude-regex R]

CTest starts a process for each GoogleTest test. Under sanitizers a start takes half a second, longer than most of the tests. Here up to 40 tests of one
program share a process; they must not depend on each other, nor on being the first. All other tests are CTest's, one by one, afterwards. Exit status 1: a
test failed, a process ended early or took too long, or none was found. What a batch that failed has printed is shown."""
import argparse
import concurrent.futures
import json
import os
import re
import subprocess
import sys
import time

TESTS_OF_A_BATCH = 40
FILTER = "--gtest_filter="


def listed(given, *options):
    out = subprocess.run(["ctest", "--test-dir", given.folder, "--show-only=json-v1", *options], capture_output=True, text=True, check=True).stdout
    return json.loads(out)["tests"]


def batches_of(tests):
    """Tests with the same program, folder and environment, by turns: neighbours in a file take similar times. @return [(tests, property)]"""
    groups = {}
    for test in tests:
        properties = {one["name"]: one["value"] for one in test["properties"]}
        key = (test["command"][0], properties.get("WORKING_DIRECTORY", "."), tuple(properties.get("ENVIRONMENT", [])))
        groups.setdefault(key, []).append(test["command"][1][len(FILTER):])
    for key, names in sorted(groups.items(), key=lambda item: -len(item[1])):
        count = -(-len(names) // TESTS_OF_A_BATCH)
        for i in range(count):
            yield key, names[i::count]


def run(given, batch):
    (program, folder, environment), names = batch
    begin = time.monotonic()
    command = [program, FILTER + ":".join(names)]
    try:
        done = subprocess.run(command, cwd=folder, env=dict(os.environ, **dict(one.split("=", 1) for one in environment)), stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=given.timeout, check=False)
        said, status = done.stdout, done.returncode
    except subprocess.TimeoutExpired as error:
        said, status = error.stdout or b"", f"no end after {given.timeout} s"
    said = said.decode(errors="replace")
    # as many as asked must have run: a filter that finds nothing passes, too
    ran = re.search(r"^\[==========\] (\d+) tests? from \d+ test (?:suite|case)s? ran\.", said, re.MULTILINE)
    if status == 0 and (ran is None or int(ran.group(1)) != len(names)):
        status = f"{ran.group(1) if ran else 'an unknown number'} of {len(names)} tests ran"
    skipped = len(set(re.findall(r"^\[  SKIPPED \] (\S+)$", said, re.MULTILINE)))
    return program, len(names), status, said, skipped, time.monotonic() - begin


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("folder")
    options.add_argument("--jobs", type=int, default=os.cpu_count())
    options.add_argument("--timeout", type=float, default=900)
    options.add_argument("--tests-regex")
    options.add_argument("--exclude-regex")
    given = options.parse_args()
    chosen = [word for name in ("tests_regex", "exclude_regex") if getattr(given, name) for word in ("--" + name.replace("_", "-"), getattr(given, name))]
    tests = listed(given, *chosen)
    in_batches = [test for test in tests if len(test.get("command", [])) >= 2 and test["command"][1].startswith(FILTER)]
    others = [test["name"] for test in tests if test not in in_batches]
    failed = passed = left_out = count = 0
    begin = time.monotonic()
    with concurrent.futures.ThreadPoolExecutor(given.jobs) as pool:
        for program, size, status, said, skipped, seconds in pool.map(lambda batch: run(given, batch), batches_of(in_batches)):
            count, passed, failed, left_out = count + 1, passed + size * (status == 0), failed + (status != 0), left_out + skipped
            print(f"{'passed' if status == 0 else 'FAILED'} {os.path.basename(program)}: {size} tests, {skipped} skipped, {seconds:.1f} s", flush=True)
            if status != 0:
                print(f"{said}\n{program}: {status}", flush=True)
    print(f"{len(in_batches)} tests in {count} processes, {time.monotonic() - begin:.0f} s: {failed} processes failed, {left_out} tests skipped", flush=True)
    if others:
        names = "|".join(f"^{re.escape(name)}$" for name in others)
        failed += subprocess.run(["ctest", "--test-dir", given.folder, "--no-tests=error", "--output-on-failure", "--parallel", str(given.jobs), "--timeout",
            str(int(given.timeout)), "--tests-regex", names], check=False).returncode != 0
    return int(failed > 0 or not tests)


if __name__ == "__main__":
    sys.exit(main())
