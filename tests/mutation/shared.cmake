# SPDX-License-Identifier: BSD-3-Clause
# For CMAKE_PROJECT_leeway_INCLUDE: every library is shared and shows its internal symbols, so that a mutant relinks one library
# and no test program. Calls inside of a library stay direct, as in the library that is released.
set(BUILD_SHARED_LIBS ON)
add_compile_options(-fno-semantic-interposition)
macro(add_library name)
  if("${name}" STREQUAL "leeway_io")
    set(leeway_io_arguments ${ARGN})
    list(REMOVE_ITEM leeway_io_arguments STATIC)
    _add_library(leeway_io SHARED ${leeway_io_arguments})
  else()
    _add_library(${name} ${ARGN})
  endif()
endmacro()
cmake_language(DEFER CALL set_target_properties leeway_core PROPERTIES C_VISIBILITY_PRESET default)
