#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Checks names of tests: words that begin with capitals, without underscores (GoogleTest makes identifiers of them), and no clause
that begins with what, who or which. Exit status 1 if a name breaks this."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
TEST = re.compile(r"^\s*(?:TYPED_)?TEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\s*\)", re.MULTILINE)


def problems_of(text, place):
    found = []
    for match in TEST.finditer(text):
        name, line = match.group(2), text.count("\n", 0, match.start(2)) + 1
        if not re.fullmatch(r"[A-Z][A-Za-z0-9]*", name):
            found.append(f"{place}:{line}: {name}: write the words of a test's name like TheseWords")
        if re.search(r"(^|[a-z0-9])(What|Who|Which)(?=[A-Z]|$)", name):
            found.append(f"{place}:{line}: {name}: name the thing in place of What, Who or Which")
    return found


def main():
    found = []
    for part in ("tests", "examples"):
        for path in sorted((ROOT / part).rglob("*.[ch]pp")):
            found += problems_of(path.read_text(), path.relative_to(ROOT))
    print("\n".join(found) if found else "all names of tests are as they should be")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
