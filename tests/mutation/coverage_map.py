# SPDX-License-Identifier: BSD-3-Clause
"""The lines of the libraries that each test of CTest executes, and how long it takes: found once per commit, by running every test once
beside libraries that clang built to count. The test programs are those of the workshop."""
import concurrent.futures
import gzip
import json
import os
import pathlib
import re
import shutil
import subprocess
import time

import workshop as ws

# Not of the libraries that mutants change, or far slower than they are worth: they build, install or fetch something, or run
# under valgrind. Tests that a mutant may not decide are named in the README.
LEFT_OUT = re.compile(r"^(install|as_built|memcheck|zoo|mutation)\b|\.EveryLineOf")
TEST_SECONDS = 300
LIVE = set()  # test processes that run now


def release_tests(workshop):
    """[{name, command, directory, environment}] of the workshop's CTest tests, without those that are left out."""
    text = ws.run(["ctest", "--test-dir", workshop.build, "--show-only=json-v1"], env={**os.environ, **workshop.paths()})
    found = []
    for test in json.loads(text)["tests"]:
        properties = {p["name"]: p["value"] for p in test.get("properties", [])}
        if "command" not in test or properties.get("DISABLED") or LEFT_OUT.search(test["name"]):
            continue
        if any(name in properties for name in ("PASS_REGULAR_EXPRESSION", "FAIL_REGULAR_EXPRESSION", "WILL_FAIL")):
            continue
        environment = dict(entry.split("=", 1) for entry in properties.get("ENVIRONMENT", []))
        found.append({"name": test["name"], "command": test["command"], "environment": environment,
                      "skip": properties.get("SKIP_RETURN_CODE", -1), "directory": properties["WORKING_DIRECTORY"]})
    return found


def filter_of(test):
    """The --gtest_filter of a test that is one case of a GoogleTest program, or None."""
    return next((word.split("=", 1)[1] for word in test["command"] if word.startswith("--gtest_filter=")), None)


def run_test(test, environment, scratch, limit, command=None):
    """Runs a test away from all others: (status, seconds, output). Status -9 or 124 after the limit. Processes of a test end with it,
    and its limit holds even when this program ends first."""
    shutil.rmtree(scratch, ignore_errors=True)
    scratch.mkdir(parents=True)
    places = {name: str(scratch) for name in ("TMPDIR", "XDG_CACHE_HOME", "HOME")}
    words = ["prlimit", "--as=16000000000", "--fsize=2000000000", "--core=0", "timeout", "--kill-after=1", f"{limit:.0f}",
             *(command or test["command"])]
    begin = time.monotonic()
    with open(scratch / ".output", "w+b") as output:
        process = subprocess.Popen(words, cwd=test["directory"], env={**os.environ, **places, **test["environment"], **environment},
                                   stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT, start_new_session=True)
        LIVE.add(process)
        try:
            status = process.wait(timeout=limit + 5)
        except subprocess.TimeoutExpired:
            status = 124
        finally:
            end(process)
            process.wait()
            LIVE.discard(process)
        seconds = time.monotonic() - begin
        output.seek(0, os.SEEK_END)
        output.seek(max(0, output.tell() - 200000))
        text = output.read().decode("utf-8", "replace")
    shutil.rmtree(scratch, ignore_errors=True)
    return status, seconds, text


def end(process):
    """Ends a test and its processes."""
    try:
        os.killpg(process.pid, 9)
    except ProcessLookupError:
        pass


