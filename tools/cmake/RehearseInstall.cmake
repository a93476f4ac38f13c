# Installation: the places of files, and the package for a user's project: find_package(Rehearse CONFIG).
#
# The libraries are shared and hide their dependencies (ODE, OSMesa, urdfdom, yaml-cpp, ...): a user's project needs
# only Eigen, and GoogleTest for Rehearse::gtest.
#
# Components: `runtime`, the command and its libraries; `development`, to build and test controllers; `samples`, those
# that are built. tools/package makes a Debian package of each of the first two.
include(CMakePackageConfigHelpers)
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)  # tests need not be built to install

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/Rehearse)
get_property(libraries GLOBAL PROPERTY REHEARSE_LIBRARIES)
get_property(headers GLOBAL PROPERTY REHEARSE_HEADERS)

install(TARGETS ${libraries} EXPORT RehearseTargets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} NAMELINK_COMPONENT development
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
  FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development
  INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
if(TARGET rehearse_interposer)
  # no target links it: audit passes its name to the dynamic linker
  install(TARGETS rehearse_interposer LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
endif()
install(TARGETS rehearse_assimp LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/rehearse)  # the model library loads it
install(FILES ${headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/rehearse COMPONENT development)
install(TARGETS ${REHEARSE_SAMPLES}
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/rehearse/controllers COMPONENT samples OPTIONAL)
install(FILES fixtures/motions/pick_up.seq fixtures/motions/sr1_squat.seq fixtures/motions/sr1_walk.seq
  DESTINATION ${CMAKE_INSTALL_DATADIR}/choreonoid/motion COMPONENT samples)
install(FILES fixtures/policy/trot.txt fixtures/policy/trot.yaml
  DESTINATION ${CMAKE_INSTALL_DATADIR}/choreonoid/policy COMPONENT samples)

# The build tree is a package as well: -D CMAKE_PREFIX_PATH=build finds it at the same relative places as installed.
set(built_package_folder ${CMAKE_BINARY_DIR}/${package_folder})
install(EXPORT RehearseTargets NAMESPACE Rehearse:: DESTINATION ${package_folder} COMPONENT development)
export(EXPORT RehearseTargets NAMESPACE Rehearse:: FILE ${built_package_folder}/RehearseTargets.cmake)
configure_package_config_file(tools/cmake/RehearseConfig.cmake.in ${built_package_folder}/RehearseConfig.cmake
  INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${built_package_folder}/RehearseConfigVersion.cmake COMPATIBILITY SameMinorVersion)
foreach(file RehearseBits.cmake RehearseControllers.cmake fuzz_points.cpp)
  configure_file(tools/cmake/${file} ${built_package_folder}/${file} COPYONLY)
endforeach()
install(FILES
  ${built_package_folder}/RehearseConfig.cmake
  ${built_package_folder}/RehearseConfigVersion.cmake
  tools/cmake/RehearseBits.cmake
  tools/cmake/RehearseControllers.cmake
  tools/cmake/fuzz_points.cpp
  DESTINATION ${package_folder} COMPONENT development)

# Man pages, and completions of shells, from the output of the command with --help.
find_program(REHEARSE_HELP2MAN help2man)
mark_as_advanced(REHEARSE_HELP2MAN)
if(REHEARSE_HELP2MAN)
  set(pages ${CMAKE_BINARY_DIR}/share/man/man1/rehearse.1.gz)
  add_custom_command(OUTPUT ${pages}
    COMMAND ${PROJECT_SOURCE_DIR}/tools/pages $<TARGET_FILE:rehearse> ${CMAKE_BINARY_DIR}/share
    DEPENDS tools/pages rehearse ${REHEARSE_PROGRAMS}
    COMMENT "Writing man pages and completions" VERBATIM)
  add_custom_target(rehearse_pages ALL DEPENDS ${pages})
  foreach(folder man bash-completion zsh fish)
    install(DIRECTORY ${CMAKE_BINARY_DIR}/share/${folder} DESTINATION ${CMAKE_INSTALL_DATADIR})
  endforeach()
else()
  message(STATUS "Man pages and completions are left out: help2man isn't installed")
endif()

# What tools/demo builds: the core and the wing viewing.
add_custom_target(rehearse_core DEPENDS rehearse rehearse-read rehearse-simulate rehearse_assimp rehearse_schemas)

# Everything that is installed, except the samples.
add_custom_target(rehearse_installed DEPENDS ${libraries} rehearse_assimp rehearse ${REHEARSE_PROGRAMS})
foreach(target rehearse_interposer rehearse_pages rehearse_schemas)
  if(TARGET ${target})
    add_dependencies(rehearse_installed ${target})
  endif()
endforeach()

if(PROJECT_IS_TOP_LEVEL)
  add_custom_target(uninstall
    COMMAND ${CMAKE_COMMAND} -D BUILD=${CMAKE_BINARY_DIR} -P ${PROJECT_SOURCE_DIR}/tools/cmake/uninstall.cmake VERBATIM)
  include(RehearsePackage)
endif()
