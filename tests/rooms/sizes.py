#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Checks sizes: a source file has at most 800 lines, a function at most 80, a folder at most 22 sources (.c, .cpp).

    sizes.py                 prints each excess; exit status 1 if there is one
    sizes.py --largest 10    also prints the largest functions

A function counts from the first line of its signature to the brace that closes it; a lambda counts as part of the function around it.
"""
import argparse
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PARTS = ["core", "ompl_bridge", "planners", "benchmarks", "examples", "tests"]
MOST_FILE, MOST_FUNCTION, MOST_FOLDER = 800, 80, 22
SOURCES = {".c", ".cpp", ".h", ".hpp"}

NO_CODE = re.compile(r"""
    //[^\n]* | /\*.*?\*/                            # comments
  | R"(?P<end>[^(\s]*)\(.*?\)(?P=end)"              # raw strings
  | "(?:\\.|[^"\\\n])*" | (?<![0-9a-fA-F])'(?:\\.|[^'\\\n])+'
  | ^[ \t]*\#(?:\\\n|[^\n])*                        # lines for the preprocessor
""", re.VERBOSE | re.DOTALL | re.MULTILINE)
SCOPE = re.compile(r"\b(?:namespace|class|struct|union|enum|extern)\b[^()]*$|^\s*extern\s+\"\s*\"\s*$")


def blank(text):
    """The text with spaces in place of comments, strings and lines for the preprocessor: line ends stay. A second branch (#else) of
    the preprocessor is left out too, so that braces pair up."""
    def spaces(match):
        return re.sub(r"[^\n]", " ", match.group(0))

    lines, depth, out = text.split("\n"), 0, []
    for line in lines:
        directive = re.match(r"\s*#\s*(if|else|elif|endif)", line)
        if directive and directive.group(1) in ("else", "elif"):
            depth = max(depth, 1)
        elif directive and directive.group(1) == "if" and depth:
            depth += 1
        elif directive and directive.group(1) == "endif" and depth:
            depth -= 1
        out.append("" if depth and not directive else line)
    return NO_CODE.sub(spaces, "\n".join(out))


def functions(text):
    """(name, first line, lines) of each definition of a function in the text of a C or C++ file."""
    code, scopes, head = blank(text), [], 0  # scopes: what each open brace is; head: where the text before a brace begins
    found = []
    for match in re.finditer(r"[{};]", code):
        at = match.start()
        inside = next((scope for scope in scopes if scope is not None), None)  # the function around this place
        if match.group() == "{":
            before = code[head:at]
            # a parameter list makes a function; `= {` and `return {` do not
            signature = re.search(r"([~\w:]+(?:\s*(?:\(\)|[^\w\s(]+))?)\s*\(", before)
            if inside is None and signature and not SCOPE.search(before) and not re.search(r"=\s*$", before):
                begin = head + len(before) - len(before.lstrip())
                scopes.append((signature.group(1), code.count("\n", 0, begin) + 1))
            else:
                scopes.append(None)
        elif match.group() == "}" and scopes:
            scope = scopes.pop()
            if scope is not None:
                found.append((scope[0], scope[1], code.count("\n", 0, at) + 2 - scope[1]))
        if inside is None or not any(scopes):
            head = at + 1
    if scopes:
        raise ValueError("braces that do not pair")
    return found


def test_name(text, line):
    """The name of a test whose macro stands in this line, or ""."""
    match = re.search(r"\bTEST\w*\(\s*(\w+),\s*(\w+)", text.split("\n")[line - 1])
    return ".".join(match.groups()) if match else ""


def survey(root, parts=PARTS):
    """(problems, functions): excesses as text, and (lines, file, line, name) of all functions."""
    problems, all_functions = [], []
    for part in parts:
        folders = {}
        for path in sorted((root / part).rglob("*")):
            place = path.relative_to(root)
            if path.suffix not in SOURCES or any(name.startswith("build") for name in place.parts[:-1]):
                continue
            text = path.read_text()
            lines = text.count("\n")
            if path.suffix in (".c", ".cpp"):
                folders[place.parent] = folders.get(place.parent, 0) + 1
            if lines > MOST_FILE:
                problems.append(f"{place}: {lines} lines; a file has at most {MOST_FILE}: move a part of it to a file of its own")
            try:
                found = functions(text)
            except ValueError as error:
                problems.append(f"{place}: {error}: functions cannot be measured")
                continue
            for name, line, length in found:
                name = test_name(text, line) or name
                all_functions.append((length, str(place), line, name))
                if length > MOST_FUNCTION:
                    problems.append(f"{place}:{line}: {name} has {length} lines; a function has at most {MOST_FUNCTION}: give its steps functions")
        problems += [f"{folder}: {count} sources; a folder has at most {MOST_FOLDER}: split it into rooms"
                     for folder, count in folders.items() if count > MOST_FOLDER]
    return problems, all_functions


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--largest", type=int, default=0, metavar="N", help="print the N largest functions")
    arguments = parser.parse_args()
    problems, found = survey(ROOT)
    for length, place, line, name in sorted(found, reverse=True)[:arguments.largest]:
        print(f"{length:5d}  {place}:{line} {name}")
    print("\n".join(problems) if problems else f"{len(found)} functions, all sizes within their limits")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
