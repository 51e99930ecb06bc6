#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# From nothing to planned motions: installs missing packages (Debian 12), builds a release in build/, writes the kitchen
# demo, plans every reach in it with certified edges, draws one, and draws where the robot's arms can get to.
#
# Leaves in build/kitchen: the demo (robot.urdf, robot.srdf, scene.yaml, reach/, meshes/), paths/*.yaml with a report each,
# motions/*.glb (animated glTF; for instance f3d or Blender play them), kitchen.png and motion_hulls.png. Exit status 0 if
# every reach was solved, proved and audited, and both pictures were drawn. May be called from any folder; reads no input.
set -euo pipefail
cd "$( dirname "${BASH_SOURCE[0]}" )/.."
exec </dev/null

build=build
demo=$build/kitchen
margin=0.003  # metres that every motion keeps from everything
seed=1
pictured=04_table

heading()
{
	printf '\n=== [%d:%02d] %s\n' $(( SECONDS / 60 )) $(( SECONDS % 60 )) "$1"
}

# value KEY FILE: the first number, word or text of that key in a JSON report, one key a line
value()
{
	sed -n "s/^ *\"$1\": \"\{0,1\}\([^\",]*\)\"\{0,1\},\{0,1\}\$/\1/p" "$2" | head -n 1
}

# picture GLB PNG [OPTIONS]: f3d without a screen
picture()
{
	local from=$1 to=$2
	shift 2
	xvfb-run -a f3d "$from" --output "$to" --dry-run --quiet --hdri "$demo/light.hdr" \
		--fxaa --camera-view-up 0,1,0 --camera-view-angle 35 "$@" || true
	if [ ! -s "$to" ]; then
		echo "f3d drew no $to" >&2
		failed=$(( failed + 1 ))
	fi
}

heading "install missing packages"
.ci/install.sh  # all sets, so that tests/run.sh can use the same build folder

heading "build"
options=( -DCMAKE_BUILD_TYPE=Release )
if [ ! -e "$build/CMakeCache.txt" ]; then
	options+=( -G Ninja )
fi
if command -v ccache >/dev/null; then
	options+=( -DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache )
fi
mkdir -p "$build"
cmake -S . -B "$build" "${options[@]}" >"$build/configure.log" 2>&1 || { cat "$build/configure.log" >&2; exit 1; }
cmake --build "$build" --parallel "$( nproc )" --target leeway examples

heading "examples/01_core: the distance of two shapes"
"$build/bin/01_clearance"

heading "examples/03_plan: a path around a wall in C, without files"
"$build/bin/03_plan"

heading "write the kitchen"
rm -rf "$demo"
mkdir -p "$demo/paths" "$demo/motions"
"$build/bin/kitchen_demo" "$demo"
model=( --robot "$demo/robot.urdf" --srdf "$demo/robot.srdf" --scene "$demo/scene.yaml" )

heading "examples/02_ompl: one reach by OMPL alone"
"$build/bin/02_plan" "$demo/robot.urdf" "$demo/robot.srdf" "$demo/scene.yaml" "$demo/reach/07_drawer.yaml"

heading "plan every reach: RRTConnect, certified edges, margin $margin m, seed $seed"
printf '%-20s %-16s %-7s %9s %9s %7s %9s %9s  %s\n' request group solved 'plan ms' 'short. ms' states 'clear mm' edges audit
failed=0
for request in "$demo"/reach/*.yaml; do
	name=$( basename "$request" .yaml )
	path=$demo/paths/$name.yaml
	report=$demo/paths/$name.json
	log=$demo/paths/$name.log
	status=0
	"$build/bin/leeway" plan "${model[@]}" --request "$request" --min-d "$margin" --validator certified --simplify --seed "$seed" \
		--out "$path" --report "$report" >"$log" 2>&1 || status=$?
	if [ "$status" -ne 0 ]; then
		printf '%-20s FAILED (status %d):\n' "$name" "$status"
		cat "$log"
		failed=$(( failed + 1 ))
		continue
	fi
	# the lesser of the audited clearances to the environment and to itself, from the path file
	clearance=$( awk '/^  (environment|self): [0-9]/ { if ( !seen || $2 < least ) { least = $2; seen = 1 } } END { printf "%.2f", 1000 * least }' "$path" )
	states=$( grep -c '^  - positions' "$path" )
	audit=$( value valid "$report" )
	printf '%-20s %-16s %-7s %9.0f %9.0f %7d %9s %9s  %s\n' "$name" "$( value group "$report" )" yes \
		"$( value plan "$report" | awk '{ print 1000 * $1 }' )" "$( value simplify "$report" | awk '{ print 1000 * $1 }' )" \
		"$states" "$clearance" "$( value edges_free "$report" )/$(( states - 1 ))" "$( [ "$audit" = true ] && echo valid || echo "NOT VALID" )"
done

heading "draw"
draw=( "$build/bin/kitchen_render" --robot "$demo/robot.urdf" --scene "$demo/scene.yaml" --colours "$demo/colours.yaml" )
for path in "$demo"/paths/*.yaml; do
	[ -e "$path" ] || continue
	"${draw[@]}" --path "$path" --animation "$demo/motions/$( basename "$path" .yaml ).glb"
done
"$build/bin/kitchen_render" --light "$demo/light.hdr"
if [ -e "$demo/paths/$pictured.yaml" ]; then
	"${draw[@]}" --path "$demo/paths/$pictured.yaml" --still "$demo/still.glb" --ghosts 5
	picture "$demo/still.glb" "$demo/kitchen.png" --resolution 1200,780 --ssao --tone-mapping --depth-peeling \
		--camera-position 4.9,2.15,1.3 --camera-focal-point 2.2,0.98,-1.75
fi
if [ -e "$demo/paths/$pictured.yaml" ]; then
	"$build/bin/leeway" view "${model[@]}" --path "$demo/paths/$pictured.yaml" --out "$demo/kitchen.html" || echo "no page is written"
fi
# the reach of each arm from the shoulder, its forearm from the elbow, its hand from the wrist: hulls right, spheres left
hulls=( "$build/bin/kitchen_hulls" --robot "$demo/robot.urdf" --colours "$demo/colours.yaml" )
hulls+=( --still "$demo/motion_hulls.glb" )
for side in left right; do
	hulls+=( --joint "${side}_shoulder_pitch=0.2" --joint "${side}_shoulder_roll=0.75" --joint "${side}_elbow=1.0" )
done
for link in shoulder_pitch_link elbow_link wrist_link; do
	hulls+=( --hull "right_$link" --sphere "left_$link" )
done
"${hulls[@]}"
# no --depth-peeling: with so much of the picture translucent, f3d 1.3 at times stops at the outermost surface. Without it,
# surfaces are painted in the order of the file: inner parts last
picture "$demo/motion_hulls.glb" "$demo/motion_hulls.png" --resolution 1200,830 \
	--camera-position 3.4,1.7,-0.75 --camera-focal-point 0,0.96,0

heading "done: $demo/kitchen.png, $demo/kitchen.html, $demo/motion_hulls.png, $demo/motions/*.glb, $demo/paths/*.yaml"
if [ "$failed" -ne 0 ]; then
	echo "$failed failed" >&2
	exit 1
fi
