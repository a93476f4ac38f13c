find_package(nlohmann_json 3.10 REQUIRED)

rehearse_add_test(trace_test LABEL unit SHARDS 1
  SOURCES
    trace/broken_traces_test.cpp
    trace/cdr_test.cpp
    trace/channel_name_test.cpp
    trace/joint_arrays_test.cpp
    trace/message_format_test.cpp
    trace/message_json_test.cpp
    trace/messages_test.cpp
    trace/ros2msg_test.cpp
    trace/run_facts_test.cpp
    trace/trace_test.cpp
  LIBRARIES Rehearse::harness nlohmann_json::nlohmann_json fmt::fmt)
