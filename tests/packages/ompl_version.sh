#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Compiles the OMPL shim, the planners and the program with the OMPL that is installed in PREFIX, and runs their conformance and contract tests.
#
#   ompl_version.sh PREFIX [FOLDER]     FOLDER: build-ompl-NAME, NAME being the last part of PREFIX
#
# OMPL's wheels on the package index have no headers: PREFIX comes from sources (cmake --install of OMPL 1.6, 1.7 or 2.0).
set -euo pipefail
cd "$( dirname "${BASH_SOURCE[0]}" )/../.."
prefix=$( realpath "${1:?usage: $0 PREFIX [FOLDER]}" ) build=${2:-build-ompl-$( basename "$1" )}
options=( -DLEEWAY_WERROR=ON -DCMAKE_BUILD_TYPE=Release "-DCMAKE_PREFIX_PATH=$prefix" "-DCMAKE_BUILD_RPATH=$prefix/lib"
	-DLEEWAY_BUILD_BENCHMARKS=OFF -DLEEWAY_BUILD_EXAMPLES=OFF -DCMAKE_GTEST_DISCOVER_TESTS_DISCOVERY_MODE=PRE_TEST )
if [ ! -e "$build/CMakeCache.txt" ]; then
	options+=( -G Ninja )
fi
if command -v ccache >/dev/null; then
	options+=( -DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache )
fi
cmake -S . -B "$build" "${options[@]}" >/dev/null
case "$( sed -n 's/^ompl_DIR:PATH=//p' "$build/CMakeCache.txt" )" in
"$prefix"/*) ;;
*) echo "$0: CMake did not find OMPL in $prefix" >&2; exit 1 ;;
esac
cmake --build "$build" --parallel "${JOBS:-$( nproc )}" --target leeway test_ompl test_ompl_psbl test_native_planner
ctest --test-dir "$build" --no-tests=error --output-on-failure --parallel "${JOBS:-$( nproc )}" --timeout 1800 \
	--tests-regex 'Ompl|OMPL|Conformance|Contract|Validity|Space|Objective|Psbl'
