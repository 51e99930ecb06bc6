#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs before a release; too long, or with too many needs, for tests/run.sh, which comes first. Root is needed for the bare system. Each stage runs
# although one before it failed; the last lines list all stages with their seconds, for core/docs/release.md.
#
#   release.sh [STAGE ...]        stages: long fuzz hostile arm64 python-arm64 python-threads colcon packages wheels ompl (default: all)
#
#   long      tests labelled long, which take minutes each, in the folder build
#   fuzz      every fuzz target for FUZZ_SECONDS (default 60)
#   hostile   all hostile files of tests/bad_inputs, under its guard
#   arm64     all tests of the core, emulated, and digests of answers against this machine's
#   python-arm64    the Python module cross-compiled, its tests emulated, digests of answers against this machine's
#   python-threads  tests of the Python package that start threads, under the thread sanitizer
#   colcon    package.xml in a workspace of ROS, and a program that finds it there
#   packages  .deb files, lintian, install, use and removal in a bare Debian 12
#   wheels    planners/python/make_wheels.sh with each interpreter of LEEWAY_PYTHONS (separated by blanks; default /usr/bin/python3)
#   ompl      shim, planners and their tests with each prefix of LEEWAY_OMPL_PREFIXES (separated by blanks); fails if there is none
set -uo pipefail
cd "$( dirname "${BASH_SOURCE[0]}" )/.."
exec </dev/null
stages=( "$@" )
[ "$#" -gt 0 ] || stages=( long fuzz hostile arm64 python-arm64 python-threads colcon packages wheels ompl )
rows=() failed=0

run()
{
	local name=$1 begin=$SECONDS result=passed
	shift
	printf '\n=== %s\n' "$name"
	"$@" || { result="FAILED (status $?)"; failed=1; }
	rows+=( "$( printf '| %s | %s | %d |' "$name" "$result" $(( SECONDS - begin )) )" )
}

answers()
{
	local options=()
	[ -e build/CMakeCache.txt ] || options=( -G Ninja -DCMAKE_BUILD_TYPE=Release )
	cmake -S . -B build "${options[@]}" >/dev/null && cmake --build build --parallel "${JOBS:-$( nproc )}" --target print_answers
}
long()
{
	ctest --test-dir build --no-tests=error --output-on-failure --parallel "${JOBS:-$( nproc )}" --timeout 900 --label-regex long
}
fuzz()
{
	JOBS=${JOBS:-$( nproc )} tests/fuzz/run.sh "${FUZZ_SECONDS:-60}"
}
hostile()
{
	cmake --build build --parallel "${JOBS:-$( nproc )}" --target leeway leeway_guard &&
		python3 tests/bad_inputs/bad_inputs.py build/bin/leeway --guard build/tests/guard/leeway_guard.so
}
arm64()
{
	answers && tests/arm64/run.sh all build/bin/print_answers
}
packages()
{
	planners/package/build_debs.sh && tests/packages/try_debs.sh build-deb
}
# python_package FOLDER OPTIONS...: the module in a build folder
python_package()
{
	cmake -S . -B "$1" -G Ninja -DLEEWAY_BUILD_PYTHON=ON -DPython_EXECUTABLE="$( realpath -s "${LEEWAY_PYTHON_DIR:-build/python-tools}" )/bin/python" \
		-DLEEWAY_BUILD_OMPL=OFF -DLEEWAY_BUILD_EXAMPLES=OFF -DLEEWAY_BUILD_BENCHMARKS=OFF "${@:2}" >/dev/null &&
		cmake --build "$1" --parallel "${JOBS:-$( nproc )}" --target leeway_python leeway_python_files
}
python_arm64()
{
	python_package build-python -DCMAKE_BUILD_TYPE=Release -DLEEWAY_BUILD_TESTS=OFF && tests/arm64/python.sh build-python/python
}
# The interpreter is not built with the sanitizer: its library is loaded first, at addresses that are not random.
python_threads()
{
	local tools
	tools=$( realpath -s "${LEEWAY_PYTHON_DIR:-build/python-tools}" )/bin
	python_package build-python-tsan -DLEEWAY_SANITIZE=thread -DLEEWAY_BUILD_TESTS=OFF -DCMAKE_BUILD_TYPE=RelWithDebInfo \
		-DCMAKE_C_FLAGS_RELWITHDEBINFO="-O1 -g1" -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="-Og -g1" &&
		env LD_PRELOAD="$( realpath "$( gcc -print-file-name=libtsan.so )" )" TSAN_OPTIONS="exitcode=66 halt_on_error=1" PYTHONDONTWRITEBYTECODE=1 \
			PYTHONPATH=build-python-tsan/python setarch -R "$tools/python" -m pytest -q -p no:cacheprovider \
			-k "thread and not bits_of_c" planners/python/tests/test_{threads_and_memory,states,worlds}.py
}
wheels()
{
	local pythons
	read -r -a pythons <<<"${LEEWAY_PYTHONS:-/usr/bin/python3}"
	planners/python/make_wheels.sh "${pythons[@]}"
}
ompl()
{
	local prefix status=0
	if [ -z "${LEEWAY_OMPL_PREFIXES:-}" ]; then
		echo "$0: set LEEWAY_OMPL_PREFIXES to the folders that OMPL 1.6, 1.7 and 2.0 are installed in" >&2
		return 1
	fi
	for prefix in $LEEWAY_OMPL_PREFIXES; do
		tests/packages/ompl_version.sh "$prefix" || status=1
	done
	return "$status"
}

.ci/install.sh core bridge tests arm64 packages python release || exit 1
for stage in "${stages[@]}"; do
	case "$stage" in
	long | fuzz | hostile | arm64 | packages | wheels | ompl) run "$stage" "$stage" ;;
	python-arm64 | python-threads) run "$stage" "${stage//-/_}" ;;
	colcon) run colcon tests/packages/try_colcon.sh ;;
	*)
		echo "$0: there is no stage $stage; stages are long, fuzz, hostile, arm64, python-arm64, python-threads, colcon, packages, wheels, ompl" >&2
		exit 2
		;;
	esac
done
printf '\n| stage | result | seconds |\n|---|---|---|\n'
printf '%s\n' "${rows[@]}"
exit "$failed"
