rehearse_add_test(trace_test LABEL unit
  SOURCES
    trace/broken_traces_test.cpp
    trace/cdr_test.cpp
    trace/messages_test.cpp
    trace/ros2msg_test.cpp
    trace/trace_test.cpp
  LIBRARIES Rehearse::trace)
