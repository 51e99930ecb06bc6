#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Everything that must hold before a change goes in, from nothing: installs missing packages (Debian 12), then
#
#   1. build-asan: the tests under the address and undefined-behaviour sanitizers, but for the long ground-truth sweeps
#   2. build-tsan: the tests that start threads, under the thread sanitizer
#   3. build:      release, warnings are errors; cppcheck over all sources; query tests at lower SIMD levels; kernels and answers on an emulated
#                  64-bit ARM (build-arm64); last, all tests but those labelled long
#
# Longer runs before a release are tests/release.sh: fuzzers (their corpora are replayed here, under the sanitizers), tests labelled long, packages,
# all of the core's tests on 64-bit ARM, other versions of OMPL.
# clang-tidy, and a build of all of it by clang with its tests, are tests/lint.sh: another fifteen minutes, which are more
# than CI has.
#
# The cheap builds come first and the whole CTest run last, so that its summary closes the output. All tests of a stage
# run; the first stage that fails ends the run with its status. May be called from any folder; reads no input.
set -euo pipefail
cd "$( dirname "${BASH_SOURCE[0]}" )/.."
exec </dev/null

jobs=$( nproc )
# Names of tests tell: those that start threads say Thread in suite or test, the ground-truth sweeps begin
# with truth. The programs that hold such tests are built under the thread sanitizer. Long under sanitizers are sweeps over
# ARMAR-III's meshes, too, and random sweeps that take a third of the stage: the same over smaller robots and fewer rounds stay.
threaded_tests='[Tt]hread'
long_tests=(
	'^truth' '^zoo' '^install' '^bad_inputs' '^packages.Shell' '^SpheresData.Armar' 'armar3/armar3' '^ReachPairsData.Armar' '^SphereTree.AMillion'
	'^EdgePieces.FreeMotions' '^Edge.CertifiedVerdictsSurvive' '^IntervalBatch.ProvedCell' '^IntervalBatch.BallPasses' '^Hierarchy.Changes'
	'^Hierarchy.PairOfMany' '^Hierarchy.EdgeContra' '^EdgeTube' '^Curve.VerdictsOnRandom'
	'^EdgeAuditData.Armar' '^StatesData' '^States.AnswersDiffer' '^NativeOmplPlanner.Progress' '^NativeOmplPlanner.Regions'
	'^Proofs.TheMotion.*LastValid' '^Proofs.TheRun.*LastValid' '^Roundings.Blends' '^SdfTest.PosesOfRandom' '^Witness.Slab' '^TriTri.Crossing'
	'^TriTri.Agrees' '^Spheres.Stopped' '^Spheres.CellsOf' '^Spheres.FormOf' '^SphereTree.Identical' '^States.ContactIs' '^Margins.EdgeEnters'
	'^EdgeMidpoint.Own' '^EdgeMidpoint.OneOf' '^EdgeMidpoint.BallOf' '^NativeProof.PathsDo' '^NativeProof.CutsKeep' '^ExtremeTrees' '^ExtremeChains.State'
	'^Edge.StepsKeep' '^MotionSweeps.NeverAbove' '^NativeOptimizer.ComesNear' '^SolidMesh.InsideContradicts' '/SolidMeshPairs' '^Required.ObstacleNearer'
	'^Kernels.LevelDiffers' '^EdgeClose.NoEdgeIsFree' '^TriTri.SmallIntegers' '^ClockCells' '^DetectedSolids.Differ' '^MovedDepth.ManySmall'
	'^ConstrainedPlanAttack' '^RandomLinesData' '^RandomPlansData' '^DroppedTest'
	'^Inverse.Branches' '^Inverse.StatesHave'
	# commands whose readers are tested in test_io and by the fuzzers' corpora: each starts the program, which takes half a second under sanitizers
	'^CliFields' '^CliWords' '^CliMessages' '^CliTune' '^CliEnds' '^CliTrajectory' '^CliSteps' '^Everything/PairsBadInput' '/CliBadInput' '^Killed' '^Cache\.'
	'^CacheData' '^Cli.Spherize' '^CliData' '^PairsData' '^examples' '^Xacro' '^ReadingCli' '^Cli.TheFirst' '^Cli.NumberOf' '^CliWorld.AMissing'
	'^CliWorld.Options' '^CliWorld.PlanWith' '^CliWorld.ATraj' '^CliPose.Wrong' )
# No parentheses: CTest takes at most nine, and leaves out nothing if there are more
long_names=$( IFS='|' && echo "${long_tests[*]}" )


