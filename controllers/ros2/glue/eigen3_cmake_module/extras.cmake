# Eigen brings its own file for CMake; Eigen3_TARGETS is the name that packages link by this module.
find_package(Eigen3 REQUIRED)
set(Eigen3_TARGETS Eigen3::Eigen)
