#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Makes the virtual environment that builds and tests the Python package: $LEEWAY_PYTHON_DIR, else build/python-tools. .ci/install.sh
# python calls this. An environment with the listed versions stays as it is.
set -euo pipefail
cd "$( dirname "${BASH_SOURCE[0]}" )/../.."
folder=${LEEWAY_PYTHON_DIR:-build/python-tools}
wanted=planners/python/requirements.txt

if cmp -s "$wanted" "$folder/.installed" && "$folder/bin/python" -c "import nanobind, numpy" 2>/dev/null; then
	exit 0
fi
echo "getting the Python tools of $wanted"
rm -rf "$folder"
log=$( mktemp )
trap 'rm -f "$log"' EXIT
if ! { /usr/bin/python3 -m venv "$folder" &&
	"$folder/bin/python" -m pip --disable-pip-version-check --no-input install --only-binary=:all: --requirement "$wanted"; } \
	</dev/null >"$log" 2>&1; then
	cat "$log" >&2
	exit 1
fi
cp "$wanted" "$folder/.installed"
