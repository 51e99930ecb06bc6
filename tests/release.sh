#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs before a release; too long, or with too many needs, for tests/run.sh, which comes first. Root is needed for the bare system. Each stage runs
# although one before it failed; the last lines list all stages with their seconds, for core/docs/release.md.
#
#   release.sh [STAGE ...]        stages: arm64 packages wheels ompl (default: all)
#
#   arm64     all tests of the core, emulated, and digests of answers against this machine's
#   packages  .deb files, lintian, install, use and removal in a bare Debian 12
#   wheels    planners/python/make_wheels.sh
#   ompl      shim, planners and their tests with each prefix of LEEWAY_OMPL_PREFIXES (separated by blanks); fails if there is none
set -uo pipefail
cd "$( dirname "${BASH_SOURCE[0]}" )/.."
exec </dev/null
stages=( "$@" )
[ "$#" -gt 0 ] || stages=( arm64 packages wheels ompl )
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
arm64()
{
	answers && tests/arm64/run.sh all build/bin/print_answers
}
packages()
{
	planners/package/build_debs.sh && tests/packages/try_debs.sh build-deb
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
	arm64 | packages | ompl) run "$stage" "$stage" ;;
	wheels) run wheels planners/python/make_wheels.sh ;;
	*)
		echo "$0: there is no stage $stage; stages are arm64, packages, wheels, ompl" >&2
		exit 2
		;;
	esac
done
printf '\n| stage | result | seconds |\n|---|---|---|\n'
printf '%s\n' "${rows[@]}"
exit "$failed"
