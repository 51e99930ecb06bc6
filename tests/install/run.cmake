# SPDX-License-Identifier: BSD-3-Clause
# Steps of the install test; any that fails is fatal. Variables: see CMakeLists.txt.
cmake_policy(VERSION 3.22)
function(run what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${what} failed (${status}): ${ARGN}\n${output}")
  endif()
  message(STATUS "${what}: ok")
endfunction()

# A prefix of an earlier run could hide a file that is no longer installed.
file(REMOVE_RECURSE "${WORK}")
set(prefix "${WORK}/prefix")
run("install" "${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${prefix}")

# The tree is moved after installation: nothing in it may remember the place it was installed to.
file(RENAME "${prefix}" "${WORK}/moved")
set(prefix "${WORK}/moved")

string(REPLACE ";" "\\;" component_list "${COMPONENTS}")
run("configure" "${CMAKE_COMMAND}" -S "${SOURCE}" -B "${WORK}/build" -G "${GENERATOR}" "-DCMAKE_PREFIX_PATH=${prefix}"
  "-DCOMPONENTS=${component_list}" "-DEXAMPLES=${EXAMPLES}" "-DSANITIZE=${SANITIZE}" "-DVERSION=${VERSION}" "-DCMAKE_C_COMPILER=${C_COMPILER}"
  "-DCMAKE_CXX_COMPILER=${CXX_COMPILER}" -DCMAKE_BUILD_TYPE=Release)
run("build" "${CMAKE_COMMAND}" --build "${WORK}/build")
run("C program" "${WORK}/build/consumer_c")
foreach(component ${COMPONENTS})
  run("C++ program of ${component}" "${WORK}/build/consumer_${component}")
endforeach()

if("ompl" IN_LIST COMPONENTS)
  set(first "${prefix}/${DOCDIR}/examples/first") # installed, with the documents
  run("C++ example on the first example" "${WORK}/build/consumer_example" "${first}/arm.urdf" "${first}/arm.srdf" "${first}/scene.yaml"
    "${first}/request.yaml")
endif()
if("plan" IN_LIST COMPONENTS)
  run("plan in C" "${WORK}/build/consumer_plan_c")
endif()
foreach(file LICENSE README.md core/docs/edges.md)
  if(NOT EXISTS "${prefix}/${DOCDIR}/${file}")
    message(FATAL_ERROR "${DOCDIR}/${file} is not installed")
  endif()
endforeach()

if(PKG_CONFIG)
  set(ENV{PKG_CONFIG_PATH} "${prefix}/${LIBDIR}/pkgconfig")
  set(sanitize)
  if(SANITIZE)
    set(sanitize "-fsanitize=${SANITIZE}")
  endif()
  function(run_by_pkg_config package source)
    # without --static, as everybody asks: a static library must name its needs
    execute_process(COMMAND "${PKG_CONFIG}" --cflags --libs "${package} = ${VERSION}" OUTPUT_VARIABLE flags
      OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE status)
    if(NOT status EQUAL 0)
      message(FATAL_ERROR "pkg-config does not find ${package} ${VERSION} in ${prefix}")
    endif()
    separate_arguments(flags UNIX_COMMAND "${flags}")
    set(compiler "${C_COMPILER}" -std=c11)
    if(source MATCHES "\\.cpp$")
      set(compiler "${CXX_COMPILER}" -std=c++17)
    endif()
    run("build by pkg-config ${package}" ${compiler} ${sanitize} "${source}" -o "${WORK}/${package}_pkg_config" ${flags} "-Wl,-rpath,${prefix}/${LIBDIR}")
    run("program by pkg-config ${package}" "${WORK}/${package}_pkg_config")
  endfunction()
  run_by_pkg_config(leeway "${SOURCE}/core.c")
  if("plan" IN_LIST COMPONENTS)
    run_by_pkg_config(leeway-plan "${EXAMPLES}/03_plan/plan.c")
  endif()
  foreach(component io ik certify motions lines manifold sequence pairs tune)
    if(component IN_LIST COMPONENTS)
      run_by_pkg_config(leeway-${component} "${SOURCE}/${component}.cpp")
    endif()
  endforeach()
endif()
