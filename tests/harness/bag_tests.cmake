rehearse_add_test(bag_test LABEL unit
  SOURCES
    bag/broken_bags_test.cpp
    bag/containers_test.cpp
    bag/ros1_bag_test.cpp
    bag/standard_types_test.cpp
  LIBRARIES Rehearse::logs fmt::fmt bz2 lz4 sqlite3 zstd)
