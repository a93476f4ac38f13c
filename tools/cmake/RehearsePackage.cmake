# Debian packages, made by CPack: `rehearse`, `rehearse-dev`, `python3-rehearse` if the module is built, separate debug symbols, and `rehearse-doc` if tools/docs
# has built the site. tools/package calls it.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME rehearse)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "The Rehearse authors <rehearse@users.noreply.github.com>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_BINARY_DIR}/packages)
set(components runtime development)
if(TARGET rehearse_python)
  list(APPEND components python)
endif()
if(EXISTS ${CMAKE_BINARY_DIR}/docs/index.html)
  list(APPEND components site)
endif()
set(CPACK_COMPONENTS_ALL ${components})
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_DEBUGINFO_PACKAGE ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${CMAKE_BINARY_DIR}/doc/triggers)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_THREADS 2)  # with one thread xz gives other bytes; more threads give the same as two
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME rehearse)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION science)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_DEPENDS "libosmesa6")  # loaded by name, when the first picture is drawn
# Programs that a verb or an option starts: where one is missed, the error names the package. apt doesn't fetch them by
# default; ffmpeg alone brings 244 packages.
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SUGGESTS "gdb, valgrind, ffmpeg, rehearse-doc")
set(CPACK_DEBIAN_RUNTIME_DESCRIPTION "record, replay and judge robot controllers
 Rehearse runs a robot controller, written for Choreonoid's SimpleController
 API, in a deterministic simulation, records what it reads and commands,
 compares the recording with a golden one, and replays it without physics.")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME rehearse-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
  "rehearse (= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}), libeigen3-dev (>= 3.4), libgtest-dev (>= 1.12)")
# As for other -dev packages: whoever compiles has a compiler, or chooses one.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "cmake (>= 3.25), g++, make | ninja-build")
set(CPACK_DEBIAN_DEVELOPMENT_DEBUGINFO_PACKAGE OFF)
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "build and test robot controllers with Rehearse
 Headers of Choreonoid's SimpleController API, GoogleTest assertions on
 recorded runs, and what CMake needs to find both.")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-rehearse)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS OFF)  # it doesn't find libraries of the package rehearse, which needs all others
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
  "rehearse (= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}), python3 (>= 3.11), python3 (<< 3.12), python3-numpy, libc6, libstdc++6, libgcc-s1, libpython3.11")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-pytest, python3-hypothesis, python3-matplotlib")
set(CPACK_DEBIAN_PYTHON_DEBUGINFO_PACKAGE OFF)
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "recordings of robot controllers as arrays, and controllers in Python
 The module rehearse: series of any recording as numpy arrays, the verbs of
 the command as functions, controllers in Python, and tests with pytest.")
# Python caches compiled modules beside them: made at the installation, and removed with the package.
set(scripts ${CMAKE_BINARY_DIR}/doc/python)
file(MAKE_DIRECTORY ${scripts})
file(WRITE ${scripts}/postinst "#!/bin/sh\nset -e\nif command -v py3compile > /dev/null; then py3compile -p python3-rehearse; fi\n")
file(WRITE ${scripts}/prerm "#!/bin/sh\nset -e\nif command -v py3clean > /dev/null; then py3clean -p python3-rehearse; fi\n")
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${scripts}/postinst ${scripts}/prerm)

set(CPACK_DEBIAN_SITE_PACKAGE_NAME rehearse-doc)
set(CPACK_DEBIAN_SITE_PACKAGE_SECTION doc)
set(CPACK_DEBIAN_SITE_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_SITE_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_SITE_DEBUGINFO_PACKAGE OFF)
set(CPACK_DEBIAN_SITE_DESCRIPTION "documentation of Rehearse, as a site
 Tutorials, one page a task, concepts and the reference, with reports to click
 through. The command rehearse doc opens it.")

# Debian's own documents; its changelog refers to the project's.
set(documents ${CMAKE_BINARY_DIR}/doc)
# of SOURCE_DATE_EPOCH, if the environment has it
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(WRITE ${documents}/changelog.Debian
  "rehearse (${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; urgency=medium\n\n"
  "  * changelog.gz has the changes of this version.\n\n"
  " -- ${CPACK_PACKAGE_CONTACT}  ${date}\n")
file(WRITE ${documents}/triggers "activate-noawait ldconfig\n")
configure_file(CHANGELOG.md ${documents}/changelog COPYONLY)
execute_process(COMMAND gzip --no-name --best --force ${documents}/changelog ${documents}/changelog.Debian
  COMMAND_ERROR_IS_FATAL ANY)
foreach(component IN LISTS components)
  string(TOUPPER ${component} upper)
  set(destination ${CMAKE_INSTALL_DATADIR}/doc/${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
  install(FILES LICENSE RENAME copyright DESTINATION ${destination} COMPONENT ${component})
  install(FILES ${documents}/changelog.gz ${documents}/changelog.Debian.gz
    DESTINATION ${destination} COMPONENT ${component})
endforeach()
include(CPack)
