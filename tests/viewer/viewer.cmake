# cmake -DTUFA=COMMAND -DVIEWER=docs/examples/chunks-viewer -DFOLDER=FOLDER -P viewer.cmake: makes a
# terrain of over a thousand chunks and a part, and looks at them with the viewer in headless
# Chromium. Says "skipped" where there is no Chromium, or npm cannot bring what the viewer needs.
cmake_minimum_required(VERSION 3.25)

find_program(NODE node)
find_program(NPM npm)
find_program(CHROMIUM NAMES chromium chromium-browser google-chrome)
foreach(program NODE NPM CHROMIUM)
  if(NOT ${program})
    message("skipped: no ${program}")
    return()
  endif()
endforeach()

# A copy, so that nothing is installed into the sources.
file(MAKE_DIRECTORY ${FOLDER})
file(COPY ${VIEWER} DESTINATION ${FOLDER} PATTERN node_modules EXCLUDE)
set(viewer ${FOLDER}/chunks-viewer)
if(NOT EXISTS ${viewer}/node_modules/puppeteer-core/package.json OR
   NOT EXISTS ${viewer}/node_modules/three/package.json)
  execute_process(COMMAND ${NPM} ci --no-audit --no-fund WORKING_DIRECTORY ${viewer}
    TIMEOUT 240 RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
  if(failed)
    message("skipped: npm cannot install what the viewer needs")
    return()
  endif()
endif()

execute_process(COMMAND ${TUFA} make terrain --voxel 0.007 -o ${FOLDER}/terrain.vdb
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${TUFA} chunks ${FOLDER}/terrain.vdb -o ${FOLDER}/terrain --chunk 16
    --levels 4 --tolerance 0.1 --factor 2.5 --quiet
  COMMAND_ERROR_IS_FATAL ANY)
set(part "${FOLDER}/<i>part & co") # a name that has to be shown as text
execute_process(COMMAND ${TUFA} make bracket --voxel 0.02 -o ${FOLDER}/bracket.vdb
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${TUFA} chunks ${FOLDER}/bracket.vdb -o ${part} --chunk 16 --quiet
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${NODE} ${CMAKE_CURRENT_LIST_DIR}/look.mjs ${viewer} ${FOLDER}/terrain
    ${part} ${TUFA} ${CHROMIUM} ${FOLDER}
  COMMAND_ERROR_IS_FATAL ANY)
