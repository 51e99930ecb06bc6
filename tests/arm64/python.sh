#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The Python module on 64-bit ARM: cross-compiles it with Debian's compiler against Debian's arm64 Python and libraries, runs tests of the
# package by qemu, and compares digests of answers with this machine's. No wheel: auditwheel does not look into other machines' libraries.
# Packages: .ci/install.sh arm64 python.
#
#   python.sh PACKAGE [FOLDER]    PACKAGE: folder with this machine's package, build/python; FOLDER (build-arm64-python) keeps the rest
set -euo pipefail
cd "$( dirname "${BASH_SOURCE[0]}" )/../.."
package=$( realpath "${1:?usage: $0 PACKAGE [FOLDER]}" ) build=${2:-build-arm64-python}
tools=$( realpath -s "${LEEWAY_PYTHON_DIR:-build/python-tools}" )/bin
LEEWAY_SYSROOT=$( realpath -m "$build/sysroot" )
export LEEWAY_SYSROOT
libraries=$LEEWAY_SYSROOT/usr/lib/aarch64-linux-gnu

LEEWAY_SYSROOT_PACKAGES="python3.11 libpython3.11-dev libqhull-dev libboost-serialization-dev libboost-filesystem-dev libboost-system-dev libeigen3-dev
	zlib1g-dev liburdfdom-dev liburdfdom-headers-dev libassimp-dev libyaml-cpp-dev libtinyxml2-dev libfmt-dev liblzf-dev liboctomap-dev libpng-dev
	nlohmann-json3-dev" tests/arm64/sysroot.sh "$LEEWAY_SYSROOT"
# Debian's CMake files and links name libraries by absolute paths
{ grep -rlE '[";: ]/usr(/lib/aarch64|")' "$libraries/cmake" || true; } |
	xargs -r sed -i -E "s#([\";: ])/usr(/lib/aarch64|\")#\1$LEEWAY_SYSROOT/usr\2#g"
find "$libraries" -type l -lname '/*' | while read -r link; do
	target=$LEEWAY_SYSROOT$( readlink "$link" )
	[ ! -e "$target" ] || ln -sf "$target" "$link"
done
mkdir -p "$LEEWAY_SYSROOT/configuration" # <aarch64-linux-gnu/python3.11/pyconfig.h>
ln -sfn "$LEEWAY_SYSROOT/usr/include/aarch64-linux-gnu" "$LEEWAY_SYSROOT/configuration/aarch64-linux-gnu"

link="-L/usr/aarch64-linux-gnu/lib -L$libraries -Wl,-rpath-link,$libraries"
options=( -DCMAKE_BUILD_TYPE=Release "-DCMAKE_CXX_FLAGS=-Wno-psabi -isystem $LEEWAY_SYSROOT/configuration" "-DCMAKE_MODULE_LINKER_FLAGS=$link"
	"-DCMAKE_SHARED_LINKER_FLAGS=$link" -DLEEWAY_BUILD_PYTHON=ON -DLEEWAY_BUILD_OMPL=OFF -DLEEWAY_BUILD_EXAMPLES=OFF
	-DLEEWAY_BUILD_BENCHMARKS=OFF -DLEEWAY_BUILD_TESTS=OFF "-DPython_EXECUTABLE=$tools/python"
	"-DPython_INCLUDE_DIR=$LEEWAY_SYSROOT/usr/include/python3.11" -DSKBUILD_SOABI=cpython-311-aarch64-linux-gnu )
if [ ! -e "$build/CMakeCache.txt" ]; then
	options+=( -G Ninja --toolchain tests/arm64/toolchain.cmake )
fi
if command -v ccache >/dev/null; then
	options+=( -DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache )
fi
cmake -S . -B "$build" "${options[@]}" >/dev/null
cmake --build "$build" --parallel "${JOBS:-$( nproc )}" --target leeway_python leeway_python_files

place=$build/packages
if [ ! -e "$place/numpy" ]; then
	version=$( "$tools/python" -c 'import numpy; print( numpy.__version__ )' )
	"$tools/python" -m pip --disable-pip-version-check --no-input install --quiet --no-deps --only-binary=:all: --python-version 3.11 \
		--platform manylinux_2_27_aarch64 --platform manylinux_2_28_aarch64 --platform manylinux2014_aarch64 --target "$place" \
		"numpy==$version" pytest pluggy iniconfig packaging pygments
fi
python_there()
{
	qemu-aarch64 -L "$LEEWAY_SYSROOT" -E PYTHONHOME="$LEEWAY_SYSROOT/usr" -E PYTHONPATH="$PWD/$build/python:$PWD/$place" \
		-E PYTHONDONTWRITEBYTECODE=1 -E LD_LIBRARY_PATH="$libraries" "$LEEWAY_SYSROOT/usr/bin/python3.11" "$@"
}
python_there -m pytest -q -p no:cacheprovider -k "not bits_of_c" planners/python/tests/test_{states,motions,models,worlds}.py
python_there tests/arm64/answers.py >"$build/there"
PYTHONPATH=$package "$tools/python" tests/arm64/answers.py >"$build/here"
if ! diff "$build/here" "$build/there"; then
	echo "$0: answers on 64-bit ARM differ from those of this machine" >&2
	exit 1
fi
cat "$build/there"
