#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Makes the virtual environment of tests/mutation and tests/coverage.sh ($LEEWAY_MUTATION_DIR, else build/mutation);
# .ci/install.sh mutation calls this. Tools that are there already stay.
set -euo pipefail
cd "$( dirname "${BASH_SOURCE[0]}" )/../.."
folder=${LEEWAY_MUTATION_DIR:-build/mutation}
tools="universalmutator==1.14.1 gcovr==8.8"

if [ "$( cat "$folder/venv/.tools" 2>/dev/null )" = "$tools" ]; then
	exit 0
fi
echo "getting $tools"
log=$( mktemp )
trap 'rm -f "$log"' EXIT
mkdir -p "$folder"
rm -rf "$folder/venv"
# shellcheck disable=SC2086 # two requirements
if ! { /usr/bin/python3 -m venv "$folder/venv" &&
	"$folder/venv/bin/python" -m pip --disable-pip-version-check --no-input install $tools; } </dev/null >"$log" 2>&1; then
	cat "$log" >&2
	exit 1
fi
echo "$tools" >"$folder/venv/.tools"
