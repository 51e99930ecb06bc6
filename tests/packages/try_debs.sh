#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The .deb files of FOLDER in a bare Debian 12 (debootstrap, a chroot; root is needed): installs them with apt, runs the program, builds and runs
# consumers outside of the tree as the README says (C by pkg-config and by CMake, C++ with OMPL), removes them, and looks for leftovers.
#
#   try_debs.sh FOLDER [CHROOT]    CHROOT is kept if given; a complete one is used again
set -euo pipefail
cd "$( dirname "${BASH_SOURCE[0]}" )/../.."
debs=$( realpath "${1:?usage: $0 FOLDER [CHROOT]}" )
if [ "$#" -gt 1 ]; then
	root=$( realpath -m "$2" )
else
	root=$( mktemp -d )
fi
mirror=${LEEWAY_DEBIAN_MIRROR:-http://deb.debian.org/debian}

finish()
{
	umount "$root/proc" 2>/dev/null || true
	[ "$#" -gt 1 ] || rm -rf --one-file-system "$root"
}
trap 'finish "$@"' EXIT
if [ ! -e "$root/etc/debian_version" ]; then
	debootstrap --variant=minbase bookworm "$root" "$mirror" >"$root.log" 2>&1 || { tail -n 20 "$root.log" >&2; exit 1; }
	rm -f "$root.log"
fi
mount -t proc proc "$root/proc" 2>/dev/null || true # some containers forbid it; nothing here needs it

inside()
{
	chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C DEBIAN_FRONTEND=noninteractive "$@"
}
step()
{
	printf '== %s\n' "$1"
	shift
	"$@" >"$scratch" 2>&1 || { tail -n 40 "$scratch" >&2; exit 1; }
}
scratch=$( mktemp )
rm -rf "$root/srv/leeway" && mkdir -p "$root/srv/leeway"
cp "$debs"/*.deb "$root/srv/leeway"
cp -r tests/install/consumer examples "$root/srv/leeway"
cp planners/python/README.md "$root/srv/leeway/python.md"
cp /etc/resolv.conf "$root/etc/resolv.conf"

step "apt-get update" inside apt-get -q update
inside sh -c 'find / -xdev -not -path "/proc/*" -not -path "/srv/*" -not -path "/var/*" -not -path "/tmp/*" | sort' >"$scratch.before"

step "install libleeway0, libleeway-cxx and leeway alone" inside sh -c 'apt-get -qy --no-install-recommends install /srv/leeway/libleeway0_*.deb /srv/leeway/libleeway-cxx*.deb /srv/leeway/leeway_*.deb'
step "run the program" inside leeway plan --robot /srv/leeway/examples/first/arm.urdf --srdf /srv/leeway/examples/first/arm.srdf \
	--scene /srv/leeway/examples/first/scene.yaml --start left --goal right --min-d 0.01 --no-cache --out /tmp/path.yaml
step "manual and completions are there" inside sh -c 'test -e /usr/share/bash-completion/completions/leeway && test -e /usr/share/fish/vendor_completions.d/leeway.fish && test -e /usr/share/zsh/vendor-completions/_leeway'

step "install python3-leeway" inside sh -c 'apt-get -qy --no-install-recommends install /srv/leeway/python3-leeway_*.deb'
step "plan in Python" inside sh -c 'cd /srv/leeway && sed -n "/^\`\`\`python/,/^\`\`\`$/p" python.md | grep -v "^\`\`\`" >/tmp/page.py && python3 /tmp/page.py | grep "SOLVED.*True"'

step "install libleeway-dev and a compiler" inside sh -c 'apt-get -qy --no-install-recommends install /srv/leeway/libleeway-dev_*.deb gcc libc6-dev pkg-config'
step "C by pkg-config: leeway" inside sh -c 'cd /tmp && cc -std=c11 /srv/leeway/consumer/core.c -o core $(pkg-config --cflags --libs leeway) && ./core && readelf -d core | grep -q "libleeway\.so\.0\]"'
step "C by pkg-config: leeway-plan" inside sh -c 'cd /tmp && cc -std=c11 /srv/leeway/examples/03_plan/plan.c -o plan $(pkg-config --cflags --libs leeway-plan) && ./plan'
step "install CMake and the packages that libleeway-dev suggests" inside sh -c 'apt-get -qy --no-install-recommends install cmake ninja-build g++ $( dpkg-query -W -f "\${Suggests}" libleeway-dev | tr -d , )'
version=$( sed -nE 's/^project\(leeway VERSION ([0-9.]+).*/\1/p' CMakeLists.txt )
step "C and C++ by CMake: configure" inside cmake -S /srv/leeway/consumer -B /tmp/consumer -G Ninja "-DCOMPONENTS=core;plan;io;ik;certify;motions;pairs;tune;ompl;planners" \
	"-DVERSION=$version" -DEXAMPLES=/srv/leeway/examples -DCMAKE_BUILD_TYPE=Release
step "C and C++ by CMake: build" inside cmake --build /tmp/consumer
for program in consumer_c consumer_core consumer_plan consumer_plan_c consumer_io consumer_ik consumer_certify consumer_motions consumer_pairs consumer_tune consumer_ompl consumer_planners; do
	step "run $program" inside "/tmp/consumer/$program"
done
first=/srv/leeway/examples/first
step "run the README's C++ with OMPL" inside /tmp/consumer/consumer_example "$first/arm.urdf" "$first/arm.srdf" "$first/scene.yaml" "$first/request.yaml"

step "remove" inside apt-get -qy purge leeway python3-leeway libleeway-dev "libleeway-cxx*" libleeway0
inside sh -c 'find / -xdev -not -path "/proc/*" -not -path "/srv/*" -not -path "/var/*" -not -path "/tmp/*" | sort' >"$scratch.after"
left=$( comm -13 "$scratch.before" "$scratch.after" | grep -i leeway || true )
if [ -n "$left" ]; then
	printf 'left behind:\n%s\n' "$left" >&2
	exit 1
fi
rm -f "$scratch" "$scratch.before" "$scratch.after"
echo "packages install, run, serve consumers, and leave nothing behind"
