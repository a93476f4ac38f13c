# Recordings as tables, pictures and videos. Part of the harness library: units and names of series are known there.
find_package(PNG REQUIRED)

target_sources(rehearse_harness PRIVATE
  src/export/channel_table.cpp
  src/export/export_files.cpp
  src/export/export_pictures.cpp
  src/export/export_source.cpp
  src/export/export_tables.cpp
  src/export/picture_file.cpp
  src/mcap/replaceable.cpp
  src/export/video_encoder.cpp)
target_link_libraries(rehearse_harness PRIVATE PNG::PNG)
