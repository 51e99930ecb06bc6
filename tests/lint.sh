#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Second opinions: the layout of all lines; clang-tidy and cppcheck over the core, the bridge and the program; and all of
# it built by clang, whose warnings are errors, and tested.
#
#   tests/lint.sh [BUILD (default build)] [format] [layout] [tidy] [cppcheck] [clang]
#
# format shows the lines that clang-format-14 would lay out otherwise, and `tests/lint.sh layout` lays them out. It needs no build; tests/run.sh runs it.
#
# BUILD is a configured folder, for its compile_commands.json. tests/run.sh runs cppcheck, which takes 20 seconds of one
# processor over everything. The rest is no stage of it, because all of CI is to take less than half an hour: on two
# processors clang-tidy takes a minute over the core and five over the C++, and clang eight for its build (BUILD-clang) and
# two for its tests. FILES="core/src/blob/blob.c ..." looks at these only.
set -euo pipefail
cd "$( dirname "${BASH_SOURCE[0]}" )/.."
build=build
if [ "$#" -gt 0 ] && [ -d "$1" ]; then
	build=$1
	shift
fi
[ "$#" -gt 0 ] || set -- format tidy cppcheck clang
if [ "$*" != format ] && [ "$*" != layout ] && [ ! -e "$build/compile_commands.json" ]; then
	echo "$0: $build/compile_commands.json is not there: configure a build first, or name its folder" >&2
	exit 2
fi
sets=( tests )
case " $* " in
*' tidy '*) sets+=( lint ) ;;
esac
.ci/install.sh "${sets[@]}"
jobs=$( nproc )
if [ -n "${FILES:-}" ]; then
	read -r -a files <<<"$FILES"
else
	mapfile -t files < <( find core/src ompl_bridge/src planners -name '*.c' -o -name '*.cpp' | sort )
fi
bad=0

sources()
{
	find core ompl_bridge planners examples benchmarks tests -name node_modules -prune -o -name '*.[ch]' -print0 -o -name '*.[ch]pp' -print0
}

for what in "$@"; do
	case "$what" in
	format)
		echo "clang-format: all files"
		sources | xargs -0 -n 20 -P "$jobs" clang-format-14 --dry-run --Werror || bad=1
		;;
	layout)
		sources | xargs -0 -n 20 -P "$jobs" clang-format-14 -i
		;;
	tidy) # checks, and why others are left out: .clang-tidy
		echo "clang-tidy: ${#files[@]} files"
		printf '%s\0' "${files[@]}" | xargs -0 -n 2 -P "$jobs" clang-tidy-14 -p "$build" --quiet 2>/dev/null || bad=1
		;;
	cppcheck)
		# invalidPointerCast: an arena is bytes that become arrays, aligned by their owner. uninitvar: of arrays that a loop
		# fills which this tool thinks may run zero times; memcheck and the sanitizers see the real ones.
		# missingIncludeSystem: headers of the system are not looked for. The rest are matters of taste in C++
		# (useStlAlgorithm is not asked for).
		mapfile -t c_files < <( printf '%s\n' "${files[@]}" | grep '\.c$' || true )
		mapfile -t cpp_files < <( printf '%s\n' "${files[@]}" | grep '\.cpp$' || true )
		checks=( --enable=warning,performance,portability --inline-suppr --quiet -j "$jobs" --error-exitcode=1 --suppress=missingIncludeSystem
			--suppress=invalidPointerCast --suppress=uninitvar -I core/include -I "$build/core/include" )
		echo "cppcheck: ${#files[@]} files"
		[ "${#c_files[@]}" -eq 0 ] || cppcheck "${checks[@]}" --std=c11 -I core/src "${c_files[@]}" || bad=1
		[ "${#cpp_files[@]}" -eq 0 ] || cppcheck "${checks[@]}" --std=c++17 -I ompl_bridge/include -I ompl_bridge/src/io -I planners "${cpp_files[@]}" || bad=1
		;;
	clang) # which also draws the random numbers of one call in another order, so that tests see other worlds
		echo "clang: a build and its tests in $build-clang"
		options=( -DLEEWAY_DATA_DIR="$( sed -n 's/^LEEWAY_DATA_DIR:[A-Z]*=//p' "$build/CMakeCache.txt" )" )
		[ -e "$build-clang/CMakeCache.txt" ] || options+=( -G Ninja )
		if command -v ccache >/dev/null; then
			options+=( -DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache )
		fi
		cmake -S . -B "$build-clang" -DLEEWAY_WERROR=ON -DCMAKE_BUILD_TYPE=Release -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ \
			"${options[@]}" && cmake --build "$build-clang" --parallel "$jobs" &&
			ctest --test-dir "$build-clang" --no-tests=error --output-on-failure --parallel "$jobs" --timeout 900 --exclude-regex '^truth|^install' ||
			bad=1
		;;
	*)
		echo "$0: '$what' is none of format, tidy, cppcheck, clang" >&2
		exit 2
		;;
	esac
done
exit "$bad"
