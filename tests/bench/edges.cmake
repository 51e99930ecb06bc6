# SPDX-License-Identifier: BSD-3-Clause
# Two runs of `leeway-bench edges` on robots made by seed: the same edges, the same verdicts, told by `compare`.
foreach(name before after)
  execute_process(COMMAND "${BENCH}" edges --data none --random-robots 3 --edges 20 --met 5 --budget 0 --certified-only --no-planner
      --json ${name}.json RESULT_VARIABLE status OUTPUT_VARIABLE text ERROR_VARIABLE text)
  if(status)
    message(FATAL_ERROR "leeway-bench edges ended with ${status}:\n${text}")
  endif()
endforeach()
execute_process(COMMAND "${BENCH}" compare before.json after.json RESULT_VARIABLE status OUTPUT_VARIABLE text ERROR_VARIABLE text)
if(status OR NOT text MATCHES "verdicts: 0 of 720 changed, 0 contradict" OR text MATCHES "other edges")
  message(FATAL_ERROR "leeway-bench compare ended with ${status}:\n${text}")
endif()
# rows without a partner are no result without a difference
foreach(arguments "before.json" "before.json;after.json;--by;mean" "before.json;none.json" "${CMAKE_CURRENT_LIST_FILE};after.json")
  execute_process(COMMAND "${BENCH}" compare ${arguments} RESULT_VARIABLE status OUTPUT_VARIABLE text ERROR_VARIABLE text)
  if(NOT status GREATER 1)
    message(FATAL_ERROR "leeway-bench compare ${arguments} ended with ${status}:\n${text}")
  endif()
endforeach()
