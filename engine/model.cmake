find_package(PkgConfig REQUIRED)
find_package(tinyxml2 9 REQUIRED)
find_package(fmt REQUIRED)
find_package(Qhull REQUIRED)
find_package(PNG REQUIRED)
find_package(JPEG REQUIRED)
find_path(XXHASH_INCLUDE_DIR xxhash.h REQUIRED)
pkg_check_modules(URDFDOM REQUIRED IMPORTED_TARGET urdfdom)
pkg_check_modules(assimp REQUIRED IMPORTED_TARGET assimp)

rehearse_add_library(model
  src/convex_hull.cpp
  src/diagnostic.cpp
  src/image.cpp
  src/mesh_cache.cpp
  src/mesh_file.cpp
  src/mesh_format.cpp
  src/mesh_input.cpp
  src/mesh_materials.cpp
  src/mesh_paths.cpp
  src/mesh_scene.cpp
  src/model.cpp
  src/obj_check.cpp
  src/package_search.cpp
  src/picture_file.cpp
  src/pinhole.cpp
  src/rigid_groups.cpp
  src/shape_bounds.cpp
  src/urdf.cpp
  src/urdf_cameras.cpp
  src/urdf_contact_sensors.cpp
  src/urdf_devices.cpp
  src/urdf_dynamics.cpp
  src/urdf_findings.cpp
  src/urdf_force_sensors.cpp
  src/urdf_joints.cpp
  src/urdf_lights.cpp
  src/urdf_links.cpp
  src/urdf_masses.cpp
  src/urdf_materials.cpp
  src/urdf_meshes.cpp
  src/urdf_mimics.cpp
  src/urdf_placement.cpp
  src/urdf_range_sensors.cpp
  src/urdf_referee.cpp
  src/urdf_schema.cpp
  src/urdf_surfaces.cpp
  src/urdf_text.cpp
  src/urdf_tracks.cpp
  src/urdf_transmissions.cpp
  src/urdf_tree.cpp
  src/urdf_values.cpp)
target_include_directories(rehearse_model PUBLIC
  $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_link_libraries(rehearse_model PUBLIC Eigen3::Eigen
  PRIVATE $<BUILD_INTERFACE:PkgConfig::URDFDOM> $<BUILD_INTERFACE:PkgConfig::assimp> $<BUILD_INTERFACE:PNG::PNG>
          $<BUILD_INTERFACE:JPEG::JPEG> $<BUILD_INTERFACE:Qhull::qhull_r> $<BUILD_INTERFACE:tinyxml2::tinyxml2>
          $<BUILD_INTERFACE:fmt::fmt>)
target_include_directories(rehearse_model PRIVATE ${XXHASH_INCLUDE_DIR})
# Eigen's alignment is part of the layout of every public type: the same whatever -m flags a user compiles with.
target_compile_definitions(rehearse_model PUBLIC EIGEN_MAX_ALIGN_BYTES=16)
