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
  src/mesh/convex_hull.cpp
  src/model/diagnostic.cpp
  src/model/image.cpp
  src/mesh/mesh_cache.cpp
  src/mesh/mesh_file.cpp
  src/mesh/mesh_format.cpp
  src/mesh/mesh_input.cpp
  src/mesh/mesh_materials.cpp
  src/mesh/mesh_paths.cpp
  src/mesh/mesh_scene.cpp
  src/model/model.cpp
  src/mesh/obj_check.cpp
  src/mesh/package_search.cpp
  src/mesh/picture_file.cpp
  src/model/pinhole.cpp
  src/model/rigid_groups.cpp
  src/model/shape_bounds.cpp
  src/model/text.cpp
  src/urdf/urdf.cpp
  src/urdf/urdf_cameras.cpp
  src/urdf/urdf_contact_sensors.cpp
  src/urdf/urdf_devices.cpp
  src/urdf/urdf_dynamics.cpp
  src/urdf/urdf_findings.cpp
  src/urdf/urdf_force_sensors.cpp
  src/urdf/urdf_joints.cpp
  src/urdf/urdf_lights.cpp
  src/urdf/urdf_links.cpp
  src/urdf/urdf_masses.cpp
  src/urdf/urdf_materials.cpp
  src/urdf/urdf_meshes.cpp
  src/urdf/urdf_mimics.cpp
  src/urdf/urdf_placement.cpp
  src/urdf/urdf_range_sensors.cpp
  src/urdf/urdf_referee.cpp
  src/urdf/urdf_schema.cpp
  src/urdf/urdf_surfaces.cpp
  src/urdf/urdf_text.cpp
  src/urdf/urdf_tracks.cpp
  src/urdf/urdf_transmissions.cpp
  src/urdf/urdf_tree.cpp
  src/urdf/urdf_values.cpp)
target_include_directories(rehearse_model PUBLIC
  $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_link_libraries(rehearse_model PUBLIC Eigen3::Eigen
  PRIVATE $<BUILD_INTERFACE:PkgConfig::URDFDOM> $<BUILD_INTERFACE:PkgConfig::assimp> $<BUILD_INTERFACE:PNG::PNG>
          $<BUILD_INTERFACE:JPEG::JPEG> $<BUILD_INTERFACE:Qhull::qhull_r> $<BUILD_INTERFACE:tinyxml2::tinyxml2>
          $<BUILD_INTERFACE:fmt::fmt>)
target_include_directories(rehearse_model PRIVATE ${XXHASH_INCLUDE_DIR})
# Eigen's alignment is part of the layout of every public type: the same whatever -m flags a user compiles with.
target_compile_definitions(rehearse_model PUBLIC EIGEN_MAX_ALIGN_BYTES=16)
