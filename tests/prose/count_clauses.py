#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Counts lines of comments and docs that put a noun clause in place of a name: "what is near", "who holds the lock",
"tells which links meet". The house writes fewer than 1 line in 200 with such a clause.

    count_clauses.py [FOLDER ...]           one row per folder: lines, hits, share
    count_clauses.py -l [FOLDER ...]        the hits as well, as file:line: text
    count_clauses.py --most 0.5             exit status 1 if a folder has this percentage of hits or more

A line of comment is a line of C or C++ with "//" or one inside /* */, trailing comments included, or a line of a script (shell,
Python, CMake, TOML) with "# " or inside a docstring; a line of docs is a line of Markdown that is not empty and not in a fenced
block. The folder "." is the files of the root alone; folders of builds are left out. Counted are
  - "what", but not in a direct question ("What is free?"), nor in "no matter what", "what if", "so what";
  - "who" after anything but a person or a comma ("the one who calls" and "users, who call" are relative clauses);
  - "Which" as the first word of a sentence, or after a verb of telling or knowing ("says which", "depends on which"); all
    other uses ("the box, which holds", "in which") are relative clauses.
Code in backticks, text in double quotes, options and names of parameters are no prose and are left out. This is a heuristic of words, not a parser: a hit
is a line to look at.
"""
import argparse
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = ["core/src", "core/include", "core/docs", "ompl_bridge", "planners", "benchmarks", "tests", "examples", ".ci", "."]
SOURCES = {".c", ".h", ".cpp", ".hpp", ".in"}
SCRIPTS = {".sh", ".py", ".cmake", ".toml", ".clang-tidy", ".clang-format", ".editorconfig", "CMakeLists.txt", "run"}

TELLING = r"(?:say|tell|know|ask|decide|choose|show|see|find|name|list|record|remember|note|matter|determine|learn|pick|print|count)"
CLAUSE = re.compile(
    r"(?<!no matter )(?<!so )\bwhat\b(?! if\b)(?![^.;:]*\?)"
    r"|(?<!one )(?<!those )(?<!user )(?<!users )(?<!caller )(?<!callers )(?<!reader )(?<!readers )(?<!author )(?<!authors )"
    r"(?<!anybody )(?<!everybody )(?<!nobody )(?<!somebody )(?<!people )(?<!, )\bwho\b(?![^.;:]*\?)"
    r"|(?:^|[.?!:] )(?-i:Which)\b(?![^.;:]*\?)"
    r"|\b" + TELLING + r"(?:s|es|ed|n|ing)?(?: (?:on|of|about|to))? which\b"
    r"|\b(?:told|said|knew|known|chosen|found|depends? on|depending on) which\b", re.I)


def has_clause(text):
    """Whether a line of prose has a noun clause that begins with what, who or which."""
    text = re.sub(r"`[^`]*`", "it", text)
    text = re.sub(r'"[^"]*"', "it", text)
    text = re.sub(r"@param(?:\[\w+\])? \w+|--[\w-]+|\w+\(\)", "it", text)
    return bool(CLAUSE.search(text))


def comment_lines(source):
    """(line number, text) of each line of comment of a C or C++ source."""
    inside = False
    for number, line in enumerate(source.splitlines(), 1):
        parts, rest = [], line if inside else re.sub(r'"(?:\\.|[^"\\])*"', '""', line)  # a string may hold "//"
        while rest:
            if inside:
                part, end, rest = rest.partition("*/")
                parts.append(part.strip().lstrip("*"))
                inside = not end
                continue
            start = re.search(r"//|/\*", rest)
            if not start:
                break
            rest = rest[start.end():]
            if start.group() == "//":
                parts.append(rest.lstrip("/!<"))
                break
            inside = True
        text = " ".join(part.strip() for part in parts).strip()
        if text and not text.startswith("SPDX-"):
            yield number, text


def doc_lines(source):
    """(line number, text) of each line of prose of a Markdown file."""
    fenced = False
    for number, line in enumerate(source.splitlines(), 1):
        if line.lstrip().startswith("```"):
            fenced = not fenced
        elif not fenced and line.strip():
            yield number, line.strip().lstrip("#>*- ")


def script_lines(source):
    """(line number, text) of each line of comment or docstring of a shell, Python, CMake or TOML file."""
    inside = False
    for number, line in enumerate(source.splitlines(), 1):
        quotes = len(re.findall(r'"""', line))
        if quotes or inside:
            text = line.replace('"""', "").strip()
            inside ^= quotes % 2 == 1
        else:
            comment = re.search(r"(?:^|\s)#+\s+(.*)", line)
            text = comment.group(1).strip() if comment else ""
        if text and not text.startswith("SPDX-"):
            yield number, text


READERS = {**dict.fromkeys(SOURCES, comment_lines), **dict.fromkeys(SCRIPTS, script_lines), ".md": doc_lines}


def files_of(folder, root):
    """Files below a folder, those of builds left out; for "." the files of the root alone."""
    if folder == ".":
        return sorted(root.iterdir())
    return sorted(path for path in (root / folder).rglob("*") if not any(part.startswith("build") for part in path.relative_to(root).parts[:-1]))


def count(folder, root=ROOT):
    """(lines of prose, hits) of a folder; a hit is (file, line number, text)."""
    lines, hits = 0, []
    for path in files_of(folder, root):
        reader = READERS.get(path.name) or READERS.get(path.suffix)
        if reader is None or not path.is_file():
            continue
        for number, text in reader(path.read_text(errors="replace")):
            lines += 1
            if has_clause(text):
                hits.append((path.relative_to(root), number, text))
    return lines, hits


def main():
    parser = argparse.ArgumentParser(description="Counts noun clauses that begin with what, who or which in comments and docs.")
    parser.add_argument("-l", "--list", action="store_true", help="list the lines as well")
    parser.add_argument("--most", type=float, metavar="PERCENT", help="exit status 1 if the share of a folder is not below this")
    parser.add_argument("folders", nargs="*", default=FOLDERS, metavar="FOLDER", help="folders below the root of the repository")
    arguments = parser.parse_args()
    status = 0
    for folder in arguments.folders:
        lines, hits = count(folder)
        share = 100 * len(hits) / max(lines, 1)
        too_many = arguments.most is not None and share >= arguments.most
        if arguments.list or too_many:
            for path, number, text in hits:
                print("%s:%d: %s" % (path, number, text))
        print("%-16s %6d lines, %4d with a clause, %5.2f %%%s" % (folder, lines, len(hits), share, ": too many" if too_many else ""))
        status |= too_many
    return int(status)


if __name__ == "__main__":
    sys.exit(main())
