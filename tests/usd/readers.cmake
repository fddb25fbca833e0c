# cmake -DTUFA=COMMAND -DFOLDER=FOLDER -P readers.cmake: writes .usda files of every kind that there
# is and compares what three.js and TinyUSDZ read with .off files. Says "skipped" where npm cannot
# bring them.
cmake_minimum_required(VERSION 3.25)

set(packages three@0.187.0 tinyusdz@0.9.0-rc10)
find_program(NODE node)
find_program(NPM npm)
if(NOT NODE)
  message("skipped: no node")
  return()
endif()
file(MAKE_DIRECTORY ${FOLDER})
if(NOT EXISTS ${FOLDER}/node_modules/tinyusdz/package.json)
  if(NPM)
    execute_process(COMMAND ${NPM} install --no-audit --no-fund --prefix ${FOLDER} ${packages}
      TIMEOUT 120 OUTPUT_QUIET ERROR_QUIET)
  endif()
  if(NOT EXISTS ${FOLDER}/node_modules/tinyusdz/package.json)
    message("skipped: npm cannot install ${packages}")
    return()
  endif()
endif()

# tufa(ARGUMENTS...): must succeed.
function(tufa)
  execute_process(COMMAND ${TUFA} ${ARGN} --quiet WORKING_DIRECTORY ${FOLDER}
    COMMAND_ERROR_IS_FATAL ANY)
endfunction()

# compare(NAME UP SCALE CREASE ARGUMENTS...): a .usda, and the same surface as .off.
set(pairs "")
function(compare name up scale crease)
  tufa(mesh box.vdb -o ${name}.usda ${ARGN} --up ${up} --scale ${scale} --crease ${crease})
  tufa(mesh box.vdb -o ${name}.off ${ARGN})
  set(pairs ${pairs} ${name}.usda ${name}.off ${up} ${scale} PARENT_SCOPE)
endfunction()

tufa(make box --voxel 0.1 -o box.vdb)
compare(faces y 1 40)
compare(quads y 1 180 --uniform)
compare(turned z 0.01 40)
tufa(lod box.vdb -o lods.usda --levels 2)

# Frames of other shapes, one of which is missing.
foreach(frame 1 2 4)
  tufa(make noise --seed ${frame} --voxel 0.2 -o f.${frame}.vdb)
endforeach()
tufa(mesh "f.#.vdb" -o all.usda --fps 25 --crease 40)
set(pairs ${pairs} all.usda f.1.off y 1)
set(frames "")
foreach(frame 1 2 4)
  tufa(mesh f.${frame}.vdb -o f.${frame}.off)
  list(APPEND frames ${frame} f.${frame}.off)
endforeach()

file(COPY ${CMAKE_CURRENT_LIST_DIR}/three.mjs ${CMAKE_CURRENT_LIST_DIR}/variants.mjs
  ${CMAKE_CURRENT_LIST_DIR}/times.mjs DESTINATION ${FOLDER})
execute_process(COMMAND ${NODE} three.mjs ${pairs} WORKING_DIRECTORY ${FOLDER}
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${NODE} variants.mjs lods.usda faces.usda WORKING_DIRECTORY ${FOLDER}
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${NODE} times.mjs all.usda 25 ${frames} WORKING_DIRECTORY ${FOLDER}
  COMMAND_ERROR_IS_FATAL ANY)
