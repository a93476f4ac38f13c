find_package(PNG REQUIRED)  # writes the kinds of PNG that we only read
rehearse_add_test(png_test LABEL unit SHARDS 1 SOURCES renderer/png_test.cpp LIBRARIES Rehearse::harness PNG::PNG)

rehearse_add_test(renderer_test LABEL render SHARDS 3
  SOURCES renderer/renderer_test.cpp renderer/renderer_checker_test.cpp renderer/renderer_culling_test.cpp
    renderer/renderer_depth_test.cpp renderer/renderer_fine_test.cpp renderer/renderer_lights_test.cpp
    renderer/renderer_mesh_test.cpp renderer/renderer_meshes_test.cpp
  LIBRARIES Rehearse::simulation)
