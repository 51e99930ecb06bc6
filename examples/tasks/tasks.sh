#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Five tasks: two arms carry a tray, a cup goes through a shelf, a door opens, a cup is taken and left, a torch follows a seam. Each is planned and proved,
# with a page that plays it.
#
#   tasks.sh OUT
#
# OUT gets robots, scenes, motions (*.json), certificates (*.lwc) and pages (*.html). `leeway` and `python3` are on the PATH.
set -euo pipefail
here=$( cd "$( dirname "${BASH_SOURCE[0]}" )" && pwd )
out=${1:?name a folder for the results}
mkdir -p "$out"
python3 "$here/robots.py" "$out"
python3 "$here/seam.py" "$out"
cp "$here"/*.yaml "$out"
common=( --min-d 0.002 --no-cache )  # metres that every motion keeps from everything; tables of small robots are not worth their time
pages=yes
leeway view --no-cache --robot "$out/arm.urdf" --out "$out/arm.html" || pages=  # a build of leeway without pages

# plan NAME ROBOT OPTIONS...: the motion, its certificates, and its page if this build of leeway writes pages
plan()
{
	local name=$1 model=( --robot "$out/$2.urdf" --scene "$out/$1_scene.yaml" "${common[@]}" )
	shift 2
	printf '\n=== %s\n' "$name"
	leeway plan "${model[@]}" "$@" --trajectory "$out/$name.json" --certificate "$out/$name.lwc" ${pages:+--view "$out/$name.html"}
	for certificate in "$out/$name".lwc "$out/$name".[0-9].lwc; do
		[ ! -e "$certificate" ] || python3 "$here/../../planners/certify/check_certificate.py" "$certificate"
	done
}

plan tray two_arms --request "$out/tray.yaml"
plan cup arm --request "$out/cup.yaml"
plan door arm --request "$out/door.yaml"
lines=()
while read -r pose; do
	lines+=( --line "hand=$pose" )
done <"$out/seam.txt"
plan pick arm --request "$out/pick.yaml"  # a certificate for each of its scenes: pick.1.lwc, ...
plan seam arm "${lines[@]}" --line-tip 0,0,0.12 --free-axis 0,0,1 --any-start --line-blend 0.005

# The files alone, without the planner: constraints and clearances as a controller drives them
printf '\n=== audits\n'
for name in tray cup door; do
	robot=$( [ "$name" = tray ] && echo two_arms || echo arm )
	leeway audit --robot "$out/$robot.urdf" --scene "$out/${name}_scene.yaml" "${common[@]}" --request "$out/$name.yaml" --trajectory "$out/$name.json"
done
