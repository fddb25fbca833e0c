# cmake -DPROJECT=. -P doors.cmake: fails if files are written or read past the doors made for that,
# or options of the command are named past the one that knows them.
#
# io/output_file writes: files appear whole or not at all, and no planted name is followed.
# The command reads volumes in tools/volume.cpp, under a crash guard.
# The library names its own fields in messages; tools/failure.cpp puts options in their place.
cmake_minimum_required(VERSION 3.25)
set(writes "ofstream|std::fstream|fopen|std::FILE|O_CREAT|O_RDWR|png_image_write_to_file")
set(writer "^lib/src/io/output_file\\.cpp$")
set(reads "[^a-zA-Z:](tufa::)?(readGrid|describeGrids|listGrids)[(]")
set(reader "^(lib/|tools/volume\\.(h|cpp)$)")
set(options "^[^/]*\"[^\"]*--[a-z]")
set(namer "^tools/")

file(GLOB_RECURSE sources RELATIVE ${PROJECT}
  ${PROJECT}/lib/*.h ${PROJECT}/lib/*.cpp ${PROJECT}/tools/*.h ${PROJECT}/tools/*.cpp)
list(LENGTH sources count)
if(count LESS 200)
  message(FATAL_ERROR "only ${count} sources found in ${PROJECT}: is this the right folder?")
endif()
set(broken "")
foreach(source IN LISTS sources)
  file(STRINGS ${PROJECT}/${source} lines REGEX "${writes}|${reads}|${options}")
  foreach(line IN LISTS lines)
    if(line MATCHES "${writes}" AND NOT source MATCHES "${writer}"
        OR line MATCHES "${reads}" AND NOT source MATCHES "${reader}"
        OR line MATCHES "${options}" AND NOT source MATCHES "${namer}")
      string(APPEND broken "${source}: ${line}\n")
    endif()
  endforeach()
endforeach()
if(broken)
  message(FATAL_ERROR "past the doors for reading, writing and options:\n${broken}")
endif()
message(STATUS "${count} sources, none past the doors")
