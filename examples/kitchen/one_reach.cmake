# SPDX-License-Identifier: BSD-3-Clause
# Test: kitchen_demo writes, leeway plans one reach, kitchen_render draws it; a .glb begins with "glTF" and holds the motion.
function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    list(GET ARGV 0 program)
    message(FATAL_ERROR "${program}: exit status ${status}")
  endif()
endfunction()

file(REMOVE_RECURSE "${FOLDER}")
run("${DEMO}" "${FOLDER}")
set(model --robot "${FOLDER}/robot.urdf" --scene "${FOLDER}/scene.yaml")
run("${LEEWAY}" plan ${model} --srdf "${FOLDER}/robot.srdf" --request "${FOLDER}/reach/07_drawer.yaml" --min-d 0.003
  --seed 1 --out "${FOLDER}/path.yaml")
run("${RENDER}" ${model} --path "${FOLDER}/path.yaml" --colours "${FOLDER}/colours.yaml" --animation "${FOLDER}/motion.glb"
  --still "${FOLDER}/still.glb")
foreach(name motion still)
  file(READ "${FOLDER}/${name}.glb" head LIMIT 4 HEX)
  if(NOT head STREQUAL "676c5446")
    message(FATAL_ERROR "${name}.glb begins with ${head}")
  endif()
endforeach()
file(STRINGS "${FOLDER}/motion.glb" animated REGEX "\"animations\":" LIMIT_COUNT 1)
if(animated STREQUAL "")
  message(FATAL_ERROR "motion.glb is not animated")
endif()
