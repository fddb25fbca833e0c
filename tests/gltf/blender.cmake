# cmake -DTUFA=COMMAND -DFOLDER=FOLDER -P blender.cmake: writes .glb files and has Blender import
# them. Says "skipped" where there is no Blender that can. Packed files are left out: Blender's
# importer does not know EXT_meshopt_compression.
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/files.cmake)

find_program(BLENDER blender)
if(NOT BLENDER)
  message("skipped: no blender")
  return()
endif()
set(options -b --factory-startup --python-exit-code 1)
execute_process(COMMAND ${BLENDER} ${options} --python-expr "import numpy"
  RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
if(failed)
  message("skipped: blender's Python has no NumPy, which its importer needs (Debian: python3-numpy)")
  return()
endif()

write_files()
foreach(name plain quantized turned one_level big big_quantized)
  execute_process(COMMAND ${BLENDER} ${options} --python ${CMAKE_CURRENT_LIST_DIR}/blender_import.py
      -- ${FOLDER}/${name}.glb ${FOLDER}/${name}.json
    COMMAND_ERROR_IS_FATAL ANY)
endforeach()
