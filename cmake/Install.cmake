# The installed package: find_package(Tufa) gives Tufa::tufa, and with the component check Tufa::check
# too; pkg-config has tufa and tufa-check; the command comes with manual pages and shell completion.

include(CMakePackageConfigHelpers)
include(GNUInstallDirs)
# Components, which become packages: runtime, dev and doc, see Package.cmake.
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME dev)
# In /usr, where the system looks for libraries, programs need not say where they are, and files lie
# where Debian wants them.
set(TUFA_DEBIAN_LAYOUT FALSE)
if(CMAKE_INSTALL_PREFIX STREQUAL "/usr")
  set(TUFA_DEBIAN_LAYOUT TRUE)
endif()
set(_package ${CMAKE_INSTALL_LIBDIR}/cmake/Tufa)

# tufa_install_library(TARGET EXPORT PKG_CONFIG_NAME)
function(tufa_install_library target export pkg_config)
  install(TARGETS ${target} EXPORT ${export}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime NAMELINK_COMPONENT dev)
  if(NOT TUFA_DEBIAN_LAYOUT)
    set_target_properties(${target} PROPERTIES INSTALL_RPATH "$ORIGIN")
  endif()
  install(EXPORT ${export} NAMESPACE Tufa:: DESTINATION ${_package})
  configure_file(cmake/${pkg_config}.pc.in ${pkg_config}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${pkg_config}.pc
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endfunction()

if(NOT BUILD_SHARED_LIBS)
  set(TUFA_STATIC TRUE)
  set(TUFA_PC_STATIC -lmeshoptimizer)
  if(TUFA_HAS_LIB3MF)
    string(APPEND TUFA_PC_STATIC " -l3MF")
  endif()
  if(TUFA_HAS_NANOVDB)
    string(APPEND TUFA_PC_STATIC " -lz -lblosc")
  endif()
  set(TUFA_PC_STATIC_CHECK "-lmpfr -lgmp")
endif()
# The file says where it is, so that the folder can be moved.
file(RELATIVE_PATH TUFA_PC_PREFIX /p/${CMAKE_INSTALL_LIBDIR}/pkgconfig /p)
string(REGEX REPLACE "/$" "" TUFA_PC_PREFIX "${TUFA_PC_PREFIX}")

set(_headers_of_check PATTERN check.h EXCLUDE)
if(TUFA_BUILD_CHECK)
  set(_headers_of_check "")
  tufa_install_library(tufa_check TufaCheckTargets tufa-check)
endif()
tufa_install_library(tufa TufaTargets tufa)
install(DIRECTORY lib/include/tufa DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} ${_headers_of_check})
if(TUFA_BUILD_TOOLS)
  if(NOT TUFA_DEBIAN_LAYOUT)
    file(RELATIVE_PATH _to_libraries /p/${CMAKE_INSTALL_BINDIR} /p/${CMAKE_INSTALL_LIBDIR})
    set_target_properties(tufa_command PROPERTIES INSTALL_RPATH "$ORIGIN/${_to_libraries}")
  endif()
  install(TARGETS tufa_command RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime)
  install(DIRECTORY ${TUFA_PAGES}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT runtime)
  install(FILES ${TUFA_PAGES}/tufa.bash RENAME tufa
    DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT runtime)
  install(FILES ${TUFA_PAGES}/tufa.zsh RENAME _tufa
    DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT runtime)
  install(FILES ${TUFA_PAGES}/tufa.fish
    DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT runtime)
endif()
if(NOT TUFA_DEBIAN_LAYOUT)
  install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)
endif()
install(FILES README.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT doc)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT doc
  PATTERN CMakeLists.txt EXCLUDE PATTERN Doxyfile.in EXCLUDE)

configure_package_config_file(cmake/TufaConfig.cmake.in TufaConfig.cmake
  INSTALL_DESTINATION ${_package})
# Before 1.0 a minor version may change the interface.
write_basic_package_version_file(TufaConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/TufaConfig.cmake ${PROJECT_BINARY_DIR}/TufaConfigVersion.cmake
  cmake/FindOpenVDB.cmake DESTINATION ${_package})
