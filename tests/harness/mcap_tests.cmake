rehearse_add_test(mcap_test LABEL unit SHARDS 3
  SOURCES
    mcap/by_summary_test.cpp
    mcap/copy_test.cpp
    mcap/damage_test.cpp
    mcap/doctor_test.cpp
    mcap/filter_test.cpp
    mcap/hostile_test.cpp
    mcap/input_test.cpp
    mcap/order_test.cpp
    mcap/reader_test.cpp
    mcap/recover_test.cpp
    mcap/select_test.cpp
    mcap/writer_forms_test.cpp
    mcap/writer_test.cpp
  LIBRARIES Rehearse::harness lz4 zstd)
