#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Asks the shells themselves: bash, and zsh and fish if they are installed, must complete every option of the program.

    completions.py PROGRAM FOLDER    FOLDER has leeway.bash, _leeway and leeway.fish

Options are all words with two dashes anywhere in the help of a subcommand, so that a line which completions.py of planners/package
misreads is asked for here."""
import pathlib
import re
import shutil
import subprocess
import sys

FEWEST = 8  # options of a subcommand that reads a robot


def run(*words, text=None):
    return subprocess.run(words, capture_output=True, text=True, input=text)


def options(program, command):
    return set(re.findall(r"(?<![\w-])--[a-z][a-z-]*[a-z]", run(program, command, "--help-all").stdout))


def by_bash(folder, command):
    script = f"""source {folder}/leeway.bash
COMP_WORDS=( leeway {command} -- ); COMP_CWORD=2; _leeway; printf '%s\\n' "${{COMPREPLY[@]}}"
"""
    return set(run("bash", "-c", script).stdout.split())


def by_zsh(folder, command):
    # _arguments is told to print its specifications
    script = f"""_arguments() {{ print -rl -- "$@" }}
_describe() {{ }}
words=( leeway {command} -- ); CURRENT=3
source {folder}/_leeway
"""
    return set(re.findall(r"^\*(--[a-z-]+)\[", run("zsh", "-f", "-c", script).stdout, re.MULTILINE))


def by_fish(folder, command):
    script = f"source {folder}/leeway.fish; complete -C 'leeway {command} --'"
    return {line.split("\t")[0] for line in run("fish", "--no-config", "-c", script).stdout.splitlines()}


def main():
    program, folder = sys.argv[1:]
    folder = pathlib.Path(folder)
    asked = {"bash": by_bash, "zsh": by_zsh, "fish": by_fish}
    commands = re.findall(r"^  ([a-z]+)  ", run(program, "--help").stdout.partition("Subcommands:")[2], re.MULTILINE)
    commands = [command for command in commands if command != "bench"]
    status = 0 if len(commands) >= 9 else 1
    print(f"{len(commands)} subcommands: {' '.join(commands)}")
    for shell, ask in asked.items():
        if not shutil.which(shell):
            print(f"note: {shell} is not installed: its completions were not asked for")
            continue
        count = 0
        for command in commands:
            wanted = options(program, command)
            if command != "cache" and len(wanted) < FEWEST:
                print(f"{command}: only {len(wanted)} options were found")
                status = 1
            missing = wanted - ask(folder, command)
            count += len(wanted)
            for word in sorted(missing):
                print(f"{shell} does not complete {command} {word}")
                status = 1
        print(f"{shell}: {count} options")
    return status


if __name__ == "__main__":
    sys.exit(main())
