# Reports for a browser. A library of its own, so that a replay links no more than it did. It simulates nothing.
find_package(PkgConfig REQUIRED)
pkg_check_modules(REPORT_CODECS REQUIRED IMPORTED_TARGET libdeflate)

rehearse_add_library(report
  src/report/failure_report.cpp
  src/report/report.cpp
  src/report/report_blobs.cpp
  src/report/report_page.cpp
  src/report/report_pictures.cpp
  src/report/report_robots.cpp
  src/report/report_run.cpp
  src/report/report_series.cpp
  src/report/report_size.cpp)
target_include_directories(rehearse_report PRIVATE ${XXHASH_INCLUDE_DIR})
# Where the page is, seen from the library: in the build folder and installed.
file(RELATIVE_PATH page_installed /prefix/${CMAKE_INSTALL_LIBDIR} /prefix/share/rehearse/report.html)
target_compile_definitions(rehearse_report PRIVATE
  REHEARSE_VERSION="${PROJECT_VERSION}" REHEARSE_PAGE_IN_BUILD="../share/rehearse/report.html"
  REHEARSE_PAGE_INSTALLED="${page_installed}")
target_link_libraries(rehearse_report
  PUBLIC Rehearse::harness
  PRIVATE PkgConfig::REPORT_CODECS Rehearse::png nlohmann_json::nlohmann_json fmt::fmt ${CMAKE_DL_LIBS})
