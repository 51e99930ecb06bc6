#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Lists functions of the public C headers that only the core and its tests call: no program, bridge, example or benchmark.

    unused.py            # exit status 1 if there is one

Such a function is a promise that nobody needs. Remove it, merge it into one that is used, or show it in an example.
"""
import pathlib
import re
import sys

HEADERS = ["core/include/leeway", "planners/*/include/leeway/planners"]
CALLERS = ["ompl_bridge", "planners", "examples", "benchmarks"]
SOURCES = {".c", ".cpp", ".h", ".hpp", ".py"}


def without_comments(text):
    return re.sub(r"//[^\n]*|/\*.*?\*/", "", text, flags=re.DOTALL)


def declared(header):
    """Names of the functions that the text of a header exports."""
    return re.findall(r"\bLW_API\b[^;{]*?\b(lw_\w+)\s*\(", without_comments(header))


def unused(headers, callers):
    """Functions that the headers declare and no caller names; both are texts."""
    called = set()
    for text in callers:
        called.update(re.findall(r"\blw_\w+\b", without_comments(text)))
    return sorted({name for header in headers for name in declared(header)} - called)


def main():
    root = pathlib.Path(__file__).resolve().parents[2]
    headers = [path for pattern in HEADERS for folder in sorted(root.glob(pattern)) for path in sorted(folder.glob("*.h"))]
    callers = [path for folder in CALLERS for path in sorted((root / folder).rglob("*")) if path.suffix in SOURCES and path not in headers]
    found = unused([path.read_text() for path in headers], [path.read_text() for path in callers])
    print("\n".join(f"{name}: only the core and its tests call it; remove it, merge it, or show it in an example" for name in found)
          or f"{len(headers)} headers, every function has a caller")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
