#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Plans between two random free states of every MJCF, SDF and xacro model: the first command that a newcomer types.

    plans.py PROGRAM [--time 5] [--seed 1] [--table rows.md] [--package NAME=FOLDER]... FOLDER...

`PROGRAM plan --robot FILE --start random --goal random --time T --no-cache` for each .xml with <mujoco>, .sdf and .xacro below the folders. A model is
planned (exit status 0), stuck (1: with the program's last line: no path within the time, or no free state found) or refused (2, with the program's reason). Exit status 1 if the program ended in
another way, or takes longer than LIMIT.
"""
import argparse
import collections
import pathlib
import re
import subprocess
import sys
import tempfile
import time

LIMIT = 40  # seconds of one model, with reading and audit


def models(folder):
    for path in sorted(folder.rglob("*")):
        if path.suffix in (".sdf", ".xacro") or path.suffix == ".xml" and re.search(r"<mujoco\b", path.read_text(errors="replace")):
            yield path


def reason(said):
    """The last line, of an error without the name of the file."""
    text = re.split(r"[\r\n]+", said.strip())[-1]
    text = text.removeprefix("leeway: ").removeprefix("error: ")
    text = re.sub(r"^xacro: \S+ failed", "xacro failed", re.sub(r"^\S+: ", "", text))
    return text.replace("|", "\\|")[:160]


def planned(options, path):
    with tempfile.TemporaryDirectory() as folder:
        command = [str(options.program), "plan", "--robot", str(path), "--start", "random", "--goal", "random", "--seed", str(options.seed),
                   "--time", f"{options.time:g}", "--out", "path.yaml", "--no-cache"]
        command += [word for package in options.package for word in ("--package-path", package)]
        begin = time.monotonic()
        try:
            done = subprocess.run(command, cwd=folder, capture_output=True, text=True, errors="replace", timeout=LIMIT, check=False)
        except subprocess.TimeoutExpired:
            return f"beyond {LIMIT} s", LIMIT, ""
        kind = {0: "planned", 1: "stuck", 2: "refused"}.get(done.returncode, f"exit status {done.returncode}")
        return kind, time.monotonic() - begin, "" if kind == "planned" else reason(done.stderr)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("folders", nargs="+", type=pathlib.Path)
    parser.add_argument("--time", type=float, default=5)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--table", type=pathlib.Path, help="all answers as rows of Markdown")
    parser.add_argument("--package", action="append", default=[], metavar="NAME=FOLDER")
    options = parser.parse_args()
    options.program = options.program.resolve()
    options.package = [re.sub(r"=(.*)", lambda m: f"={pathlib.Path(m[1]).resolve()}", package) for package in options.package]
    rows, counts = [], collections.Counter()
    for folder in options.folders:
        for path in models(folder.resolve()):
            kind, seconds, why = planned(options, path)
            counts[kind] += 1
            rows.append(f"| {path.relative_to(folder.resolve().parent)} | {kind} | {seconds:.1f} | {why.replace(str(folder.resolve().parent) + '/', '')} |")
            print(rows[-1], flush=True)
    if options.table:
        options.table.write_text("\n".join(rows) + "\n")
    print(f"seed {options.seed}: " + ", ".join(f"{count} {kind}" for kind, count in sorted(counts.items())))
    return 1 if set(counts) - {"planned", "stuck", "refused"} else 0


if __name__ == "__main__":
    sys.exit(main())