def covered_libraries(workshop, jobs):
    """The libraries again, built to count executed lines; the folder that holds them."""
    folder = workshop.folder / "covered"
    if (folder / "built").exists():
        return folder
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "objects").mkdir(parents=True)
    flags = ["-w", "-O1", "-fprofile-instr-generate", "-fcoverage-mapping"]
    compilers = {"cc": "clang", "gcc": "clang", "c++": "clang++", "g++": "clang++"}
    objects = {}

    def compile_one(source):
        _, output, _ = workshop.commands[source]
        place = folder / "objects" / (source.replace("/", "_") + ".o")
        words = [word for word in workshop.compile_words(source, place) if word != "-Werror"]
        words[0] = compilers[os.path.basename(words[0])]
        ws.run((["ccache"] if shutil.which("ccache") else []) + words + flags, cwd=workshop.tree)
        objects[output] = str(place)

    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        list(pool.map(compile_one, sorted(workshop.commands)))
    for words, output in workshop.links.values():
        linked = [objects.get(word, word) for word in words]
        linked[linked.index("-o") + 1] = str(folder / ws.output_name(words, output))
        linked[0] = compilers[os.path.basename(linked[0])]
        # The libraries of a link are named by their places in the build; at run time those beside this one are found first
        ws.run(linked + ["-fprofile-instr-generate"], cwd=workshop.build)
    (folder / "built").touch()
    return folder


def executed_lines(profiles, libraries, tree):
    """{file: bits}, bit n set if line n was executed; files relative to the tree."""
    merged = profiles / "merged"
    files = [str(p) for p in profiles.glob("*.profraw") if p.stat().st_size]
    if not files:
        return {}
    ws.run(["llvm-profdata", "merge", "--sparse", "--failure-mode=all", "-o", merged, *files])
    first, *others = [str(library) for library in libraries]
    text = ws.run(["llvm-cov", "export", "--format=lcov", f"--instr-profile={merged}", first, *(f"--object={o}" for o in others)])
    found, file, bits, tree = {}, None, 0, str(tree) + "/"
    for line in text.splitlines():
        if line.startswith("SF:"):
            file, bits = line[3:], 0
        elif line.startswith("DA:"):
            number, count = line[3:].split(",")[:2]
            if count != "0":
                bits |= 1 << int(number)
        elif line == "end_of_record" and bits:
            name = file.removeprefix(tree)
            if not os.path.isabs(name):
                found[name] = found.get(name, 0) | bits
    return found


def make(workshop, jobs, say=print):
    """The map of this workshop's commit: {"tests": [...], "broken": {name: why}}, each test with seconds and lines {file: bits}."""
    place = workshop.folder / "map.json.gz"
    if place.exists():
        return load(place)
    covered = covered_libraries(workshop, jobs)
    libraries = sorted(covered.glob("*.so*"))
    tests = release_tests(workshop)
    say(f"{len(tests)} tests run once each to see which lines they execute")
    broken, done = {}, []

    def measure(numbered):
        number, test = numbered
        profiles = workshop.folder / "profiles" / str(number)
        shutil.rmtree(profiles, ignore_errors=True)
        profiles.mkdir(parents=True)
        environment = {**workshop.paths([covered]), "LLVM_PROFILE_FILE": str(profiles / "%m-%p.profraw")}
        status, seconds, text = run_test(test, environment, workshop.folder / "scratch" / f"map-{number}", TEST_SECONDS)
        if status == test["skip"] or "[  SKIPPED ]" in text:
            broken[test["name"]] = "skipped"
        elif status != 0:
            broken[test["name"]] = f"status {status}: {text[-500:]}"
        else:
            lines = executed_lines(profiles, libraries, workshop.tree)
            if lines:
                done.append({**test, "seconds": seconds, "lines": lines})
        shutil.rmtree(profiles, ignore_errors=True)
        if (len(done) + len(broken)) % 100 == 0:
            say(f"  {len(done)} of {len(tests)}")

    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        list(pool.map(measure, enumerate(tests)))
    done.sort(key=lambda test: test["name"])
    partial = place.with_suffix(".partial")
    with gzip.open(partial, "wt", compresslevel=3) as file:
        packed = [{**t, "lines": {f: hex(b) for f, b in t["lines"].items()}} for t in done]
        json.dump({"tests": packed, "broken": broken}, file)
    partial.rename(place)
    return {"tests": done, "broken": broken}


def load(place):
    with gzip.open(pathlib.Path(place), "rt") as file:
        found = json.load(file)
    for test in found["tests"]:
        test["lines"] = {f: int(b, 16) for f, b in test["lines"].items()}
    return found


def lines_of(bits):
    """The numbers of the lines that a map's bits name."""
    return {n for n, bit in enumerate(reversed(bin(bits)[2:])) if bit == "1"}
