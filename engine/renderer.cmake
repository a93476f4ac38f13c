# The renderer draws with OSMesa. Pictures as files (png.h) are a library of their own: a replay reads frames from a
# trace, and may not link OSMesa.
find_package(PkgConfig REQUIRED)
pkg_check_modules(osmesa REQUIRED IMPORTED_TARGET osmesa)
pkg_check_modules(libdeflate REQUIRED IMPORTED_TARGET libdeflate)
find_package(PNG REQUIRED)
find_package(fmt REQUIRED)

rehearse_add_library(png src/png/png.cpp)
target_link_libraries(rehearse_png PUBLIC Rehearse::model PRIVATE PNG::PNG PkgConfig::libdeflate fmt::fmt)

rehearse_add_library(renderer
  src/renderer/closed_surface.cpp
  src/renderer/renderer.cpp
  src/renderer/renderer_gl.cpp
  src/renderer/renderer_items.cpp
  src/renderer/renderer_meshes.cpp
  src/renderer/renderer_painter.cpp
  src/renderer/vision.cpp)
target_link_libraries(rehearse_renderer PUBLIC Rehearse::model PRIVATE PkgConfig::osmesa fmt::fmt)
