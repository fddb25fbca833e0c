# cmake -DTUFA=COMMAND -DFOLDER=FOLDER -P validator.cmake: writes .glb files of every kind that there
# is and asks Khronos's validator. Says "skipped" where npm cannot bring it.
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/files.cmake)

set(version 2.0.0-dev.3.10)
set(module ${FOLDER}/node_modules/gltf-validator)
find_program(NODE node)
find_program(NPM npm)
if(NOT NODE)
  message("skipped: no node")
  return()
endif()
if(NOT EXISTS ${module}/package.json)
  if(NPM)
    execute_process(COMMAND ${NPM} install --no-audit --no-fund --prefix ${FOLDER} gltf-validator@${version}
      TIMEOUT 120 OUTPUT_QUIET ERROR_QUIET)
  endif()
  if(NOT EXISTS ${module}/package.json)
    message("skipped: npm cannot install gltf-validator ${version}")
    return()
  endif()
endif()

write_files()
execute_process(COMMAND ${NODE} ${CMAKE_CURRENT_LIST_DIR}/validate.mjs ${module} ${glb_files}
  COMMAND_ERROR_IS_FATAL ANY)
