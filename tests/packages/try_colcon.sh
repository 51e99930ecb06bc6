#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds package.xml in a workspace by colcon, as ROS does, and then a program that finds the library there. colcon comes from the
# package index into FOLDER; ROS is not needed.
#
#   try_colcon.sh [FOLDER (build-colcon)]
set -euo pipefail
cd "$( dirname "${BASH_SOURCE[0]}" )/../.."
folder=${1:-build-colcon}
mkdir -p "$folder/src" "$folder/consumer"
[ -x "$folder/tools/bin/colcon" ] || { python3 -m venv "$folder/tools" && "$folder/tools/bin/python" -m pip --disable-pip-version-check \
	--no-input install --quiet colcon-common-extensions; }
ln -sfn "$PWD" "$folder/src/leeway"
cat >"$folder/consumer/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.16)
project(consumer C CXX)
find_package(leeway REQUIRED COMPONENTS core io ompl)
add_executable(consumer consumer.cpp)
target_link_libraries(consumer leeway::ompl leeway::io leeway::core)
END
cat >"$folder/consumer/consumer.cpp" <<'END'
#include "leeway/io/model.hpp"
#include <cstdio>
int main( int, char** argv )
{
	std::printf( "%s\n", leeway::io::loadRobot( argv[1], argv[2] ).name.c_str() );
}
END
arm=$PWD/examples/first/arm
cd "$folder"
export MAKEFLAGS=${MAKEFLAGS:--j${JOBS:-$( nproc )}} # colcon's own -l waits where other programs run
tools/bin/colcon build --event-handlers console_cohesion- --cmake-args -DCMAKE_BUILD_TYPE=Release -DLEEWAY_BUILD_TESTS=OFF \
	-DLEEWAY_BUILD_BENCHMARKS=OFF -DLEEWAY_BUILD_EXAMPLES=OFF
set +u # colcon's script reads variables that are not set
. install/setup.bash
set -u
cmake -S consumer -B consumer/build >/dev/null && cmake --build consumer/build
[ "$( consumer/build/consumer "$arm.urdf" "$arm.srdf" )" = desk_arm ] && leeway --version
