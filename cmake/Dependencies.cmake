# Every outside package that Tufa needs, found in one place.
#
# TBB comes first and by its own package config: the folder of Debian's FindOpenVDB.cmake also holds
# a FindTBB.cmake that would shadow it. OpenVDB is found by cmake/FindOpenVDB.cmake of this project,
# because Debian installs OpenVDB's module outside CMake's module path.

find_package(Threads REQUIRED)
find_package(TBB CONFIG REQUIRED)
find_package(OpenVDB 8.0 REQUIRED)
find_package(nlohmann_json 3.10 REQUIRED)
find_package(meshoptimizer CONFIG REQUIRED)

set(TUFA_HAS_LIB3MF FALSE)
if(TUFA_USE_LIB3MF)
  # Of version 1: the interface of version 2 is another one.
  find_path(Lib3MF_INCLUDE_DIR Model/COM/NMR_DLLInterfaces.h PATH_SUFFIXES lib3mf)
  find_library(Lib3MF_LIBRARY 3MF)
  mark_as_advanced(Lib3MF_INCLUDE_DIR Lib3MF_LIBRARY)
  if(Lib3MF_INCLUDE_DIR AND Lib3MF_LIBRARY)
    set(TUFA_HAS_LIB3MF TRUE)
    message(STATUS "Tufa writes .3mf through lib3mf")
  else()
    message(STATUS "Tufa writes no .3mf: no lib3mf 1 (lib3mf-dev of Debian 12)")
  endif()
endif()

set(TUFA_HAS_NANOVDB FALSE)
if(TUFA_USE_NANOVDB)
  # Headers alone; files may be compressed by zlib or Blosc.
  find_path(NanoVDB_INCLUDE_DIR nanovdb/NanoVDB.h)
  find_path(Blosc_INCLUDE_DIR blosc.h)
  find_library(Blosc_LIBRARY blosc)
  find_package(ZLIB QUIET)
  mark_as_advanced(NanoVDB_INCLUDE_DIR Blosc_INCLUDE_DIR Blosc_LIBRARY)
  if(NanoVDB_INCLUDE_DIR AND Blosc_INCLUDE_DIR AND Blosc_LIBRARY AND ZLIB_FOUND)
    # Later headers have other names.
    include(CheckCXXSourceCompiles)
    set(CMAKE_REQUIRED_INCLUDES ${NanoVDB_INCLUDE_DIR})
    check_cxx_source_compiles("#include <nanovdb/util/IO.h>
      static_assert(sizeof(nanovdb::io::MetaData) == 176 && NANOVDB_MAJOR_VERSION_NUMBER == 32);
      int main() { return 0; }" TUFA_NANOVDB_COMPILES)
    unset(CMAKE_REQUIRED_INCLUDES)
    set(TUFA_HAS_NANOVDB ${TUFA_NANOVDB_COMPILES})
  endif()
  if(TUFA_HAS_NANOVDB)
    message(STATUS "Tufa reads .nvdb")
  else()
    message(STATUS "Tufa reads no .nvdb: no libnanovdb-dev of version 32, libblosc-dev or zlib1g-dev")
  endif()
endif()

# One header of Ceres Solver's, and Eigen's: nothing is linked.
if(TUFA_USE_CERES)
  find_package(Eigen3 QUIET NO_MODULE)
  find_path(TUFA_CERES_INCLUDE_DIR ceres/tiny_solver.h)
  if(NOT Eigen3_FOUND)
    unset(TUFA_CERES_INCLUDE_DIR CACHE)
  endif()
endif()
if(TUFA_CERES_INCLUDE_DIR)
  message(STATUS "tufa fit solves by Ceres's TinySolver: ${TUFA_CERES_INCLUDE_DIR}/ceres")
else()
  message(STATUS "tufa fit is left out: no Ceres Solver (libceres-dev)")
endif()

if(TUFA_BUILD_CHECK)
  # CGAL warns about missing build types and sets flags of its own unless told not to.
  set(CGAL_DO_NOT_WARN_ABOUT_CMAKE_BUILD_TYPE TRUE)
  find_package(CGAL 5.5 REQUIRED)
endif()
if(TUFA_BUILD_TOOLS)
  find_package(CLI11 2.1 REQUIRED)
  find_package(PNG REQUIRED)
  if(TUFA_USE_ITK)
    # Its package looks for libraries in C, and tells of every program of others that is missing.
    enable_language(C)
    set(CMAKE_MESSAGE_LOG_LEVEL ERROR)
    find_package(ITK 5 QUIET COMPONENTS ITKIOGDCM ITKIOMeta ITKIONIFTI ITKIONRRD ITKIOPNG ITKIOTIFF)
    unset(CMAKE_MESSAGE_LOG_LEVEL)
    # Debian's headers know the compiler alone that ITK was built with.
    if(ITK_FOUND)
      include(CheckCXXSourceCompiles)
      set(CMAKE_REQUIRED_INCLUDES ${ITK_INCLUDE_DIRS})
      set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
      check_cxx_source_compiles("#include <itkImageIOBase.h>\nint main() { return 0; }" TUFA_ITK_COMPILES)
      unset(CMAKE_TRY_COMPILE_TARGET_TYPE)
      unset(CMAKE_REQUIRED_INCLUDES)
      set(ITK_FOUND ${TUFA_ITK_COMPILES})
    endif()
  endif()
  if(ITK_FOUND)
    message(STATUS "tufa import reads images through ITK ${ITK_VERSION_MAJOR}.${ITK_VERSION_MINOR}")
  else()
    message(STATUS "tufa import reads raw images alone: no ITK (libinsighttoolkit5-dev)")
  endif()
endif()
if(TUFA_BUILD_TESTS)
  find_package(GTest REQUIRED)
endif()
