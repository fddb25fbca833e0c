# cmake -DTUFA=tufa_unchecked -P without_check.cmake: fails unless a command built without the mesh
# checker says so, in one line, before any work, wherever the checker is asked for.
cmake_minimum_required(VERSION 3.25)

set(said "tufa: this tufa was built without the mesh checker; configure with -DTUFA_BUILD_CHECK=ON\n")

foreach(call IN ITEMS
    "check;none.ply"
    "compare;none.vdb;-o;none.html"
    "mesh;none.vdb;-o;none.ply;--check"
    "lod;none.vdb;-o;none.glb;--check"
    "lod;none.vdb;-o;none.glb;--report;none.html"
    "chunks;--assemble;none;--lods;all:0;-o;none.ply;--check")
  execute_process(COMMAND ${TUFA} ${call} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE error)
  if(NOT code EQUAL 2 OR NOT error STREQUAL said OR NOT out STREQUAL "")
    message(FATAL_ERROR "tufa ${call}: exit code ${code}, \"${out}\", \"${error}\"")
  endif()
endforeach()

execute_process(COMMAND ${TUFA} mesh --help OUTPUT_VARIABLE help COMMAND_ERROR_IS_FATAL ANY)
if(NOT help MATCHES "no mesh checker")
  message(FATAL_ERROR "the help text of --check does not say that there is no checker")
endif()

# The same of images without ITK, in one line that names the way out.
file(WRITE none.nii "")
execute_process(COMMAND ${TUFA} import none.nii -o none.vdb
  RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE error)
if(NOT code EQUAL 2 OR NOT error MATCHES "^tufa: [^\n]*built without ITK[^\n]*--size[^\n]*\n$"
    OR NOT out STREQUAL "")
  message(FATAL_ERROR "tufa import: exit code ${code}, \"${out}\", \"${error}\"")
endif()

# What needs no checker works as ever.
execute_process(COMMAND ${TUFA} mesh none.vdb -o none.ply RESULT_VARIABLE code ERROR_QUIET)
if(NOT code EQUAL 3)
  message(FATAL_ERROR "tufa mesh none.vdb: exit code ${code}")
endif()
