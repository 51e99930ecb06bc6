#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs three.js and esbuild, in the versions of package-lock.json, into $LEEWAY_VIEW_DIR, else build/view-tools. CMake and
# .ci/install.sh view call this. A folder with the listed versions stays as it is.
set -euo pipefail
cd "$( dirname "${BASH_SOURCE[0]}" )"
folder=${LEEWAY_VIEW_DIR:-../../build/view-tools}
if cmp -s package-lock.json "$folder/.installed" && [ -d "$folder/node_modules/three" ]; then
	exit 0
fi
if ! command -v npm >/dev/null; then
	echo "npm was not found (Debian: apt-get install npm)"
	exit 1
fi
mkdir -p "$folder"
cp package.json package-lock.json "$folder"
log=$( mktemp )
trap 'rm -f "$log"' EXIT
# esbuild's program is a package of its own: no script of a package is run
if ! npm ci --prefix "$folder" --ignore-scripts --no-audit --no-fund --fetch-retries 2 --fetch-timeout 60000 </dev/null >"$log" 2>&1; then
	echo "npm ci failed: $( grep -m 1 -E 'ERR!|error' "$log" || tail -n 1 "$log" )"
	exit 1
fi
cp package-lock.json "$folder/.installed"
