# SPDX-License-Identifier: BSD-3-Clause
# Precompiled headers: half of the time of a C++ file goes into headers of the standard library and of fmt. Each of these targets has its
# own, since they differ in flags; tests share one (tests/CMakeLists.txt). A target is here if it saves more than its header costs.
set(common algorithm array cmath cstdint filesystem fstream functional limits map memory optional set sstream string utility vector
  fmt/format.h)
set(json nlohmann/json.hpp)
set(python nanobind/nanobind.h nanobind/ndarray.h nanobind/stl/string.h nanobind/stl/vector.h nanobind/stl/pair.h nanobind/stl/map.h)

function(leeway_precompile target)
  if(TARGET ${target})
    list(TRANSFORM ARGN REPLACE "(.+)" "$<$<COMPILE_LANGUAGE:CXX>:<\\1$<ANGLE-R>>")
    target_precompile_headers(${target} PRIVATE ${ARGN})
  endif()
endfunction()

foreach(target leeway_io leeway_ik leeway_pairs leeway_tune)
  leeway_precompile(${target} ${common})
endforeach()
foreach(target leeway leeway_view leeway_motions leeway_bench leeway_experiments leeway_planning leeway-bench kitchen_model)
  leeway_precompile(${target} ${common} ${json})
endforeach()
leeway_precompile(leeway_python ${common} ${python})
