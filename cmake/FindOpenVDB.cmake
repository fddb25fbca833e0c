# Finds OpenVDB and defines OpenVDB::openvdb. Needs TBB::tbb, found before. OpenVDB's headers use
# half floats of Imath, so programs link that too.
#
# OpenVDB_ROOT or CMAKE_PREFIX_PATH point it at an installation outside the system folders.

find_path(OpenVDB_INCLUDE_DIR openvdb/version.h)
find_library(OpenVDB_LIBRARY openvdb)
mark_as_advanced(OpenVDB_INCLUDE_DIR OpenVDB_LIBRARY)

if(OpenVDB_INCLUDE_DIR)
  set(OpenVDB_VERSION "")
  foreach(_part MAJOR MINOR PATCH)
    file(STRINGS ${OpenVDB_INCLUDE_DIR}/openvdb/version.h _line
         REGEX "^#define OPENVDB_LIBRARY_${_part}_VERSION_NUMBER +[0-9]+")
    string(REGEX MATCH "[0-9]+$" _number "${_line}")
    list(APPEND OpenVDB_VERSION ${_number})
  endforeach()
  list(JOIN OpenVDB_VERSION "." OpenVDB_VERSION)
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenVDB
  REQUIRED_VARS OpenVDB_LIBRARY OpenVDB_INCLUDE_DIR
  VERSION_VAR OpenVDB_VERSION)

find_package(Imath CONFIG QUIET)

if(OpenVDB_FOUND AND NOT TARGET OpenVDB::openvdb)
  add_library(OpenVDB::openvdb UNKNOWN IMPORTED)
  set_target_properties(OpenVDB::openvdb PROPERTIES
    IMPORTED_LOCATION ${OpenVDB_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${OpenVDB_INCLUDE_DIR}
    INTERFACE_LINK_LIBRARIES "TBB::tbb;Threads::Threads;$<TARGET_NAME_IF_EXISTS:Imath::Imath>")
endif()
