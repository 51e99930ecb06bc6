# SPDX-License-Identifier: BSD-3-Clause
# VAMP as a module of leeway-bench planning, from sources of the user: -DLEEWAY_VAMP_SOURCE=DIR, a checkout of KavrakiLab/vamp. Of its
# dependencies two are included, nigh and pdqsort; VAMP's CMake fetches them into its build folder, or into CPM_SOURCE_CACHE. Plain
# checkouts of them are named by -DLEEWAY_VAMP_INCLUDES="DIR;DIR".

# The folder that has HEADER, of several ones: those named by the user, and those that CPM filled for VAMP in SOURCE
function(leeway_find_vamp_dependency name header out)
  set(folders)
  foreach(folder IN LISTS LEEWAY_VAMP_INCLUDES)
    list(APPEND folders "${folder}" "${folder}/src")
  endforeach()
  # VAMP's README builds in build/ or cmake-build-*/, its Python package in build/*/
  set(patterns "${LEEWAY_VAMP_SOURCE}/*build*/_deps/${name}-src" "${LEEWAY_VAMP_SOURCE}/build/*/_deps/${name}-src")
  if(NOT "$ENV{CPM_SOURCE_CACHE}" STREQUAL "")
    list(APPEND patterns "$ENV{CPM_SOURCE_CACHE}/${name}/*" "$ENV{CPM_SOURCE_CACHE}/${name}/*/${name}")
  endif()
  foreach(pattern IN LISTS patterns)
    file(GLOB found LIST_DIRECTORIES true "${pattern}")
    foreach(folder IN LISTS found)
      list(APPEND folders "${folder}" "${folder}/src")
    endforeach()
  endforeach()
  foreach(folder IN LISTS folders)
    if(EXISTS "${folder}/${header}")
      set(${out} "${folder}" PARENT_SCOPE)
      return()
    endif()
  endforeach()
  list(JOIN LEEWAY_VAMP_INCLUDES ", " named)
  message(FATAL_ERROR "LEEWAY_VAMP_SOURCE: ${LEEWAY_VAMP_SOURCE}: VAMP includes ${header} of ${name}, which is neither in a build folder there, "
    "nor in the folder CPM_SOURCE_CACHE of the environment ($ENV{CPM_SOURCE_CACHE}), nor in LEEWAY_VAMP_INCLUDES (${named}). "
    "Configure VAMP there once (cmake -S . -B build), or add a checkout of ${name} to -DLEEWAY_VAMP_INCLUDES=\"NIGH;PDQSORT\".")
endfunction()

# Sets LEEWAY_VAMP_DIRS, the folders to include, and LEEWAY_VAMP_VERSION from LEEWAY_VAMP_SOURCE and LEEWAY_VAMP_INCLUDES
function(leeway_find_vamp)
  foreach(header collision/factory.hh planning/rrtc.hh planning/simplify.hh planning/validate.hh random/halton.hh
      robots/baxter.hh robots/fetch.hh robots/panda.hh robots/ur5.hh)
    if(NOT EXISTS "${LEEWAY_VAMP_SOURCE}/src/impl/vamp/${header}")
      message(FATAL_ERROR "LEEWAY_VAMP_SOURCE: ${LEEWAY_VAMP_SOURCE} has no src/impl/vamp/${header}. "
        "Name a checkout: git clone https://github.com/KavrakiLab/vamp")
    endif()
  endforeach()
  leeway_find_vamp_dependency(nigh nigh/kdtree_batch.hpp nigh)
  leeway_find_vamp_dependency(pdqsort pdqsort.h pdqsort)
  set(LEEWAY_VAMP_DIRS "${LEEWAY_VAMP_SOURCE}/src/impl" "${nigh}" "${pdqsort}" PARENT_SCOPE)
  set(version "of unknown version")
  if(EXISTS "${LEEWAY_VAMP_SOURCE}/CMakeLists.txt")
    file(READ "${LEEWAY_VAMP_SOURCE}/CMakeLists.txt" text)
    if(text MATCHES "project\\([^)]*VERSION[ \n]+([0-9.]+)")
      set(version "${CMAKE_MATCH_1}")
    endif()
  endif()
  set(LEEWAY_VAMP_VERSION "${version}" PARENT_SCOPE)
endfunction()

# The flags of a release build of VAMP: cmake/CompilerSettings.cmake there
function(leeway_vamp_flags out)
  if(CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
    set(flags -march=native -mavx2)
  elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "^(aarch64|arm64)$")
    set(flags -mcpu=native -mtune=native)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 13)
      list(APPEND flags -flax-vector-conversions)
    endif()
  else()
    message(FATAL_ERROR "LEEWAY_VAMP_SOURCE: VAMP has no kernels for ${CMAKE_SYSTEM_PROCESSOR}; leave it out")
  endif()
  list(APPEND flags -O3 -DNDEBUG -fno-math-errno -fno-signed-zeros -fno-trapping-math -fno-rounding-math -ffp-contract=fast)
  if(CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
    list(APPEND flags -fassociative-math)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
      list(APPEND flags -fno-honor-infinities -fno-honor-nans -fapprox-func)
    endif()
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU") # for clang it needs a linker of LLVM, and gains nothing: it is one file
    list(APPEND flags -flto=auto)
  endif()
  set(${out} "${flags}" PARENT_SCOPE)
endfunction()

# bin/leeway_planner_vamp.so, which leeway-bench finds beside it; not installed. VAMP's headers are not held to our warnings, and
# leeway_options is not linked: it forbids contraction, which VAMP is built with.
function(leeway_add_vamp)
  if(NOT TARGET leeway_planning)
    message(FATAL_ERROR "LEEWAY_VAMP_SOURCE: VAMP is a module of leeway-bench planning, which this build does not have: "
      "switch LEEWAY_BUILD_BRIDGE, LEEWAY_BUILD_PLANNERS and LEEWAY_BUILD_OMPL on, or leave LEEWAY_VAMP_SOURCE out")
  endif()
  leeway_find_vamp()
  leeway_vamp_flags(flags)
  list(JOIN flags " " text)
  add_library(leeway_planner_vamp MODULE planning/vamp_module.cpp)
  set_target_properties(leeway_planner_vamp PROPERTIES PREFIX "" LIBRARY_OUTPUT_DIRECTORY "${CMAKE_RUNTIME_OUTPUT_DIRECTORY}")
  target_include_directories(leeway_planner_vamp SYSTEM PRIVATE ${LEEWAY_VAMP_DIRS} ${EIGEN3_INCLUDE_DIRS})
  # the core's headers only: a module calls none of its functions
  target_include_directories(leeway_planner_vamp PRIVATE "${CMAKE_CURRENT_SOURCE_DIR}"
    $<TARGET_PROPERTY:leeway_core,INTERFACE_INCLUDE_DIRECTORIES>)
  target_compile_options(leeway_planner_vamp PRIVATE -Wall -Wextra -Wno-ignored-attributes ${flags})
  target_link_options(leeway_planner_vamp PRIVATE ${flags})
  target_compile_definitions(leeway_planner_vamp PRIVATE LEEWAY_VAMP_VERSION="${LEEWAY_VAMP_VERSION}"
    LEEWAY_VAMP_FLAGS="${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}, ${text}")
  add_dependencies(leeway-bench leeway_planner_vamp)
  list(JOIN LEEWAY_VAMP_DIRS ", " text)
  message(STATUS "VAMP ${LEEWAY_VAMP_VERSION} beside leeway-bench, from ${text}")
endfunction()
