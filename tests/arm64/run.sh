#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The core on 64-bit ARM: cross-compiles it and its tests with Debian's compiler, runs them by qemu, and compares digests of answers
# with those of this machine. Packages: .ci/install.sh arm64.
#
#   run.sh quick PROGRAM [FOLDER]   kernels at all levels, answers: two minutes. PROGRAM: print_answers of this machine's build
#   run.sh all PROGRAM [FOLDER]     all tests of the core, some hours of processor time: long doubles have 113 bits there, by software
#
# FOLDER (build-arm64) keeps the packages and the build. Reaches come from this machine: see tests/levels/answers.cpp.
set -euo pipefail
cd "$( dirname "${BASH_SOURCE[0]}" )/../.."
usage="usage: $0 quick|all PROGRAM [FOLDER]"
mode=${1:?$usage} program=${2:?$usage} build=${3:-build-arm64}
jobs=${JOBS:-$( nproc )}
LEEWAY_SYSROOT=$( realpath -m "$build/sysroot" )
export LEEWAY_SYSROOT

tests/arm64/sysroot.sh "$LEEWAY_SYSROOT"
options=( -DLEEWAY_WERROR=ON -DCMAKE_BUILD_TYPE=Release -DLEEWAY_BUILD_BRIDGE=OFF
	-DLEEWAY_BUILD_EXAMPLES=OFF -DLEEWAY_BUILD_BENCHMARKS=OFF -DCMAKE_GTEST_DISCOVER_TESTS_DISCOVERY_MODE=PRE_TEST
	-DCMAKE_CXX_FLAGS=-Wno-psabi ) # GCC notes that an ABI of 2014 changed
if [ ! -e "$build/CMakeCache.txt" ]; then
	options+=( -G Ninja --toolchain tests/arm64/toolchain.cmake )
fi
if command -v ccache >/dev/null; then
	options+=( -DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache )
fi
cmake -S . -B "$build" "${options[@]}" >/dev/null

# Comparing tests of programs with text and installed trees is no matter of the machine.
case "$mode" in
quick)
	cmake --build "$build" --parallel "$jobs" --target test_core_query print_answers
	select=( --tests-regex '^(Kernels|BatchKernels|levels)\.' )
	;;
all)
	cmake --build "$build" --parallel "$jobs"
	select=( --exclude-regex '^(rooms|prose|mutation|install|as_built|packages)|^AsBuilt' )
	;;
*)
	echo "$usage" >&2
	exit 2
	;;
esac
ctest --test-dir "$build" --no-tests=error --output-on-failure --parallel "$jobs" --timeout 7200 "${select[@]}"

scratch=$( mktemp -d )
trap 'rm -rf "$scratch"' EXIT
"$program" 12 write "$scratch" >"$scratch/here"
qemu-aarch64 -L /usr/aarch64-linux-gnu -E LD_LIBRARY_PATH="$LEEWAY_SYSROOT/usr/lib/aarch64-linux-gnu" "$build/bin/print_answers" 12 read "$scratch" \
	>"$scratch/arm64"
if ! diff "$scratch/here" "$scratch/arm64"; then
	echo "$0: answers on 64-bit ARM differ from those of this machine" >&2
	exit 1
fi
cat "$scratch/arm64"
echo "$( grep -c '^world' "$scratch/arm64" ) digests of answers agree with this machine's"
