# SPDX-License-Identifier: BSD-3-Clause
# The page of `leeway view`: three.js and the page's scripts, bundled by esbuild into one C++ source; the engine, compiled to
# WebAssembly by Emscripten. Included by planners/CMakeLists.txt, where the program is: it owns the source that is made here.
set(LEEWAY_BUILD_VIEW AUTO CACHE STRING "Pages of leeway view: ON, OFF, or AUTO: where npm and emcc work; see planners/view/README.md")
set_property(CACHE LEEWAY_BUILD_VIEW PROPERTY STRINGS AUTO ON OFF)
set(LEEWAY_VIEW_DIR "$ENV{LEEWAY_VIEW_DIR}" CACHE PATH "Folder of the tools that bundle the page (default: view-tools in the build folder)")

# leeway_view_missing(reason): fatal with ON, a message with AUTO
function(leeway_view_missing part reason)
  if(LEEWAY_BUILD_VIEW STREQUAL "AUTO")
    message(STATUS "leeway view: ${part} is left out: ${reason}")
  else()
    message(FATAL_ERROR "leeway view: ${reason}. Run .ci/install.sh view, or configure with -DLEEWAY_BUILD_VIEW=OFF")
  endif()
endfunction()

set(view "${CMAKE_CURRENT_SOURCE_DIR}/view")
set(tools "${LEEWAY_VIEW_DIR}")
if(NOT tools)
  set(tools "${CMAKE_SOURCE_DIR}/build/view-tools") # where .ci/install.sh view puts them
  if(NOT EXISTS "${tools}/.installed")
    set(tools "${CMAKE_BINARY_DIR}/view-tools")
  endif()
endif()
set(problem "")
if(LEEWAY_BUILD_VIEW)
  find_program(LEEWAY_NODE node)
  if(NOT LEEWAY_NODE)
    set(problem "node was not found (Debian: apt-get install nodejs npm)")
  else()
    execute_process(COMMAND "${CMAKE_COMMAND}" -E env "LEEWAY_VIEW_DIR=${tools}" "${view}/get_tools.sh"
      RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
    if(NOT result EQUAL 0)
      string(REGEX REPLACE "\n.*" "" output "${output}")
      set(problem "three.js and esbuild could not be installed: ${output}")
    endif()
  endif()
  if(problem)
    leeway_view_missing("the page" "${problem}")
  endif()
endif()

file(MAKE_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}/view")
set(made "${CMAKE_CURRENT_BINARY_DIR}/view/leeway_page.cpp")
if(NOT LEEWAY_BUILD_VIEW OR problem)
  set(LEEWAY_HAS_VIEW OFF CACHE INTERNAL "Whether the program writes pages")
  file(CONFIGURE OUTPUT "${made}" CONTENT "extern const char* const leeway_page;\nconst char* const leeway_page = \"\";\n")
else()
  set(LEEWAY_HAS_VIEW ON CACHE INTERNAL "Whether the program writes pages")
  find_program(LEEWAY_EMCC emcc)
  set(engine "")
  if(NOT LEEWAY_EMCC)
    leeway_view_missing("the engine in the page" "emcc was not found (Debian: apt-get install emscripten)")
  else()
    set(engine "${CMAKE_CURRENT_BINARY_DIR}/view/engine.wasm")
    # No contraction, as everywhere: the answers are those of the program. SSE2 intrinsics become WebAssembly's vectors
    set(flags -O3 -msimd128 -msse2 -std=gnu11 -ffp-contract=off -fno-math-errno -DLEEWAY_HULLS=0 "-I${CMAKE_SOURCE_DIR}/core/include"
      "-I${CMAKE_SOURCE_DIR}/core/src" "-I${CMAKE_BINARY_DIR}/core/include")
    file(GLOB headers CONFIGURE_DEPENDS "${CMAKE_SOURCE_DIR}/core/src/*/*.h" "${CMAKE_SOURCE_DIR}/core/include/leeway/*.h")
    # An object for each room: after a change of one file only its room is compiled again
    set(objects "")
    foreach(room base simd shape distance depth robot scene query reachability checker near motion blob)
      file(GLOB sources CONFIGURE_DEPENDS "${CMAKE_SOURCE_DIR}/core/src/${room}/*.c")
      set(object "${CMAKE_CURRENT_BINARY_DIR}/view/${room}.o")
      add_custom_command(OUTPUT "${object}" COMMAND "${LEEWAY_EMCC}" -r ${flags} ${sources} -o "${object}" DEPENDS ${sources} ${headers}
        COMMENT "WebAssembly: ${room}" VERBATIM)
      list(APPEND objects "${object}")
    endforeach()
    set(own "${view}/engine/engine.c" "${view}/engine/apart.c" "${view}/engine/touching.c")
    add_custom_command(OUTPUT "${engine}" COMMAND "${LEEWAY_EMCC}" ${flags} ${own} ${objects} -sALLOW_MEMORY_GROWTH=1 -sSTANDALONE_WASM=1
      --no-entry -o "${engine}" DEPENDS ${objects} ${own} "${view}/engine/apart.h" "${view}/engine/touching.h" ${headers} COMMENT "WebAssembly: the engine" VERBATIM)
  endif()
  file(GLOB page CONFIGURE_DEPENDS "${view}/page/*")
  add_custom_command(OUTPUT "${made}" "${CMAKE_CURRENT_BINARY_DIR}/view/page.html"
    COMMAND "${LEEWAY_NODE}" "${view}/page/build.mjs" "${tools}" "${made}" "${CMAKE_CURRENT_BINARY_DIR}/view/page.html" ${engine}
    DEPENDS ${page} ${engine} "${view}/package-lock.json" COMMENT "The page of leeway view" VERBATIM)
endif()
find_package(ZLIB REQUIRED)
target_sources(leeway_view PRIVATE "${made}")
target_link_libraries(leeway_view PRIVATE ZLIB::ZLIB)
