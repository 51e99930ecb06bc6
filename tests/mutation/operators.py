#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Prints the mutants of universalmutator's C rules as JSON: { file: [[line, mutated text, rule], ...] }.

    VENV/bin/python operators.py TREE FILE...

Runs in the virtual environment that .ci/install.sh mutation makes. The rules of universalmutator are used as they come; it
compiles nothing here, because mutate.py compiles its mutants.
"""
import contextlib
import json
import pathlib
import sys

from universalmutator import mutator

RULES = {".c": ["universal.rules", "c.rules", "c_like.rules"], ".h": ["universal.rules", "c.rules", "c_like.rules"],
         ".cpp": ["universal.rules", "cpp.rules", "c_like.rules"], ".hpp": ["universal.rules", "cpp.rules", "c_like.rules"]}


def main():
    tree = pathlib.Path(sys.argv[1])
    found = {}
    with contextlib.redirect_stdout(sys.stderr):
        for name in sys.argv[2:]:
            with open(tree / name, encoding="utf-8") as file:
                lines = file.readlines()
            mutants = mutator.mutants_regexp(lines, RULES[pathlib.Path(name).suffix], ignorePatterns=[], ignoreStringOnly=True)
            found[name] = [[line, text.rstrip("\n"), rule[0]] for line, text, rule, _ in mutants]
    json.dump(found, sys.stdout)


if __name__ == "__main__":
    main()
