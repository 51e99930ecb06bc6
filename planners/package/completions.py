#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes shell completions of a program from its own help: leeway.bash, _leeway (zsh) and leeway.fish.

    completions.py PROGRAM FOLDER

Subcommands and options are those that PROGRAM --help and PROGRAM SUBCOMMAND --help-all list. An option whose value is one of a few
words ("a|b|c") completes these words, all others complete files."""
import pathlib
import re
import subprocess
import sys

OPTION = re.compile(r"^  (?:-(?P<short>\w),)?(?P<name>--[a-z][a-z0-9-]*)(?P<rest>.*)$")
SUBCOMMAND = re.compile(r"^  (?P<name>[a-z][a-z0-9-]*)  +(?P<text>.*)$")
VALUE = re.compile(r"^ (?P<value>[^ ]+)")


def help_of(program, *words):
    done = subprocess.run([program, *words], capture_output=True, text=True, check=True)
    return done.stdout.splitlines()


def subcommands(lines):
    begin = lines.index("Subcommands:") + 1
    found = []
    for line in lines[begin:]:
        match = SUBCOMMAND.match(line)
        if not match:
            break
        found.append((match["name"], match["text"]))
    return found


def options(lines):
    """Of each option: names, words of its value (None: a flag; empty: anything), text."""
    found = []
    for i, line in enumerate(lines):
        match = OPTION.match(line)
        if not match:
            continue
        names = (["-" + match["short"]] if match["short"] else []) + [match["name"]]
        head, _, text = match["rest"].partition("  ")
        text = text.strip() or (lines[i + 1].strip() if i + 1 < len(lines) else "")
        value = VALUE.match(head)
        words = None
        if value:
            words = value["value"].split("|") if re.fullmatch(r"[a-z0-9]+(\|[a-z0-9]+)+", value["value"]) else []
        found.append((names, words, text))
    return found


def bash(name, commands):
    cases, values = [], set()
    for command, _, its_options in commands:
        words = " ".join(word for names, _, _ in its_options for word in names)
        cases.append(f'\t{command}) words="{words}" ;;')
        values |= {(names[-1], " ".join(choices)) for names, choices, _ in its_options if choices}
    names = " ".join(command for command, _, _ in commands)
    choices = "\n".join(f'\t{option}) COMPREPLY=( $( compgen -W "{words}" -- "$word" ) ); return ;;' for option, words in sorted(values))
    rows = "\n".join(cases)
    return f"""# bash completion of {name}, written by completions.py
_{name}()
{{
	local word="${{COMP_WORDS[COMP_CWORD]}}" before="${{COMP_WORDS[COMP_CWORD-1]}}" words=""
	COMPREPLY=()
	if [ "$COMP_CWORD" -eq 1 ]; then
		COMPREPLY=( $( compgen -W "{names} --help --help-all --version" -- "$word" ) )
		return
	fi
	case "$before" in
{choices}
	esac
	case "${{COMP_WORDS[1]}}" in
{rows}
	esac
	case "$word" in
	-*) COMPREPLY=( $( compgen -W "$words" -- "$word" ) ) ;;
	*) COMPREPLY=( $( compgen -f -- "$word" ) ) ;;
	esac
}}
complete -o filenames -F _{name} {name}
"""


def quoted(text):
    return "'" + text.replace("'", "'\\''") + "'"


def zsh(name, commands):
    rows = []
    for command, _, its_options in commands:
        specs = []
        for names, choices, text in its_options:
            plain = re.sub(r"[\[\]:]", " ", text)
            value = "" if choices is None else f":value:({' '.join(choices)})" if choices else ":value:_files"
            specs += [quoted(f"*{option}[{plain}]{value}") for option in names]
        joined = " \\\n\t\t\t".join(specs)
        rows.append(f"\t{command})\n\t\t_arguments \\\n\t\t\t{joined or '_files'} ;;")
    names = "\n".join("\t\t" + quoted(f"{command}:{text}") for command, text, _ in commands)
    cases = "\n".join(rows)
    return f"""#compdef {name}
# zsh completion of {name}, written by completions.py
_{name}()
{{
	local -a commands
	commands=(
{names}
	)
	if (( CURRENT == 2 )); then
		_describe command commands
		compadd -- --help --help-all --version
		return
	fi
	local command=$words[2]
	shift words
	(( CURRENT-- ))
	case $command in
{cases}
	esac
}}
_{name} "$@"
"""


def fish(name, commands):
    rows = [f"# fish completion of {name}, written by completions.py"]
    for option in ("help", "help-all", "version"):
        rows.append(f"complete -c {name} -n __fish_use_subcommand -l {option}")
    for command, text, its_options in commands:
        rows.append(f"complete -c {name} -f -n __fish_use_subcommand -a {command} -d {quoted(text)}")
        for names, choices, what in its_options:
            words = [f"complete -c {name} -n '__fish_seen_subcommand_from {command}'"]
            words += [f"-l {option[2:]}" if option.startswith("--") else f"-s {option[1:]}" for option in names]
            if choices is not None:
                words.append(f"-x -a {quoted(' '.join(choices))}" if choices else "-r")
            rows.append(" ".join(words + [f"-d {quoted(what)}"]))
    return "\n".join(rows) + "\n"


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    name = pathlib.Path(program).name
    commands = []
    for command, text in subcommands(help_of(program, "--help")):
        # another program answers for bench, where it was built
        its_options = [] if command == "bench" else options(help_of(program, command, "--help-all"))
        commands.append((command, text, its_options))
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.bash").write_text(bash(name, commands))
    (folder / f"_{name}").write_text(zsh(name, commands))
    (folder / f"{name}.fish").write_text(fish(name, commands))


if __name__ == "__main__":
    main()
