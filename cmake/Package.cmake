# cpack: a .deb each of the command with the libraries, of what programs are built with, and of the
# documentation; and a .tar.gz of the whole installed tree. The preset `package` installs to the
# folders of Debian.

set(CPACK_GENERATOR DEB TGZ)
set(CPACK_PACKAGE_VENDOR "The Tufa authors")
# Whoever builds a package answers for it; Debian's tools take name and address from there too.
set(_name ${CPACK_PACKAGE_VENDOR})
if(DEFINED ENV{DEBFULLNAME})
  set(_name $ENV{DEBFULLNAME})
endif()
set(CPACK_PACKAGE_CONTACT ${_name})
if(DEFINED ENV{DEBEMAIL})
  set(CPACK_PACKAGE_CONTACT "${_name} <$ENV{DEBEMAIL}>")
endif()
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

set(CPACK_COMPONENTS_ALL runtime dev doc)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # the first line of each description is its own
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS OFF)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(TUFA_DEBIAN_VERSION ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME tufa)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION graphics)
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "watertight meshes from sparse OpenVDB volumes
The command tufa and its libraries make adaptive, watertight meshes with a
certified error from level sets and fog volumes, levels of detail and chunks
of them, and check, compare and repair meshes.")
# Asked of dpkg-shlibdeps, so that they are those of the machine that builds.
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/lib)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
# What Debian wants beside the scripts that cpack makes, which run ldconfig themselves.
if(BUILD_SHARED_LIBS)
  file(WRITE ${PROJECT_BINARY_DIR}/debian/triggers "activate-noawait ldconfig\n")
  set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/debian/triggers)
endif()

set(CPACK_DEBIAN_DEV_PACKAGE_NAME tufa-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "tufa (= ${TUFA_DEBIAN_VERSION})")
# What the headers include.
set(CPACK_DEBIAN_DEV_PACKAGE_SUGGESTS "libopenvdb-dev, libtbb-dev, libimath-dev")
set(CPACK_COMPONENT_DEV_DESCRIPTION "watertight meshes from OpenVDB volumes (development files)
Headers, and files for CMake and pkg-config, to build C++ programs that use
the libraries of Tufa.")

set(CPACK_DEBIAN_DOC_PACKAGE_NAME tufa-doc)
set(CPACK_DEBIAN_DOC_PACKAGE_SECTION doc)
set(CPACK_DEBIAN_DOC_PACKAGE_ARCHITECTURE all)
set(CPACK_COMPONENT_DOC_DESCRIPTION "watertight meshes from OpenVDB volumes (documentation)
What the command does and how its stages work, with examples in C++ and shell
scripts by role.")

# What Debian wants in the folder of each package.
if(TUFA_DEBIAN_LAYOUT)
  find_program(TUFA_GZIP gzip REQUIRED)
  string(TIMESTAMP TUFA_PACKAGE_DATE "%a, %d %b %Y %H:%M:%S +0000" UTC)
  configure_file(cmake/changelog.Debian.in debian/changelog.Debian @ONLY)
  configure_file(CHANGELOG.md debian/changelog COPYONLY)
  foreach(_file changelog changelog.Debian)
    execute_process(COMMAND ${TUFA_GZIP} -9nf ${PROJECT_BINARY_DIR}/debian/${_file}
      COMMAND_ERROR_IS_FATAL ANY)
  endforeach()
  foreach(_component ${CPACK_COMPONENTS_ALL})
    string(TOUPPER ${_component} _upper)
    set(_folder ${CMAKE_INSTALL_DATADIR}/doc/${CPACK_DEBIAN_${_upper}_PACKAGE_NAME})
    install(FILES cmake/copyright ${PROJECT_BINARY_DIR}/debian/changelog.gz
      ${PROJECT_BINARY_DIR}/debian/changelog.Debian.gz
      DESTINATION ${_folder} COMPONENT ${_component})
  endforeach()
endif()
include(CPack)
