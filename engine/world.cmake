find_package(PkgConfig REQUIRED)
pkg_check_modules(ODE REQUIRED IMPORTED_TARGET ode)
find_path(XXHASH_INCLUDE_DIR xxhash.h REQUIRED)

rehearse_add_library(world src/world/world.cpp src/world/simulated_body.cpp src/world/ode_body.cpp src/world/ode_joint.cpp
  src/world/kinematic_body.cpp src/world/beams.cpp src/world/contact_surface.cpp src/world/contacts.cpp src/world/cut.cpp src/world/geoms.cpp
  src/world/hull_contacts.cpp src/world/hull_parts.cpp src/world/hull_round_contacts.cpp src/world/own_contacts.cpp src/world/polytope.cpp
  src/world/shape_contacts.cpp src/world/ode_runtime.cpp src/world/scanner.cpp src/world/state_by_name.cpp src/world/touches.cpp)
target_link_libraries(rehearse_world PUBLIC Rehearse::model PRIVATE PkgConfig::ODE)
target_include_directories(rehearse_world PRIVATE ${XXHASH_INCLUDE_DIR})
