#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Fetches Debian's arm64 packages that the core and its tests link, and unpacks them into FOLDER. The machine's own package lists
# stay as they are: apt-get works on lists in FOLDER/apt. A folder that is complete is left alone, without network.
#
#   sysroot.sh FOLDER      LEEWAY_SYSROOT_PACKAGES: others than those of the core, with all that they depend on
set -euo pipefail
packages=( libqhull-dev libqhull8.0 libqhull-r8.0 libqhullcpp8.0 qhull-bin libgtest-dev libgmock-dev googletest )
if [ -n "${LEEWAY_SYSROOT_PACKAGES:-}" ]; then
	read -r -d '' -a packages <<<"$LEEWAY_SYSROOT_PACKAGES" || true
fi

folder=$( realpath -m "${1:?usage: $0 FOLDER}" )
if [ "$( cat "$folder/complete" 2>/dev/null || true )" = "${packages[*]}" ]; then
	exit 0
fi
rm -rf "$folder"
mkdir -p "$folder/apt/lists/partial" "$folder/apt/cache/archives/partial" "$folder/apt/packages"
: >"$folder/apt/status"
fetch()
{
	apt-get -qq -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o Dir::State="$folder/apt" \
		-o Dir::State::lists="$folder/apt/lists" -o Dir::State::status="$folder/apt/status" -o Dir::Cache="$folder/apt/cache" \
		-o APT::Sandbox::User="$( id -un )" -o Acquire::Retries=3 "$@"
}
fetch update
if [ -n "${LEEWAY_SYSROOT_PACKAGES:-}" ]; then
	fetch -o Debug::NoLocking=1 --download-only --assume-yes --no-install-recommends install "${packages[@]}" >/dev/null
	mv "$folder"/apt/cache/archives/*.deb "$folder/apt/packages"
else
	( cd "$folder/apt/packages" && fetch download "${packages[@]}" )
fi
for package in "$folder"/apt/packages/*.deb; do
	dpkg-deb --extract "$package" "$folder"
done
rm -rf "$folder/apt"
printf '%s\n' "${packages[*]}" >"$folder/complete"
