#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Writes manual pages of the program and its subcommands from their own help, by help2man.
#
#   manuals.sh PROGRAM FOLDER
set -euo pipefail
program=$( realpath "${1:?usage: $0 PROGRAM FOLDER}" ) folder=${2:?usage: $0 PROGRAM FOLDER}
name=$( basename "$program" )
mkdir -p "$folder"
rm -f "$folder"/*.1 "$folder"/*.1.gz

# page TITLE TEXT COMMAND: bench has no page, because another program answers
page()
{
	# help2man takes a name with a space for one command; its page is called as git's are
	help2man --no-info --section=1 --help-option="$4" --version-string="$version" --name="$2" "$3" |
		sed -e "s|$program|$name|g" -e "s|^\.TH [^ ]*|.TH ${1^^}|" -e "s|^$name [a-z]* \\\\-|$1 \\\\-|" >"$folder/$1.1"
}
version=$( "$program" --version | awk '{ print $2 }' )
page "$name" "certified clearance of robot states and motions" "$program" --help
"$program" --help | awk '/^Subcommands:/ { on = 1; next } on && !/^  / { exit } on { name = $1; $1 = ""; print name "\t" substr( $0, 2 ) }' |
	while IFS=$'\t' read -r command text; do
		[ "$command" = bench ] || page "$name-$command" "$text" "$program $command" --help-all
	done
gzip -9n "$folder"/*.1
