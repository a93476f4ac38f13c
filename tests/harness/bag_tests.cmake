rehearse_add_test(bag_test LABEL unit
  SOURCES
    bag/broken_bags_test.cpp
    bag/containers_test.cpp
    bag/standard_types_test.cpp
  LIBRARIES Rehearse::logs sqlite3 zstd)
