// The files of the user's cache: what goes when there are too many.
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <string>

#include "base/user_cache.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

class UserCache : public ::testing::Test {
 protected:
  UserCache() { fs::remove_all(folder_); }
  ~UserCache() override { fs::remove_all(folder_); }
  void keep(const std::string& name, std::size_t size) const {
    keep_in_cache(folder_ / name, std::string(size, 'x'), bound);
  }
  bool has(const std::string& name) const { return fs::exists(folder_ / name); }
  void make_old(const std::string& name, int days) const {
    fs::last_write_time(folder_ / name, fs::file_time_type::clock::now() - std::chrono::hours(24 * days));
  }
  static constexpr std::uintmax_t bound = 100;  // [bytes]
  const fs::path folder_ = fs::path(::testing::TempDir()) / ("user_cache_" + std::to_string(::getpid()));
};

TEST_F(UserCache, TheFileThatWasReadLongestAgoGoesFirst) {
  keep("first", 40);
  keep("second", 40);
  make_old("first", 3);
  make_old("second", 2);
  EXPECT_EQ(read_from_cache(folder_ / "first"), std::string(40, 'x'));
  keep("third", 40);
  EXPECT_TRUE(has("first")) << "it was read after the second";
  EXPECT_FALSE(has("second"));
  EXPECT_TRUE(has("third"));
}

TEST_F(UserCache, AFileAboveTheBoundIsNotKept) {
  keep("small", 60);
  keep("large", 101);
  EXPECT_TRUE(has("small"));
  EXPECT_FALSE(has("large"));
}

TEST_F(UserCache, FilesWithinTheBoundStay) {
  for (const char* name : {"first", "second", "third"}) {
    keep(name, 30);
    make_old(name, 400);
  }
  keep("fourth", 10);
  for (const char* name : {"first", "second", "third", "fourth"}) EXPECT_TRUE(has(name)) << name;
}

}  // namespace
}  // namespace rehearse
