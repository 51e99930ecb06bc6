# SPDX-License-Identifier: BSD-3-Clause
# Several files of a target in one compilation: readers of JSON, YAML and options, Eigen and OMPL spend most of a compilation in headers and
# in templates, so that eight files take as long as three. LEEWAY_UNITY=TESTS: tests, benchmarks and the program, whose files need not stand alone.
# LEEWAY_UNITY=ALL: the libraries, too; for sanitizers, whose builds take twice as long. A name in an anonymous namespace then has to be
# the only one of its target, or its file stands alone below.
set(together_tests leeway test_cli test_native_planner test_ompl test_manifold_ompl test_pose_goals test_bench leeway_bench
  leeway_planning)
set(together_all leeway_io leeway_ik leeway_view leeway_ompl leeway_planners leeway_plan leeway_pairs leeway_tune leeway_lines
  leeway_manifold leeway_certify leeway_referee leeway_replay leeway_fuzz_targets kitchen_model)

set(together ${together_tests})
if(LEEWAY_UNITY STREQUAL "ALL")
  list(APPEND together ${together_all})
endif()
foreach(target ${together})
  if(TARGET ${target})
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
    # a fixture of an anonymous namespace is in no header
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-Wno-subobject-linkage>)
  endif()
endforeach()

# Files that share a name with another one of their target, each in a compilation of its own
function(leeway_alone target)
  if(TARGET ${target})
    list(TRANSFORM ARGN PREPEND "${CMAKE_SOURCE_DIR}/tests/")
    set_source_files_properties(${ARGN} TARGET_DIRECTORY ${target} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  endif()
endfunction()
leeway_alone(test_ompl ompl/counting_allocator.cpp) # it replaces new and delete
leeway_alone(test_native_planner native_planner/portfolio_test.cpp native_planner/proof_test.cpp)
leeway_alone(test_cli cli/ends_test.cpp cli/pairs_fixture.cpp)
leeway_alone(test_bench bench/report_test.cpp)
