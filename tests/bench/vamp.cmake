# SPDX-License-Identifier: BSD-3-Clause
# -DLEEWAY_VAMP_SOURCE with empty files in place of VAMP: each place of its dependencies is found, and a missing header stops
# CMake with a message that has folder, header and remedy. ROOT is the source folder, WORK one of our own.
cmake_policy(VERSION 3.22)
if(CONFIGURE) # a run of its own per case: the message ends it
  include("${ROOT}/benchmarks/planning/vamp.cmake")
  leeway_find_vamp()
  list(JOIN LEEWAY_VAMP_DIRS "|" dirs)
  message("found ${LEEWAY_VAMP_VERSION} in ${dirs}")
  return()
endif()

function(expect includes) # and the parts of the answer
  execute_process(COMMAND "${CMAKE_COMMAND}" -DCONFIGURE=ON "-DROOT=${ROOT}" "-DLEEWAY_VAMP_SOURCE=${WORK}/vamp"
    "-DLEEWAY_VAMP_INCLUDES=${includes}" -P "${CMAKE_CURRENT_LIST_FILE}" ERROR_VARIABLE answer)
  string(REGEX REPLACE "[ \n]+" " " answer "${answer}") # message() breaks lines
  foreach(part IN LISTS ARGN)
    string(FIND "${answer}" "${part}" at)
    if(at EQUAL -1)
      message(SEND_ERROR "LEEWAY_VAMP_INCLUDES '${includes}': '${part}' is not in: ${answer}")
    endif()
  endforeach()
endfunction()

function(touch)
  foreach(file IN LISTS ARGN)
    file(WRITE "${WORK}/${file}" "")
  endforeach()
endfunction()

file(REMOVE_RECURSE "${WORK}")
set(ENV{CPM_SOURCE_CACHE} "")
expect("" "${WORK}/vamp has no src/impl/vamp/collision/factory.hh" "git clone")
foreach(header collision/factory planning/rrtc planning/simplify planning/validate random/halton robots/baxter robots/fetch robots/panda)
  touch(vamp/src/impl/vamp/${header}.hh)
endforeach()
expect("" "${WORK}/vamp has no src/impl/vamp/robots/ur5.hh" "git clone")
touch(vamp/src/impl/vamp/robots/ur5.hh)
expect("" "${WORK}/vamp: VAMP includes nigh/kdtree_batch.hpp of nigh" "-DLEEWAY_VAMP_INCLUDES=")

# plain checkouts, of which one is forgotten, or is another folder
touch(n/src/nigh/kdtree_batch.hpp p/pdqsort.h)
expect("${WORK}/n" "VAMP includes pdqsort.h of pdqsort" "LEEWAY_VAMP_INCLUDES (${WORK}/n)")
expect("${WORK}/p;${WORK}/none" "VAMP includes nigh/kdtree_batch.hpp of nigh")
expect("${WORK}/p;${WORK}/n" "found of unknown version in ${WORK}/vamp/src/impl|${WORK}/n/src|${WORK}/p")

# a cache of CPM, and a build folder of VAMP, which comes first
file(WRITE "${WORK}/vamp/CMakeLists.txt" "cmake_minimum_required(VERSION 3.16...3.22)\nproject(\n    vamp\n    VERSION 0.2\n)")
touch(cache/nigh/1f/src/nigh/kdtree_batch.hpp cache/pdqsort/2e/pdqsort.h)
expect("" "VAMP includes nigh/kdtree_batch.hpp of nigh")
set(ENV{CPM_SOURCE_CACHE} "${WORK}/cache")
expect("" "found 0.2 in ${WORK}/vamp/src/impl|${WORK}/cache/nigh/1f/src|${WORK}/cache/pdqsort/2e")
touch(vamp/build/cp312/_deps/nigh-src/src/nigh/kdtree_batch.hpp)
expect("" "${WORK}/vamp/build/cp312/_deps/nigh-src/src|${WORK}/cache/pdqsort/2e")
touch(vamp/cmake-build-release/_deps/pdqsort-src/pdqsort.h)
expect("" "${WORK}/vamp/build/cp312/_deps/nigh-src/src|${WORK}/vamp/cmake-build-release/_deps/pdqsort-src")
expect("${WORK}/p" "_deps/nigh-src/src|${WORK}/p")
