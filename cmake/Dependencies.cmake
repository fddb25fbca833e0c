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
