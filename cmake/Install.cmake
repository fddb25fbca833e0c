# The installed package: find_package(tufa) gives tufa::tufa, and with the component check, which
# needs CGAL, tufa::check too.

include(CMakePackageConfigHelpers)
include(GNUInstallDirs)
set(_package ${CMAKE_INSTALL_LIBDIR}/cmake/tufa)

set(_headers_of_check PATTERN check.h EXCLUDE)
if(TUFA_BUILD_CHECK)
  set(_headers_of_check "")
  install(TARGETS tufa_check EXPORT tufaCheckTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT tufaCheckTargets NAMESPACE tufa:: DESTINATION ${_package})
endif()
install(TARGETS tufa EXPORT tufaTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT tufaTargets NAMESPACE tufa:: DESTINATION ${_package})
install(DIRECTORY lib/include/tufa DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} ${_headers_of_check})
if(TUFA_BUILD_TOOLS)
  install(TARGETS tufa_command RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()

configure_package_config_file(cmake/tufaConfig.cmake.in tufaConfig.cmake
  INSTALL_DESTINATION ${_package})
# Before 1.0 a minor version may change the interface.
write_basic_package_version_file(tufaConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/tufaConfig.cmake ${PROJECT_BINARY_DIR}/tufaConfigVersion.cmake
  cmake/FindOpenVDB.cmake DESTINATION ${_package})
