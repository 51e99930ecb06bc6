#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds libleeway0, libleeway-cxx0.1, libleeway-dev, leeway and python3-leeway as .deb files in FOLDER (build-deb), and checks them by lintian: errors end the run.
# Needs .ci/install.sh core bridge packages python.
#
#   build_debs.sh [FOLDER]
set -euo pipefail
cd "$( dirname "${BASH_SOURCE[0]}" )/../.."
build=${1:-build-deb}
options=( -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX=/usr -DCMAKE_INSTALL_LIBDIR="lib/$( dpkg-architecture -qDEB_HOST_MULTIARCH )"
	-DCMAKE_INSTALL_DOCDIR=share/doc/libleeway-dev -DBUILD_SHARED_LIBS=ON -DCMAKE_SKIP_INSTALL_RPATH=ON -DLEEWAY_BUILD_TESTS=OFF
	-DLEEWAY_BUILD_EXAMPLES=OFF -DLEEWAY_BUILD_BENCHMARKS=OFF
	-DLEEWAY_BUILD_PYTHON=ON -DPython_EXECUTABLE="$( realpath -s "${LEEWAY_PYTHON_DIR:-build/python-tools}" )/bin/python"
	-DLEEWAY_PYTHON_INSTALL_DIR=lib/python3/dist-packages/leeway
	"-DCMAKE_EXE_LINKER_FLAGS=-Wl,-z,relro,-z,now" "-DCMAKE_SHARED_LINKER_FLAGS=-Wl,-z,relro,-z,now" )
if [ ! -e "$build/CMakeCache.txt" ]; then
	options+=( -G Ninja )
fi
if command -v ccache >/dev/null; then
	options+=( -DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache )
fi
command -v help2man >/dev/null || { echo "$0: help2man is missing; .ci/install.sh packages" >&2; exit 1; }
cmake -S . -B "$build" "${options[@]}" >/dev/null
cmake --build "$build" --parallel "${JOBS:-$( nproc )}"
version=$( sed -nE 's/^project\(leeway VERSION ([0-9.]+).*/\1/p' CMakeLists.txt )
mkdir -p "$build/debian"
# Debian asks for a changelog of the package; the program's own is among the documents
printf 'leeway (%s) unstable; urgency=medium\n\n  * Version %s; changes: core/docs/CHANGELOG.md.\n\n -- The leeway developers <leeway@example.org>  Thu, 01 Jan 2026 00:00:00 +0000\n' \
	"$version" "$version" | gzip -9n >"$build/debian/changelog.gz"
rm -f "$build"/*.deb
( cd "$build" && umask 022 && cpack -G DEB >cpack.log ) || { cat "$build/cpack.log" >&2; exit 1; }
ls "$build"/*.deb
lintian --allow-root --fail-on error --tag-display-limit 0 "$build"/*.deb
