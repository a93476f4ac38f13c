# The server for viewers: its handshakes, its frames, and its protocol.
rehearse_add_test(live_test LABEL unit TIMEOUT 240
  SOURCES
    live/hostile_viewers_test.cpp
    live/viewer_protocol_test.cpp
  LIBRARIES Rehearse::viewing Threads::Threads fmt::fmt nlohmann_json::nlohmann_json)
