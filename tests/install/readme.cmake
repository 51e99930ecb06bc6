# SPDX-License-Identifier: BSD-3-Clause
# The C and C++ examples of README.md equal examples/01_core and examples/02_ompl, which are built and run, below the two head lines.
file(READ "${ROOT}/README.md" readme)
foreach(example "c|01_core/clearance.c" "cpp|02_ompl/plan.cpp")
  string(REGEX REPLACE "\\|.*" "" language "${example}")
  string(REGEX REPLACE ".*\\|" "" file "${example}")
  file(READ "${ROOT}/examples/${file}" source)
  string(REGEX REPLACE "^//[^\n]*\n//[^\n]*\n" "" source "${source}")
  string(FIND "${readme}" "```${language}\n${source}```\n" place)
  if(place EQUAL -1)
    message(FATAL_ERROR "README.md does not show examples/${file} as it is")
  endif()
endforeach()
