# What `cmake --install` puts where, so that a user's project finds it: find_package(Rehearse CONFIG).
#
# The libraries are shared and keep what they are made with (ODE, OSMesa, urdfdom, yaml-cpp, ...) to themselves: a user's
# project needs Eigen, and GoogleTest for Rehearse::gtest, and no more.
include(CMakePackageConfigHelpers)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/Rehearse)
set(libraries cnoid model world png renderer mcap trace scenario harness report log audit simulation testing gtest)
list(TRANSFORM libraries PREPEND rehearse_)

install(TARGETS ${libraries} EXPORT RehearseTargets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
# nobody links it: audit names it to the dynamic linker
install(TARGETS rehearse_interposer LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY engine/include/rehearse harness/include/rehearse DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(TARGETS ${REHEARSE_SAMPLES} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/rehearse/controllers)
install(FILES fixtures/motions/pick_up.seq fixtures/motions/sr1_squat.seq DESTINATION ${CMAKE_INSTALL_DATADIR}/choreonoid/motion)

install(EXPORT RehearseTargets NAMESPACE Rehearse:: DESTINATION ${package_folder})
configure_package_config_file(tools/cmake/RehearseConfig.cmake.in ${CMAKE_BINARY_DIR}/RehearseConfig.cmake
  INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/RehearseConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES
  ${CMAKE_BINARY_DIR}/RehearseConfig.cmake
  ${CMAKE_BINARY_DIR}/RehearseConfigVersion.cmake
  tools/cmake/RehearseBits.cmake
  tools/cmake/RehearseControllers.cmake
  DESTINATION ${package_folder})
