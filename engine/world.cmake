find_package(PkgConfig REQUIRED)
pkg_check_modules(ODE REQUIRED IMPORTED_TARGET ode)
find_path(XXHASH_INCLUDE_DIR xxhash.h REQUIRED)

rehearse_add_library(world src/world.cpp src/simulated_body.cpp src/ode_body.cpp src/ode_joint.cpp
  src/kinematic_body.cpp src/beams.cpp src/contact_surface.cpp src/contacts.cpp src/cut.cpp src/geoms.cpp
  src/hull_contacts.cpp src/hull_parts.cpp src/hull_round_contacts.cpp src/own_contacts.cpp src/polytope.cpp
  src/shape_contacts.cpp src/ode_runtime.cpp src/scanner.cpp src/touches.cpp)
target_link_libraries(rehearse_world PUBLIC Rehearse::model PRIVATE PkgConfig::ODE)
target_include_directories(rehearse_world PRIVATE ${XXHASH_INCLUDE_DIR})
