// The bytes that this process has read, which show whether a result was kept or computed again.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <fstream>
#include <string>

namespace rehearse::test {

/// Of files and of others, since its start.
inline std::int64_t bytes_read() {
  std::ifstream counters("/proc/self/io");
  std::string name;
  std::int64_t count = 0;
  counters >> name >> count;
  EXPECT_EQ(name, "rchar:");
  return count;
}

}  // namespace rehearse::test
