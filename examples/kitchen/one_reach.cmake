# SPDX-License-Identifier: BSD-3-Clause
# Test: kitchen_demo writes, leeway plans one reach, kitchen_render draws it, kitchen_hulls the reach of an arm; a .glb
# begins with "glTF" and holds the motion, or the hull and the sphere. Without qhull HULLS is empty.
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
set(names motion still)
if(HULLS)
  run("${HULLS}" --robot "${FOLDER}/robot.urdf" --colours "${FOLDER}/colours.yaml" --still "${FOLDER}/hulls.glb"
    --joint right_elbow=1 --hull right_elbow_link --sphere left_elbow_link)
  list(APPEND names hulls)
  foreach(part "M of right_elbow_link" "sphere of left_elbow_link")
    file(STRINGS "${FOLDER}/hulls.glb" drawn REGEX "\"name\":\"${part}\"" LIMIT_COUNT 1)
    if(drawn STREQUAL "")
      message(FATAL_ERROR "hulls.glb has no ${part}")
    endif()
  endforeach()
  # an unknown link: a message, not a picture
  execute_process(COMMAND "${HULLS}" --robot "${FOLDER}/robot.urdf" --still "${FOLDER}/none.glb" --hull nobody
    RESULT_VARIABLE status ERROR_VARIABLE text)
  if(NOT status EQUAL 2 OR NOT text MATCHES "nobody: is no link" OR EXISTS "${FOLDER}/none.glb")
    message(FATAL_ERROR "an unknown link: exit status ${status}, ${text}")
  endif()
endif()
foreach(name ${names})
  file(READ "${FOLDER}/${name}.glb" head LIMIT 4 HEX)
  if(NOT head STREQUAL "676c5446")
    message(FATAL_ERROR "${name}.glb begins with ${head}")
  endif()
endforeach()
file(STRINGS "${FOLDER}/motion.glb" animated REGEX "\"animations\":" LIMIT_COUNT 1)
if(animated STREQUAL "")
  message(FATAL_ERROR "motion.glb is not animated")
endif()
