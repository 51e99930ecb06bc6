# SPDX-License-Identifier: BSD-3-Clause
# Debian packages (build_debs.sh): libleeway0 has the shared libraries of the C interfaces, libleeway-cxx0.1 those of the C++ interfaces but OMPL's,
# libleeway-dev headers, archives for OMPL and documents, leeway the program; python3-leeway the package of Python, for the machine's Python.
if(NOT CMAKE_SYSTEM_NAME STREQUAL "Linux")
  return()
endif()
set(LEEWAY_CXX_PACKAGE libleeway-cxx${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(LEEWAY_PACKAGES runtime:libleeway${LEEWAY_ABI} cxx:${LEEWAY_CXX_PACKAGE} devel:libleeway-dev program:leeway)
if(LEEWAY_BUILD_PYTHON)
  list(APPEND LEEWAY_PACKAGES python:python3-leeway)
endif()
foreach(part IN LISTS LEEWAY_PACKAGES)
  string(REGEX REPLACE ":.*" "" component "${part}")
  string(REGEX REPLACE ".*:" "" package "${part}")
  install(FILES "${CMAKE_SOURCE_DIR}/planners/package/debian/copyright" DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/${package}"
    COMPONENT ${component} EXCLUDE_FROM_ALL)
  install(FILES "${CMAKE_BINARY_DIR}/debian/changelog.gz" DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/${package}"
    COMPONENT ${component} EXCLUDE_FROM_ALL OPTIONAL)
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME leeway)
set(CPACK_PACKAGE_CONTACT "The leeway developers <leeway@example.org>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "certified clearance of robot states and motions")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
string(REGEX REPLACE ":[^;]*" "" CPACK_COMPONENTS_ALL "${LEEWAY_PACKAGES}")
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${CMAKE_BINARY_DIR}/core" "${CMAKE_BINARY_DIR}/planners/search"
  "${CMAKE_BINARY_DIR}/ompl_bridge/src/io" "${CMAKE_BINARY_DIR}/planners/ik" "${CMAKE_BINARY_DIR}/planners/certify" "${CMAKE_BINARY_DIR}/planners/motions" "${CMAKE_BINARY_DIR}/planners/pairs"
  "${CMAKE_BINARY_DIR}/planners/tune")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY ">=")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_NAME} built using CMake") # CPack's default: it leaves the first lines below as they are

set(text "leeway measures and certifies the clearance of robots for motion planning:
of a state, and of a whole motion. It works on the real meshes of robot and
scene, and proves its answers.
")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME libleeway${LEEWAY_ABI})
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_EXTRA "${CMAKE_SOURCE_DIR}/planners/package/debian/triggers")
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "certified clearance of robots, shared libraries
${text}
This package has the shared libraries of the C interfaces.")
set(CPACK_DEBIAN_CXX_PACKAGE_NAME ${LEEWAY_CXX_PACKAGE})
set(CPACK_DEBIAN_CXX_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_CXX_PACKAGE_CONTROL_EXTRA "${CMAKE_SOURCE_DIR}/planners/package/debian/triggers")
set(CPACK_DEBIAN_CXX_PACKAGE_DEPENDS "libleeway${LEEWAY_ABI} (= ${PROJECT_VERSION})")
set(CPACK_COMPONENT_CXX_DESCRIPTION "certified clearance of robots, shared libraries of C++
${text}
This package has the shared libraries of the C++ interfaces: files, inverse
kinematics, certificates, motions, pairs of links, tuning.")
set(CPACK_DEBIAN_DEVEL_PACKAGE_NAME libleeway-dev)
set(CPACK_DEBIAN_DEVEL_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVEL_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEVEL_PACKAGE_DEPENDS "libleeway${LEEWAY_ABI} (= ${PROJECT_VERSION}), ${LEEWAY_CXX_PACKAGE} (= ${PROJECT_VERSION})")
# For the component ompl: programs in C, and in C++ without OMPL, need none of these
string(CONCAT CPACK_DEBIAN_DEVEL_PACKAGE_SUGGESTS "libompl-dev, libboost-serialization-dev, libboost-filesystem-dev, libboost-system-dev, "
  "libeigen3-dev, zlib1g-dev, liburdfdom-dev, liburdfdom-headers-dev, libassimp-dev, libyaml-cpp-dev, libtinyxml2-dev, libfmt-dev, liblzf-dev, "
  "liboctomap-dev, libpng-dev")
set(CPACK_COMPONENT_DEVEL_DESCRIPTION "certified clearance of robots, development files
${text}
This package has headers, CMake and pkg-config files, archives of the parts
for OMPL, and the documents. The parts for OMPL need the suggested packages.")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME leeway)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "libleeway${LEEWAY_ABI} (= ${PROJECT_VERSION}), ${LEEWAY_CXX_PACKAGE} (= ${PROJECT_VERSION})")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "certified clearance of robots, program
${text}
This package has the program leeway, its manual pages and shell completions.")
if(LEEWAY_BUILD_PYTHON) # the module is made for one version of Python
  find_package(Python 3.9 REQUIRED COMPONENTS Interpreter)
  math(EXPR next "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-leeway)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA "${CMAKE_SOURCE_DIR}/planners/package/debian/python/postinst"
    "${CMAKE_SOURCE_DIR}/planners/package/debian/python/prerm") # compiled files go with the package
  string(CONCAT CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "libleeway${LEEWAY_ABI} (= ${PROJECT_VERSION}), ${LEEWAY_CXX_PACKAGE} (= ${PROJECT_VERSION}), "
    "python3 (>= 3.${Python_VERSION_MINOR}), python3 (<< 3.${next}~), python3-numpy")
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION "certified clearance of robots, package for Python
${text}
This package has the module leeway of Python 3: arrays of NumPy in and out.")
endif()
include(CPack)
