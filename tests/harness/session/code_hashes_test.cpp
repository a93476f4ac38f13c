// The hashes of the code in a process, which are kept for the next process.
#include "core/recording/code_hashes.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <string>

#include "base/file_identity.h"
#include "base/hashing.h"
#include "support/bytes_read.h"
#include "support/temporary_folder.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

/// A file that counts as a library of this process.
class CodeHashes : public ::testing::Test {
 protected:
  CodeHashes() { ::setenv("REHEARSE_CACHE", cache_.c_str(), 1); }
  ~CodeHashes() override { before_ ? ::setenv("REHEARSE_CACHE", before_->c_str(), 1) : ::unsetenv("REHEARSE_CACHE"); }

  /// No program can set the time of a file's last change, so that a file has to wait for its age.
  void write(const std::string& code) const {
    std::ofstream(file_) << code;
    while (!FileIdentity::of(file_)->is_older_than(std::chrono::seconds(2))) ::usleep(100'000);
  }
  std::map<std::string, LoadedLibrary> libraries(const std::string& build_id = "an identifier") const {
    return {{"code.so", {file_.string(), build_id, {{0, fs::file_size(file_)}}, FileIdentity::of(file_)->inode}}};
  }
  std::string hash(const std::string& build_id = "an identifier") const {
    const auto hashes = code_hashes_of(libraries(build_id));
    EXPECT_TRUE(hashes.ok()) << to_string(hashes.errors());
    return hashes.ok() ? hashes->at("code.so") : "";
  }
  static std::string hash_of(const std::string& code) { return hash_text(hash_bytes(code.data(), code.size())); }
  fs::path kept() const {
    for (const fs::directory_entry& entry : fs::directory_iterator(cache_ / "code")) return entry.path();
    return {};
  }

  const test::TemporaryFolder folder_;
  const fs::path file_ = folder_ / "code.so", cache_ = folder_ / "cache";

 private:
  const std::optional<std::string> before_ = [] {
    const char* set = std::getenv("REHEARSE_CACHE");
    return set ? std::optional<std::string>(set) : std::nullopt;
  }();
};

TEST_F(CodeHashes, OfAnUnchangedFileAreReadOnce) {
  const std::string code(1 << 20, 'a');
  write(code);
  const std::int64_t before = test::bytes_read();
  EXPECT_EQ(hash(), hash_of(code));
  const std::int64_t once = test::bytes_read();
  EXPECT_EQ(hash(), hash_of(code));
  EXPECT_GT(once - before, std::ssize(code));
  EXPECT_LT(test::bytes_read() - once, std::ssize(code) / 100);
}

TEST_F(CodeHashes, NoticeAChangeThatKeepsSizeAndTime) {
  write("before");
  EXPECT_EQ(hash(), hash_of("before"));
  const auto written = fs::last_write_time(file_);
  write("after!");
  fs::last_write_time(file_, written);
  EXPECT_EQ(hash(), hash_of("after!"));
}

TEST_F(CodeHashes, NoticeAnotherFileInThePlaceOfTheFirst) {
  write("before");
  EXPECT_EQ(hash(), hash_of("before"));
  fs::rename(file_, folder_ / "first.so");
  write("after!");
  EXPECT_EQ(hash(), hash_of("after!"));
}

/// As in a file system whose times and inodes are those of an earlier image.
TEST_F(CodeHashes, AreThoseOfTheBuildIdentifier) {
  write("before");
  EXPECT_EQ(hash("one"), hash_of("before"));
  const std::string of_one = [&] {
    std::ifstream stream(kept(), std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  }();
  EXPECT_EQ(hash("two"), hash_of("before"));
  std::ifstream stream(kept(), std::ios::binary);
  EXPECT_NE(std::string(std::istreambuf_iterator<char>(stream), {}), of_one);
}

TEST_F(CodeHashes, ThatAreDamagedAreReadAgain) {
  write("code");
  EXPECT_EQ(hash(), hash_of("code"));
  std::ifstream stream(kept(), std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(stream), {}};
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] ^= 1;
    std::ofstream(kept(), std::ios::binary) << damaged;
    EXPECT_EQ(hash(), hash_of("code")) << at;
    std::ofstream(kept(), std::ios::binary) << whole.substr(0, at);
    EXPECT_EQ(hash(), hash_of("code")) << at;
  }
}

TEST_F(CodeHashes, OfFilesThatMayChangeUnnoticedAreNotKept) {
  std::ofstream(file_) << "just written";
  EXPECT_EQ(hash(), hash_of("just written"));
  write("code without an identifier");
  EXPECT_EQ(hash(""), hash_of("code without an identifier"));
  EXPECT_FALSE(fs::exists(cache_));
  ::setenv("REHEARSE_CACHE", "off", 1);
  EXPECT_EQ(hash(), hash_of("code without an identifier"));
}

TEST_F(CodeHashes, AreNoneIfTheFileIsNotTheLoadedOne) {
  write("code");
  EXPECT_EQ(hash(), hash_of("code"));
  auto replaced = libraries();
  ++replaced.at("code.so").inode;
  const auto hashes = code_hashes_of(replaced);
  ASSERT_FALSE(hashes.ok());
  EXPECT_NE(hashes.errors()[0].message.find("was replaced"), std::string::npos);
}

}  // namespace
}  // namespace rehearse
