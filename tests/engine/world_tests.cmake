rehearse_add_test(solver_tests LABEL sim SHARDS 1
  SOURCES solver/bounded_problem_test.cpp solver/forest_test.cpp solver/island_test.cpp
  LIBRARIES Rehearse::simulation)

rehearse_add_test(mjcf_world_test LABEL sim SHARDS 1 SOURCES mjcf/mjcf_world_test.cpp LIBRARIES Rehearse::simulation)

rehearse_add_test(world_tests LABEL sim SHARDS 8
  SOURCES
    world/actuators_test.cpp
    world/backlash_cycle_test.cpp
    world/connections_test.cpp
    world/contacts_test.cpp
    world/create_test.cpp
    world/cut_wrench_test.cpp
    world/direct_step_test.cpp
    world/drives_test.cpp
    world/floating_joints_test.cpp
    world/force_sensor_test.cpp
    world/free_rotation_test.cpp
    world/friction_test.cpp
    world/given_motion_test.cpp
    world/hull_bodies_test.cpp
    world/hull_contacts_test.cpp
    world/inertial_sensors_test.cpp
    world/initial_velocities_test.cpp
    world/joints_test.cpp
    world/kinematic_test.cpp
    world/limits_test.cpp
    world/mass_faults_test.cpp
    world/material_pairs_test.cpp
    world/mimic_test.cpp
    world/own_contacts_test.cpp
    world/passive_joints_test.cpp
    world/planar_test.cpp
    world/range_sensor_meshes_test.cpp
    world/range_sensor_test.cpp
    world/residual_test.cpp
    world/rigid_groups_test.cpp
    world/scanner_test.cpp
    world/sleep_test.cpp
    world/stacks_test.cpp
    world/state_test.cpp
    world/surfaces_test.cpp
    world/terrain_test.cpp
    world/touches_test.cpp
    world/tracks_test.cpp
    world/trimesh_test.cpp
    world/weightless_links_test.cpp
    world/wrenches_test.cpp
  LIBRARIES Rehearse::simulation)

rehearse_add_test(vision_tests LABEL render SHARDS 1
  SOURCES vision/pinhole_test.cpp vision/vision_test.cpp
  LIBRARIES Rehearse::simulation)

# These compute their expected values, which takes long.
set_source_files_properties(world/hull_contacts_test.cpp world/range_sensor_meshes_test.cpp PROPERTIES
  COMPILE_OPTIONS "-O2;-fno-sanitize=all" SKIP_PRECOMPILE_HEADERS ON)
