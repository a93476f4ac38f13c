find_package(tinyxml2 9 REQUIRED)
find_package(PNG REQUIRED)
find_package(JPEG REQUIRED)
rehearse_add_test(model_tests LABEL unit SHARDS 4
  SOURCES model/convex_hull_test.cpp model/convex_parts_test.cpp base/digest_test.cpp base/hashing_test.cpp base/result_test.cpp base/user_cache_test.cpp model/heightmap_file_test.cpp model/mesh_cache_test.cpp
          model/mesh_file_test.cpp model/mesh_hostile_test.cpp
          model/mesh_looks_test.cpp model/mesh_paths_test.cpp model/model_test.cpp model/picture_file_test.cpp
          model/sr1_test.cpp model/urdf_broken_test.cpp model/urdf_devices_test.cpp model/urdf_hostile_test.cpp
          model/urdf_joint_parts_test.cpp
          model/urdf_lenient_test.cpp model/urdf_masses_test.cpp model/urdf_mesh_up_test.cpp model/urdf_meshes_test.cpp model/urdf_referee_test.cpp
          model/urdf_sensor_dialects_test.cpp model/urdf_surfaces_test.cpp model/urdf_test.cpp
  LIBRARIES Rehearse::harness tinyxml2::tinyxml2 PNG::PNG JPEG::JPEG)

rehearse_add_test(units_tests LABEL unit SHARDS 1 SOURCES units/units_test.cpp LIBRARIES Rehearse::harness)

rehearse_add_test(mjcf_tests LABEL unit SHARDS 1 SOURCES mjcf/mjcf_broken_test.cpp mjcf/mjcf_model_test.cpp mjcf/mjcf_test.cpp
  LIBRARIES Rehearse::harness)

# Debian's libmujoco-dev: the same models, read independently.
set(REHEARSE_MUJOCO_MODELS "" CACHE PATH "A folder of MuJoCo models, which are to be compared with MuJoCo's own reader")
find_package(mujoco QUIET)
if(mujoco_FOUND)
  rehearse_add_test(mjcf_interop_test LABEL compat TIMEOUT 300 SOURCES mjcf/mjcf_interop_test.cpp
    LIBRARIES Rehearse::harness mujoco::mujoco fmt::fmt)
  target_compile_definitions(mjcf_interop_test PRIVATE MUJOCO_MODELS="${REHEARSE_MUJOCO_MODELS}")
else()
  message(STATUS "libmujoco-dev isn't installed: models aren't compared with MuJoCo's own reader")
endif()

rehearse_add_test(body_tests LABEL unit SHARDS 1
  SOURCES model/body_broken_test.cpp model/body_test.cpp model/mesh_nodes_test.cpp model/vrml_body_test.cpp model/vrml_test.cpp
  LIBRARIES Rehearse::harness)

rehearse_add_test(body_checkout_test LABEL compat TIMEOUT 300 SOURCES model/body_checkout_test.cpp LIBRARIES Rehearse::harness)
target_compile_definitions(body_checkout_test PRIVATE CHOREONOID_SOURCE="${REHEARSE_CHOREONOID_SOURCE}")
