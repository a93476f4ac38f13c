# Reading and writing recordings. No simulation, no controller: a replay, a viewer and a diff need this and no more.
find_package(fmt REQUIRED)
find_package(nlohmann_json 3.10 REQUIRED)

rehearse_add_library(trace
  src/trace/hashing.cpp
  src/trace/channel_name.cpp
  src/trace/message_json.cpp
  src/trace/message_print.cpp
  src/trace/message_rest.cpp
  src/trace/range_messages.cpp
  src/trace/ros2msg_parse.cpp
  src/trace/ros2msg_decode.cpp
  src/trace/ros2msg_literal.cpp
  src/trace/run_facts.cpp
  src/trace/trace_rows.cpp
  src/trace/trace_typed_rows.cpp
  src/trace/trace_doctor.cpp
  src/trace/trace_load.cpp
  src/trace/trace.cpp)
target_link_libraries(rehearse_trace
  PUBLIC Rehearse::mcap
  PRIVATE fmt::fmt nlohmann_json::nlohmann_json)
