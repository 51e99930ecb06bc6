#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Puts Coal into a build folder, so that leeway-bench has it as a peer: the Python wheel "coal" carries headers and libraries.
#
#   benchmarks/get_coal.sh BUILD_FOLDER      needs python3 with pip, and the network; about 400 MB with Coal's dependencies
set -euo pipefail

if [ $# -ne 1 ] || [ ! -e "$1/CMakeCache.txt" ]; then
	echo "usage: $0 BUILD_FOLDER (a configured one)" >&2
	exit 2
fi
build=$( cd "$1" && pwd )
python3 -m pip install --quiet --upgrade --target "$build/coal" coal
cmake -U LEEWAY_COAL_LIBRARY "$build" >/dev/null
echo "Coal is in $build/coal; now: cmake --build $build --target leeway-bench"
