rehearse_add_library(model src/diagnostic.cpp)
target_include_directories(rehearse_model PUBLIC
  $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_link_libraries(rehearse_model PUBLIC Eigen3::Eigen)
# Eigen's alignment is part of the layout of every public type: the same whatever -m flags a user compiles with.
target_compile_definitions(rehearse_model PUBLIC EIGEN_MAX_ALIGN_BYTES=16)
