# SPDX-License-Identifier: BSD-3-Clause
# leeway_cxx_library(part description [LEEWAY part...] [PACKAGES package...] [LIBRARIES library...]): names, soname, installed headers and
# pkg-config file of leeway_<part>, a library of C++ with headers in include/leeway/<part>. LEEWAY: parts of leeway that it links beside the
# core. PACKAGES: packages of pkg-config, and LIBRARIES: libraries without one, that an archive needs; a shared library knows its own.
#
# C++ interfaces promise less than C's: their soname has the minor version too.
function(leeway_cxx_library part description)
  cmake_parse_arguments(PARSE_ARGV 2 needs "" "" "LEEWAY;PACKAGES;LIBRARIES")
  add_library(leeway::${part} ALIAS leeway_${part})
  set_target_properties(leeway_${part} PROPERTIES EXPORT_NAME ${part} VERSION ${PROJECT_VERSION}
    SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} INSTALL_RPATH "$ORIGIN")
  target_compile_features(leeway_${part} PUBLIC cxx_std_17)
  set(libraries "")
  set(requires "leeway = ${PROJECT_VERSION}")
  foreach(other IN LISTS needs_LEEWAY)
    string(APPEND requires ", leeway-${other} = ${PROJECT_VERSION}")
  endforeach()
  get_target_property(type leeway_${part} TYPE)
  if(type STREQUAL "STATIC_LIBRARY")
    foreach(package IN LISTS needs_PACKAGES)
      string(APPEND requires ", ${package}")
    endforeach()
    foreach(library IN LISTS needs_LIBRARIES)
      string(APPEND libraries " -l${library}")
    endforeach()
    string(APPEND libraries " -pthread")
  endif()
  file(RELATIVE_PATH LEEWAY_PC_TO_PREFIX "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
  configure_file("${CMAKE_SOURCE_DIR}/ompl_bridge/library.pc.in" "${CMAKE_CURRENT_BINARY_DIR}/leeway-${part}.pc" @ONLY)
  install(FILES "${CMAKE_CURRENT_BINARY_DIR}/leeway-${part}.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
endfunction()
