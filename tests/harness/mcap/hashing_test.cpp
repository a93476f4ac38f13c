// Hashes of files, and which of them are kept.
#include "base/hashing.h"

#include <gtest/gtest.h>

#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "base/file_identity.h"
#include "support/bytes_read.h"
#include "support/temporary_folder.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using std::chrono::seconds;

class ContentHash : public ::testing::Test {
 protected:
  void write(const std::string& text) const { std::ofstream(file_) << text; }
  /// No program can set the time of a file's last change, so that a file has to wait for its age.
  void wait_until_settled() const {
    while (!FileIdentity::of(file_)->is_older_than(seconds(2))) ::usleep(100'000);
  }

  const test::TemporaryFolder folder_;
  const fs::path file_ = folder_ / "library.so";
};

TEST_F(ContentHash, AnUnchangedFileIsReadOnce) {
  const std::string text(1 << 20, 'a');
  write(text);
  wait_until_settled();
  const std::int64_t before = test::bytes_read();
  const std::string hash = content_hash_of(file_);
  const std::int64_t once = test::bytes_read();
  EXPECT_EQ(content_hash_of(file_), hash);
  EXPECT_EQ(hash, hash_text(hash_bytes(text.data(), text.size())));
  EXPECT_GT(once - before, std::ssize(text));
  EXPECT_LT(test::bytes_read() - once, std::ssize(text) / 100);
}

TEST_F(ContentHash, AChangeOfAKeptFileIsNoticedThoughItsSizeAndItsTimeAreThoseFromBefore) {
  write("before");
  const auto written = fs::last_write_time(file_);
  wait_until_settled();
  const std::string before = content_hash_of(file_);
  write("after!");
  fs::last_write_time(file_, written);
  EXPECT_NE(content_hash_of(file_), before);
}

TEST_F(ContentHash, AnotherFileInItsPlaceIsNoticed) {
  write("before");
  wait_until_settled();
  const std::string before = content_hash_of(file_);
  std::ofstream(folder_ / "other.so") << "after!";
  fs::rename(folder_ / "other.so", file_);
  EXPECT_NE(content_hash_of(file_), before);
}

TEST_F(ContentHash, AFileThatWasJustChangedIsReadEachTime) {
  write("0");
  std::string before = content_hash_of(file_);
  for (const char* text : {"1", "2", "3", "4", "5"}) {  // within one step of the file system's clock
    write(text);
    const std::string now = content_hash_of(file_);
    EXPECT_NE(now, before) << text;
    before = now;
  }
}

TEST_F(ContentHash, OfAMissingFileIsThatOfNoBytes) {
  EXPECT_EQ(content_hash_of(folder_ / "none.so"), hash_text(hash_bytes(nullptr, 0)));
  EXPECT_EQ(FileIdentity::of(folder_ / "none.so"), std::nullopt);
}

}  // namespace
}  // namespace rehearse
