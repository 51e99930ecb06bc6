#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Two arms hand over a pot in the KIT kitchen while a drawer opens: plans, audits and pages of both halves.
#
#   handover.sh DATA [OUT]
#
# DATA has the folders mbm (Panda) and kit_kitchen, as LEEWAY_DATA_DIR; OUT (default: handover) gets scenes, motions and pages. `leeway` is on the PATH.
set -euo pipefail
here=$( cd "$( dirname "${BASH_SOURCE[0]}" )" && pwd )
data=${1:?give the folder of mbm and kit_kitchen}
out=${2:-handover}
mkdir -p "$out"
cp "$here/before.yaml" "$here/after.yaml" "$out"
packages=( --package-path "$data" --package-path "panda=$data/mbm/panda" )

# half NAME HAND GOAL GOAL: from the states of its world file to the goals, with the pot in one hand
half()
{
	local world=$out/$1.yaml motions=$out/$1
	{ cat "$data/kit_kitchen/scene.yaml"; sed "s#HAND#$2#" "$here/pot.yaml"; } >"$out/$1_scene.yaml"
	leeway world plan --world "$world" "${packages[@]}" --goal "$3" --goal "$4" --deadline 8 --min-d 0.005 --out "$motions"
	local with=( --world "$world" "${packages[@]}" --motion "left=$motions/left.json" --motion "right=$motions/right.json" --min-d 0.005 )
	leeway world audit "${with[@]}" --certificate "$out/$1.lwc"
	leeway world view "${with[@]}" --out "$out/$1.html" >"$out/$1.txt" || echo "no page of $1 is written"
}

# where before.yaml ends after.yaml begins: no world file lets an object change hands at a time
half before left/panda_hand \
	left=panda_joint1=0.353,panda_joint2=-0.72,panda_joint3=-0.356,panda_joint4=-2.564,panda_joint5=-2.9,panda_joint6=2.809,panda_joint7=0.324 \
	right=panda_joint1=0.41,panda_joint2=-0.776,panda_joint3=-0.417,panda_joint4=-2.595,panda_joint5=-2.839,panda_joint6=2.805,panda_joint7=0.21
half after right/panda_hand \
	left=panda_joint1=0,panda_joint2=-0.785,panda_joint3=0,panda_joint4=-2.356,panda_joint5=0,panda_joint6=1.571,panda_joint7=0.785 \
	right=panda_joint1=-0.139,panda_joint2=-0.085,panda_joint3=0.382,panda_joint4=-2.857,panda_joint5=-2.884,panda_joint6=1.931,panda_joint7=0.725
