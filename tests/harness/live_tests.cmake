# The server for viewers: its handshakes, its frames, its protocol and its pages; the files that a page watches.
rehearse_add_test(live_test LABEL unit TIMEOUT 240
  SOURCES
    live/hostile_viewers_test.cpp
    live/pages_test.cpp
    live/viewer_protocol_test.cpp
    ui/source_watch_test.cpp
  LIBRARIES Rehearse::viewing Threads::Threads fmt::fmt nlohmann_json::nlohmann_json)