heading()
{
	printf '\n=== [%d:%02d] %s\n' $(( SECONDS / 60 )) $(( SECONDS % 60 )) "$1"
}

# stage NAME COMMAND...
stage()
{
	local name=$1 status=0
	shift
	heading "$name"
	"$@" || status=$?
	if [ "$status" -ne 0 ]; then
		heading "FAILED: $name (status $status)" >&2
		exit "$status"
	fi
}

# later NAME COMMAND...: in the background, since downloads leave the processors idle; `collect NAME` is its stage.
declare -A later_pids
later()
{
	local name=$1
	shift
	"$@" >"$scratch/$name" 2>&1 &
	later_pids[$name]=$!
}

# collect NAME: the output and the status of `later NAME`
collect()
{
	local status=0
	wait "${later_pids[$1]}" || status=$?
	cat "$scratch/$1"
	return "$status"
}

# Python packages, the page's compiler and browser, robots: minutes of downloads. A missing robot fails the tests that need it, no more.
install_tools()
{
	local status=0
	{ .ci/install.sh python && .ci/install.sh view; } || status=$?
	.ci/install.sh zoo-tests || touch "$scratch/no-zoo"
	return "$status"
}

# configure FOLDER [OPTIONS]: a folder that is configured already keeps its generator.
configure()
{
	local folder=$1
	shift
	local options=( -DLEEWAY_WERROR=ON "$@" )
	if [ ! -e "$folder/CMakeCache.txt" ]; then
		options+=( -G Ninja )
	fi
	cmake -S . -B "$folder" "${options[@]}"
}

# configure_sanitized FOLDER SANITIZERS: -O1 keeps line numbers true and builds fast; C++ under sanitizers takes half of that
# time with -Og. Plain char is unsigned, as on ARM. Tests are found when they are run, because a program may need the runner below even to list its tests.
configure_sanitized()
{
	configure "$1" -DLEEWAY_SANITIZE="$2" -DLEEWAY_UNITY=ALL -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_C_FLAGS_RELWITHDEBINFO="-O1 -g1 -funsigned-char" \
		-DCMAKE_CXX_FLAGS_RELWITHDEBINFO="-Og -g1 -funsigned-char" -DLEEWAY_BUILD_BENCHMARKS=OFF -DLEEWAY_BUILD_EXAMPLES=OFF \
		-DLEEWAY_BUILD_VIEW=OFF -DCMAKE_GTEST_DISCOVER_TESTS_DISCOVERY_MODE=PRE_TEST
}

# build FOLDER [TARGETS]
build()
{
	local folder=$1
	shift
	cmake --build "$folder" --parallel "$jobs" ${1:+--target "$@"}
}

# run_tests FOLDER [CTEST OPTIONS]
run_tests()
{
	local folder=$1
	shift
	# one more at once than there are processors: browsers, servers and Python wait a fifth of their time
	"${runner[@]}" ctest --test-dir "$folder" --no-tests=error --output-on-failure --parallel "$(( jobs + 1 ))" --timeout 900 "$@"
}

# threaded_targets FOLDER: the test programs in which a threaded test is, as the build in this folder compiles them, alone or with other files
threaded_targets()
{
	local file
	while read -r file; do
		sed -nE "s,.* -o tests/.*CMakeFiles/([^/]+)\\.dir/.* -c [^ ]*/$file\".*,\\1,p" "$1/compile_commands.json"
		grep -rl --include='unity_*.cxx' "/$file\"" "$1/tests" | sed -nE 's,.*CMakeFiles/([^/]+)\.dir/.*,\1,p' || true
	done < <( grep -rlsE --include="*.cpp" "^TEST(_F|_P)?\(.*$threaded_tests" tests ) | sort -u
}

# run_batches FOLDER [OPTIONS]: many tests in one process. A start under a sanitizer takes half a second, longer than most tests.
run_batches()
{
	local folder=$1
	shift
	"${runner[@]}" tests/batches.py "$folder" --jobs "$jobs" "$@"
}

# at_levels LEVELS: the query tests with SIMD kernels of at most these levels, all at once
at_levels()
{
	local level status=0
	for level in "$@"; do
		LW_CPU_MASK=$level build/bin/test_core_query --gtest_brief=1 >"$scratch/level-$level" 2>&1 &
	done
	for level in "$@"; do
		wait -n || status=$?
	done
	tail -n 3 "${@/#/$scratch/level-}"
	[ "$status" -eq 0 ] || cat "${@/#/$scratch/level-}"
	return "$status"
}

