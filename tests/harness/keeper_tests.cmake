rehearse_add_test(keeper_test LABEL unit SHARDS 1
  SOURCES
    keeper/ring_test.cpp
    keeper/trace_keeper_test.cpp
  LIBRARIES Rehearse::harness)
rehearse_add_test(guard_test LABEL unit SHARDS 1
  SOURCES
    guard/own_process_test.cpp
    guard/worker_pool_test.cpp
  LIBRARIES Rehearse::harness)
