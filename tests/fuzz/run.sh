#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Fuzzes every target for a while, from the corpora of this folder, and prints the work of each.
#
#   tests/fuzz/run.sh [SECONDS per target (default 60)] [TARGET...]
#
#   BUILD=folder   of a build with LEEWAY_BUILD_FUZZERS (default build-fuzz; configured and built if it is missing)
#   JOBS=n         targets at a time (default 1)
#   EXCEPT=names   targets that are left out
#   SEED=n         of libFuzzer's random choices (default: another one each time)
#   KEEP=folder    where corpora grow from run to run (default: a temporary folder, removed)
#
# Exit status 1 if something was found: the inputs are then in BUILD/findings, and belong into tests/fuzz/corpus/TARGET with
# the fix.
set -euo pipefail
cd "$( dirname "${BASH_SOURCE[0]}" )/../.."
exec </dev/null

seconds=${1:-60}
shift || true
build=${BUILD:-build-fuzz}
if [ ! -x "$build/bin/leeway_fuzz" ]; then
	# SDF files are read by libsdformat, which is built without the fuzzer and the sanitizers
	cmake -S . -B "$build" -G Ninja -DLEEWAY_BUILD_FUZZERS=ON -DLEEWAY_SDF=OFF -DLEEWAY_WERROR=ON -DCMAKE_BUILD_TYPE=RelWithDebInfo \
		-DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_C_FLAGS_RELWITHDEBINFO="-O1 -g1" \
		-DCMAKE_CXX_FLAGS_RELWITHDEBINFO="-O1 -g1" -DLEEWAY_BUILD_BENCHMARKS=OFF -DLEEWAY_BUILD_EXAMPLES=OFF
	cmake --build "$build" --parallel "$( nproc )" --target fuzzers
fi
build=$( cd "$build" && pwd )
fuzz=$build/bin/leeway_fuzz
corpus=$PWD/tests/fuzz/corpus

scratch=$( mktemp -d )
# Inputs become files, thousands in a second: where files are memory, a disk does not decide how many
files=$scratch/files
if [ -d /dev/shm ] && [ -w /dev/shm ]; then
	files=$( mktemp -d -p /dev/shm )
fi
trap 'rm -rf "$scratch" "$files"' EXIT
keep=${KEEP:-$scratch/corpora}
mkdir -p "$keep" "$build/findings" "$files"
"$build/bin/leeway_fuzz_seeds" "$scratch/seeds" >"$scratch/targets"
python3 tests/bad_inputs/hostile.py "$scratch/seeds"
if [ "$#" -gt 0 ]; then
	for target in "$@"; do grep "^$target " "$scratch/targets"; done >"$scratch/chosen"
	mv "$scratch/chosen" "$scratch/targets"
fi
for target in ${EXCEPT:-}; do
	sed -i "/^$target /d" "$scratch/targets"
done
# urdfdom's links own each other in a circle when it rejects a tree, and assimp forgets its data of a file that it rejects;
# the memory is theirs.
printf '%s\n' leak:liburdfdom_model leak:libassimp >"$scratch/leaks"

# one TARGET LONGEST: a run of libFuzzer, and a line about its work, with the processor's time: where others work too, it is
# less. The timeout is one of the clock, and longer than a process has to stand still for others (20 s were not); an input
# that takes ten is kept as slow-unit.
one()
{
	local target=$1 longest=$2 status=0 more=() TIMEFORMAT='%U %S'
	local log=$scratch/$target.log
	mkdir -p "$keep/$target" "$corpus/$target"
	if [ -e "tests/fuzz/dictionaries/$target" ]; then
		more+=( "-dict=tests/fuzz/dictionaries/$target" )
	fi
	if [[ $target == mesh_* ]]; then
		more+=( -detect_leaks=0 ) # at the end only: a look after each input that assimp leaks for takes nineteen parts of twenty
	fi
	{
		time LEEWAY_FUZZ_TARGET=$target TMPDIR=$files LSAN_OPTIONS="suppressions=$scratch/leaks:print_suppressions=0" \
		UBSAN_OPTIONS=print_stacktrace=1 \
		"$fuzz" -seed="${SEED:-0}" -max_total_time="$seconds" -max_len="$longest" -timeout=60 -rss_limit_mb=2048 -malloc_limit_mb=1024 \
		-print_final_stats=1 -artifact_prefix="$build/findings/$target-" ${more[@]+"${more[@]}"} \
		"$keep/$target" "$corpus/$target" "$scratch/seeds/$target" >"$log" 2>&1 || status=$?
	} 2>"$scratch/$target.time"
	printf '%-12s %9s runs in %8.1f s of processor time, %6s features%s\n' "$target" \
		"$( sed -nE 's/^stat::number_of_executed_units: *//p' "$log" )" \
		"$( awk '{ print $1 + $2 }' "$scratch/$target.time" )" \
		"$( grep -oE ' ft: [0-9]+' "$log" | tail -1 | grep -oE '[0-9]+' )" \
		"$( [ "$status" -eq 0 ] || echo "  FOUND: $( grep -oE 'Test unit written to .*' "$log" | tail -1 )" )"
	if [ "$status" -ne 0 ]; then
		cp "$log" "$build/findings/$target.log"
		grep -E 'ERROR|runtime error|broken promise|SUMMARY|terminate|what\(\)' "$log" | head -8 | sed 's/^/    /'
		touch "$scratch/found"
	fi
}

if [ "${JOBS:-1}" -eq 1 ]; then
	while read -r target longest; do one "$target" "$longest"; done <"$scratch/targets"
else
	while read -r target longest; do
		while [ "$( jobs -rp | wc -l )" -ge "$JOBS" ]; do wait -n; done
		one "$target" "$longest" &
	done <"$scratch/targets"
	wait
fi
[ ! -e "$scratch/found" ]
