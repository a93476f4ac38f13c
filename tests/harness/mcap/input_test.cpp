// What a Reader opens besides files: pipes, and what it refuses.
#include "mcap_files.h"

#include <gmock/gmock.h>

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <algorithm>
#include <cstdlib>
#include <thread>
#include <utility>

using namespace rehearse;
using namespace rehearse::test;
using testing::HasSubstr;

namespace {

/// Both ends of a pipe.
class Pipe {
 public:
  Pipe() { EXPECT_EQ(::pipe(ends_), 0); }
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void write(mcap::Bytes bytes) const {
    EXPECT_EQ(::write(ends_[1], bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  void close_end(int end) {
    if (ends_[end] >= 0) ::close(std::exchange(ends_[end], -1));
  }
  std::string path() const { return "/proc/self/fd/" + std::to_string(ends_[0]); }

 private:
  int ends_[2] = {-1, -1};
};

}  // namespace

TEST(McapInput, APipeIsReadAsAFile) {
  const TempFile file;
  ASSERT_EQ(::mkfifo(file.path().c_str(), 0600), 0);
  const Buffer bytes = small_file();
  std::thread feeder([&] { file.write(bytes); });
  auto reader = mcap::Reader::open(file.path());
  feeder.join();
  ASSERT_TRUE(reader) << to_string(reader.errors());
  EXPECT_EQ((*reader)->size(), bytes.size());
  EXPECT_EQ(pass_in_order(**reader).messages.size(), 5u);
}

TEST(McapInput, APipeThatHasNoNameCanBeOpenedAgain) {
  Pipe pipe, other;
  pipe.write(small_file());
  pipe.close_end(1);
  other.write(Composer().magic().header().end().bytes);
  other.close_end(1);
  for (int time = 0; time < 2; ++time) {
    EXPECT_EQ(pass_over(*std::move(*mcap::Reader::open(pipe.path()))).messages.size(), 5u);
    EXPECT_EQ(pass_over(*std::move(*mcap::Reader::open(other.path()))).messages.size(), 0u);
  }
}

TEST(McapInput, APipeForWhichThereIsNoRoomIsRefused) {
  const char* const before = std::getenv("TMPDIR");
  const std::string restored = before ? before : "";
  ::setenv("TMPDIR", "/nonexistent", 1);
  Pipe pipe;
  const auto reader = mcap::Reader::open(pipe.path());
  before ? ::setenv("TMPDIR", restored.c_str(), 1) : ::unsetenv("TMPDIR");
  ASSERT_FALSE(reader);
  EXPECT_THAT(to_string(reader.errors()),
              HasSubstr(": error: can't store the input in the folder for temporary files: "));
}

TEST(McapInput, AFileThatIsMadeUpAsItIsReadIsReadAsAFile) {
  const auto reader = mcap::Reader::open("/proc/self/status");
  ASSERT_FALSE(reader);
  EXPECT_EQ(to_string(reader.errors()),
            "/proc/self/status: error: not an MCAP file: it doesn't begin with the magic bytes \\x89MCAP0\\r\\n\n");
}

TEST(McapInput, WhatNothingCanBeReadOfIsRefused) {
  const TempFile file;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  ASSERT_LT(file.path().string().size(), sizeof address.sun_path);
  file.path().string().copy(address.sun_path, sizeof address.sun_path - 1);
  const int made = ::socket(AF_UNIX, SOCK_STREAM, 0);
  ASSERT_EQ(::bind(made, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  const auto why = [](const std::filesystem::path& path) {
    const auto reader = mcap::Reader::open(path);
    return reader.errors().front().message;
  };
  EXPECT_EQ(why(file.path()), "can't read the trace: it is a socket's file");
  EXPECT_EQ(why("/dev/zero"), "can't read the trace: it is a device");
  EXPECT_EQ(why("/nonexistent.mcap"), "can't read the trace: No such file or directory");
  ::close(made);
}

TEST(McapInput, AFileThatGrowsIsReadAsLargeAsItWas) {
  const TempFile file;
  const Composer first = Composer().magic().header().channel(1, "/a").message(1, 1, "first");
  file.write(first.bytes);
  auto reader = std::move(*mcap::Reader::open(file.path()));
  file.write(Composer().raw(first.bytes).message(1, 2, "second").bytes);
  EXPECT_EQ(reader->size(), first.bytes.size());
  EXPECT_EQ(pass_over(*reader).messages.size(), 1u);
}
