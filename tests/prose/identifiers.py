#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Finds names in the docs that the sources do not have.

A page says `lwi_edge_prove`, `motion/prove.c` or `Edge.StepsKeep..`; the code moves on, and the page describes what is gone. This script
reads all names in backticks of the Markdown pages and looks each up in the other files of the repository:

* names of code: words with an underscore or two capitals inside, members (`a.b_c`), qualified names, calls (`next()`);
* options (`--min-d`) and variables of the environment;
* tests (`Suite.Name`; `Suite.Nam..` for the beginning of a name, `.Nam..` for one of the suite named before);
* paths, from the root, from the page, or the end of a path.

History is left out: the changelog may name things that were removed. Names of other projects stand in ELSEWHERE.

    identifiers.py [--root FOLDER]      lists the names that are nowhere; exit status 1 if there are any
"""
import argparse
import pathlib
import re
import sys

SKIPPED_PAGES = {"core/docs/CHANGELOG.md"}
# Names that other projects or robots own, and patterns of names.
ELSEWHERE = {
    "MoveIt and ROS": "AttachedBody moveit_msgs/MotionPlanRequest moveit_msgs/RobotTrajectory octomap_msgs/OctomapWithPose angle_wraparound",
    "other formats and libraries": "closed_shell nearest_points PQP.h cluster.job_script()",
    "links of Fetch": "torso_lift_link shoulder_lift_link shoulder_pan_link head_pan_link forearm_roll_link wrist_flex_link",
    "patterns": "Suite.WordsWithCapitals readX() x_reader.cpp x_test.cpp tests/io/shape/x_test.cpp",
    "written by commands of the page": "edges_out.csv panda_spherized.urdf not_covered.txt",
    "written by users": "problems.toml",
}
# Folders that builds, installations and users make; a part in capitals stands for any name.
MADE = re.compile(r"^(build\S*|install|share|\.\.)/|(^|/)[A-Z]+([/.]|$)|-[A-Z]+[-.]")
SPAN = re.compile(r"`([^`\n]+)`")
FENCE = re.compile(r"^(```|~~~)")
TEST = re.compile(r"^([A-Z]\w*)?\.([A-Z]\w*)(\.\.)?$")
PATH = re.compile(r"^[\w.+-]+(/[\w.+-]+)+/?$|^[\w-]+\.(c|h|cpp|hpp|py|sh|md|toml|cmake|csv|txt)$")
OPTION = re.compile(r"^--[a-z][a-z0-9-]+$")
CODE = re.compile(r"^[A-Za-z_*][\w:.*]*(\(\))?$")
WORD = re.compile(r"[A-Za-z_*][\w*]*")


def repository_files(root):
    """All files but those of builds, caches and git."""
    paths = (path.relative_to(root) for path in root.rglob("*") if path.is_file())
    return sorted(path.as_posix() for path in paths
                  if not any(part.startswith("build") or part in ("__pycache__", ".git", "out") for part in path.parts[:-1]))


def looks_like_code(text):
    if not CODE.match(text):
        return False
    return "_" in text.strip("_") or "::" in text or text.endswith("()") or re.search(r"[a-z][A-Z]", text) is not None


class Sources:
    """All words, options, tests and paths of the files that are not pages."""

    def __init__(self, root, files):
        self.paths = files
        self.words, self.options, self.tests = set(), set(), set()
        for name in files:
            if name.endswith(".md") or name.startswith("benchmarks/results/"):
                continue
            text = (root / name).read_text(encoding="utf-8", errors="replace")
            self.words.update(re.findall(r"[A-Za-z_]\w*", text))
            self.options.update(re.findall(r"--[a-z][a-z0-9-]+", text))
            self.tests.update(re.findall(r"\bTEST(?:_F|_P)?\(\s*(\w+)\s*,\s*(\w+)", text))
            self.tests.update(re.findall(r"NAME\s+([A-Za-z]\w*)\.(\w+)", text))
        self.suites = {suite for suite, _ in self.tests}

    def has_word(self, word):
        if "*" not in word:
            return word in self.words
        pattern = re.compile(word.replace("*", r"\w*"))
        return word.strip("*") == "" or any(pattern.fullmatch(known) for known in self.words)

    def has_test(self, suite, name, is_start):
        return any(s.split("/")[-1] == suite and (n.startswith(name) if is_start else n == name) for s, n in self.tests)

    def has_path(self, page, text):
        text = text.rstrip("/")
        beside = (pathlib.PurePosixPath(page).parent / text).as_posix()
        return any(p == text or p.endswith("/" + text) or ("/" + p).find("/" + text + "/") >= 0 or p == beside or p.startswith(beside + "/")
                   for p in self.paths)


def unknown_names(page, text, sources):
    """(line, name) for each name of a page that the sources do not have."""
    elsewhere = {word for words in ELSEWHERE.values() for word in words.split()}
    fenced, suite = False, None
    for number, line in enumerate(text.splitlines(), 1):
        if FENCE.match(line):
            fenced = not fenced
        if fenced:
            continue
        for span in SPAN.findall(line):
            name = span.strip()
            if name in elsewhere:
                continue
            test = TEST.match(name)
            if test and (test[1] is None or test[1] in sources.suites):
                suite = test[1] or suite
                known = suite is not None and sources.has_test(suite, test[2], test[3] is not None)
            elif OPTION.match(name):
                known = name in sources.options
            elif PATH.match(name):
                known = MADE.search(name) or sources.has_path(page, name)
            elif looks_like_code(name):
                known = all(sources.has_word(word) for word in WORD.findall(name))
            else:
                continue
            if not known:
                yield number, name


def main():
    parser = argparse.ArgumentParser(description="Finds names in the docs that the sources do not have.")
    parser.add_argument("--root", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parents[2])
    root = parser.parse_args().root
    files = repository_files(root)
    sources = Sources(root, files)
    count = 0
    for page in files:
        if page.endswith(".md") and page not in SKIPPED_PAGES:
            for number, name in unknown_names(page, (root / page).read_text(encoding="utf-8"), sources):
                print(f"{page}:{number}: `{name}` is nowhere in the sources: the page is out of date, or the name belongs to ELSEWHERE")
                count += 1
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main())