# True if a program built with the sanitizer $1 works here when run by the command in the other arguments. A kernel or a
# container may forbid what a sanitizer needs; that says nothing about the code.
sanitizer_works()
{
	local sanitizer=$1
	shift
	printf 'int main( void ) { return 0; }\n' >"$scratch/probe.c"
	cc -fsanitize="$sanitizer" "$scratch/probe.c" -o "$scratch/probe" && "$@" "$scratch/probe" >/dev/null 2>&1
}

scratch=$( mktemp -d )
trap 'kill $( jobs -p ) 2>/dev/null || true; rm -rf "$scratch"' EXIT
export XDG_CACHE_HOME="$scratch/caches" # the user's own cache is left alone
notes=()
runner=( env )

stage "install missing packages" .ci/install.sh
stage "layout of all lines" tests/lint.sh format
mkdir -p build
stage "reference of the interfaces" doxygen core/docs/Doxyfile
later tools install_tools

stage "address, undefined: configure" configure_sanitized build-asan address,undefined,float-cast-overflow
stage "address, undefined: build" build build-asan
stage "tools of Python and the page, robots of the zoo" collect tools
LEEWAY_VIEW_DIR=$( realpath "${LEEWAY_VIEW_DIR:-build/view-tools}" )
export LEEWAY_VIEW_DIR
if [ -e "$scratch/no-zoo" ]; then
	notes+=( "the zoo's robots could not be fetched from the package index: the tests labelled zoo fail, all others run" )
fi
# Use after return is not looked for: it doubles the time of this stage, and gcc's warnings find what returns a local's address
asan_options=strict_string_checks=1:detect_stack_use_after_return=0
if ! sanitizer_works address env; then
	# LeakSanitizer stops its process with ptrace, which some containers forbid.
	asan_options+=:detect_leaks=0
	notes+=( "the leak sanitizer does not work on this machine: leaks were not looked for" )
fi
# urdfdom's links own each other in a circle when it rejects a tree; the memory is its own.
# assimp forgets its data of a file that it refuses.
printf '%s\n' leak:liburdfdom_model leak:libassimp >"$scratch/leaks"
runner=( env ASAN_OPTIONS="$asan_options" UBSAN_OPTIONS=print_stacktrace=1
	LSAN_OPTIONS="suppressions=$scratch/leaks:print_suppressions=0" )
stage "address, undefined: test" run_batches build-asan --exclude-regex "$long_names"

# gcc's thread sanitizer cannot map its shadow where the kernel randomises too many address bits (vm.mmap_rnd_bits above
# 28): without randomisation it can.
runner=( env )
if ! sanitizer_works thread "${runner[@]}"; then
	runner=( setarch -R )
fi
# assimp is not built with the sanitizer, which then misses the guards of its static variables. OMPL's CForest hands a
# sampler to its other threads while it is being made.
printf '%s\n' called_from_lib:libassimp race:ompl::base::CForestStateSampler >"$scratch/races"
runner+=( env TSAN_OPTIONS="suppressions=$scratch/races" )
if sanitizer_works thread "${runner[@]}"; then
	stage "thread: configure" configure_sanitized build-tsan thread
	mapfile -t targets < <( threaded_targets build-tsan )
	stage "thread: build ${targets[*]}" build build-tsan "${targets[@]}"
	stage "thread: test" run_batches build-tsan --tests-regex "$threaded_tests"
else
	notes+=( "the thread sanitizer does not work on this machine, not even without address randomisation: stage left out" )
fi

stage "release: configure" configure build -DCMAKE_BUILD_TYPE=Release -DLEEWAY_UNITY=TESTS -DLEEWAY_BUILD_PYTHON=ON -DLEEWAY_BUILD_VIEW=ON \
	-DPython_EXECUTABLE="$( realpath -s "${LEEWAY_PYTHON_DIR:-build/python-tools}" )/bin/python"
stage "release: build" build build
stage "cppcheck" tests/lint.sh build cppcheck
# The best level that this machine has is that of all tests below
stage "release: query tests, at most SSE2 and scalar" at_levels 2 1
stage "64-bit ARM: kernels and answers, emulated" tests/arm64/run.sh quick build/bin/print_answers
for note in ${notes[@]+"${notes[@]}"}; do
	heading "note: $note"
done
runner=( env )
stage "release: all tests" run_tests build --label-exclude long
