#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compares the binary interface of the C libraries with the list in abi.txt: exported functions, layouts of public structs, values of
enumerators. Exit status 1 if they differ.

    abi.py [--write] NUMBER INCLUDE... -- LIBRARY...    NUMBER: LEEWAY_ABI; INCLUDE: folders of public headers; LIBRARY: shared libraries or
    archives

A new function or enumerator is an addition: --write (the target abi_list) puts it into the list. A function that is gone, or a struct that has another layout,
breaks programs built before: raise LEEWAY_ABI in CMakeLists.txt, then --write (before the first release --write alone)."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

LIST = pathlib.Path(__file__).with_name("abi.txt")
RECORD = re.compile(r"^ +0 \| struct (lw_\w+)$")
MEMBER = re.compile(r"^ *(\d+) \|   (\S.*)$")  # two blanks more are members of members
SIZE = re.compile(r"^ +\| \[sizeof=(\d+), align=(\d+)\]$")
ENUMERATOR = re.compile(r"^\t(LW_\w+) = ([^,/]+?),?\s*(?://.*)?$", re.MULTILINE)
HEADERS = ("leeway/leeway.h", "leeway/planners/planner.h")


def functions(library):
    table = ["-D"] if ".so" in pathlib.Path(library).name else ["-g"]
    lines = subprocess.run(["nm", *table, "--defined-only", library], capture_output=True, text=True, check=True).stdout.splitlines()
    names = [line.split()[-1] for line in lines if line.split()]
    return {f"function {name}" for name in names if re.fullmatch(r"lw_\w+", name)}


def structs(includes):
    found = set()
    with tempfile.TemporaryDirectory() as folder:
        source = pathlib.Path(folder) / "all.c"
        there = [h for h in HEADERS if any((pathlib.Path(i) / h).exists() for i in includes)]
        source.write_text("".join(f'#include "{header}"\n' for header in there))
        command = [os.environ.get("CLANG", "clang"), "-std=c11", "-fsyntax-only", "-Xclang", "-fdump-record-layouts-complete",
                   *[f"-I{include}" for include in includes], source]
        name = None
        for line in subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines():
            if match := RECORD.match(line):
                name = match[1]
            elif name and (match := SIZE.match(line)):
                found.add(f"struct {name}: {match[1]} bytes aligned to {match[2]}")
                name = None
            elif name and (match := MEMBER.match(line)):
                found.add(f"struct {name} {int(match[1]):4}: {match[2]}")
    return found


def enumerators(includes):
    found = set()
    for header in (h for i in includes for h in sorted(pathlib.Path(i).rglob("*.h"))):
        found |= {f"value {name} = {value.strip()}" for name, value in ENUMERATOR.findall(header.read_text())}
    return found


def main():
    words = sys.argv[1:]
    write = words[:1] == ["--write"]
    words = words[1:] if write else words
    cut = words.index("--")
    number, includes, libraries = words[0], words[1:cut], words[cut + 1:]
    now = structs(includes) | enumerators(includes)
    for library in libraries:
        now |= functions(library)
    if not any(line.startswith("struct lw_checker_def") for line in now) or "function lw_checker_state" not in now:
        sys.exit("abi.py: no struct lw_checker_def or no function lw_checker_state was found: the tools' output has changed")
    text = f"LEEWAY_ABI {number}\n" + "".join(f"{line}\n" for line in sorted(now))
    if write:
        LIST.write_text(text)
        return 0
    listed = LIST.read_text().splitlines()
    before = set(listed[1:])
    for line in sorted(before - now):
        print(f"gone or changed: {line}")
    for line in sorted(now - before):
        print(f"new: {line}")
    if listed[0] != f"LEEWAY_ABI {number}":
        print(f"abi.txt is of {listed[0]}, the build of LEEWAY_ABI {number}")
    elif before == now:
        print(f"{len(now)} functions, members and values are those of {LIST.name}")
        return 0
    print("additions: cmake --build BUILD --target abi_list writes the list. Anything gone or changed: raise LEEWAY_ABI in CMakeLists.txt first")
    return 1


if __name__ == "__main__":
    sys.exit(main())
