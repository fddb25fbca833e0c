# cmake -DLIBRARY=lib -P layers.cmake: fails if a folder of lib/src includes one that comes later, so
# that arrows run one way, or if headers of OpenVDB, TBB or CGAL are included beyond the folders that
# know them.
cmake_minimum_required(VERSION 3.25)
get_filename_component(LIBRARY ${LIBRARY} ABSOLUTE)
set(sources ${LIBRARY}/src)

# The stages of the pipeline: each sees itself and those before it. What lies in no folder sees all.
set(stages base grid uniform octree distance intersect topology reduce refine extract lod chunks)
set(before "")
foreach(stage IN LISTS stages)
  list(APPEND before ${stage})
  set(sees_${stage} ${before})
endforeach()
# These three come side by side, but for one: topology asks intersect.
list(REMOVE_ITEM sees_intersect distance)
list(REMOVE_ITEM sees_topology distance)
# Plain arrays come in and go out here: it knows of no grid.
set(sees_reduce base reduce)
# Methods beside dual contouring: they share its cells, and the rounding of finished meshes.
set(sees_extract base grid uniform refine extract)
list(REMOVE_ITEM sees_lod extract)
list(REMOVE_ITEM sees_chunks extract)
list(APPEND sees_chunks shading)
# Folders beside the pipeline, and all that each of them sees.
set(sees_shapes base grid shapes)
set(sees_implicit base io implicit)
set(sees_voxelize base grid implicit voxelize)
set(sees_filter base grid filter)
set(sees_attributes base attributes)
set(sees_shading base shading)
set(sees_io base shading io)
set(sees_check base grid check)

# OpenVDB's headers cost seconds in each file. Only these files may include them; <openvdb/version.h>
# costs nothing.
set(knows_openvdb "^(grid|attributes|filter|voxelize|shapes|io/grid)/")
set(publishes_openvdb "^(shapes|voxelize)\\.h$")
set(includes_openvdb "<(openvdb/|tufa/(shapes|voxelize|tufa)\\.h)")
set(costs_nothing "<openvdb/version\\.h>")

set(broken "")
set(arrows 0)
file(GLOB_RECURSE files RELATIVE ${sources} ${sources}/*.h ${sources}/*.cpp)
foreach(file IN LISTS files)
  file(STRINGS ${sources}/${file} includes_of_${file} REGEX "^ *# *include")
endforeach()

# Headers of these folders that bring OpenVDB's along, be it through others.
set(costly "")
set(count -1)
while(NOT count EQUAL found)
  set(found ${count})
  foreach(file IN LISTS files)
    if(NOT file MATCHES "${knows_openvdb}.*\\.h$" OR file IN_LIST costly)
      continue()
    endif()
    foreach(include IN LISTS includes_of_${file})
      string(REGEX REPLACE ".*[\"<](.*)[\">].*" "\\1" header "${include}")
      if(header IN_LIST costly
          OR include MATCHES "${includes_openvdb}" AND NOT include MATCHES "${costs_nothing}")
        list(APPEND costly ${file})
        break()
      endif()
    endforeach()
  endforeach()
  list(LENGTH costly count)
endwhile()

foreach(file IN LISTS files)
  set(folder "")
  if(file MATCHES "^([a-z0-9_]+)/")
    set(folder ${CMAKE_MATCH_1})
    if(NOT DEFINED sees_${folder})
      string(APPEND broken "${file}: folder ${folder} has no place in layers.cmake\n")
      continue()
    endif()
  endif()
  foreach(include IN LISTS includes_of_${file})
    string(REGEX REPLACE ".*[\"<](.*)[\">].*" "\\1" header "${include}")
    if(include MATCHES "\"([a-z0-9_]+)/")
      math(EXPR arrows "${arrows} + 1")
      if(folder AND NOT CMAKE_MATCH_1 IN_LIST sees_${folder})
        string(APPEND broken "${file}: ${folder} must not see ${CMAKE_MATCH_1}\n")
      elseif(header IN_LIST costly AND NOT file MATCHES "${knows_openvdb}")
        string(APPEND broken "${file}: ${header} brings OpenVDB's headers along\n")
      endif()
    elseif(include MATCHES "\"")
      string(APPEND broken "${file}: own headers are named by their folder: ${include}\n")
    elseif(include MATCHES "<(tbb|oneapi)/" AND NOT folder STREQUAL "base")
      string(APPEND broken "${file}: only base names TBB\n")
    elseif(include MATCHES "<CGAL/" AND NOT folder STREQUAL "check")
      string(APPEND broken "${file}: only check names CGAL\n")
    elseif(include MATCHES "${includes_openvdb}" AND NOT include MATCHES "${costs_nothing}"
        AND NOT file MATCHES "${knows_openvdb}")
      string(APPEND broken "${file}: only grid, attributes, filter, voxelize, shapes and io/grid include ${header}\n")
    endif()
  endforeach()
endforeach()

file(GLOB headers RELATIVE ${LIBRARY}/include/tufa ${LIBRARY}/include/tufa/*.h)
list(REMOVE_ITEM headers tufa.h)  # it includes all others
foreach(file IN LISTS headers)
  file(STRINGS ${LIBRARY}/include/tufa/${file} includes REGEX "^ *# *include")
  foreach(include IN LISTS includes)
    if(include MATCHES "[\"<](tbb|oneapi|CGAL)/")
      string(APPEND broken "tufa/${file}: public headers name neither TBB nor CGAL\n")
    elseif(include MATCHES "${includes_openvdb}" AND NOT include MATCHES "${costs_nothing}"
        AND NOT file MATCHES "${publishes_openvdb}")
      string(APPEND broken "tufa/${file}: of the public headers only shapes.h and voxelize.h "
        "include OpenVDB's: ${include}\n")
    endif()
  endforeach()
endforeach()

list(LENGTH headers public)
if(arrows LESS 300 OR public LESS 10)
  message(FATAL_ERROR "only ${arrows} includes and ${public} public headers found in ${LIBRARY}: "
    "is this the right folder?")
endif()
if(broken)
  message(FATAL_ERROR "${broken}")
endif()
message(STATUS "${arrows} includes, all of them to an earlier layer")
