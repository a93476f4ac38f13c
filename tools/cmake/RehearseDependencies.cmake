# Libraries of other projects that the core is built with. A wing finds those that it alone needs.
find_package(PkgConfig REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(yaml-cpp 0.7 REQUIRED)
find_package(tinyxml2 9 REQUIRED)
find_package(Qhull REQUIRED)
find_package(PNG REQUIRED)
find_package(JPEG REQUIRED)
find_package(Threads REQUIRED)
find_path(XXHASH_INCLUDE_DIR xxhash.h REQUIRED)
pkg_check_modules(URDFDOM REQUIRED IMPORTED_TARGET urdfdom)
pkg_check_modules(assimp REQUIRED IMPORTED_TARGET assimp)
pkg_check_modules(libdeflate REQUIRED IMPORTED_TARGET libdeflate)
pkg_check_modules(ODE REQUIRED IMPORTED_TARGET ode)
pkg_check_modules(osmesa REQUIRED osmesa)  # its headers: the renderer loads the library when it draws
pkg_check_modules(LIBDW REQUIRED libdw)    # likewise: it is loaded when a library's line information is read
pkg_check_modules(MCAP_CODECS REQUIRED IMPORTED_TARGET libzstd liblz4 libdeflate)

add_library(rehearse_xxhash INTERFACE)
target_include_directories(rehearse_xxhash INTERFACE ${XXHASH_INCLUDE_DIR})
